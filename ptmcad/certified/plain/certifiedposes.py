"""The equilibria at a point of any mechanism with springs of free lengths, with everything asked of
a pose.

Closed loops leave one degree of freedom: there is no index, and a pose is stable where the energy's
second derivative along the loops is positive.

Guarantee: each equilibrium is proved, and all are there unless the answer is UNDECIDED, which then
says in how many boxes there may be more. Every number settles the digits asked for or, where it may
be zero, is enclosed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isqrt
from typing import Any

from flint import arb, arb_mat, ctx

from ptmcad.answer.poses import Pose, Poses, springs_of
from ptmcad.answer.regionmap import Solution, Status
from ptmcad.certified.arb_isolation import Box
from ptmcad.certified.peaks import peaks
from ptmcad.certified.plain.pointcounts import BranchCounter, PlainCounter, plain_counter
from ptmcad.certified.plain.problem import FIRST, MAX_UNKNOWNS_AT_POINTS
from ptmcad.certified.plain.rational import Point, exact_eigenvalues, exact_values, rational_point
from ptmcad.certified.plain.spectrum import ordered_eigenvalues
from ptmcad.formulas.ballarithmetic import ball, run_arb
from ptmcad.formulas.graph import Formula, Graph, gradient
from ptmcad.formulas.tape import Tape, record
from ptmcad.model import Mechanism, Model, ptm
from ptmcad.model.compile import CompiledSystem, compiled_with
from ptmcad.model.fourbars import flat_everywhere
from ptmcad.question.counts import POSE_COLUMNS, Count
from ptmcad.question.domain import proved
from ptmcad.question.slice import Axis, Slice
from ptmcad.text.balls import bounded, enclosed
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.expressions import axis

_PEAKED = ptm().springs[2]
_PEAKS = {
    1: f"the energy has a peak where spring {_PEAKED.start}{_PEAKED.end} has no length too",
    2: f"the energy has two peaks where spring {_PEAKED.start}{_PEAKED.end} has no length too",
}
MAX_DOUBLINGS = 4
"""Of the bits, for a number that is not distinguished from zero."""
NOT_TOLD = (
    "not all equilibria could be distinguished: there are infinitely many, one is nearly degenerate, or a spring has "
    "nearly no length there"
)
NOT_TOLD_OF_LOOPS = NOT_TOLD.replace("or a spring", "a loop is nearly flat, or a spring")


def plain_poses(model: Model, parameters: Mapping[str, Fraction], digits: int) -> Poses:
    """All equilibria of a mechanism.

    Parameters
    ----------
    parameters : all variables of the description.
    digits : significant digits that every enclosure settles.

    Raises
    ------
    ConfigError, GeometryError
        As `ptmcad.certified.plain.pointcounts.plain_counter` does, or where a parameter is not what
        its kind asks for.
    """
    slice = proved(point_slice(model, parameters))
    at = numbers_at(model, parameters)
    if flat := flat_everywhere(at.mechanism, slice.parameters):
        loop, fold = flat
        return Poses(model, parameters, (), Status.UNDECIDED, digits, 0, loop.in_short(fold))
    count, reason = (Count.TOTAL, NOT_TOLD_OF_LOOPS) if at.is_closed else (Count.INDEX, NOT_TOLD)
    zeros, unclear = solutions_at(plain_counter(slice, MAX_UNKNOWNS_AT_POINTS), count)
    poses = [pose_at(at, counter, solution, digits) for counter, solution in zeros]
    bits = max((bits for _, bits in poses), default=0)
    found = tuple(_ordered([pose for pose, _ in poses]))
    if unclear:
        return Poses(
            model, parameters, found, Status.UNDECIDED, digits, bits, reason, undecided=unclear
        )
    remark = _PEAKS.get(peaks(parameters)[0], "") if model == ptm() else ""
    return Poses(model, parameters, found, Status.CERTIFIED, digits, bits, remark)


def solutions_at(
    counter: BranchCounter, count: Count
) -> tuple[list[tuple[PlainCounter, Solution]], int]:
    """The solutions, each with the counter of its branch, and the number of boxes in which there
    may be more.
    """
    found, unclear = [], 0
    for branch in counter.branches:
        counts = branch.at(Fraction(0), Fraction(0), count)
        unclear += counts.open
        found += [(branch, solution) for solution in counts.solutions]
    return found, unclear


def boxes_of(counter: PlainCounter, solution: Solution, precision: int) -> tuple[Box, Box]:
    """A box of the mechanism's unknowns that holds a solution of a branch and no other one, and a
    narrow one.
    """
    cube, box = counter.search.located(Fraction(0), Fraction(0), solution, precision)
    with ctx.workprec(precision):
        return (*box[:FIRST], *(ball(c - cube.radius, c + cube.radius) for c in cube.center)), box


def _ordered(poses: Sequence[Pose]) -> Iterator[Pose]:
    """In their order; of those whose energies are not separated larger angles come first."""
    groups: list[list[Pose]] = []
    for pose in sorted(poses, key=_order):
        last = groups[-1] if groups else []
        if (
            pose.energy is not None
            and last
            and last[0].energy is not None
            and last[0].stable == pose.stable
            and pose.energy.low <= max(other.known_energy.high for other in last)
        ):
            last.append(pose)
        else:
            groups.append([pose])
    for group in groups:
        yield from sorted(
            group, key=lambda pose: [angle.center for angle in pose.angles], reverse=True
        )


def _order(pose: Pose) -> tuple[Fraction, ...]:
    """Stable equilibria first, then by energy; without a potential by the unknowns."""
    numbers = (*pose.angles, *pose.reals) if pose.energy is None else (pose.energy,)
    return Fraction(not pose.stable), *(number.center for number in numbers)


def point_slice(model: Model, parameters: Mapping[str, Fraction]) -> Slice:
    """The model at a point as a slice on whose axes nothing depends."""
    unit = (Fraction(0), Fraction(1))
    constants = {name: 0 * axis(0) + value for name, value in parameters.items()}
    return Slice("point", model, (Axis("x", *unit), Axis("y", *unit)), constants, Count.INDEX)


@dataclass(frozen=True, slots=True)
class _Numbers:
    """Everything asked of a pose of a mechanism at values of its parameters.

    Attributes
    ----------
    system : compiled with these values.
    formulas : of the numbers by ``names``; of the Hessian's entries row by row; of the energy's
        slopes. Without a potential there is none of the latter two, nor with closed loops, where
        slopes of the energy are not zero.
    tape : of the numbers and the Hessian's entries.
    """

    mechanism: Mechanism
    parameters: Mapping[str, Fraction]
    system: CompiledSystem
    names: tuple[str, ...]
    formulas: tuple[Sequence[Formula], ...]
    tape: Tape

    @property
    def is_closed(self) -> bool:
        """Whether loops are closed."""
        return bool(self.system.tangent)


def numbers_at(model: Model, parameters: Mapping[str, Fraction]) -> _Numbers:
    """Of a mechanism, as formulas in its unknowns."""
    mechanism = model.whole
    assert mechanism is not None
    graph = Graph()
    unknowns = {
        name: graph.variable(number) for number, name in enumerate(mechanism.unknowns, FIRST)
    }
    system = compiled_with(
        model, {name: graph.constant(value) for name, value in parameters.items()} | unknowns
    )
    found = {f"{angle}.cos": unknowns[angle].cos() for angle in mechanism.angles}
    found |= {f"{angle}.sin": unknowns[angle].sin() for angle in mechanism.angles}
    found |= {f"{name}.real": unknowns[name] for name in mechanism.reals} | system.quantities
    hessian, slopes = list[Formula](), tuple[Formula, ...]()
    if (energy := system.energy()) is not None:
        found["energy"] = energy
    if (potential := system.potential()) is not None:
        variables = [v.variable for v in unknowns.values()]
        slopes = gradient(potential, variables)
        hessian = [entry for slope in slopes for entry in gradient(slope, variables)]
    formulas = (*found.values(),), hessian, slopes
    return _Numbers(mechanism, parameters, system, tuple(found), formulas, record(formulas[:2]))


def pose_at(
    at: _Numbers, counter: PlainCounter, solution: Solution, digits: int
) -> tuple[Pose, int]:
    """The pose with all numbers settled or, where they may be zero, enclosed; and the bits that
    this took.
    """
    numbers, bits = measured(at, lambda bits: boxes_of(counter, solution, bits), digits)
    criterion, signs = at.system.criterion, solution.signs
    return with_further(
        assembled(at, numbers, criterion.morse_index(signs), criterion.is_stable(signs))
    ), bits


def measured(
    at: _Numbers, boxes: Callable[[int], tuple[Box, Box]], digits: int
) -> tuple[dict[str, Enclosure], int]:
    """The numbers of a pose by name, settled or, where they may be zero, enclosed; and the bits
    that this took.

    Parameters
    ----------
    boxes : with so many bits, one that holds the solution and no other one, and a narrow one.
    """
    unknowns = at.mechanism.unknowns
    bits, point = 32 + 2 * digits, Point()
    found = _exact_numbers(at, point)
    for attempt in range(MAX_DOUBLINGS):
        bits *= 2
        whole, box = boxes(bits)
        with ctx.workprec(bits):
            if attempt > 0 and not at.is_closed and len(point) < len(unknowns):
                # some number is not settled: it may be a short one, or a longer one with more bits
                held, around = (
                    dict(zip(unknowns, some[FIRST:], strict=True)) for some in (box, whole)
                )
                point = (
                    rational_point(at.mechanism, at.parameters, at.formulas[2], held, around)
                    or point
                )
                found |= _exact_numbers(at, point)
            numbers = _numbers_of(at, run_arb(at.tape, box, bits), found)
            waiting = [
                name for name, number in numbers.items() if name not in found or number.is_exact()
            ]
            settled = {name: _proved_digits(numbers[name], digits, attempt) for name in waiting}
        found |= {name: number for name, number in settled.items() if number is not None}
        if found.keys() >= numbers.keys():
            break
    return _all_bounded(found, numbers), bits


def _exact_numbers(at: _Numbers, point: Point) -> dict[str, Enclosure]:
    """The numbers that are rational by these unknowns."""
    known, entries = (exact_values(some, point) for some in at.formulas[:2])
    found = {name: value for name, value in zip(at.names, known, strict=True) if value is not None}
    size = isqrt(len(entries))
    rows = [entries[k : k + size] for k in range(0, len(entries), size or 1)]
    found |= {f"eigenvalue {n}": value for n, value in enumerate(exact_eigenvalues(rows))}
    return {name: Enclosure(value, value) for name, value in found.items()}


def _numbers_of(
    at: _Numbers, values: Sequence[arb], found: Mapping[str, Enclosure]
) -> dict[str, arb]:
    """The numbers of a pose by name, with its angles and deflections in radians and degrees, and
    eigenvalues.

    Parameters
    ----------
    values : on the tape.
    found : has an angle's cosine or sine, where it is known to be zero.
    """
    numbers = {
        name: values[int(place)] for name, place in zip(at.names, at.tape.outputs[0], strict=True)
    }
    size = isqrt(len(at.tape.outputs[1]))
    hessian = arb_mat(size, size, [values[int(place)] for place in at.tape.outputs[1]])
    for name in [name.removesuffix(".cos") for name in at.names if name.endswith(".cos")]:
        cosine, sine = f"{name}.cos", f"{name}.sin"
        turned = _angle(numbers[cosine], numbers[sine], found.get(cosine), found.get(sine))
        numbers[f"{name}.radians"], numbers[f"{name}.degrees"] = turned
        if name not in at.mechanism.angles:  # of a deflection they are not asked for
            del numbers[cosine], numbers[sine]
    return numbers | {
        f"eigenvalue {n}": value for n, value in enumerate(ordered_eigenvalues(hessian))
    }


def _angle(
    cosine: arb, sine: arb, known_cosine: Enclosure | None, known_sine: Enclosure | None
) -> tuple[arb, arb]:
    """An angle in (-pi, pi], in radians and degrees; next to half a turn, where the sine may be
    zero, around pi.
    """
    for known, other, turns in ((known_sine, cosine, (0, 2)), (known_cosine, sine, (1, -1))):
        if known is not None and known.exact == 0 and not other.contains(0):
            quarters = turns[0 if other > 0 else 1]
            return arb.pi() * quarters / 2, arb(90 * quarters)
    around_half = cosine < 0 and sine.contains(0)
    radians = arb.pi() + (sine / cosine).atan() if around_half else arb.atan2(sine, cosine)
    return radians, radians * 180 / arb.pi()


def _all_bounded(
    found: Mapping[str, Enclosure], numbers: Mapping[str, arb]
) -> dict[str, Enclosure]:
    """The numbers that are found, and of those that no digits settle all of their balls.

    Raises
    ------
    ArithmeticError
        When one has no bounds, which would be a fault of this program: all are of smooth functions
        in a proved box.
    """
    held = dict(found)
    for name in numbers.keys() - found.keys():
        bounds = bounded(numbers[name])
        if bounds is None:
            raise ArithmeticError(f"no bounds of {name} in a proved pose")
        held[name] = bounds
    return held


def _proved_digits(number: arb, digits: int, attempt: int) -> Enclosure | None:
    """An enclosure that settles the digits asked for; None of a wider one.

    A number may lie so near the middle between two texts of that many digits that no attempt tells
    them apart: one digit more settles it.
    """
    found = enclosed(number, digits)
    return enclosed(number, digits + 1) if found is None and attempt > 1 else found


def with_further(pose: Pose) -> Pose:
    """The pose with the predicates that hold or not; without a potential nothing says what is
    stable.
    """
    columns = POSE_COLUMNS if pose.energy is not None else {}
    found = {name: _holds(pose.stable, column.of_pose(pose)) for name, column in columns.items()}
    return replace(
        pose, further={name: holds for name, holds in found.items() if holds is not None}
    )


def _holds(stable: bool | None, margins: Sequence[Enclosure]) -> bool | None:
    """Whether a pose is stable and all numbers are positive; None where that is not decided."""
    if stable is False or any(margin.high < 0 or margin.exact == 0 for margin in margins):
        return False
    return True if stable and all(margin.low > 0 for margin in margins) else None


def assembled(
    at: _Numbers, numbers: Mapping[str, Enclosure], index: int | None, stable: bool | None
) -> Pose:
    """The pose of these numbers by name, whose Hessian was proved to have so many negative
    eigenvalues.

    Parameters
    ----------
    index : None where there is no Hessian, or its index is not decided.
    stable : None where that is not decided.
    """
    mechanism = at.mechanism

    def numbers_of(*whats: str) -> Callable[[Any], Any]:
        return lambda spring: tuple(numbers[f"{spring.name}.{what}"] for what in whats)

    eigenvalues = tuple(
        numbers[f"eigenvalue {n}"]
        for n in range(len(mechanism.unknowns))
        if f"eigenvalue {n}" in numbers
    )
    if index is not None and not all(
        (v.low < 0) if n < index else (v.high > 0) for n, v in enumerate(eigenvalues)
    ):
        raise ArithmeticError("the Hessian's eigenvalues contradict the index that was proved")
    nodes = {name: (numbers[f"{name}.x"], numbers[f"{name}.y"]) for name in mechanism.points}
    return Pose(
        angles=tuple(numbers[f"{angle}.radians"] for angle in mechanism.angles),
        degrees=tuple(numbers[f"{angle}.degrees"] for angle in mechanism.angles),
        cosines_sines=tuple(
            numbers[f"{angle}.{part}"] for angle in mechanism.angles for part in ("cos", "sin")
        ),
        nodes=nodes,
        energy=numbers.get("energy"),
        eigenvalues=eigenvalues,
        multiplicity=1,
        index=index,
        stable=stable,
        flat=all(y.exact == 0 for _, y in nodes.values()),
        reals=tuple(numbers[f"{name}.real"] for name in mechanism.reals),
        **springs_of(
            at.system.elastic,
            _number,
            numbers_of("length", "force"),
            numbers_of("deflection.radians", "deflection.degrees", "moment"),
        ),
    )


def _number(formula: Formula) -> Fraction:
    assert formula.value is not None
    return formula.value
