"""The equilibria at a point of a mechanism whose springs have free lengths, with everything asked of a pose.

Guarantee: all equilibria are there, each proved; every number settles the digits asked for. A pose is called flat, and
its numbers are exact, only when the flat configuration itself is an equilibrium, exactly, and lies in the box in which
the pose is the only one. What could not be decided makes the whole answer UNDECIDED.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt
from typing import Any

from flint import arb, ctx

from ptmcad.answer.poses import Pose, Poses, Spring
from ptmcad.answer.regionmap import Solution, Status
from ptmcad.certified.arb_evaluation import ball
from ptmcad.certified.arb_isolation import Box, refined
from ptmcad.certified.points import point_counter
from ptmcad.certified.system import System
from ptmcad.mechanism import ptm
from ptmcad.mechanism.evaluate import value_at
from ptmcad.question.domain import prove_slice
from ptmcad.question.slice import Axis, Count, Slice
from ptmcad.text.balls import ball_of, enclosed
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.expressions import axis

MECHANISM = ptm()
MORE_BITS = 3000
"""A number that so many bits beyond the digits asked for do not distinguish from zero stays undecided."""
NOT_TOLD = (
    "the equilibria could not be distinguished: there are infinitely many, one is nearly degenerate, or a spring has "
    "nearly no length there"
)
_PEAKS = {
    1: "the energy has a peak where spring A3A4 has no length too",
    2: "the energy has two peaks where spring A3A4 has no length too",
}
ZERO = "a number of an equilibrium could not be distinguished from zero"


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
    slice = _point_slice(parameters)
    prove_slice(slice)
    counter = point_counter(slice)
    counts = counter.at(Fraction(0), Fraction(0), Count.INDEX)
    if not counts.decided:
        return Poses(MECHANISM.name, parameters, (), Status.UNDECIDED, digits, 0, NOT_TOLD)
    poses, most = [], 0
    for solution in counts.solutions:
        pose, bits = _pose(parameters, counter.equilibria_at(Fraction(0), Fraction(0)).equations, solution, digits)
        most = max(most, bits)
        if pose is None:
            return Poses(MECHANISM.name, parameters, (), Status.UNDECIDED, digits, most, ZERO)
        poses.append(pose)
    peaks = _PEAKS.get(counts.cones or 0, "")
    return Poses(MECHANISM.name, parameters, tuple(_ordered(poses)), Status.CERTIFIED, digits, most, peaks)


def _point_slice(parameters: Mapping[str, Fraction]) -> Slice:
    """The mechanism at a point as a slice on whose axes nothing depends."""
    constants = {name: 0 * axis(0) + value for name, value in parameters.items()}
    unit = (Fraction(0), Fraction(1))
    return Slice("point", MECHANISM.name, (Axis("x", *unit), Axis("y", *unit)), constants)


def _ordered(poses: Sequence[Pose]) -> list[Pose]:
    """Stable ones first, then by energy; where energies are not separated, larger angles come first."""
    by_energy = sorted(poses, key=lambda pose: pose.energy.center)
    groups: list[list[Pose]] = []
    for pose in by_energy:
        if groups and pose.energy.low <= max(p.energy.high for p in groups[-1]):
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

    def enclosure(self, digits: int) -> Enclosure | None:
        return enclosed(self.ball, digits) if self.exact is None else Enclosure(self.exact, self.exact)


def _pose(
    parameters: Mapping[str, Fraction], equations: System, solution: Solution, digits: int
) -> tuple[Pose | None, int]:
    """The pose with all numbers settled, and the bits that this took; None when some number is not."""
    signs = _flat(parameters, solution)
    bits = 64 + 4 * digits
    found: dict[str, Enclosure] = {}
    while bits <= MORE_BITS + 8 * digits:
        box = refined(equations, _box(solution, bits), bits)
        with ctx.workprec(bits):
            numbers = _numbers(parameters, box, signs)
            for name in numbers.keys() - found.keys():  # what a lower precision settled stays as it is
                if (settled := numbers[name].enclosure(digits)) is not None:
                    found[name] = settled
        if found.keys() == numbers.keys():
            return _assembled(parameters, found, solution.signs, signs is not None), bits
        bits *= 2
    return None, bits // 2


def _box(solution: Solution, bits: int) -> Box:
    with ctx.workprec(bits):
        r = solution.radius
        return (arb(0), arb(0), *(ball(c - r, c + r) for c in solution.center))


def _flat(parameters: Mapping[str, Fraction], solution: Solution) -> tuple[int, int] | None:
    """The cosines of the flat configuration that the solution is, if it is one.

    With both sines zero all springs lie along the base, so that only vertical loads can turn the bars.
    """
    if parameters["F3"] or parameters["F4"]:
        return None
    cosines = []
    with ctx.workprec(256):
        for center in solution.center:
            half_turns = round(float(ball_of(center) / arb.pi()))
            distance = abs(ball_of(center) - half_turns * arb.pi())
            if not distance < ball_of(solution.radius):
                return None
            cosines.append(-1 if half_turns % 2 else 1)
    first, second = cosines
    x3, x4 = first * parameters["L1"], parameters["rho"] - second * parameters["L2"]
    lengths = {"1": abs(x4), "2": abs(x3 - parameters["rho"]), "3": abs(x4 - x3)}
    if any(lengths[name] == 0 and parameters[f"l0_{name}"] != 0 for name in lengths):
        return None
    return first, second


def _numbers(parameters: Mapping[str, Fraction], box: Box, flat: tuple[int, int] | None) -> dict[str, _Number]:
    """The numbers of a pose at the context's precision."""
    if flat is not None:
        zero = Fraction(0)
        exact = _quantities(dict(parameters), (Fraction(flat[0]), zero, Fraction(flat[1]), zero), abs)
        numbers = {name: _Number(ball_of(value), value) for name, value in exact.items()}
        for i, cosine in enumerate(flat, 1):
            exact_angle = (None if cosine < 0 else zero, Fraction(180 if cosine < 0 else 0))
            numbers[f"th{i}"] = _Number(arb.pi() if cosine < 0 else arb(0), exact_angle[0])
            numbers[f"degrees{i}"] = _Number(ball_of(exact_angle[1]), exact_angle[1])
    else:
        cosines_sines = (box[2].cos(), box[2].sin(), box[3].cos(), box[3].sin())
        balls = _quantities({n: ball_of(v) for n, v in parameters.items()}, cosines_sines, None)
        numbers = {name: _Number(value) for name, value in balls.items()}
        for i in (1, 2):
            angle = arb.atan2(numbers[f"s{i}"].ball, numbers[f"c{i}"].ball)
            numbers[f"th{i}"], numbers[f"degrees{i}"] = _Number(angle), _Number(angle * 180 / arb.pi())
        for name in ("A1x", "A1y", "A2y"):
            numbers[name] = _Number(arb(0), Fraction(0))
        numbers["A2x"] = _Number(ball_of(parameters["rho"]), parameters["rho"])
    trace, spread = numbers.pop("trace"), numbers.pop("spread")
    root = _Number(spread.ball.sqrt() if spread.ball > 0 else spread.ball.nonnegative_part().sqrt())
    if spread.exact is not None:
        numerator, denominator = isqrt(spread.exact.numerator), isqrt(spread.exact.denominator)
        whole = Fraction(numerator, denominator)
        root = _Number(ball_of(spread.exact).sqrt(), whole if whole * whole == spread.exact else None)
    for name, sign in (("low", -1), ("high", 1)):
        half_sum = (trace.ball + sign * root.ball) / 2
        if trace.exact is None or root.exact is None:
            numbers[name] = _Number(half_sum)
        else:
            numbers[name] = _Number(half_sum, (trace.exact + sign * root.exact) / Fraction(2))
    return numbers


