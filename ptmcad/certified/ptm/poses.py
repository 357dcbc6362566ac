"""The equilibria at a point of a mechanism whose springs have free lengths, with everything asked of a pose.

Guarantee: each equilibrium is proved, and all are there unless the answer is UNDECIDED. Every number settles the digits
asked for or, where it may be zero, is enclosed. A pose is called flat, and its numbers are exact, only when the flat
configuration itself is an equilibrium, exactly, and lies in the box in which the pose is the only one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isqrt

from flint import arb, ctx

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import Solution
from ptmcad.certified.arb_evaluation import ball, run_arb
from ptmcad.certified.arb_isolation import Box, refined
from ptmcad.certified.formula import Graph, Operation
from ptmcad.certified.plain.poses import (
    NOT_TOLD,
    all_bounded,
    angle_of,
    answered,
    assembled,
    point_slice,
    proved_digits,
)
from ptmcad.certified.potential import potential
from ptmcad.certified.ptm.points import point_counter
from ptmcad.certified.ptm.statics import TH1, TH2
from ptmcad.certified.system import System
from ptmcad.certified.tape import Tape, record
from ptmcad.mechanism import ptm
from ptmcad.question.domain import prove_slice
from ptmcad.question.slice import Count
from ptmcad.text.balls import ball_of
from ptmcad.text.enclosure import Enclosure

MECHANISM = ptm()
MORE_BITS = 3000
"""A number that so many bits beyond the digits asked for do not distinguish from zero stays undecided."""
_PEAKED = MECHANISM.springs[2]
_PEAKS = {
    1: f"the energy has a peak where spring {_PEAKED.start}{_PEAKED.end} has no length too",
    2: f"the energy has two peaks where spring {_PEAKED.start}{_PEAKED.end} has no length too",
}


def certified_poses(parameters: Mapping[str, Fraction], digits: int) -> Poses:
    """All equilibria of the mechanism.

    Parameters
    ----------
    parameters : all variables of the description.
    digits : significant digits that every enclosure settles.

    Raises
    ------
    GeometryError
        When a length or a stiffness is not positive, or the base or a free length is negative.
    """
    slice = point_slice(MECHANISM, parameters)
    prove_slice(slice)
    counter = point_counter(slice)
    counts = counter.at(Fraction(0), Fraction(0), Count.INDEX)
    solutions, unclear = (counts.solutions, 0) if counts.decided else counter.proved(Fraction(0), Fraction(0))
    written, equations = _tape(parameters), counter.equilibria_at(Fraction(0), Fraction(0)).equations
    poses = [_pose(parameters, written, equations, s, digits) for s in solutions]
    found = answered(MECHANISM, parameters, digits, poses, unclear, NOT_TOLD, _PEAKS.get(counts.cones or 0, ""))
    return replace(found, equilibria=tuple(_ordered(found.equilibria)))


def _ordered(poses: Sequence[Pose]) -> list[Pose]:
    """Stable ones first, then by energy; where energies are not separated, larger angles come first."""
    by_energy = sorted(poses, key=lambda pose: pose.known_energy.center)
    groups: list[list[Pose]] = []
    for pose in by_energy:
        if groups and pose.known_energy.low <= max(p.known_energy.high for p in groups[-1]):
            groups[-1].append(pose)
        else:
            groups.append([pose])
    ordered = [
        pose
        for group in groups
        for pose in sorted(group, key=lambda p: (p.angles[0].center, p.angles[1].center), reverse=True)
    ]
    return sorted(ordered, key=lambda pose: not pose.stable)


@dataclass(frozen=True, slots=True)
class _Number:
    """A number as its exact value, where it is known, and a ball."""

    ball: arb
    exact: Fraction | None = None

    def enclosure(self, digits: int, attempt: int) -> Enclosure | None:
        return proved_digits(self.ball, digits, attempt) if self.exact is None else Enclosure(self.exact, self.exact)


def _pose(
    parameters: Mapping[str, Fraction],
    written: tuple[Tape, tuple[str, ...]],
    equations: System,
    solution: Solution,
    digits: int,
) -> tuple[Pose, int]:
    """The pose with all numbers settled or, where they may be zero, enclosed; and the bits that this took."""
    tape, names = written
    flat = _flat(tape, solution)
    bits, attempt, numbers = 64 + 4 * digits, 0, dict[str, _Number]()
    found: dict[str, Enclosure] = {}
    while bits <= MORE_BITS + 8 * digits:
        box = refined(equations, _box(solution, bits), bits)
        with ctx.workprec(bits):
            numbers = _numbers(tape, names, box, flat)
            for name in numbers.keys() - found.keys():  # what a lower precision settled stays as it is
                if (settled := numbers[name].enclosure(digits, attempt)) is not None:
                    found[name] = settled
        if found.keys() == numbers.keys():
            break
        bits, attempt = 2 * bits, attempt + 1
    held = all_bounded(found, {name: number.ball for name, number in numbers.items()})
    return assembled(MECHANISM, parameters, held, solution.signs.count("-"), flat is not None), bits


def _box(solution: Solution, bits: int) -> Box:
    with ctx.workprec(bits):
        r = solution.radius
        return (arb(0), arb(0), *(ball(c - r, c + r) for c in solution.center))


def _tape(parameters: Mapping[str, Fraction]) -> tuple[Tape, tuple[str, ...]]:
    """Everything asked of a pose as a tape, and the names of its outputs; the equations of equilibrium come first."""
    graph = Graph()
    unknowns = {angle: graph.variable(number) for angle, number in zip(MECHANISM.angles, (TH1, TH2), strict=True)}
    at = potential(MECHANISM, {name: graph.constant(value) for name, value in parameters.items()}, unknowns)
    g1, g2 = (graph.derivative(at.energy, number) for number in (TH1, TH2))
    h11, h12, h22 = graph.derivative(g1, TH1), graph.derivative(g1, TH2), graph.derivative(g2, TH2)
    found = {f"cos {angle}": variable.cos() for angle, variable in unknowns.items()}
    found |= {f"sin {angle}": variable.sin() for angle, variable in unknowns.items()}
    found |= {f"{name} {n}": coordinate for name, pair in at.points.items() for n, coordinate in enumerate(pair)}
    found |= {f"length {n}": length for n, length in enumerate(at.lengths)}
    found |= {f"force {n}": force for n, force in enumerate(at.forces)}
    found |= {"energy": at.energy, "trace": h11 + h22, "spread": (h11 - h22).squared() + 4 * h12.squared()}
    return record([[g1, g2], list(found.values())]), tuple(found)


def _flat(tape: Tape, solution: Solution) -> list[Fraction] | None:
    """The values on the tape at the flat configuration that the solution is, if it is one."""
    cosines = {}
    with ctx.workprec(256):
        for number, center in zip((TH1, TH2), solution.center, strict=True):
            half_turns = round(float(ball_of(center) / arb.pi()))
            distance = abs(ball_of(center) - half_turns * arb.pi())
            if not distance < ball_of(solution.radius):
                return None
            cosines[number] = Fraction(-1 if half_turns % 2 else 1)
    try:
        values = _flat_values(tape, cosines)
    except ZeroDivisionError:  # a spring with a free length has no length
        return None
    return None if any(values[int(place)] for place in tape.outputs[0]) else values


def _flat_values(tape: Tape, cosines: Mapping[int, Fraction]) -> list[Fraction]:
    """The tape run in fractions where all sines are zero, and all springs lie along the base."""
    values: list[Fraction] = []
    for place in range(len(tape)):
        operation, first, second = Operation(int(tape.operations[place])), int(tape.first[place]), tape.second[place]
        if operation is Operation.CONSTANT:
            values.append(tape.constants[place])
        elif operation is Operation.VARIABLE:
            values.append(Fraction(first))
        elif operation is Operation.COSINE:
            values.append(cosines[int(values[first])])
        elif operation is Operation.SINE:
            values.append(Fraction(0))
        else:
            values.append(_EXACT[operation](values[first], values[int(second)]))
    return values


_EXACT: Mapping[Operation, Callable[[Fraction, Fraction], Fraction]] = {
    Operation.ADD: lambda a, b: a + b,
    Operation.SUBTRACT: lambda a, b: a - b,
    Operation.MULTIPLY: lambda a, b: a * b,
    Operation.DIVIDE: lambda a, b: a / b,
    Operation.SQUARE: lambda a, _: a * a,
    Operation.NEGATE: lambda a, _: -a,
    # of a vector of which one coordinate is zero
    Operation.LENGTH: lambda a, b: abs(a) + abs(b),
    Operation.INVERSE_LENGTH: lambda a, b: 1 / (abs(a) + abs(b)),
    Operation.DIRECTION: lambda a, b: a / (abs(a) + abs(b)),
}


def _numbers(tape: Tape, names: Sequence[str], box: Box, flat: list[Fraction] | None) -> dict[str, _Number]:
    """The numbers of a pose at the context's precision."""
    numbers = {}
    if flat is not None:
        for name, place in zip(names, tape.outputs[1], strict=True):
            numbers[name] = _Number(ball_of(flat[int(place)]), flat[int(place)])
        for angle in MECHANISM.angles:
            folded = numbers[f"cos {angle}"].exact == -1
            numbers[angle] = _Number(arb.pi()) if folded else _Number(arb(0), Fraction(0))
            degrees = Fraction(180 if folded else 0)
            numbers[f"degrees {angle}"] = _Number(ball_of(degrees), degrees)
    else:
        balls = run_arb(tape, box, ctx.prec)
        for name, place in zip(names, tape.outputs[1], strict=True):
            numbers[name] = _Number(balls[int(place)], tape.constants.get(int(place)))
        for angle in MECHANISM.angles:
            radians = angle_of(numbers[f"cos {angle}"].ball, numbers[f"sin {angle}"].ball)
            numbers[angle], numbers[f"degrees {angle}"] = _Number(radians), _Number(radians * 180 / arb.pi())
    trace, spread = numbers.pop("trace"), numbers.pop("spread")
    root = _Number(spread.ball.sqrt() if spread.ball > 0 else spread.ball.nonnegative_part().sqrt())
    if spread.exact is not None:
        numerator, denominator = isqrt(spread.exact.numerator), isqrt(spread.exact.denominator)
        whole = Fraction(numerator, denominator)
        root = _Number(ball_of(spread.exact).sqrt(), whole if whole * whole == spread.exact else None)
    for name, sign in (("eigenvalue 0", -1), ("eigenvalue 1", 1)):
        half_sum = (trace.ball + sign * root.ball) / 2
        if trace.exact is None or root.exact is None:
            numbers[name] = _Number(half_sum)
        else:
            numbers[name] = _Number(half_sum, (trace.exact + sign * root.exact) / Fraction(2))
    return numbers
