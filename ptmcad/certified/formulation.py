"""Which formulas a slice is computed with: the paper's mechanism has its own, all others the plain ones.

Guarantee: both ways promise the same of their curves and counts. Only the time that a search takes differs.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Protocol

from ptmcad.certified.curve import Curve
from ptmcad.certified.plain import curves as plain_curves
from ptmcad.certified.plain.points import plain_counter
from ptmcad.certified.points import PointCount
from ptmcad.certified.ptm import curves as ptm_curves
from ptmcad.certified.ptm.points import point_counter as ptm_counter
from ptmcad.mechanism import ptm
from ptmcad.question.slice import Count, Slice


class Counter(Protocol):
    """Counts at points of one slice."""

    def at(self, x: Fraction, y: Fraction, count: Count, *, thorough: bool = True) -> PointCount:
        """What ``count`` needs at the point (x, y) of the two axes."""
        ...


def is_refined(slice: Slice) -> bool:
    """Whether the slice's model has formulas of its own."""
    return slice.model == ptm()


def curves(slice: Slice, count: Count, without: frozenset[str] = frozenset()) -> tuple[Curve, ...]:
    """The curves at which ``count`` may change.

    Parameters
    ----------
    without : names of savings to switch off, of `ptmcad.question.savings`.

    Raises
    ------
    ConfigError, GeometryError
        Where the plain formulas do not take the slice: see `ptmcad.certified.plain.problem.problem_of`.
    """
    if is_refined(slice):
        return ptm_curves.curves(slice, count, without)
    return plain_curves.curves(slice, count, without)


def point_counter(slice: Slice) -> Counter:
    """Write the solutions of a slice out, to count them at its points."""
    return ptm_counter(slice) if is_refined(slice) else plain_counter(slice)


def distance_from_degeneracy(slice: Slice, x: Fraction, y: Fraction) -> Fraction:
    """Small where the search takes long, which is best begun first; 0 where nothing is known of it."""
    return ptm_curves.distance_from_degeneracy(slice, x, y) if is_refined(slice) else Fraction(0)
