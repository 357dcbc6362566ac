"""The involutions by which the certified engine searches less, and the coordinates that one of them
keeps, or takes to their negatives, about a component of its fixed points; and which savings are made
in the search for the curves of a problem.

Guarantee: that of `ptmcad.model.involutions`; a problem's springs, too, are kept up to their order.
Together the frames of an involution reach all configurations, or the image of each.
What is left out is decided by `omissions` alone: the search leaves out what it says, and nothing
else; the plan of a result is written from it. Loads neither numpy nor numba.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any, NamedTuple

from ptmcad.certified.plain.geometry import Matrix, turning_directions
from ptmcad.certified.plain.harmonics import Angle, TrigonometricPolynomial, Unknown
from ptmcad.certified.plain.problem import TURN, Problem, Range, problem_of
from ptmcad.formulas.graph import Formula, Graph
from ptmcad.model.involutions import Involution, involutions
from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import Expression, constant

SADDLES = "folds-of-saddles"
CONES = "cones-and-creases"
DEPENDENT = "dependent-equations"
IMAGES = "mirror-images"


def mirrors(slice: Slice, problem: Problem) -> list[Involution]:
    """Those that keep each point, and fix some configurations; first those with the most odd
    unknowns.

    There are none in half angles, where springs are pushes, and in closed loops; and of a branch none
    but those that keep the sides on which its springs are.
    """
    if problem.pushes or problem.rows or problem.closing or not problem.is_gradient:
        return []
    found = [
        each
        for each in involutions(slice.model, slice.parameters)
        if each.odd and each.has_fixed_unknowns and _squares(problem) == _squares(problem, each)
        if not _is_short_where_fixed(problem, each)
        if not problem.is_branch or _keeps_sides(problem, each)
    ]
    return sorted(found, key=lambda each: -each.odd)


def _keeps_sides(problem: Problem, change: Involution) -> bool:
    """Whether all inequalities of a branch, and so the parts of the energy that are along its
    springs' lines, are the same at the images.
    """
    return all(image_of(c.value, change) == c.value for c in problem.inequalities)


def _is_short_where_fixed(problem: Problem, change: Involution) -> bool:
    """Whether all unknowns are odd, so that fixed configurations are isolated, and a spring has no
    length in one of them, whatever the axes. Its cone is there at each point of the window:
    coordinates about it are not regular, but for the single unknown of a crease."""
    if change.odd < max(len(problem.unknowns), 2):
        return False
    # in quarter turns; real unknowns are 0
    choices = [
        (half, half + 2) if is_angle else (0,)
        for is_angle, half in zip(problem.is_angle, change.halves, strict=True)
    ]
    return any(
        all(_vanishes(f, quarters) for f in cone.difference)
        for quarters in product(*choices)
        for cone in problem.cones
    )


def _vanishes(f: TrigonometricPolynomial, quarters: tuple[int, ...]) -> bool:
    """Whether a polynomial is zero for all axes where angles are so many quarter turns and real
    unknowns are zero.
    """
    total = constant(0)
    for (multiples, powers), (cosine, sine) in f.terms.items():
        if not any(powers):
            turned = sum(m * q for m, q in zip(multiples, quarters, strict=True)) % 4
            total = total + (cosine, sine, -cosine, -sine)[turned]
    return not total.numerator


def halving(slice: Slice) -> Involution | None:
    """One that takes the window to itself, and does not keep its points; a reflection if there is
    any.

    None where the count is by a predicate that symmetries do not keep; or by one of whose margins
    one is a sum of squares, as what vanishes in its place is kept as that sum only.
    """
    if not slice.count.kind.is_symmetric:
        return None
    if any(condition.squares for condition in problem_of(slice).further):
        return None
    x, y = slice.axes
    found = involutions(slice.model, slice.parameters, ((x.low, x.high), (y.low, y.high)))
    moving = [each for each in found if not each.keeps_points]
    return min(moving, key=lambda each: (each.axes, -sum(each.axis_signs)), default=None)


def square_of(
    vector: tuple[TrigonometricPolynomial, TrigonometricPolynomial],
) -> TrigonometricPolynomial:
    """The squared length."""
    x, y = vector
    return x * x + y * y


def image_of(f: TrigonometricPolynomial, change: Involution) -> TrigonometricPolynomial:
    """The polynomial's values at the images."""
    return f.moved(change.images, change.signs, change.halves)


