"""What holds at a critical value at which a branch ends, for springs with free lengths: a pose there, and energies.

Guarantee: every enclosure holds the number at the critical value, wherever that lies in its own enclosure. The pose
that is reached is proved to be the branch of the one beyond. The energy of the branch that ends differs from that at a
place beside by no more than the distance times the largest slope: along a branch of critical points the energy changes
with the parameter alone, which is bounded on the torus.

Not guaranteed: that the branch ends in the degenerate pose that Newton's method finds from its last place. That pose is
proved, it lies at the critical value, and its energy is one that the branch may have there.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from flint import arb, ctx, fmpq

from ptmcad.answer.paths import PathPoint, Target
from ptmcad.certified.arb_isolation import Box, approached, newton, refined
from ptmcad.certified.continuation import BranchEquations, ProvedPoint, carried, located, over
from ptmcad.certified.parameters import parameter_formulas
from ptmcad.certified.system import EquationSystem, system
from ptmcad.formulas.balls import run_arb
from ptmcad.formulas.graph import Graph
from ptmcad.formulas.tape import Tape, record
from ptmcad.model import Mechanism
from ptmcad.model.compile import compiled_with
from ptmcad.model.determinants import determinant, gradient
from ptmcad.question.slice import Slice
from ptmcad.text.balls import ball_of, enclosure_of
from ptmcad.text.enclosure import Enclosure

BITS = 192
_PASSES = 12
"""Of Newton's method from the last place of a branch to where it ends."""
_FIRST = 2
"""The number of the first unknown, after the axes'."""
_NEAREST = Fraction(1, 2**60)
"""How near to a critical value a branch is carried, against its distance."""


class BranchEnd(NamedTuple):
    """The pose that is reached at a critical value, its energy, and that of the branch that ends there."""

    target: Target
    energy: Enclosure
    target_energy: Enclosure


@dataclass(frozen=True, slots=True)
class LineFormulas:
    """A mechanism on unknown angles, on a line of a slice.

    Attributes
    ----------
    equations : of equilibrium.
    folds : the same and the Hessian's determinant, with the axis as a further unknown, the first one.
    numbers : a tape of the energy, its slope along the line, and the heights of the rising points.
    """

    equations: BranchEquations
    folds: EquationSystem
    numbers: Tape


def line_of(slice: Slice, mechanism: Mechanism, varying: int, fixed: Fraction) -> LineFormulas:
    """The formulas of a slice of a mechanism, along the axis number ``varying`` at a value of the other one."""
    graph = Graph()
    unknowns = {name: graph.variable(number) for number, name in enumerate(mechanism.unknowns, _FIRST)}
    at = compiled_with(mechanism, parameter_formulas(graph, slice) | unknowns)
    energy = at.energy()
    assert energy is not None
    variables = [v.variable for v in unknowns.values()]
    slopes = gradient(energy, variables)
    heights = [at.points[name][1] for name in mechanism.rising]
    numbers = record([[energy, graph.derivative(energy, varying), *heights]])
    hessian = [gradient(f, variables) for f in slopes]
    folds = system([*slopes, determinant(hessian)], [varying, *variables])
    return LineFormulas(BranchEquations(system(slopes, variables), varying, fixed), folds, numbers)


def landing(line: LineFormulas, at: Enclosure, last: PathPoint, beyond: PathPoint) -> BranchEnd | None:
    """What holds at a critical value; None where that is not proved.

    Parameters
    ----------
    at : of the only critical value between the two places.
    last : the branch that ends there.
    beyond : the pose that is reached, which is simple there.
    """
    with ctx.workprec(BITS):
        after = _near(line, at, beyond)
        there = None if after is None else over(line.equations, after, at)
        energy = _energy_at(line, at, last)
        if energy is None or there is None:
            return None
        value = ball_of(at.low).union(ball_of(at.high))
        reached, _, *heights = _numbers(line, value, there)
        sides = tuple(1 if y > 0 else -1 if y < 0 else 0 for y in heights)
        return BranchEnd(Target(tuple(map(enclosure_of, there)), (), sides), energy, enclosure_of(reached))


