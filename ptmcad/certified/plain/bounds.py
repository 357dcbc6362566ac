"""Ranges of the unknowns that hold all solutions over a window: a full turn of each angle, proved bounds of the others.

Guarantee: over the closed window no solution at which no inequality is violated has a real unknown outside of its
range, nor comes to infinity. (Lemma 19 of docs/soundness.md.)
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from math import gcd, inf, isfinite

import numpy as np

from ptmcad.certified.evaluation import Floats, program, run
from ptmcad.certified.formula import Formula, Graph, Operation
from ptmcad.certified.plain.chart import chart
from ptmcad.certified.plain.geometry import geometry
from ptmcad.certified.plain.loopchart import loop_chart
from ptmcad.certified.plain.nested import eliminated, nested, scaled, sharp_squares, times
from ptmcad.certified.plain.problem import FIRST, Problem
from ptmcad.certified.plain.separated import separated
from ptmcad.certified.plain.trigonometric import TrigonometricPolynomial
from ptmcad.certified.tape import Tape, enclosing_floats, record
from ptmcad.errors import ConfigError
from ptmcad.question.slice import Axis

TURN = (-3.0, -3.0 + 6.2832)
"""A little more than a full turn, cut where no symmetric solution lies."""
MIN_POWER, MAX_POWER = -10, 40
"""Of two, tried as bounds."""
MAX_BOXES = 1000
"""For one bound; each is halved along an axis or an unknown where nothing excludes it."""
MAX_BOXES_HELD = 5_000
"""The same for a length that springs hold together with others, by all parts in which they are regular."""
MIN_SHARE = 1e-12
"""Of a range, or of a number's size, below which it is not halved again."""
MAX_WEIGHT = 3
"""Unknowns that grow together may grow like powers up to this one."""

Range = tuple[float, float]


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
    found: tuple[Range, ...] = ()
    # more polynomials cost more time, and are seldom needed
    for with_products in (False, True) if len(problem.unknowns) > 1 and _rigid(problem) else (False,):
        found = _Search(problem, window, _vanishing(problem, with_products)).ranges()
        if all(isfinite(sum(bounds)) for bounds in found):
            break
    return found


def refusal(problem: Problem, found: Sequence[Range]) -> ConfigError:
    """What to raise where some unknowns have no range, with their names."""
    missing = [name for name, bounds in zip(problem.unknowns, found, strict=True) if not isfinite(sum(bounds))]
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


def _vanishing(problem: Problem, with_products: bool) -> list[TrigonometricPolynomial]:
    """Polynomials that are zero at every solution."""
    known = [*_rigid(problem), *problem.multiples]
    if with_products:
        reals = [k for k, name in enumerate(problem.unknowns) if name in problem.reals]
        known += [times(f, k) for f in _rigid(problem) for k in reals]
    return [*known, *eliminated(known)]


def _rigid(problem: Problem) -> Sequence[TrigonometricPolynomial]:
    """The equations that are polynomials: with cones those that close loops."""
    return problem.equations[: problem.closing] if problem.has_springs else problem.equations