def _squares(
    problem: Problem, change: Involution | None = None
) -> Counter[tuple[Expression, frozenset[object]]]:
    """The pulls of springs with their squared lengths, or those at the images."""
    found = [(cone.pull, square_of(cone.difference)) for cone in problem.cones]
    return Counter(
        (pull, frozenset((image_of(f, change) if change else f).terms.items())) for pull, f in found
    )


class _SignedSum(NamedTuple):
    """An unknown as a sum: a sign times an even coordinate, one times an odd one, and quarter
    turns.

    A coordinate that is not in it is -1.
    """

    even: int
    even_sign: int
    odd: int
    odd_sign: int
    quarters: int


@dataclass(frozen=True, slots=True)
class MirrorFrame:
    """Coordinates about one component of an involution's fixed points.

    Attributes
    ----------
    problem : what they are coordinates of.
    change : the involution.
    places : of the unknowns.
    squares : of the lengths of its springs.
    ranges : of the even coordinates.
    reaches : of the odd coordinates that are no angles the largest absolute values; 0 for an angle,
        of which a quarter turn to each side is taken.
    """

    problem: Problem
    change: Involution
    places: tuple[_SignedSum, ...]
    squares: tuple[TrigonometricPolynomial, ...]
    ranges: tuple[Range, ...]
    reaches: tuple[Fraction, ...]

    @property
    def evens(self) -> list[list[tuple[int, int]]]:
        """For each even coordinate the unknowns that it is in, with its signs."""
        return _members([(p.even, p.even_sign) for p in self.places], len(self.ranges))

    @property
    def odds(self) -> list[list[tuple[int, int]]]:
        """The same of the odd ones."""
        return _members([(p.odd, p.odd_sign) for p in self.places], len(self.reaches))

    def distance_squared(self, unknowns: Sequence[Unknown]) -> Formula:
        """Of a configuration from its image: the sum of the squares of the odd coordinates' sines,
        or of their shares of the reach.
        """
        graph = unknowns[0].graph
        total = graph.constant(0)
        for odd, reach in zip(self.odds, self.reaches, strict=True):
            k = odd[0][0]
            q, image, sign = unknowns[k], unknowns[self.change.images[k]], self.change.signs[k]
            if isinstance(q, Formula) and isinstance(image, Formula):
                total = total + ((q - sign * image) * (1 / (2 * reach))).squared()
            elif isinstance(q, Angle) and isinstance(image, Angle):
                apart = q + -sign * image + Angle(graph, quarters=2 * self.change.halves[k])
                total = total + (1 - apart.cos()) * Fraction(1, 2)
        return total

    def unknowns(
        self, evens: Sequence[Formula], odds: Sequence[Formula | Angle], graph: Graph
    ) -> list[Unknown]:
        """What stands for the unknowns.

        Parameters
        ----------
        odds : angles, and formulas of what is none; none on the component itself.
        """
        found: list[Unknown] = []
        for is_angle, place in zip(self.problem.is_angle, self.places, strict=True):
            total: Any = Angle(graph, quarters=place.quarters) if is_angle else graph.constant(0)
            if place.even >= 0:
                even = evens[place.even]
                total += place.even_sign * (Angle(graph, {even: 1}) if is_angle else even)
            if odds and place.odd >= 0:
                total += place.odd_sign * odds[place.odd]
            found.append(total)
        return found

    def block(
        self,
        hessian: Matrix,
        columns: Sequence[Sequence[tuple[int, int]]],
        scales: Sequence[Formula],
        *,
        over: bool,
    ) -> Matrix:
        """The Hessian by some coordinates, from that by the unknowns with rows over ``scales``.

        Parameters
        ----------
        over : whether rows may stay over a positive factor.
        """

        def entry(a: Sequence[tuple[int, int]], b: Sequence[tuple[int, int]]) -> Formula:
            total = scales[0].graph.constant(0)
            common = over and all(scales[i] is scales[a[0][0]] for i, _ in a)
            for i, s in a:
                row = sum(
                    ((s * t) * hessian[i][j] for j, t in b), start=scales[0].graph.constant(0)
                )
                total = total + (row if common else scales[i] * row)
            return total

        return tuple(tuple(entry(a, b) for b in columns) for a in columns)


