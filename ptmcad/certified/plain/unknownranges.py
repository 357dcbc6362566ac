"""Ranges of the unknowns that hold all solutions over a window: a full turn of each angle, proved
bounds of the others.

Guarantee: over the closed window no solution at which no inequality is violated has a real unknown
outside of its range, nor comes to infinity. (Lemma 19 of docs/soundness.md.)
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from math import gcd, inf, isfinite

import numpy as np

from ptmcad.certified.plain.geometry import geometry
from ptmcad.certified.plain.harmonics import Multi, TrigonometricPolynomial
from ptmcad.certified.plain.problem import FIRST, TURN, Problem, Range
from ptmcad.certified.plain.springchart import chart
from ptmcad.errors import ConfigError
from ptmcad.formulas.graph import Formula, Graph, Operation, expression_formula, length
from ptmcad.formulas.intervalarithmetic import run
from ptmcad.formulas.tape import Floats, Tape, enclosing_floats, record
from ptmcad.question.slice import Axis

MIN_POWER, MAX_POWER = -10, 40
"""Of two, tried as bounds."""
MAX_BOXES = 1000
"""For one bound; each is halved along an axis or an unknown where nothing excludes it."""
MAX_BOXES_HELD = 5_000
"""The same for lengths that springs hold together."""
AXES_HELD = 1 / 64
"""Weight of the widths along the axes in the choice of the variable to halve then: mostly the axes
are not in what holds lengths.
"""
MIN_SHARE = 1e-12
"""Of a range, or of a number's size, below which it is not halved again."""
MAX_WEIGHT = 3
"""Unknowns that grow together may grow like powers up to this one."""


def ranges(problem: Problem, axes: tuple[Axis, Axis]) -> tuple[Range, ...]:
    """The range of each unknown.

    Raises
    ------
    ConfigError
        With the unknowns, when no bounds of them could be proved.
    """
    found = known_ranges(problem, axes)
    if not all(isfinite(sum(bounds)) for bounds in found):
        raise refusal(problem, found)
    return found


def known_ranges(problem: Problem, axes: tuple[Axis, Axis]) -> tuple[Range, ...]:
    """The range of each unknown; infinite where no bounds could be proved."""
    window = [(enclosing_floats(axis.low)[0], enclosing_floats(axis.high)[1]) for axis in axes]
    # the equations that are polynomials: with springs those that close loops
    rigid = problem.equations[: problem.closing] if problem.has_springs else problem.equations
    known = [*rigid, *problem.multiples]
    return _BoundSearch(problem, window, [*known, *eliminated(known)]).ranges()


def refusal(problem: Problem, found: Sequence[Range]) -> ConfigError:
    """What to raise where some unknowns have no range, with their names."""
    missing = [
        name
        for name, bounds in zip(problem.unknowns, found, strict=True)
        if not isfinite(sum(bounds))
    ]
    which = f"no bound of the unknown{'s' * (len(missing) > 1)} {', '.join(missing)} could be proved over the window"
    if problem.has_springs:  # which no other engine takes
        return ConfigError(
            f"{which}, and the certified engine, which free lengths need, searches a bounded box: narrow the window, "
            "or add a spring that holds what is not bounded",
            key=f"unknowns.{missing[0]}",
        )
    return ConfigError(
        f"{which}, and the certified engine searches a bounded box: choose exact, or narrow the window",
        key=f"unknowns.{missing[0]}",
    )


