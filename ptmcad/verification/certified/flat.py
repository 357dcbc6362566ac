"""Samples at which the bars are in line where the spring between them has no length, and how their cells are decided.

The base is the bars' sum or their difference there. Along both bars turned together the spring's length begins with a
square, so its energy is no cone but flat; where the forces balance some direction of the spring, no test in the two
angles tells the place from an equilibrium, however small the box. That is so all along a line of the window, on which
simple samples lie, where there are no loads or F3 and F4 are equal or opposite.

Guarantee: the points `beside` are in the sample's cell and off such lines. A cell's counts hold at each of its points,
so those at another one decide them.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ptmcad.answer.regionmap import Cell
from ptmcad.verification.certified.structure import CertifiedClaims
from ptmcad.verification.certified.vectors import CROSSING, evaluated

_PLACES = ((3, 2), (-2, 3), (2, -1), (-1, -3))
"""Where points beside a sample are, in quarters of a square around it: on no line with it through two of them."""
_PARTS = 8
"""Of the window's width, half the width of the largest such square: what is nearly flat takes many boxes ..."""
_MIN_PARTS = 2**60
"""... and of the smallest one."""


def is_flat(values: Mapping[str, Fraction]) -> bool:
    """Whether the spring between the bars pulls, and has no length where the bars are in line with the base."""
    fixed, *arms = (evaluated(z, values) for z in CROSSING.vectors)
    base, (one, two) = abs(fixed), map(abs, arms)
    return evaluated(CROSSING.free, values) > 0 and base > 0 and base in (one + two, abs(one - two))


def beside(claims: CertifiedClaims, cell: Cell) -> list[tuple[Fraction, Fraction]]:
    """Points of a sample's cell that are not flat themselves, near the sample; none where the whole slice is flat."""
    return [at for at in near(claims, cell) if not is_flat(parameters_at(claims, *at))]


def near(claims: CertifiedClaims, cell: Cell) -> list[tuple[Fraction, Fraction]]:
    """Points of a sample's cell near the sample; none where it is very near to a rectangle of the cover."""
    u, v = claims.on_lattice(*cell.sample)
    half, least = Fraction(claims.sweep.steps, _PARTS), Fraction(claims.sweep.steps, _MIN_PARTS)
    while not claims.sweep.free_around(u, v, half):
        half /= 2
        if half < least:
            return []
    return [claims.off_lattice(u + half * i / 4, v + half * j / 4) for i, j in _PLACES]


def parameters_at(claims: CertifiedClaims, x: Fraction, y: Fraction) -> dict[str, Fraction]:
    """Every parameter at a point, free lengths that are not given being zero."""
    return {name: Fraction(0) for name in claims.model.free_lengths} | claims.parameters_at(x, y)