def _members(signed: Sequence[tuple[int, int]], count: int) -> list[list[tuple[int, int]]]:
    return [[(k, sign) for k, (own, sign) in enumerate(signed) if own == n] for n in range(count)]


def frames(problem: Problem, change: Involution, ranges: Sequence[Range]) -> Iterator[MirrorFrame]:
    """One for each component of the fixed points; together their odd coordinates reach all
    configurations.
    """
    angles = problem.is_angle
    alone = [k for k, j in enumerate(change.images) if j == k and change.signs[k] < 0 and angles[k]]
    squares = tuple(square_of(cone.difference) for cone in problem.cones)
    for sides in product((0, 2), repeat=len(alone)):
        turned = dict(zip(alone, sides, strict=True))
        places, evens, reaches = dict[int, _SignedSum](), list[Range](), list[Fraction]()
        for k, (j, sign, half) in enumerate(
            zip(change.images, change.signs, change.halves, strict=True)
        ):
            if j < k:
                continue
            low, high = ranges[k]
            if j > k:
                least, most = sorted(sign * end for end in ranges[j])
                places[k] = _SignedSum(len(evens), 1, len(reaches), 1, 0)
                places[j] = _SignedSum(len(evens), sign, len(reaches), -sign, 2 * half)
                evens.append(TURN if angles[k] else ((low + least) / 2, (high + most) / 2))
                reaches.append(
                    Fraction(0) if angles[k] else Fraction(max(most - low, high - least)) / 2
                )
            elif sign > 0:
                places[k] = _SignedSum(len(evens), 1, -1, 0, 0)
                evens.append(ranges[k])
            else:
                places[k] = _SignedSum(-1, 0, len(reaches), 1, half + turned.get(k, 0))
                reaches.append(Fraction(0) if angles[k] else Fraction(max(-low, high)))
        yield MirrorFrame(
            problem,
            change,
            tuple(places[k] for k in range(len(places))),
            squares,
            tuple(evens),
            tuple(reaches),
        )


def omissions(
    slice: Slice, problem: Problem, count: Count, without: frozenset[str]
) -> tuple[frozenset[str], frozenset[str], tuple[Involution, ...]]:
    """What can be left out of a problem of the slice: the names of savings of
    `ptmcad.question.savings` that are made, and of those that could be and were switched off; and
    the involutions about whose fixed points folds are searched.

    Parameters
    ----------
    without : names of savings that are switched off.
    """
    changes = mirrors(slice, problem)
    of_minima = problem.is_gradient and count.is_of_stable
    dependent = not problem.closing and bool(problem.cones or turning_directions(problem))
    is_possible = {
        SADDLES: of_minima,
        CONES: of_minima and bool(problem.cones),
        DEPENDENT: dependent,
        IMAGES: bool(changes),
    }
    possible = frozenset(name for name, holds in is_possible.items() if holds)
    made = possible - without
    if SADDLES not in made or IMAGES in made:
        # only folds of minima alone, in the unknowns themselves, have the points at which a spring
        # without length swallows a minimum
        made -= {CONES}
    return made, possible & without, tuple(changes) if IMAGES in made else ()
