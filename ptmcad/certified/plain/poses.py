"""The equilibria at a point of any mechanism with springs of free lengths, with everything asked of a pose.

Guarantee: each equilibrium is proved, and all are there unless the answer is UNDECIDED, which then says in how many
boxes there may be more. Every number settles the digits asked for or, where it may be zero, is enclosed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from flint import arb, arb_mat, ctx

from ptmcad.answer.poses import Pose, Poses, Spring, TorsionSpring
from ptmcad.answer.regionmap import Solution, Status
from ptmcad.certified.arb_evaluation import ball, run_arb
from ptmcad.certified.arb_isolation import Box
from ptmcad.certified.formula import Graph
from ptmcad.certified.plain.covering import located
from ptmcad.certified.plain.points import BranchCounter, PlainCounter, plain_counter
from ptmcad.certified.plain.problem import FIRST, MAX_UNKNOWNS_AT_POINTS
from ptmcad.certified.plain.resting import rational_point
from ptmcad.certified.plain.slanted import with_slanted
from ptmcad.certified.plain.spectrum import ordered_eigenvalues
from ptmcad.certified.plain.symmetric import Point, quarter_turns, rational_numbers
from ptmcad.certified.potential import potential
from ptmcad.certified.tape import Tape, record
from ptmcad.mechanism import Mechanism, Model
from ptmcad.mechanism.evaluate import value_at
from ptmcad.question.domain import prove_slice
from ptmcad.question.slice import Axis, Count, Slice
from ptmcad.text.balls import bounded, enclosed
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.expressions import axis

MAX_DOUBLINGS = 4
"""Of the bits, for a number that is not distinguished from zero."""
NOT_TOLD = (
    "not all equilibria could be distinguished: there are infinitely many, one is nearly degenerate, or a spring has "
    "nearly no length there"
)


def plain_poses(mechanism: Mechanism, parameters: Mapping[str, Fraction], digits: int) -> Poses:
    """All equilibria of a mechanism.

    Parameters
    ----------
    parameters : all variables of the description.
    digits : significant digits that every enclosure settles.

    Raises
    ------
    ConfigError, GeometryError
        As `ptmcad.certified.plain.points.plain_counter` does, or where a parameter is not what its kind asks for.
    """
    slice = point_slice(mechanism, parameters)
    prove_slice(slice)
    zeros, unclear = solutions_at(plain_counter(slice, MAX_UNKNOWNS_AT_POINTS), Count.INDEX)
    written = tape_of(mechanism, parameters)
    poses = [_pose(mechanism, parameters, written, at, solution, digits) for at, solution in zeros]
    return answered(mechanism, parameters, digits, sorted(poses, key=lambda p: _order(p[0])), unclear, NOT_TOLD)


def answered(
    model: Model,
    parameters: Mapping[str, Fraction],
    digits: int,
    poses: Sequence[tuple[Pose, int]],
    unclear: int,
    reason: str,
    remark: str = "",
) -> Poses:
    """The answer: these poses, each with the bits that it took; for a reason undecided where some may lack.

    Parameters
    ----------
    unclear : boxes in which there may be more equilibria.
    reason : for which there are such boxes.
    remark : where there are none.
    """
    most = max((bits for _, bits in poses), default=0)
    status, remark = (Status.UNDECIDED, reason) if unclear else (Status.CERTIFIED, remark)
    return Poses(model, parameters, tuple(pose for pose, _ in poses), status, digits, most, remark, undecided=unclear)


def solutions_at(counter: BranchCounter, count: Count) -> tuple[list[tuple[PlainCounter, Solution]], int]:
    """The solutions, each with the counter of its branch, and the number of boxes in which there may be more."""
    found, unclear = [], 0
    for branch in counter.branches:
        counts = branch.at(Fraction(0), Fraction(0), count)
        unclear += counts.open
        found += [(branch, solution) for solution in counts.solutions]
    return found, unclear


def boxes_of(counter: PlainCounter, solution: Solution, precision: int) -> tuple[Box, Box]:
    """A box of the mechanism's unknowns that holds a solution of a branch and no other one, and a narrow one."""
    cube, box = located(counter.problem, counter.equations, (Fraction(0), Fraction(0)), solution, precision)
    with ctx.workprec(precision):
        return (*box[:FIRST], *(ball(c - cube.radius, c + cube.radius) for c in cube.center)), box


def _order(pose: Pose) -> tuple[Fraction, ...]:
    """Stable equilibria first, then by energy; without a potential by the unknowns."""
    if pose.energy is not None:
        return Fraction(not pose.stable), pose.energy.center
    return tuple(number.center for number in (*pose.angles, *pose.reals))


def point_slice(model: Model, parameters: Mapping[str, Fraction]) -> Slice:
    """The model at a point as a slice on whose axes nothing depends."""
    unit = (Fraction(0), Fraction(1))
    constants = {name: 0 * axis(0) + value for name, value in parameters.items()}
    return Slice("point", model, (Axis("x", *unit), Axis("y", *unit)), constants, Count.INDEX)


