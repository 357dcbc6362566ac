"""Bounds of the real unknowns at given parameters, beyond which a model has no solution that
counts.

Guarantee: for all parameters in the balls no solution at which no inequality is violated has a real
unknown beyond its bound.

What is zero at solutions is a polynomial in the unknown h, and in those of which no bound is known
yet. Put a number that is not negative for each of these, and R and such a number for h: if all
coefficients have one sign, and the constant one is not zero, there is no solution from R on. All
signs of unknowns are tried. Coefficients are balls over all angles and all other real unknowns as
far as they are bounded; the part of a spring with a free length is at most its pull times the
slope, of either sign. Where unknowns bound one another, x_j = t_j g^w_j with |t_j| at most 1, and
the same is tried for g; where springs hold several, `ptmcad.verification.normalform.held` is. The
second engine evaluates by Horner's rule on unbounded intervals.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from math import comb, inf, nextafter
from typing import NamedTuple

from flint import arb

from ptmcad.verification.coordinates import ball, power
from ptmcad.verification.normalform.boxes import Unproved, size
from ptmcad.verification.normalform.held import bounds_of
from ptmcad.verification.normalform.waves import Form, Key, Waves

HALF_TURN = 101 / 32
"""A little more than pi, so that a range of this half width around 0 has the whole circle."""
POWERS = range(-10, 41)
"""Powers of two that are tried as bounds."""
FINE_POWERS = (4, 10, 20, 40)
"""... and those that are tried with angles in parts, where none will do for all angles at once."""
MAX_PARTS = 400
MAX_WEIGHT = 3

Row = Mapping[Key, arb]
"""A polynomial by its waves."""
Monomials = dict[tuple[int, ...], arb]
"""By the powers of what is not bounded."""
_Linear = tuple[list[list[arb]], list[arb], list[tuple[arb, list[arb], list[arb]]]]
"""Equations A s + b less the parts of springs, as `bounds_of` has them."""
_ZERO, _ANY = arb(0), arb(0, 1)


@dataclass(frozen=True, slots=True)
class _RangeChart:
    """Each unknown as a factor times a power of a number that is not negative and not bounded, or a
    factor alone.

    Attributes
    ----------
    variables : which number that is; None for a factor alone.
    lead : the number that is large.
    """

    factors: tuple[arb, ...]
    variables: tuple[int | None, ...]
    weights: tuple[int, ...]
    lead: int

    def monomials(self, row: Row) -> Monomials:
        """A row as a polynomial in the numbers that are not bounded."""
        total: Monomials = {}
        for (turned, raised, sine), c in row.items():
            term, angle, powers = c, _ZERO, [0] * (len(self.factors) + 1)
            for j, (x, variable, weight) in enumerate(
                zip(self.factors, self.variables, self.weights, strict=True)
            ):
                if turned[j]:
                    angle = angle + turned[j] * x
                if raised[j]:
                    term = term * power(x, raised[j])
                    if variable is not None:
                        powers[variable] += weight * raised[j]
            if any(turned):
                term = term * (angle.sin() if sine else angle.cos())
            total[*powers] = total.get((*powers,), _ZERO) + term
        return total

    def is_all(self, holds: Callable[[_RangeChart], bool], parts: int) -> bool:
        """Whether something holds in all parts of the chart, which is halved into so many at most."""
        waiting, treated = [self], 0
        while waiting:
            part = waiting.pop()
            treated += 1
            if holds(part):
                continue
            halves = None if treated + len(waiting) >= parts else part.halves(self)
            if halves is None:
                return False
            waiting += halves
        return True

    def halves(self, whole: _RangeChart) -> tuple[_RangeChart, _RangeChart] | None:
        """Two charts, halved in the factor that is largest as a share of the whole one's; None
        where there is none.
        """
        shares = {
            j: float((x.rad() / y.rad()).mid())
            for j, (x, y) in enumerate(zip(self.factors, whole.factors, strict=True))
            if y.rad() > 0
        }
        if not shares:
            return None
        widest = max(shares, key=lambda j: shares[j])
        x = self.factors[widest]
        one, two = x.lower().union(x.mid()), arb(x.mid()).union(x.upper())
        return self._with(widest, one), self._with(widest, two)

    def _with(self, k: int, x: arb) -> _RangeChart:
        return _RangeChart(
            (*self.factors[:k], x, *self.factors[k + 1 :]), self.variables, self.weights, self.lead
        )


class _Equation(NamedTuple):
    """An equation with balls for its coefficients, and the slopes of the springs by its unknown."""

    smooth: Row
    cones: Sequence[tuple[arb, Row, Row]] = ()

    def monomials(self, chart: _RangeChart) -> Monomials:
        """All of it; the springs' parts have either sign."""
        total = chart.monomials(self.smooth)
        for pull, right, above in self.cones:
            across, up = chart.monomials(right), chart.monomials(above)
            for powers in across.keys() | up.keys():
                reach = pull * size(across.get(powers, _ZERO), up.get(powers, _ZERO))
                total[powers] = total.get(powers, _ZERO) + reach * _ANY
        return total


