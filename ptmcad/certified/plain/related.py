"""Numbers of an equilibrium that are exact because its unknowns are related, whatever their values are.

Such as a chain of two equal bars that is folded onto its own pivot: its second angle is the first one and half a turn,
and the point in which it ends is the pivot, also where nothing is known of the first angle but the forces' balance.

Guarantee: exact. Relations are a guess, by balls: an angle is another one, or its negative, and some quarter turns
more, or a real unknown is another one or its negative; or either is fixed. If where they hold the equations all follow
from some of them, as many as make up the unknowns with the relations, interval Newton can prove that these and the
relations have a zero in a box. It is an equilibrium; if the box holds only one, the relations hold at that (Lemma S9 of
docs/soundness.md).

Balls alone would never tell such a number from its neighbours. The lemma is that of interval Newton as in
`ptmcad.certified.arb_isolation`.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import islice, product
from typing import NamedTuple

from flint import arb, ctx

from ptmcad.certified.arb_isolation import Box, newton
from ptmcad.certified.formula import Formula
from ptmcad.certified.plain.chart import chart
from ptmcad.certified.plain.combinations import independent
from ptmcad.certified.plain.geometry import geometry
from ptmcad.certified.plain.jets import rational_root
from ptmcad.certified.plain.problem import FIRST, Problem, constant_of
from ptmcad.certified.plain.relaxed import around
from ptmcad.certified.plain.symmetric import Point, numbers_by, point_of
from ptmcad.certified.plain.trigonometric import Harmonics, Multi, TrigonometricPolynomial
from ptmcad.certified.system import system
from ptmcad.mechanism import Mechanism
from ptmcad.mechanism.evaluate import evaluate
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.expressions import constant
from ptmcad.text.tree import Tree

MAX_CHOICES = 64
"""Of relations that are tried; each takes milliseconds."""
_Term = tuple[Hashable, tuple[Multi, Multi], int]
"""A root, multiples and powers of the unknowns, and 0 for the cosine or 1 for the sine."""


class Relation(NamedTuple):
    """An unknown that is a sign times another one, and so many quarter turns; without another one it is fixed.

    Attributes
    ----------
    unknown, other : their numbers among the unknowns.
    """

    unknown: int
    other: int | None
    sign: int
    quarters: int


def related_numbers(
    mechanism: Mechanism,
    parameters: Mapping[str, Fraction],
    problem: Problem,
    boxes: tuple[Box, Box],
    precision: int,
) -> tuple[Point, dict[str, Enclosure]]:
    """The fixed unknowns of an equilibrium, and its numbers that are rational, by relations that are proved.

    Parameters
    ----------
    problem : at these parameters, the branch that the equilibrium belongs to.
    boxes : one that holds no other equilibrium, and a narrower one around the equilibrium.
    precision : in bits.

    Returns
    -------
    The numbers by name, as exact enclosures; nothing where there is no proof.
    """
    place = around(mechanism, {}, boxes, precision)
    if place is None:
        return {}, {}
    with ctx.workprec(precision):
        choices = list(_choices(problem, boxes[1]))
    for relations in choices:
        if _hold(problem, relations, place, precision):
            turns = {problem.unknowns[r.unknown]: r.quarters for r in relations if r.other is None}
            fixed = point_of(mechanism, turns)
            values = {name: constant(value) for name, value in parameters.items()}
            known = _Known(Harmonics(problem.unknowns, problem.reals, values), relations)
            return fixed, numbers_by(mechanism, parameters, fixed, known)
    return {}, {}


def _choices(problem: Problem, near: Box) -> Iterator[tuple[Relation, ...]]:
    """Relations that an equilibrium seems to satisfy, the most of them first."""
    seeming = [(*_seeming(problem, near[FIRST:], j), None) for j in range(len(problem.unknowns))]
    chosen = [tuple(r for r in some if r is not None) for some in islice(product(*seeming), MAX_CHOICES)]
    for relations in sorted(chosen, key=len, reverse=True):
        if relations and {r.other for r in relations}.isdisjoint(r.unknown for r in relations):
            yield relations


def _seeming(problem: Problem, near: Sequence[arb], j: int) -> Iterator[Relation]:
    """That of one unknown alone, or those to the first one before it to which there is any."""
    isreal = problem.unknowns[j] in problem.reals
    unit = arb(1) if isreal else arb.pi() / 2

    def quarters(difference: arb) -> int | None:
        n = 0 if isreal else round(float((difference / unit).mid()))
        return n if difference.overlaps(n * unit) else None

    if (n := quarters(near[j])) is not None:
        yield Relation(j, None, 1, n)
    for i in range(j):
        if (problem.unknowns[i] in problem.reals) is isreal:
            found = [Relation(j, i, s, n) for s in (1, -1) if (n := quarters(near[j] - s * near[i])) is not None]
            if found:
                yield from found
                return


def _hold(problem: Problem, relations: Sequence[Relation], place: Box, precision: int) -> bool:
    """Whether it is proved that there is an equilibrium in a box at which the relations hold."""
    chosen = _implying(problem, relations)
    if chosen is None or len(chosen) + len(relations) != len(problem.unknowns):
        return False
    equations = chart(geometry(problem)).equations
    variables = [equations[0].graph.variable(k) for k in problem.variables]
    step = newton(
        system(
            [*(equations[k] for k in chosen), *(_zero(problem, r, variables) for r in relations)], problem.variables
        ),
        place,
        precision,
    )
    return step is not None and step[1]


def _zero(problem: Problem, relation: Relation, variables: Sequence[Formula]) -> Formula:
    """What is zero, next to where the unknowns are, only where a relation holds."""
    difference = variables[relation.unknown]
    if relation.other is not None:
        difference = difference - relation.sign * variables[relation.other]
    if problem.unknowns[relation.unknown] in problem.reals:
        return difference
    return difference.cos() if relation.quarters % 2 else difference.sin()


def _implying(problem: Problem, relations: Sequence[Relation]) -> list[int] | None:
    """Equations from which all follow, by linear combination, where the relations hold; None where that is not known.

    Each is a sum of polynomials, those next to the same root of a polynomial being one.
    """
    rows: list[dict[_Term, Fraction]] = [{} for _ in problem.equations]

    def add(row: dict[_Term, Fraction], f: TrigonometricPolynomial, root: Hashable = None) -> None:
        for wave, pair in _restricted(f, relations).terms.items():
            for kind, c in enumerate(pair):
                row[root, wave, kind] = row.get((root, wave, kind), Fraction(0)) + c.constant()

    for row, equation in zip(rows, problem.equations, strict=True):
        add(row, equation)
    for cone in problem.cones:
        (x, y), *weights = ([_restricted(f, relations) for f in pair] for pair in (cone.difference, *cone.weights))
        squared = x * x + y * y
        if not squared.terms:
            return None
        length = _length(squared)
        root, factor = (None, cone.pull / length) if length else (frozenset(squared.terms.items()), cone.pull)
        for row, (a, b) in zip(rows, weights, strict=True):
            add(row, (x * a + y * b).scaled(factor), root)
    for push in problem.pushes:
        for row, weight in zip(rows, push.weights, strict=True):
            add(row, weight.scaled(push.pull), push.direction)
    return independent({term: c for term, c in row.items() if c} for row in rows)


def _length(squared: TrigonometricPolynomial) -> Fraction | None:
    """The square root, where that is a rational number."""
    number = _number(squared)
    return None if number is None else rational_root(number)


def _number(f: TrigonometricPolynomial) -> Fraction | None:
    """The value of a polynomial without unknowns."""
    alone = not any(any(m) or any(e) for m, e in f.terms)
    return constant_of(f).constant() if alone else None


def _restricted(f: TrigonometricPolynomial, relations: Iterable[Relation]) -> TrigonometricPolynomial:
    """The polynomial where relations hold."""
    for unknown, other, sign, quarters in relations:
        f = f.replaced(unknown, other, sign, quarters)
    return f


class _Known(NamedTuple):
    """What relations tell of a mechanism; see `ptmcad.certified.plain.symmetric.Known`."""

    ring: Harmonics
    relations: tuple[Relation, ...]

    def value(self, tree: Tree) -> Fraction | None:
        return _number(self._of(tree))

    def squared_length(self, mechanism: Mechanism, start: str, end: str) -> Fraction | None:
        ends = zip(mechanism.points[start], mechanism.points[end], strict=True)
        x, y = (self._of(b) - self._of(a) for a, b in ends)
        return _number(x * x + y * y)

    def _of(self, tree: Tree) -> TrigonometricPolynomial:
        return _restricted(evaluate(tree, self.ring), self.relations)
