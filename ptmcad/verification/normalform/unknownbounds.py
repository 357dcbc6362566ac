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
the same is tried for g. The second engine evaluates by Horner's rule on unbounded intervals.

Lengths that springs hold together are bounded by diagonal dominance. Let equations be A s + b = sum
of K_c (u_c . w_ci), with unit vectors u_c. For any matrix V let M = V A and Q be upper bounds of
|I - M|, g positive upper bounds of |V b| + sum of K_c |sum_j V_ij w_cj|. As s = V (A s) +
(I - M) s,

    |s| <= g + Q |s|,  so that with  t = max |s_i|/g_i  and  q = max (Q g)_i/g_i  is  t <= 1 + q t,

and |s_i| <= g_i/(1 - q) if q < 1: M, with columns times g_j, has a dominant diagonal then
(Gershgorin). V is about the inverse of A's middle, as balls without a radius have it; that it is
any matrix is enough. The second engine solves by Cramer's rule, exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product
from math import comb, inf, nextafter
from typing import NamedTuple

from flint import arb, arb_mat

from ptmcad.verification.coordinates import ball, power
from ptmcad.verification.normalform.boxes import Unproved, size
from ptmcad.verification.normalform.waves import Form, Key, Waves

HALF_TURN = 101 / 32
"""A little more than pi, so that a range of this half width around 0 has the whole circle."""
POWERS = range(-10, 41)
"""Powers of two that are tried as bounds."""
FINE_POWERS = (4, 10, 20, 40)
"""... and those that are tried with angles in parts, where none will do for all angles at once."""
MAX_PARTS = 400
MAX_WEIGHT = 3
MAX_SHARE = 0.5
"""Of q: a wider box of what A depends on is halved, as bounds grow like 1/(1 - q)."""
_MIN_SIZE = 2.0**-60

_Balls = Sequence[arb]
Row = Mapping[Key, arb]
"""A polynomial by its waves."""
Monomials = dict[tuple[int, ...], arb]
"""By the powers of what is not bounded."""
_Linear = tuple[Sequence[_Balls], _Balls, Sequence[tuple[arb, _Balls, _Balls]]]
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
        one, two = (
            replace(self, factors=(*self.factors[:widest], half, *self.factors[widest + 1 :]))
            for half in (x.lower().union(x.mid()), arb(x.mid()).union(x.upper()))
        )
        return one, two


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

    def ways(self, waiting: Sequence[int]) -> Iterator[dict[int, float] | None]:
        """Bounds of one unknown, whatever others without one are; of some that bound one another;
        of some that springs hold; None where there are none.
        """
        for k in waiting:
            yield self._bounded({k: 1}, POWERS)
        several = [c for n in range(2, len(waiting) + 1) for c in combinations(waiting, n)]
        for chosen in several if self.has_polynomials else ():
            for weights in sorted(
                product(range(1, MAX_WEIGHT + 1), repeat=len(chosen)),
                key=lambda w: (max(w), sum(w)),
            ):
                yield self._bounded(dict(zip(chosen, weights, strict=True)), ())
        yield from map(self.held, several)

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

    def _bounded(
        self, weights: Mapping[int, int], powers: Sequence[int]
    ) -> dict[int, float] | None:
        """The unknowns' bounds that follow from the least power of two that bounds the number whose
        powers they are.
        """
        charts = list(self._faces(weights))

        def holds(exponent: int, parts: int) -> bool:
            return all(self._is_empty(chart, arb(2) ** exponent, parts) for chart in charts)

        for parts, exponents in ((1, powers), (MAX_PARTS, FINE_POWERS)):
            # what does not hold far away holds nowhere
            if exponents and holds(exponents[-1], parts):
                least = next(e for e in exponents if e == exponents[-1] or holds(e, parts))
                return {k: 2.0 ** (least * weight) for k, weight in weights.items()}
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
    bounds = _Bounds(form, values)
    found = bounds.found
    while waiting := [k for k, half in enumerate(found) if half is None]:
        # those that are known serve to bound the others
        new = next(filter(None, bounds.ways(waiting)), None)
        if new is None:
            raise Unproved(f"no bound of the unknown {form.unknowns[waiting[0]]} could be proved")
        for k, half in new.items():
            found[k] = half
    return tuple(half for half in found if half is not None)


def bounds_of(
    matrix: Sequence[_Balls], rest: _Balls, springs: Sequence[tuple[arb, _Balls, _Balls]]
) -> list[arb] | None:
    """Of each length, exact numbers; None where no dominant diagonal is found.

    Parameters
    ----------
    matrix, rest : A, row by row, and b.
    springs : for each K, and the coordinates of the vector w_ci for each equation.
    """
    n = range(len(rest))
    try:
        inverse = arb_mat([[arb(a.mid()) for a in row] for row in matrix]).inv()
    except ZeroDivisionError:
        return None
    guess = [[arb(inverse[i, j].mid()) for j in n] for i in n]
    columns = list(zip(*matrix, strict=True))
    reach = [_reach(row, rest, springs) for row in guess]
    off = [[(int(i == j) - _dot(guess[i], columns[j])).abs_upper() for j in n] for i in n]
    shares = [_dot(off[i], reach).abs_upper() / reach[i] for i in n]
    if not all(share < MAX_SHARE for share in shares):
        return None
    most = max(share.abs_upper() for share in shares)
    return [(r / (1 - most)).abs_upper() for r in reach]


def _reach(factors: _Balls, rest: _Balls, springs: Sequence[tuple[arb, _Balls, _Balls]]) -> arb:
    """A positive upper bound of the rest and the springs' parts, where the equations are summed up
    with factors.
    """
    total = abs(_dot(factors, rest)) + _MIN_SIZE
    for pull, across, up in springs:
        total = total + pull * size(_dot(factors, across), _dot(factors, up))
    return total.abs_upper()


def _dot(a: _Balls, b: _Balls) -> arb:
    return sum((x * y for x, y in zip(a, b, strict=True)), arb(0))