class _Bounds:
    """What is known of the solutions: what is zero, what is positive, and the unknowns' bounds so
    far.
    """

    def __init__(self, form: Form, values: Mapping[str, arb]):
        def row(waves: Waves) -> Row:
            return {key: ball(terms, values) for key, terms in waves.items()}

        rows = [row(waves) for waves in form.equations]
        springs = [
            [(ball(c.pull, values), row(c.weights[k][0]), row(c.weights[k][1])) for c in form.cones]
            for k in range(form.size)
        ]
        self.equations = list(map(_Equation, rows, springs))
        if form.rigid:
            self.equations += [_Equation(row(waves)) for waves in form.multiples]
        self.has_polynomials = bool(form.rigid)
        self.inequalities = [row(waves) for waves in form.inequalities]
        unit = [
            (((0,) * form.size, tuple(int(j == k) for j in range(form.size)), 0), k)
            for k in range(form.size)
        ]
        self.positive = {
            k for key, k in unit for f in self.inequalities if f.keys() == {key} and f[key] > 0
        }
        self.found: list[float | None] = [
            HALF_TURN if circle else None for circle in form.is_circle
        ]

    def _factor(self, k: int) -> arb:
        """A ball for a bounded unknown."""
        half = self.found[k]
        assert half is not None
        return arb(half / 2, half / 2) if k in self.positive else arb(0, half)

    def _signs(self, k: int) -> tuple[int, ...]:
        return (1,) if k in self.positive else (1, -1)

    def alone(self, k: int) -> float | None:
        """A bound of one unknown, whatever those without one are."""
        return self._bound(list(self._faces({k: 1})), POWERS)

    def together(self, chosen: Sequence[int]) -> dict[int, float] | None:
        """Bounds of some unknowns that bound one another."""
        if not self.has_polynomials:
            return None
        for weights in sorted(
            product(range(1, MAX_WEIGHT + 1), repeat=len(chosen)), key=lambda w: (max(w), sum(w))
        ):
            of = dict(zip(chosen, weights, strict=True))
            bound = self._bound(list(self._faces(of)), ())
            if bound is not None:
                return {k: bound**w for k, w in of.items()}
        return None

    def held(self, chosen: Sequence[int]) -> dict[int, float] | None:
        """Bounds of some unknowns in which their equations are linear, but for the directions of
        springs.
        """
        factors = tuple(
            arb(1) if half is None else self._factor(k) for k, half in enumerate(self.found)
        )
        variables = tuple(k if half is None else None for k, half in enumerate(self.found))
        whole = _RangeChart(factors, variables, (1,) * len(factors), 0)
        if self._linear(whole, chosen) is None:
            return None
        found: list[list[arb]] = []

        def is_bounded(part: _RangeChart) -> bool:
            linear = self._linear(part, chosen)
            bounds = None if linear is None else bounds_of(*linear)
            found.extend([] if bounds is None else [bounds])
            return bounds is not None

        if not whole.is_all(is_bounded, MAX_PARTS):
            return None
        return {
            k: nextafter(float(max(some)), inf) for k, *some in zip(chosen, *found, strict=True)
        }

    def _linear(self, chart: _RangeChart, chosen: Sequence[int]) -> _Linear | None:
        """The equations of some unknowns; None where other unknowns without a bound, or squares of
        these, are in.
        """
        none = (0,) * (len(chart.factors) + 1)
        units = [tuple(int(j == k) for j in range(len(none))) for k in chosen]
        matrix, rest, parts = [], [], []
        for equation in (self.equations[k] for k in chosen):
            terms = chart.monomials(equation.smooth)
            slopes = [
                (chart.monomials(across), chart.monomials(up)) for _, across, up in equation.cones
            ]
            if not _present(terms) <= {none, *units} or any(
                not _present(f) <= {none} for pair in slopes for f in pair
            ):
                return None
            matrix.append([terms.get(unit, _ZERO) for unit in units])
            rest.append(terms.get(none, _ZERO))
            parts.append([(across.get(none, _ZERO), up.get(none, _ZERO)) for across, up in slopes])
        springs = [
            (pull, [vectors[c][0] for vectors in parts], [vectors[c][1] for vectors in parts])
            for c, (pull, _, _) in enumerate(self.equations[chosen[0]].cones)
        ]
        return matrix, rest, springs

    def _faces(self, weights: Mapping[int, int]) -> Iterator[_RangeChart]:
        lead, everything = len(self.found), range(len(self.found))
        free = [j for j, half in enumerate(self.found) if half is None and j not in weights]
        for largest in weights:
            for side, *signs in product(self._signs(largest), *map(self._signs, free)):
                of = dict(zip(free, signs, strict=True))
                shares = {j: arb(0.5, 0.5) if j in self.positive else _ANY for j in weights} | {
                    largest: arb(side)
                }
                yield _RangeChart(
                    tuple(
                        shares[j] if j in shares else arb(of[j]) if j in of else self._factor(j)
                        for j in everything
                    ),
                    tuple(lead if j in shares else j if j in of else None for j in everything),
                    tuple(weights.get(j, 1) for j in everything),
                    lead,
                )

    def _bound(self, charts: Sequence[_RangeChart], powers: Sequence[int]) -> float | None:
        """The least power of two that is a bound in all charts."""

        def holds(exponent: int, parts: int) -> bool:
            return all(self._is_empty(chart, arb(2) ** exponent, parts) for chart in charts)

        for parts, exponents in ((1, powers), (MAX_PARTS, FINE_POWERS)):
            # what does not hold far away holds nowhere
            if exponents and holds(exponents[-1], parts):
                return float(
                    2.0 ** next(e for e in exponents if e == exponents[-1] or holds(e, parts))
                )
        return None

    def _is_empty(self, chart: _RangeChart, bound: arb, parts: int) -> bool:
        """Whether no solution has the leading number at the bound or beyond."""

        def has_none(part: _RangeChart) -> bool:
            return any(
                _is_positive(part.monomials(f), part.lead, bound, -1) for f in self.inequalities
            ) or any(
                _is_positive(terms, part.lead, bound, sign)
                for terms in (e.monomials(part) for e in self.equations)
                for sign in (1, -1)
            )

        return chart.is_all(has_none, parts)


