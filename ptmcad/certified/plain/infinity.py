"""Solutions that leave to infinity: patches in which all unknowns are bounded, and the curves where one is infinite.

Guarantee: each solution that counts over the window is in one of the patches, and a sequence of them over points that
converge has a limit in one. (Theorem 4 of docs/soundness.md.)

An unknown on the line of which no bound is known over the window is in [-1, 1], or it is the inverse of one there.
Unknowns may share a block: then x_k = 1/u or -1/u for the largest, and x_j = t_j/u. A patch is a choice for each block.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from math import isfinite

import numpy as np

from ptmcad.certified.formula import Formula, Graph
from ptmcad.certified.plain.bounds import Range, is_empty, known_ranges, refusal
from ptmcad.certified.plain.problem import FIRST, Condition, Problem
from ptmcad.certified.plain.trigonometric import TrigonometricPolynomial
from ptmcad.certified.tape import enclosing_floats, record
from ptmcad.question.slice import Axis

WITNESSES = tuple((Fraction(u), Fraction(v)) for u, v in (("10/21", "19/35"), ("2/13", "11/17"), ("15/19", "4/23")))
"""Shares of the window: points that are rarely on a curve that a person has in mind."""


@dataclass(frozen=True, slots=True)
class Patch:
    """A problem in coordinates that are bounded.

    Attributes
    ----------
    problem : its unknowns are named as ever; those among ``inverse`` are the inverse of what they were, up to a sign.
    inverse : numbers of unknowns.
    """

    problem: Problem
    ranges: tuple[Range, ...]
    inverse: tuple[int, ...] = ()


def patches(problem: Problem, axes: tuple[Axis, Axis]) -> tuple[Patch, ...]:
    """The problem itself where all its unknowns are bounded over the window, else several.

    Raises
    ------
    ConfigError
        With the unknowns without a bound, where in none of the blocks that are tried solutions at infinity are found to
        be rare: as for springs with a free length, of which nothing is known there.
    """
    known = known_ranges(problem, axes)
    free = [k for k, bounds in enumerate(known) if not isfinite(sum(bounds))]
    if not free:
        return (Patch(problem, known),)
    for blocks in ([(k,) for k in free], [tuple(free)]) if not (problem.has_springs or problem.closing) else ():
        found = tuple(_patches(problem, known, blocks))
        if any(_is_clear(found, point) for point in _points(axes)):
            return found
    raise refusal(problem, known)


def _patches(problem: Problem, known: Sequence[Range], blocks: Sequence[tuple[int, ...]]) -> Iterator[Patch]:
    """All choices: for each block none of its unknowns is large, or one is the largest, and positive or negative."""
    for choice in product(*(_choices(known, block) for block in blocks)):
        ranges, changed, inverse = list(known), problem, []
        for block, (largest, side) in zip(blocks, choice, strict=True):
            for k in block:
                ranges[k] = 0.0 if known[k][0] == 0 else -1.0, 1.0
            if side:
                ranges[largest] = 0.0, 1.0
                inverse.append(largest)
                changed = _inverted(changed, block, largest, side)
        yield Patch(changed, tuple(ranges), tuple(inverse))


def _choices(known: Sequence[Range], block: tuple[int, ...]) -> list[tuple[int, int]]:
    return [(block[0], 0), *((k, side) for k in block for side in ((1,) if known[k][0] == 0 else (1, -1)))]


def _inverted(problem: Problem, block: Sequence[int], largest: int, side: int) -> Problem:
    """The problem with x_k = side/u, x_j = t_j/u, each polynomial times the least power of u that leaves no pole."""

    def changed(f: TrigonometricPolynomial) -> TrigonometricPolynomial:
        degrees = {key: sum(key[1][j] for j in block) for key in f.terms}
        most = max(degrees.values(), default=0)
        terms = {}
        for (m, e), (a, b) in f.terms.items():
            sign = side ** e[largest]
            raised = (*e[:largest], most - degrees[m, e], *e[largest + 1 :])
            terms[m, raised] = a * sign, b * sign
        return TrigonometricPolynomial(terms)

    def conditions(given: Sequence[Condition]) -> tuple[Condition, ...]:
        return tuple(Condition(c.text, changed(c.value)) for c in given)

    return replace(
        problem,
        equations=tuple(map(changed, problem.equations)),
        is_gradient=False,  # no longer
        inequalities=conditions(problem.inequalities),
        stability=conditions(problem.stability),
        multiples=(),
        excesses=tuple(
            replace(excess, value=changed(excess.value), boundary=tuple(map(changed, excess.boundary)))
            for excess in problem.excesses
        ),
    )


def at_infinity(patch: Patch, k: int, conditions: Sequence[Condition]) -> tuple[list[Formula], list[Formula]]:
    """The equations and the conditions of a patch where the inverse of an unknown is zero, in a graph of their own."""
    graph = Graph()
    unknowns = [graph.variable(j) for j in patch.problem.variables]

    def limit(f: TrigonometricPolynomial) -> Formula:
        return TrigonometricPolynomial({key: c for key, c in f.terms.items() if not key[1][k]}).formula(graph, unknowns)

    return [limit(f) for f in patch.problem.equations], [limit(c.value) for c in conditions]


def _is_clear(found: Sequence[Patch], point: tuple[Range, Range]) -> bool:
    """Whether it is proved that no solution is infinite at a point."""
    for patch in found:
        for k in patch.inverse:
            tape = record(list(at_infinity(patch, k, patch.problem.inequalities)))
            box = np.array([*point, *patch.ranges])
            box[FIRST + k] = 0.0
            if not is_empty(tape, box):
                return False
    return True


def _points(axes: tuple[Axis, Axis]) -> Iterator[tuple[Range, Range]]:
    for shares in WITNESSES:
        x, y = (axis.low + (axis.high - axis.low) * share for axis, share in zip(axes, shares, strict=True))
        yield enclosing_floats(x), enclosing_floats(y)