def _quantities(
    p: Mapping[str, Any], cosines_sines: tuple[Any, Any, Any, Any], flat_length: Callable[[Any], Any] | None
) -> dict[str, Any]:
    """Coordinates, lengths, forces, energy and the Hessian's trace and spread, in rational numbers or in balls."""
    c1, s1, c2, s2 = cosines_sines
    x3, y3, x4, y4 = p["L1"] * c1, p["L1"] * s1, p["rho"] - p["L2"] * c2, p["L2"] * s2
    zero = 0 * p["rho"]
    found = {
        "c1": c1, "s1": s1, "c2": c2, "s2": s2, "A1x": zero, "A1y": zero, "A2x": p["rho"], "A2y": zero,
        "A3x": x3, "A3y": y3, "A4x": x4, "A4y": y4,
    }  # fmt: skip
    # a spring's vector, and its derivatives by the angles as multiples (m1, m2) of those of A3 and A4
    springs = (("1", x4, y4, 0, 1), ("2", x3 - p["rho"], y3, 1, 0), ("3", x4 - x3, y4 - y3, -1, 1))
    d1, d2 = (-y3, x3), (y4, p["rho"] - x4)
    energy = -(p["F3x"] * x3 + p["F3"] * y3 + p["F4x"] * x4 + p["F4"] * y4)
    h11 = p["F3x"] * x3 + p["F3"] * y3
    h22 = -p["F4x"] * (p["rho"] - x4) + p["F4"] * y4
    h12 = zero
    for name, x, y, m1, m2 in springs:
        k, free = p[f"k{name}"], p[f"l0_{name}"]
        length = flat_length(x) if flat_length else (x * x + y * y).sqrt()
        stretch = length - free
        found[f"length{name}"], found[f"force{name}"] = length, k * stretch
        energy = energy + k * stretch * stretch / 2
        tension, bend = (k, zero) if free == 0 else (k * stretch / length, k * free / (length * length * length))
        along1, along2 = m1 * (x * d1[0] + y * d1[1]), m2 * (x * d2[0] + y * d2[1])
        # second derivatives: of A3 by th1 is -A3, of A4 by th2 is A2 - A4
        h11 = h11 + tension * (m1 * m1 * p["L1"] * p["L1"] - m1 * (x * x3 + y * y3)) + bend * along1 * along1
        turned = x * (p["rho"] - x4) - y * y4
        h22 = h22 + tension * (m2 * m2 * p["L2"] * p["L2"] + m2 * turned) + bend * along2 * along2
        h12 = h12 + tension * (m1 * m2 * (d1[0] * d2[0] + d1[1] * d2[1])) + bend * along1 * along2
    found["energy"], found["trace"] = energy, h11 + h22
    found["spread"] = (h11 - h22) * (h11 - h22) + 4 * h12 * h12
    return found


def _assembled(parameters: Mapping[str, Fraction], at: Mapping[str, Enclosure], signs: str, flat: bool) -> Pose:
    springs = tuple(
        Spring(
            spring.name,
            spring.start,
            spring.end,
            value_at(spring.stiffness, parameters),
            at[f"length{n}"],
            at[f"force{n}"],
            value_at(spring.free, parameters),
        )
        for n, spring in enumerate(MECHANISM.springs, 1)
    )
    index = signs.count("-")
    if index != (at["low"].high < 0) + (at["high"].high < 0):
        raise ArithmeticError("the Hessian's eigenvalues contradict the index that was proved")
    return Pose(
        angles=(at[MECHANISM.angles[0]], at[MECHANISM.angles[1]]),
        degrees=(at["degrees1"], at["degrees2"]),
        cosines_sines=(at["c1"], at["s1"], at["c2"], at["s2"]),
        nodes={name: (at[f"{name}x"], at[f"{name}y"]) for name in MECHANISM.points},
        springs=springs,
        energy=at["energy"],
        eigenvalues=(at["low"], at["high"]),
        multiplicity=1,
        index=index,
        stable=index == 0,
        flat=flat,
        admissible=index == 0 and all(spring.force.low > 0 for spring in springs),
    )