def tape_of(mechanism: Mechanism, parameters: Mapping[str, Fraction]) -> tuple[Tape, tuple[str, ...]]:
    """Everything asked of a pose as a tape, and the names of its outputs; the Hessian's entries come row by row.

    Without a potential there is neither an energy nor a Hessian.
    """
    graph = Graph()
    unknowns = {name: graph.variable(number) for number, name in enumerate(mechanism.unknowns, 2)}
    at = potential(mechanism, {name: graph.constant(value) for name, value in parameters.items()}, unknowns)
    found = {f"cos {angle}": unknowns[angle].cos() for angle in mechanism.angles}
    found |= {f"sin {angle}": unknowns[angle].sin() for angle in mechanism.angles}
    found |= {f"real {name}": unknowns[name] for name in mechanism.reals}
    found |= {f"{name} {n}": coordinate for name, pair in at.points.items() for n, coordinate in enumerate(pair)}
    found |= {f"length {n}": length for n, length in enumerate(at.lengths)}
    found |= {f"force {n}": force for n, force in enumerate(at.forces)}
    for n, (spring, (cosine, sine)) in enumerate(zip(mechanism.torsion, at.deflections, strict=True)):
        moment = value_at(spring.stiffness, parameters) * sine
        found |= {f"torsion cos {n}": cosine, f"torsion sin {n}": sine, f"torsion moment {n}": moment}
    if not mechanism.has_potential:
        return record([list(found.values()), []]), tuple(found)
    found["energy"] = at.energy
    slopes = [graph.derivative(at.energy, v.variable) for v in unknowns.values()]
    hessian = [graph.derivative(slope, v.variable) for slope in slopes for v in unknowns.values()]
    return record([list(found.values()), hessian]), tuple(found)


def _pose(
    mechanism: Mechanism,
    parameters: Mapping[str, Fraction],
    written: tuple[Tape, tuple[str, ...]],
    counter: PlainCounter,
    solution: Solution,
    digits: int,
) -> tuple[Pose, int]:
    """The pose with all numbers settled or, where they may be zero, enclosed; and the bits that this took."""
    tape, _ = written
    bits, found = 32 + 2 * digits, dict[str, Enclosure]()
    turns: dict[str, int] = {}
    at: Point = {}
    for attempt in range(MAX_DOUBLINGS):
        bits *= 2
        whole, box = boxes_of(counter, solution, bits)
        if attempt > 0:  # some number is not settled: it may be a short one, or a longer one with more bits
            with ctx.workprec(bits):
                held, boxes = (dict(zip(mechanism.unknowns, some[2:], strict=True)) for some in (box, whole))
                at = at or rational_point(mechanism, parameters, held, boxes)
                rational, surds = with_slanted(mechanism, parameters, at, held, boxes)
            turns |= quarter_turns(mechanism, rational)
            if rational or surds.multiples:
                found |= rational_numbers(mechanism, parameters, rational, surds)
        with ctx.workprec(bits):
            values = run_arb(tape, box, bits)
            numbers = numbers_of(mechanism, written, values, turns, found)
            size = len(mechanism.unknowns) if mechanism.has_potential else 0
            entries = arb_mat(size, size, [values[int(place)] for place in tape.outputs[1]])
            numbers |= {f"eigenvalue {n}": value for n, value in enumerate(ordered_eigenvalues(entries))}
            settle(found, numbers, written, digits, attempt)
        if found.keys() >= numbers.keys():
            break
    index = solution.signs.count("-") if mechanism.has_potential and solution.signs else None
    return assembled(mechanism, parameters, all_bounded(found, numbers), index), bits


def numbers_of(
    mechanism: Mechanism,
    written: tuple[Tape, tuple[str, ...]],
    values: Sequence[arb],
    turns: Mapping[str, int],
    found: Mapping[str, Enclosure],
) -> dict[str, arb]:
    """The numbers of a pose by name, with its angles and deflections in radians and degrees.

    Parameters
    ----------
    written : as `tape_of` has it.
    values : on that tape.
    turns : angles that are known to be so many quarter turns.
    found : has a deflection's cosine or sine, where it is known to be zero.
    """
    tape, names = written
    numbers = {name: values[int(place)] for name, place in zip(names, tape.outputs[0], strict=True)}
    for angle in mechanism.angles:
        radians = angle_of(numbers[f"cos {angle}"], numbers[f"sin {angle}"])
        if angle in turns:
            radians = arb.pi() * turns[angle] / 2
        numbers |= {angle: radians, f"degrees {angle}": radians * 180 / arb.pi()}
    for n in range(len(mechanism.torsion)):
        numbers |= _deflection(found, n, numbers.pop(f"torsion cos {n}"), numbers.pop(f"torsion sin {n}"))
    return numbers


def angle_of(cosine: arb, sine: arb) -> arb:
    """The angle in (-pi, pi]; next to half a turn, where the sine may be zero, a ball around pi."""
    if cosine < 0 and sine.contains(0):
        return arb.pi() + (sine / cosine).atan()
    return arb.atan2(sine, cosine)