def merger(line: LineFormulas, at: Enclosure, last: PathPoint, beyond: PathPoint) -> BranchEnd | None:
    """The same where the pose beyond is what several become, of which ``last`` is one; None where that is not proved.

    The pose in which they merge is told, without proof, to lie about where those on both sides are, no farther off than
    these are from each other; an angle beyond that is not told from half turns, as that of a flat pose, is one of them.
    """
    energy = _energy_at(line, at, last)
    if energy is None:
        return None
    angles = tuple(
        b if (ball_of(b.low).union(ball_of(b.high)) / arb.pi()).contains_integer() else _around(a, b)
        for a, b in zip(last.angles, beyond.angles, strict=True)
    )
    return BranchEnd(Target(angles, (), beyond.sides), energy, energy)


def _around(first: Enclosure, second: Enclosure) -> Enclosure:
    """The hull of two enclosures, three times as wide."""
    low, high = min(first.low, second.low), max(first.high, second.high)
    return Enclosure(2 * low - high, 2 * high - low)


def _energy_at(line: LineFormulas, at: Enclosure, last: PathPoint) -> Enclosure | None:
    """The energy of a branch at the critical value at which it ends; None where the branch is not proved."""
    with ctx.workprec(BITS):
        place = located(line.equations, last.value, last.angles)
        if place is None:
            return None
        limit = _limit(line, at, place)
        fold = _fold(line, at, place)
        if fold is None:
            return enclosure_of(limit)
        energy = _numbers(line, fold[line.equations.varying], fold[_FIRST:])[0]
        return enclosure_of(energy if limit.contains(energy) else limit)


def _near(line: LineFormulas, at: Enclosure, point: PathPoint) -> ProvedPoint | None:
    """A branch as near to a critical value as it can be carried."""
    start = located(line.equations, point.value, point.angles)
    if start is None:
        return None
    end = at.low if point.value < at.low else at.high
    return carried(line.equations, start, end + (point.value - end) * _NEAREST)


def _limit(line: LineFormulas, at: Enclosure, place: ProvedPoint) -> arb:
    """The energy of a branch at the critical value, from a place beside."""
    between = ball_of(place.value).union(ball_of(at.low)).union(ball_of(at.high))
    anywhere = (arb.pi() * arb(0, 1),) * len(place.unknowns)
    slope = _numbers(line, between, anywhere)[1]
    return _numbers(line, ball_of(place.value), place.unknowns)[0] + 2 * between.rad() * slope * arb(0, 1)


def _fold(line: LineFormulas, at: Enclosure, place: ProvedPoint) -> Box | None:
    """The degenerate pose at a critical value that Newton's method finds from a place beside; None without proof."""
    folds, varying = line.folds, line.equations.varying
    variables = [int(k) for k in folds.unknowns]
    found = approached(folds, line.equations.box(ball_of(at.center), place.unknowns), _PASSES)
    if found is None:
        return None
    box = list(found)
    for k in variables:
        box[k] = arb(box[k].mid(), arb(fmpq(1, 2 ** (ctx.prec // 3))))
    step = newton(folds, tuple(box), ctx.prec) if all(box[k].is_finite() for k in variables) else None
    if step is None or not step[1]:
        return None
    fold = refined(folds, tuple(box), ctx.prec)
    return fold if fold[varying].overlaps(ball_of(at.low).union(ball_of(at.high))) else None


def _numbers(line: LineFormulas, value: arb, unknowns: tuple[arb, ...]) -> list[arb]:
    values = run_arb(line.numbers, line.equations.box(value, unknowns), ctx.prec)
    return [values[int(place)] for place in line.numbers.outputs[0]]