@dataclass(frozen=True, slots=True)
class _BoundSearch:
    """The search for bounds over a window, with some polynomials that vanish at solutions."""

    problem: Problem
    window: Sequence[Range]
    vanishing: Sequence[TrigonometricPolynomial]

    def ranges(self) -> tuple[Range, ...]:
        """The range of each unknown; infinite where no bound of it was found."""
        problem = self.problem
        found = [
            TURN if is_angle else (0.0, inf) if self._is_positive(k) else (-inf, inf)
            for k, is_angle in enumerate(problem.is_angle)
        ]
        reals = [k for k, is_angle in enumerate(problem.is_angle) if not is_angle]
        if not reals:
            return tuple(found)
        alone = self._alone()
        waiting = list(reals)
        while waiting:
            # the ranges that are known serve to bound the others
            new = next(filter(None, (self._range(alone, found, k) for k in waiting)), None)
            new = new or next(
                filter(None, (self._together(found, chosen) for chosen in _subsets(waiting))), None
            )
            if new is None:
                return tuple(found)
            for k, bounds in new.items():
                found[k] = bounds
                waiting.remove(k)
        for k in reals if len(reals) > 1 else ():
            # bounds that were found together, or before others were known, are wide
            start = (0.0 if found[k][0] == 0 else -inf), inf
            again = self._range(alone, [*found[:k], start, *found[k + 1 :]], k)
            if again is not None:
                found[k] = max(found[k][0], again[k][0]), min(found[k][1], again[k][1])
        return tuple(found)

    def _is_positive(self, k: int) -> bool:
        """Whether a solution counts only where the unknown itself is positive."""
        powers = tuple(int(j == k) for j in range(len(self.problem.unknowns)))
        key = (0,) * len(powers), powers
        return any(
            c.value.terms.keys() == {key}
            and c.value.terms[key][0].is_constant
            and c.value.terms[key][0].constant() > 0
            for c in self.problem.inequalities
        )

    def _alone(self) -> Tape:
        """What vanishes at solutions, and what is not negative at those that count, for boxes that
        may be infinite.
        """
        problem = self.problem
        at = chart(geometry(problem))
        graph = at.equations[0].graph
        unknowns = [graph.variable(j) for j in problem.variables]
        inequalities = [c.value.formula(unknowns) for c in problem.inequalities]
        return record(
            [[*at.equations, *(f.formula(unknowns) for f in self.vanishing)], inequalities]
        )

    def _range(self, tape: Tape, found: Sequence[Range], k: int) -> _Found | None:
        """The range of one unknown, whatever those without a range are; each end is a power of two,
        or it is known.
        """
        box = np.array([*self.window, *found])

        def least(sign: int) -> int | None:
            def holds(power: int) -> bool:
                beyond = (2.0**power, inf) if sign > 0 else (-inf, -(2.0**power))
                return is_empty(tape, _with(box, FIRST + k, beyond))

            return _least(holds)

        above, low = least(1), found[k][0]
        if above is not None and low == -inf:
            below = least(-1)
            low = -inf if below is None else -(2.0**below)
        return None if above is None or low == -inf else {k: (low, 2.0**above)}

    def _together(self, found: Sequence[Range], chosen: tuple[int, ...]) -> _Found | None:
        """Ranges of unknowns of which one is always the largest: x_j = t_j u^-w_j, |t_j| at most 1,
        and one 1 or -1.

        Several weights w are tried, equal ones first.
        """
        if not self.vanishing and not self.problem.has_springs:
            return None
        for weights in sorted(
            product(range(1, MAX_WEIGHT + 1), repeat=len(chosen)), key=lambda w: (max(w), sum(w))
        ):
            if gcd(*weights) == 1:
                shares = dict(zip(chosen, weights, strict=True))
                power = self._common_bound(found, shares)
                if power is not None:
                    ends = {k: 2.0 ** (power * w) for k, w in shares.items()}
                    return {k: (0.0 if found[k][0] == 0 else -end, end) for k, end in ends.items()}
        return None

    def _common_bound(self, found: Sequence[Range], weights: Mapping[int, int]) -> int | None:
        """The least power p such that no solution has |x_j|^(1/w_j) at least 2^p for some j."""
        graph = Graph()
        unknowns = [
            graph.variable(j) for j in (*self.problem.variables, FIRST + len(self.problem.unknowns))
        ]

        def formulas(polynomials: Iterable[TrigonometricPolynomial]) -> list[Formula]:
            return [scaled_together([f], weights)[0].formula(unknowns) for f in polynomials]

        inequalities = formulas(c.value for c in self.problem.inequalities)
        tape = record(
            [formulas(self.vanishing), [*inequalities, *self._balances(weights, unknowns)]]
        )
        lowest = {k: 0.0 if found[k][0] == 0 else -1.0 for k in weights}
        faces = [(k, side) for k, low in lowest.items() for side in {1.0, low} if side]
        most, axes = (MAX_BOXES_HELD, AXES_HELD) if self.problem.has_springs else (MAX_BOXES, 1.0)

        def holds(power: int) -> bool:
            box = np.array([*self.window, *found, (0.0, 2.0**-power)])
            for k, low in lowest.items():
                box[FIRST + k] = low, 1.0
            return all(is_empty(tape, _with(box, FIRST + k, side), most, axes) for k, side in faces)

        return _least(holds)

    def _balances(
        self, weights: Mapping[int, int], unknowns: Sequence[Formula]
    ) -> Iterator[Formula]:
        """Of each equation what its springs reach at most, plus the rest, and less it: not negative
        at solutions.

        Whatever the direction u of a spring is, K u.w is at most K |w|.
        """
        problem, graph = self.problem, unknowns[0].graph
        for k, equation in enumerate(problem.equations if problem.has_springs else ()):
            parts = [equation, *(w for cone in problem.cones for w in cone.weights[k])]
            parts += [push.weights[k] for push in problem.pushes]
            rest, *others = (f.formula(unknowns) for f in scaled_together(parts, weights))
            ends, held = others[: 2 * len(problem.cones)], others[2 * len(problem.cones) :]
            reach = graph.constant(0)
            for cone, x, y in zip(problem.cones, ends[::2], ends[1::2], strict=True):
                reach = reach + expression_formula(graph, cone.pull) * length(x, y)
            for push, way in zip(problem.pushes, held, strict=True):
                rest = rest - push.strength(graph) * way
            yield from (reach + rest, reach - rest)