def settle(
    found: dict[str, Enclosure],
    numbers: Mapping[str, arb],
    written: tuple[Tape, tuple[str, ...]],
    digits: int,
    attempt: int,
) -> None:
    """Add to what is found the numbers that are exact on the tape, and those whose balls settle the digits."""
    tape, names = written
    constants = {n: tape.constants.get(int(k)) for n, k in zip(names, tape.outputs[0], strict=True)}
    for name in numbers.keys() - found.keys():
        exact = constants.get(name)
        settled = proved_digits(numbers[name], digits, attempt) if exact is None else Enclosure(exact, exact)
        if settled is not None:
            found[name] = settled


def all_bounded(found: Mapping[str, Enclosure], numbers: Mapping[str, arb]) -> dict[str, Enclosure]:
    """The numbers that are found, and of those that no digits settle all of their balls.

    Raises
    ------
    ArithmeticError
        When one has no bounds, which would be a fault of this program: all are of smooth functions in a proved box.
    """
    held = dict(found)
    for name in numbers.keys() - found.keys():
        bounds = bounded(numbers[name])
        if bounds is None:
            raise ArithmeticError(f"no bounds of {name} in a proved pose")
        held[name] = bounds
    return held


def _deflection(found: Mapping[str, Enclosure], number: int, cosine: arb, sine: arb) -> dict[str, arb]:
    """A torsion spring's deflection in radians and degrees; exact balls where it is known to be none.

    Parameters
    ----------
    found : has the cosine or the sine, where it is known to be zero.
    """
    quarters = None
    for part, other, turns in (("sin", cosine, (0, 2)), ("cos", sine, (1, -1))):
        known = found.get(f"torsion {part} {number}")
        if known is not None and known.exact == 0 and not other.contains(0):
            quarters = turns[0 if other > 0 else 1]
    radians = angle_of(cosine, sine) if quarters is None else arb.pi() * quarters / 2
    degrees = radians * 180 / arb.pi() if quarters is None else arb(90 * quarters)
    return {f"torsion deflection {number}": radians, f"torsion degrees {number}": degrees}


def proved_digits(number: arb, digits: int, attempt: int) -> Enclosure | None:
    """An enclosure that settles the digits asked for, or, of a number that is still not told from one halfway between
    two texts of so many after all that may explain it was tried, of one digit more; None of a wider one.
    """
    found = enclosed(number, digits)
    return enclosed(number, digits + 1) if found is None and attempt > 1 else found


def is_tense(stable: bool | None, springs: Sequence[Spring]) -> bool | None:
    """Whether a pose is stable with every spring longer than its free length; None where that is not decided."""
    forces = [spring.force for spring in springs]
    if stable is False or any(force.high < 0 or force.exact == 0 for force in forces):
        return False
    return True if stable and all(force.low > 0 for force in forces) else None


def assembled(
    mechanism: Mechanism,
    parameters: Mapping[str, Fraction],
    at: Mapping[str, Enclosure],
    index: int | None,
    flat: bool = False,
) -> Pose:
    """The pose of these numbers by name, whose Hessian was proved to have so many negative eigenvalues.

    Parameters
    ----------
    index : None where there is no Hessian, or its index is not decided.
    """
    springs = tuple(
        Spring(
            spring.name,
            spring.start,
            spring.end,
            value_at(spring.stiffness, parameters),
            at[f"length {n}"],
            at[f"force {n}"],
            value_at(spring.free, parameters),
        )
        for n, spring in enumerate(mechanism.springs)
    )
    torsion = tuple(
        TorsionSpring(
            spring.name,
            value_at(spring.stiffness, parameters),
            *(at[f"torsion {what} {n}"] for what in ("deflection", "degrees", "moment")),
        )
        for n, spring in enumerate(mechanism.torsion)
    )
    stable = None if index is None else index == 0
    eigenvalues = tuple(at[f"eigenvalue {n}"] for n in range(len(mechanism.unknowns)) if f"eigenvalue {n}" in at)
    if index is not None and not all((v.low < 0) if n < index else (v.high > 0) for n, v in enumerate(eigenvalues)):
        raise ArithmeticError("the Hessian's eigenvalues contradict the index that was proved")
    return Pose(
        angles=tuple(at[angle] for angle in mechanism.angles),
        degrees=tuple(at[f"degrees {angle}"] for angle in mechanism.angles),
        cosines_sines=tuple(at[f"{part} {angle}"] for angle in mechanism.angles for part in ("cos", "sin")),
        nodes={name: (at[f"{name} 0"], at[f"{name} 1"]) for name in mechanism.points},
        springs=springs,
        energy=at.get("energy"),
        eigenvalues=eigenvalues,
        multiplicity=1,
        index=index,
        stable=stable,
        flat=flat,
        admissible=is_tense(stable, springs) if mechanism.has_potential else None,
        reals=tuple(at[f"real {name}"] for name in mechanism.reals),
        torsion=torsion,
    )
