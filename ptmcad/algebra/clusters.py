"""Complex roots of polynomials whose coefficients are known as balls, in disjoint discs with their
numbers.

Guarantee: every polynomial with coefficients in the balls has, counted with multiplicity, exactly
the stated number of roots in each disc, and no others. Pellet's test proves it: where |c_k| r^k is
more than the sum of all other |c_j| r^j, the polynomial of coefficients c has k roots of modulus
less than r (Pellet 1881, by Rouche's theorem).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any, NamedTuple

from flint import acb, acb_poly, arb, arb_poly, ctx, fmpq, fmpq_poly

from ptmcad.algebra.polynomials import UnivariatePolynomial
from ptmcad.algebra.reflections import axis_of, squared

_RADII = 8
"""Numbers of radii that are tried, the least first, in geometric progression."""


class RootDisc(NamedTuple):
    """An open disc.

    Attributes
    ----------
    center : a real number, or one further from the real axis than the radius.
    number : of the roots inside, with multiplicity.
    """

    center: acb
    radius: arb
    number: int

    @property
    def is_real(self) -> bool:
        """Whether the disc meets the real axis, and then lies symmetrically to it."""
        return bool(self.center.imag == 0)

    def meets(self, other: RootDisc) -> bool:
        """False where the closed discs are certainly disjoint."""
        return not abs(self.center - other.center) > self.radius + other.radius

    @property
    def extent(self) -> tuple[fmpq, fmpq]:
        """Rational numbers below and above the real disc."""
        low, high = self.center.real - self.radius, self.center.real + self.radius
        return low.lower().fmpq(), high.upper().fmpq()


def clusters_over(rows: Sequence[UnivariatePolynomial], abscissa: arb) -> list[RootDisc] | None:
    """The clusters of a polynomial in v with coefficients in Z[u], for u in a ball."""
    coefficients, axis = [arb_poly(row)(abscissa) for row in rows], axis_of(rows)
    if axis is None:
        return clusters(coefficients)
    # p is q((d (v - m))^2), of half the degree; the roots are starts only, so m may be that of the
    # ball's middle
    middle, d = abscissa.mid().fmpq(), axis.denom()
    squares = _approximate([arb_poly(row)(abscissa) for row in squared(rows, axis)])
    steps = [((square.sqrt() / d).mid(), m) for square, m in squares]
    return clusters(
        coefficients, [((acb(axis(middle)) + w).mid(), m) for s, m in steps for w in (s, -s)]
    )


def clusters(
    coefficients: Sequence[arb], starts: Sequence[tuple[acb, int]] | None = None
) -> list[RootDisc] | None:
    """Disjoint discs that hold all roots; None where the balls are too large to tell.

    Roots so near to each other that the balls do not part them are in one disc.

    Parameters
    ----------
    starts : all roots about where they are, with multiplicities; they are computed where they are
        not given. Nothing that is proved depends on them.
    """
    if len(coefficients) < 2 or coefficients[-1].contains(0):
        return None
    polynomial = acb_poly(list(coefficients))
    waiting: list[_Group] = [
        (root,) * m for root, m in (_approximate(coefficients) if starts is None else starts)
    ]
    found: list[tuple[_Group, RootDisc]] = []
    while waiting:
        group = waiting.pop()
        others = [*waiting, *(g for g, _ in found)]
        cluster = _cluster(polynomial, group, others)
        if cluster is not None:
            found.append((group, cluster))
            continue
        if not others:
            return None
        joined = min(others, key=lambda g: _gap(group, g).mid().fmpq())
        waiting = [g for g in waiting if g is not joined] + [group + joined]
        found = [(g, c) for g, c in found if g is not joined]
    discs = [c for _, c in found]
    if any(c.meets(d) for c, d in combinations(discs, 2)) or not all(map(_is_settled, discs)):
        return None
    return discs


def _approximate(coefficients: Sequence[arb]) -> list[tuple[acb, int]]:
    """The roots of the polynomial in the middle of the balls, with their multiplicities."""
    middle = fmpq_poly([c.mid().fmpq() for c in coefficients])
    roots: Any = middle.numer().complex_roots()  # pairs; FLINT's stub says otherwise
    return [(root.mid(), m) for root, m in roots]


_Group = tuple[acb, ...]
"""Approximate roots, as often as they count."""


def _gap(one: _Group, other: _Group) -> arb:
    """Nearly the least distance of roots of two groups."""
    return min((abs(z - w) for z in one for w in other), key=lambda d: d.mid().fmpq())


def _is_settled(c: RootDisc) -> bool:
    """Whether the disc is known to meet the real axis, or known not to."""
    return c.is_real or bool(abs(c.center.imag) > c.radius)


def _cluster(polynomial: acb_poly, group: _Group, others: Sequence[_Group]) -> RootDisc | None:
    """A disc about the group's roots that passes Pellet's test, or None."""
    center = (sum(group, acb(0)) / len(group)).mid()
    spread = _gap((center,), group) if len(group) == 1 else max(
        (abs(z - center) for z in group), key=lambda d: d.mid().fmpq()
    )  # fmt: skip
    if not abs(center.imag) > spread:
        center = acb(center.real)
    # a single root, or all roots in one group, may have any small disc
    free = min((_gap((center,), g) for g in others), default=arb(1), key=lambda d: d.mid().fmpq())
    sizes = [abs(c) for c in polynomial(acb_poly([center, 1])).coeffs()]
    greatest = free / 4
    least = max(2 * spread, free / 2 ** (ctx.prec // 4), key=lambda d: d.mid().fmpq())
    if not greatest > least:
        return None
    for k in range(_RADII):
        radius = (least * (greatest / least) ** fmpq(k, _RADII - 1)).mid()
        terms = [size * radius**j for j, size in enumerate(sizes)]
        inside = terms.pop(len(group))
        if inside > sum(terms, arb(0)):
            return RootDisc(center, radius, len(group))
    return None