def _present(terms: Monomials) -> set[tuple[int, ...]]:
    """The powers of terms that are not exactly zero."""
    return {powers for powers, c in terms.items() if not (c == 0)}  # noqa: SIM201 (a ball that is not exactly zero)


def _is_positive(terms: Monomials, lead: int, bound: arb, sign: int) -> bool:
    """Whether a polynomial times a sign is positive where the leading number is at least the bound."""
    shifted: Monomials = {}
    for powers, c in terms.items():
        i = powers[lead]
        for j in range(i + 1):
            lower = (*powers[:lead], j, *powers[lead + 1 :])
            shifted[lower] = shifted.get(lower, _ZERO) + sign * c * comb(i, j) * bound ** (i - j)
    return all(c >= 0 if any(powers) else c > 0 for powers, c in shifted.items()) and not all(
        map(any, shifted)
    )


def half_widths(form: Form, values: Mapping[str, arb]) -> tuple[float, ...]:
    """For each unknown half the width of a range around 0 that has all solutions, or a whole turn.

    Raises
    ------
    Unproved
        With the unknown, when no bound of it could be proved.
    """
    if all(form.is_circle):
        return (HALF_TURN,) * form.size
    found = _all_bounds(_Bounds(form, values))
    if None not in found:
        return tuple(half for half in found if half is not None)
    raise Unproved(f"no bound of the unknown {form.unknowns[found.index(None)]} could be proved")


def _all_bounds(bounds: _Bounds) -> list[float | None]:
    """The bounds as far as they are found; those that are known serve to bound the others."""
    found = bounds.found
    while waiting := [k for k, half in enumerate(found) if half is None]:
        for k in waiting:
            found[k] = bounds.alone(k)
            if found[k] is not None:
                break
        else:
            several = [c for n in range(2, len(waiting) + 1) for c in combinations(waiting, n)]
            for way, chosen in product((bounds.together, bounds.held), several):
                both = way(chosen)
                if both is not None:
                    for k, half in both.items():
                        found[k] = half
                    break
            else:
                break
    return found