_Found = dict[int, Range]
"""Ranges by the number of the unknown."""


def eliminated(equations: Sequence[TrigonometricPolynomial]) -> list[TrigonometricPolynomial]:
    """Sums of two equations, one times a factor, without one of their common terms, if that leaves
    no more terms.

    What a reaction takes from one substance it often gives to another: the sum bounds unknowns that
    neither does.
    """
    found: list[TrigonometricPolynomial] = []
    for f, g in combinations(equations, 2):
        for key in f.terms.keys() & g.terms.keys():
            (a, b), (c, d) = f.terms[key], g.terms[key]
            if a.numerator and c.numerator and not (b * c - a * d).numerator:
                combined = f.scaled(c) - g.scaled(a)
                if (
                    0 < len(combined.terms) <= max(len(f.terms), len(g.terms))
                    and combined not in found
                ):
                    found.append(combined)
    return found


def scaled_together(
    polynomials: Sequence[TrigonometricPolynomial], weights: Mapping[int, int]
) -> list[TrigonometricPolynomial]:
    """Some with t_j u^-w_j in the place of real unknowns, times u^d: polynomials in one more
    unknown, u, the last.

    d is the least number that leaves no pole in any of them, so that at u = 0 they are what
    dominates far away.
    """

    def degree(powers: Multi) -> int:
        return sum(w * powers[j] for j, w in weights.items())

    most = max((degree(e) for f in polynomials for _, e in f.terms), default=0)
    return [
        TrigonometricPolynomial(
            {((*m, 0), (*e, most - degree(e))): pair for (m, e), pair in f.terms.items()}
        )
        for f in polynomials
    ]


def _with(box: Floats, variable: int, value: float | Range) -> Floats:
    face = box.copy()
    face[variable] = value
    return face


def _subsets(waiting: Sequence[int]) -> Iterator[tuple[int, ...]]:
    return (chosen for size in range(1, len(waiting) + 1) for chosen in combinations(waiting, size))


def _least(holds: Callable[[int], bool]) -> int | None:
    """The least power of two for which something holds that holds for all larger ones; None when
    for none.
    """
    if not holds(MAX_POWER):
        return None
    low, high = MIN_POWER - 1, MAX_POWER
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def is_empty(tape: Tape, box: Floats, most: int = MAX_BOXES, axes: float = 1.0) -> bool:
    """Whether it is proved that a box has no solution that counts; shape (variables, 2), infinite
    ends included.
    """
    low, high = np.empty((2, len(tape)))
    finite = np.isfinite(box).all(axis=1)
    used = np.isin(
        np.arange(len(box)), tape.program.first[tape.program.operations == Operation.VARIABLE]
    )
    with np.errstate(invalid="ignore"):
        # what is no more than a rounded number is not halved
        wide = box[:, 1] - box[:, 0] > MIN_SHARE * np.abs(box).max(axis=1)
        lengths = np.where(finite & used & wide, box[:, 1] - box[:, 0], inf)
    lengths[:FIRST] /= axes
    vanishing, nonnegative = tape.outputs
    waiting, treated = [box], 0
    while waiting:
        part = waiting.pop()
        treated += 1
        # a run that finds two enclosures of one number apart has proved that there is no such point
        if not run(tape.program, part[:, 0].copy(), part[:, 1].copy(), low, high, 0, len(tape)) or (
            (low[vanishing] > 0).any()
            or (high[vanishing] < 0).any()
            or (high[nonnegative] < 0).any()
        ):
            continue
        with np.errstate(invalid="ignore"):
            widths = np.where(finite, part[:, 1] - part[:, 0], 0.0) / lengths
        widest = int(np.argmax(widths))
        if treated >= most or widths[widest] < MIN_SHARE:
            return False
        middle = part[widest].mean()
        for side in (0, 1):
            half = part.copy()
            half[widest, side] = middle
            waiting.append(half)
    return True