@dataclass(frozen=True, slots=True)
class _Search:
    """The search for bounds over a window, with some polynomials that vanish at solutions."""

    problem: Problem
    window: Sequence[Range]
    vanishing: Sequence[TrigonometricPolynomial]

    def ranges(self) -> tuple[Range, ...]:
        """The range of each unknown; infinite where no bound of it was found."""
        problem = self.problem
        found = [
            TURN if name not in problem.reals else (0.0, inf) if self._is_positive(k) else (-inf, inf)
            for k, name in enumerate(problem.unknowns)
        ]
        reals = [k for k, name in enumerate(problem.unknowns) if name in problem.reals]
        tapes = {k: self._alone(k) for k in reals}
        waiting = list(reals)
        while waiting:
            # the ranges that are known serve to bound the others
            new = next(filter(None, (self._range(tapes[k], found, k) for k in waiting)), None)
            new = new or next(filter(None, (self._together(found, chosen) for chosen in _subsets(waiting))), None)
            new = new or next(filter(None, (self._held(found, chosen) for chosen in _subsets(waiting))), None)
            if new is None:
                return tuple(found)
            for k, bounds in new.items():
                found[k] = bounds
                waiting.remove(k)
        for k in reals if len(reals) > 1 else ():
            # bounds that were found together, or before others were known, are wide
            start = (0.0 if found[k][0] == 0 else -inf), inf
            again = self._range(tapes[k], [*found[:k], start, *found[k + 1 :]], k)
            if again is not None:
                found[k] = max(found[k][0], again[k][0]), min(found[k][1], again[k][1])
        return tuple(found)

    def _is_positive(self, k: int) -> bool:
        """Whether a solution counts only where the unknown itself is positive."""
        powers = tuple(int(j == k) for j in range(len(self.problem.unknowns)))
        key = (0,) * len(powers), powers
        return any(
            c.value.terms.keys() == {key} and c.value.terms[key][0].is_constant and c.value.terms[key][0].constant() > 0
            for c in self.problem.inequalities
        )

    def _alone(self, k: int) -> Tape:
        """What vanishes at solutions, and what is not negative at those that count, for boxes that may be infinite.

        The same polynomials are nested in several ways: none is the best one in all boxes.
        """
        problem = self.problem
        at = loop_chart(problem) if problem.closing else chart(geometry(problem))
        graph = at.equations[0].graph
        unknowns = [graph.variable(j) for j in problem.variables]
        others = [(j, True) for j, name in enumerate(problem.unknowns) if name in problem.reals and j != k]

        def ways(polynomials: Iterable[TrigonometricPolynomial]) -> list[Formula]:
            orders = [(k, False), *others], [*others, (k, False)]
            return [nested(graph, f, unknowns, order) for f in polynomials for order in orders]

        inequalities = ways(c.value for c in problem.inequalities)
        return sharp_squares(record([[*at.equations, *ways(self.vanishing)], inequalities]))

    def _range(
        self, tape: Tape, found: Sequence[Range], k: int, parts: Sequence[Floats] = (), most: int = MAX_BOXES
    ) -> _Found | None:
        """The range of one unknown, whatever those without a range are; each end is a power of two, or it is known.

        Parameters
        ----------
        parts : boxes that cover the window and the other ranges, where it is not to be the whole in one.
        most : boxes for each of them.
        """
        boxes = parts or [np.array([*self.window, *found])]

        def least(sign: int) -> int | None:
            def holds(power: int) -> bool:
                beyond = (2.0**power, inf) if sign > 0 else (-inf, -(2.0**power))
                return all(is_empty(tape, _with(box, FIRST + k, beyond), most) for box in boxes)

            return _least(holds)

        above, low = least(1), found[k][0]
        if above is not None and low == -inf:
            below = least(-1)
            low = -inf if below is None else -(2.0**below)
        return None if above is None or low == -inf else {k: (low, 2.0**above)}

    def _held(self, found: Sequence[Range], chosen: tuple[int, ...]) -> _Found | None:
        """Ranges of several lengths that springs hold together: for polynomials alone, and a single length, all that
        this could tell has been tried."""
        equations = separated(self.problem, chosen) if len(chosen) > 1 and self.problem.has_springs else ()
        if not equations:
            return None
        # it is the determinant that has to be halved, in what it depends on
        graph = Graph()
        unknowns = [graph.variable(j) for j in self.problem.variables]
        slope = record([[equations[0].slope.formula(graph, unknowns)], []])
        parts = empty_parts(slope, np.array([*self.window, *found]))
        if parts is None:
            return None
        ranges: _Found = {}
        order = [(j, False) for j, name in enumerate(self.problem.unknowns) if name in self.problem.reals]
        for equation in equations:
            tape = sharp_squares(record([[], equation.nonnegative(graph, unknowns, order)]))
            most = max(1, MAX_BOXES_HELD // len(parts))
            ranges |= self._range(tape, found, equation.unknown, parts, most) or {}
        return ranges or None

    def _together(self, found: Sequence[Range], chosen: tuple[int, ...]) -> _Found | None:
        """Ranges of unknowns of which one is always the largest: x_j = t_j u^-w_j, |t_j| at most 1, and one 1 or -1.

        Several weights w are tried, equal ones first.
        """
        if not self.vanishing:
            return None
        for weights in sorted(product(range(1, MAX_WEIGHT + 1), repeat=len(chosen)), key=lambda w: (max(w), sum(w))):
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
        unknowns = [graph.variable(j) for j in (*self.problem.variables, FIRST + len(self.problem.unknowns))]

        def formulas(polynomials: Iterable[TrigonometricPolynomial]) -> list[Formula]:
            return [scaled(f, weights).formula(graph, unknowns) for f in polynomials]

        inequalities = formulas(c.value for c in self.problem.inequalities)
        tape = sharp_squares(record([formulas(self.vanishing), inequalities]))
        lowest = {k: 0.0 if found[k][0] == 0 else -1.0 for k in weights}
        faces = [(k, side) for k, low in lowest.items() for side in {1.0, low} if side]

        def holds(power: int) -> bool:
            box = np.array([*self.window, *found, (0.0, 2.0**-power)])
            for k, low in lowest.items():
                box[FIRST + k] = low, 1.0
            return all(is_empty(tape, _with(box, FIRST + k, side)) for k, side in faces)

        return _least(holds)


_Found = dict[int, Range]
"""Ranges by the number of the unknown."""


def _with(box: Floats, variable: int, value: float | Range) -> Floats:
    face = box.copy()
    face[variable] = value
    return face


def _subsets(waiting: Sequence[int]) -> Iterator[tuple[int, ...]]:
    return (chosen for size in range(1, len(waiting) + 1) for chosen in combinations(waiting, size))


def _least(holds: Callable[[int], bool]) -> int | None:
    """The least power of two for which something holds that holds for all larger ones; None when for none."""
    if not holds(MAX_POWER):
        return None
    low, high = MIN_POWER - 1, MAX_POWER
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def is_empty(tape: Tape, box: Floats, most: int = MAX_BOXES) -> bool:
    """Whether it is proved that a box has no solution that counts; shape (variables, 2), infinite ends included."""
    return empty_parts(tape, box, most) is not None


def empty_parts(tape: Tape, box: Floats, most: int = MAX_BOXES) -> list[Floats] | None:
    """The parts of a box of which each is proved to have none; None where that takes more boxes."""
    low, high = np.empty((2, len(tape)))
    finite = np.isfinite(box).all(axis=1)
    used = np.isin(np.arange(len(box)), tape.first[tape.operations == Operation.VARIABLE])
    with np.errstate(invalid="ignore"):
        # what is no more than a rounded number is not halved
        wide = box[:, 1] - box[:, 0] > MIN_SHARE * np.abs(box).max(axis=1)
        lengths = np.where(finite & used & wide, box[:, 1] - box[:, 0], inf)
    vanishing, nonnegative = tape.outputs
    waiting, treated = [box], 0
    empty: list[Floats] = []
    while waiting:
        part = waiting.pop()
        treated += 1
        # a run that finds two enclosures of one number apart has proved that there is no such point
        if not run(program(tape), part[:, 0].copy(), part[:, 1].copy(), low, high, 0, len(tape)) or (
            (low[vanishing] > 0).any() or (high[vanishing] < 0).any() or (high[nonnegative] < 0).any()
        ):
            empty.append(part)
            continue
        with np.errstate(invalid="ignore"):
            widths = np.where(finite, part[:, 1] - part[:, 0], 0.0) / lengths
        widest = int(np.argmax(widths))
        if treated >= most or widths[widest] < MIN_SHARE:
            return None
        middle = part[widest].mean()
        for side in (0, 1):
            half = part.copy()
            half[widest, side] = middle
            waiting.append(half)
    return empty
