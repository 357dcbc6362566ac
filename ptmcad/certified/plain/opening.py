"""The energy of a problem that an involution keeps, as a smooth function u(e, c, w) next to its
fixed points.

Guarantee: the formulas of an `UnfoldedEnergy` are derivatives of u, exactly, all over its frame.

Everything is written of polynomials in an odd r, as a part that is even plus r times another one,
both functions of v = r^2. Of a spring's squared length N + r M, with that of its image N - r M, the
two lengths have a product that is the root of Z = N^2 - v M^2, and half a sum that is the root of
(N + the product)/2. Such roots are variables until all is differentiated; then their ordinary
formulas take their places.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb
from typing import NamedTuple

from ptmcad.certified.plain.harmonics import Angle, Multi, TrigonometricPolynomial, Unknown
from ptmcad.certified.plain.mirrors import MirrorFrame, image_of
from ptmcad.certified.plain.problem import FIRST, Range
from ptmcad.formulas.evaluation import substituted
from ptmcad.formulas.graph import Formula, Graph, expression_formula, inverse_length, length
from ptmcad.text.expressions import Expression, constant

QUARTER = (0.0, 1.5708)
"""A little more than a quarter turn."""
_HALF = Fraction(1, 2)


class _EvenOdd(NamedTuple):
    """Of a function the even part, and the odd one over r."""

    even: Formula
    odd: Formula


@dataclass(frozen=True, slots=True)
class Coordinates:
    """A frame's coordinates where the odd one of number ``lead`` is the largest, as variables of a
    graph.

    Attributes
    ----------
    evens : variables.
    r : the variable of the lead: the tangent of half an angle, or that angle itself where nothing
        else is odd; of what is no angle a share of its reach.
    w : what the odd coordinates, or these tangents, are multiples of r by.
    coordinate : a variable that stands for v = r^2, or for the cosine of r where that is an angle,
        and r for its sine.
    """

    frame: MirrorFrame
    lead: int
    graph: Graph
    evens: tuple[Formula, ...]
    r: Formula
    w: tuple[Formula, ...]
    coordinate: Formula

    @property
    def is_turning(self) -> bool:
        """Whether r is an angle."""
        return len(self.w) == 1 and not self.frame.reaches[0]

    @property
    def v(self) -> Formula:
        """r^2 by the coordinate."""
        return 1 - self.coordinate.squared() if self.is_turning else self.coordinate

    @property
    def value(self) -> Formula:
        """The coordinate by r."""
        return self.r.cos() if self.is_turning else self.r.squared()

    @property
    def ranges(self) -> tuple[Range, ...]:
        """Of the variables."""
        lead = QUARTER if self.is_turning else (0.0, 1.0)
        return (*self.frame.ranges, lead, *((-1.0, 1.0) for _ in self.w[1:]))

    def unknowns(self) -> list[Unknown]:
        """The problem's, by the variables."""
        odds: list[Formula | Angle] = []
        for w, reach in zip(self.w, self.frame.reaches, strict=True):
            if reach:
                odds.append(reach * (self.r * w))
            elif self.is_turning:
                odds.append(Angle(self.graph, {self.r: 1}))
            else:
                odds.append(Angle(self.graph, tangents={self.r * w: 1}))
        return self.frame.unknowns(self.evens, odds, self.graph)

    def _near(self, odd: int) -> Formula:
        """A variable for 1/(1 + t^2), t being the tangent of half an angle."""
        return self.graph.variable(self.coordinate.variable + 1 + odd)

    def nears(self) -> dict[int, Formula]:
        """What takes the places of these variables."""
        return {
            self._near(j).variable: 1 / (1 + (self.r * w).squared()) for j, w in enumerate(self.w)
        }

    def derivative(self, f: Formula, by: Formula) -> Formula:
        """The derivative by a coordinate of what has no roots in it."""
        total = self.graph.derivative(f, by.variable)
        for j, w in enumerate(self.w):
            near = self._near(j)
            slope = self.graph.derivative(self.v * w.squared(), by.variable)
            total = total - self.graph.derivative(f, near.variable) * (near.squared() * slope)
        return total

    def pace(self, odd: int) -> Formula:
        """The derivative of an odd coordinate by its share or tangent."""
        reach = self.frame.reaches[odd]
        return self.graph.constant(reach) if reach else 2 * self._near(odd)

    def _wave(self, multiples: Multi) -> _EvenOdd:
        """The cosine of a sum of odd angles, and its sine over r."""
        if self.is_turning:
            before = _EvenOdd(self.coordinate, self.graph.constant(-1))
            wave = _EvenOdd(self.graph.constant(1), self.graph.constant(0))
            for _ in range(multiples[0]):  # Chebyshev's polynomials
                before, wave = (
                    wave,
                    _EvenOdd(
                        *(2 * self.coordinate * f - g for f, g in zip(wave, before, strict=True))
                    ),
                )
            return wave
        run, rise, near = self.graph.constant(1), self.graph.constant(0), self.graph.constant(1)
        for j, n in enumerate(multiples):
            for _ in range(abs(n)):
                t = self.w[j] if n > 0 else -self.w[j]
                run, rise, near = run - self.v * (rise * t), rise + run * t, near * self._near(j)
        return _EvenOdd(2 * (run.squared() * near) - 1, 2 * (run * rise * near))

    def _power(self, powers: Multi) -> _EvenOdd:
        """A product of powers of the unknowns that are no angles."""
        total = _EvenOdd(self.graph.constant(1), self.graph.constant(0))
        for place, power in zip(self.frame.places, powers, strict=True):
            if not power:
                continue
            zero = self.graph.constant(0)
            even = place.even_sign * self.evens[place.even] if place.even >= 0 else zero
            odd = (
                (place.odd_sign * self.frame.reaches[place.odd]) * self.w[place.odd]
                if place.odd >= 0
                else zero
            )
            some = [zero, zero]
            for k in range(power + 1):
                term = comb(power, k) * (_to(even, power - k) * _to(odd, k) * _to(self.v, k // 2))
                some[k % 2] = some[k % 2] + term
            total = self.times(total, _EvenOdd(*some))
        return total

    def times(self, one: _EvenOdd, other: _EvenOdd) -> _EvenOdd:
        """A product."""
        return _EvenOdd(
            one.even * other.even + self.v * (one.odd * other.odd),
            one.even * other.odd + one.odd * other.even,
        )

    def parts(self, terms: Iterable[tuple[int, TrigonometricPolynomial]]) -> _EvenOdd:
        """Of a sum of multiples of polynomials."""
        size = len(self.w)
        # by odd multiples and powers, and by even multiples: of cos cos, sin cos, cos sin and sin
        # sin
        known: dict[tuple[Multi, Multi], dict[Multi, list[Expression]]] = {}
        for factor, f in terms:
            for (m, powers), (a, b) in f.terms.items():
                evens, odds, quarters = [0] * len(self.evens), [0] * size, 0
                for n, place in zip(m, self.frame.places, strict=True):
                    if place.even >= 0:
                        evens[place.even] += n * place.even_sign
                    if place.odd >= 0:
                        odds[place.odd] += n * place.odd_sign
                    quarters += n * place.quarters
                # a cos(A + q) + b sin(A + q) = c cos A + d sin A
                c, d = ((a, b), (b, -a), (-a, -b), (-b, a))[quarters % 4]
                (first, s), (second, t) = _leading(evens), _leading(odds)
                entry = known.setdefault((second, powers), {}).setdefault(first, [constant(0)] * 4)
                for k, value in enumerate((c, d * s, d * t, c * (-s * t))):
                    entry[k] = entry[k] + value * factor
        total = _EvenOdd(self.graph.constant(0), self.graph.constant(0))
        for (odds_, powers), by_even in known.items():
            even = odd = self.graph.constant(0)
            for multiples, (cc, sc, cs, ss) in by_even.items():
                angle = Angle(
                    self.graph, {e: n for e, n in zip(self.evens, multiples, strict=True) if n}
                )
                cosine, sine = angle.cos(), angle.sin()
                even = even + (
                    expression_formula(self.graph, cc) * cosine
                    + expression_formula(self.graph, sc) * sine
                )
                odd = odd + (
                    expression_formula(self.graph, cs) * cosine
                    + expression_formula(self.graph, ss) * sine
                )
            wave = self._wave(odds_)
            added = self.times(_EvenOdd(even * wave.even, odd * wave.odd), self._power(powers))
            total = _EvenOdd(total.even + added.even, total.odd + added.odd)
        return total


def _leading(multiples: Sequence[int]) -> tuple[Multi, int]:
    """The multiples with a first one that is positive, and the sign that this takes."""
    sign = -1 if next((n for n in multiples if n), 1) < 0 else 1
    return tuple(sign * n for n in multiples), sign


def _to(f: Formula, power: int) -> Formula:
    if power == 0:
        return f.graph.constant(1)
    return f.squared() if power == 2 else f if power == 1 else f * _to(f, power - 1)


class _Spring(NamedTuple):
    """A spring of a length l, or one of two that are each other's images.

    Attributes
    ----------
    image : number of the other one, or its own.
    square, parts : of l.
    product : l^2, or of two the square of the product of both, which is even.
    inverse : a variable for one over its root.
    share : of two, a variable for one over the sum of both.
    """

    number: int
    image: int
    pull: Formula
    square: TrigonometricPolynomial
    parts: _EvenOdd
    product: Formula
    inverse: Formula
    share: Formula


@dataclass(frozen=True, slots=True)
class UnfoldedEnergy:
    """The derivatives of u.

    Attributes
    ----------
    slope : u_c.
    ratios : g, the derivatives by w over v.
    bend, mixed : u_cc, and u_ce for each even coordinate.
    by_even, by_coordinate, by_ratio : the derivatives of each of g.
    """

    slope: Formula
    ratios: tuple[Formula, ...]
    bend: Formula
    mixed: tuple[Formula, ...]
    by_even: tuple[tuple[Formula, ...], ...]
    by_coordinate: tuple[Formula, ...]
    by_ratio: tuple[tuple[Formula, ...], ...]


def coordinates(frame: MirrorFrame, lead: int) -> Coordinates:
    """In a graph of their own."""
    graph, count, size = Graph(), len(frame.places), len(frame.ranges)
    variables = [graph.variable(FIRST + k) for k in range(count + 1)]
    others = variables[size + 1 : count]
    w = (*others[:lead], graph.constant(1), *others[lead:])
    return Coordinates(
        frame, lead, graph, tuple(variables[:size]), variables[size], w, variables[count]
    )


def stiffness(at: Coordinates, vectors: Sequence[tuple[Formula, Formula]]) -> Formula:
    """Where one coordinate alone is odd the second derivative by it on the fixed points, times a
    positive number.

    Parameters
    ----------
    vectors : of the springs with a free length, by the even coordinates.
    """
    springs = list(_springs(at))
    slope, _ = _slopes(at, springs)
    here = at.graph.constant(int(at.is_turning))
    return substituted(
        -slope if at.is_turning else slope,
        {at.coordinate.variable: here}
        | dict.fromkeys(at.nears(), at.graph.constant(1))
        | _lengths(springs, vectors),
    )


def _slopes(at: Coordinates, springs: Sequence[_Spring]) -> tuple[Formula, list[Formula]]:
    """u_c, and the derivatives by shares or tangents over r; that of the lead is without springs."""
    odds = at.frame.odds
    ratios = [
        at.parts([(s, at.frame.problem.equations[k]) for k, s in odd]).odd
        * (1 if at.is_turning else at.pace(j))
        for j, odd in enumerate(odds)
    ]
    if at.is_turning:
        slope = -ratios[0]
    else:
        slope = (
            sum((w * g for w, g in zip(at.w, ratios, strict=True)), start=at.graph.constant(0))
            * _HALF
        )
    for spring in springs:
        slope = slope - spring.pull * _stretch(at, spring, at.coordinate)
        for j, odd in enumerate(odds):
            if j != at.lead:
                ratios[j] = ratios[j] - spring.pull * at.pace(j) * _share(at, spring, odd)
    return slope, ratios


def _lengths(
    springs: Sequence[_Spring], vectors: Sequence[tuple[Formula, Formula]]
) -> dict[int, Formula]:
    """What takes the places of the roots."""
    values = {}
    for spring in springs:
        one, other = vectors[spring.number], vectors[spring.image]
        inverse = inverse_length(*one)
        values[spring.inverse.variable] = (
            inverse if one is other else inverse * inverse_length(*other)
        )
        values[spring.share.variable] = 1 / (length(*one) + length(*other))
    return values


def opening(at: Coordinates, vectors: Sequence[tuple[Formula, Formula]]) -> UnfoldedEnergy:
    """The derivatives in some coordinates.

    Parameters
    ----------
    vectors : of the springs with a free length, by the variables.
    """
    springs = list(_springs(at))
    slope, ratios = _slopes(at, springs)

    def derivative(f: Formula, by: Formula) -> Formula:
        total = at.derivative(f, by)
        for spring in springs:
            for root, change in _roots(at, spring, by):
                total = total + at.graph.derivative(f, root.variable) * change
        return total

    others = [j for j in range(len(at.w)) if j != at.lead]
    g = [ratios[j] for j in others]
    values = {at.coordinate.variable: at.value} | at.nears() | _lengths(springs, vectors)

    def put(f: Formula, *by: Formula) -> Formula:
        return substituted(derivative(f, *by) if by else f, values)

    return UnfoldedEnergy(
        put(slope),
        tuple(map(put, g)),
        put(slope, at.coordinate),
        tuple(put(slope, e) for e in at.evens),
        tuple(tuple(put(f, e) for e in at.evens) for f in g),
        tuple(put(f, at.coordinate) for f in g),
        tuple(tuple(put(f, at.w[j]) for j in others) for f in g),
    )


def _springs(at: Coordinates) -> Iterator[_Spring]:
    """The springs, each together with its image."""
    problem, change = at.frame.problem, at.frame.change
    squares = at.frame.squares
    left = dict(enumerate(squares))
    number = at.coordinate.variable + len(at.w)
    while left:
        k = min(left)
        image, pull = image_of(left.pop(k), change), problem.cones[k].pull
        other = k
        if image != squares[k]:
            other = next(j for j, f in left.items() if f == image and problem.cones[j].pull == pull)
            del left[other]
        parts, weight = at.parts([(1, squares[k])]), expression_formula(at.graph, pull)
        product = parts.even if other == k else at.parts([(1, squares[k] * image)]).even
        inverse, share = at.graph.variable(number + 1), at.graph.variable(number + 2)
        number += 2
        yield _Spring(k, other, weight, squares[k], parts, product, inverse, share)


def _stretch(at: Coordinates, spring: _Spring, by: Formula) -> Formula:
    """The derivative of the length, or of the sum of both, whose square is twice the even part and
    their product.
    """
    slope = spring.inverse * at.derivative(spring.product, by) * _HALF
    if spring.image == spring.number:
        return slope
    return spring.share * (at.derivative(spring.parts.even, by) + slope)


def _roots(at: Coordinates, spring: _Spring, by: Formula) -> Iterator[tuple[Formula, Formula]]:
    """The variables that stand for roots, with their derivatives."""
    slope = spring.inverse * at.derivative(spring.product, by) * _HALF
    yield spring.inverse, -(spring.inverse.squared() * slope)
    if spring.image != spring.number:
        yield spring.share, -(spring.share.squared() * _stretch(at, spring, by))


def _share(at: Coordinates, spring: _Spring, odd: Sequence[tuple[int, int]]) -> Formula:
    """The derivative of the length, or of the sum of both, by an odd coordinate, over r."""
    slope = at.parts([(s, spring.square.derivative(k)) for k, s in odd])
    if spring.image == spring.number:
        return spring.inverse * slope.odd * _HALF
    # 1/l = (l' + l - r M/(l + l'))/(2 l l'), with the squares N + r M and N - r M
    tilt = spring.share * spring.parts.odd
    return spring.inverse * (slope.odd * (_HALF / spring.share) - slope.even * tilt)
