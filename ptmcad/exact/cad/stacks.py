"""Stacks of the open decomposition: over each open interval of the base, the curves' branches in
order.

Guarantee: over the whole interval of a stack the walls are disjoint graphs of continuous (indeed
analytic) functions, in the order given, and every part of a curve in the window over it is one of
them.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.polynomials import UnivariatePolynomial
from ptmcad.algebra.real_roots import (
    Interval,
    RealRoot,
    gaps,
    inside,
    isolate,
    numbered_disjoint,
    sign_at,
)
from ptmcad.answer.regionmap import Wall
from ptmcad.exact.cad.projection import FibredCurve
from ptmcad.text.flint_numbers import simplest_between


class BaseEnd(NamedTuple):
    """An end of a stack: the window's edge or a critical abscissa.

    Attributes
    ----------
    root : where it is; rational at the edge.
    critical : the abscissa's number; None at the window's edge.
    """

    root: RealRoot
    critical: int | None


class StackData(NamedTuple):
    """A stack with its rational sample abscissa and the rational sample heights of its cells, from
    below.
    """

    left: BaseEnd
    right: BaseEnd
    sample: fmpq
    walls: tuple[Wall, ...]
    heights: tuple[fmpq, ...]


def roots_over(
    curves: Sequence[FibredCurve], u: fmpq, fibre: Interval
) -> tuple[tuple[Wall, RealRoot], ...]:
    """All roots of the curves in the open fibre interval over a rational abscissa that is not
    critical, in order.

    The isolating intervals are pairwise disjoint, ends included.
    """
    found = [
        (Wall(c.component, k), root)
        for c in curves
        for k, root in enumerate(c.roots_over(u, fibre))
    ]
    ordered = numbered_disjoint([root for _, root in found])
    return tuple((found[number][0], root) for number, root in ordered)


def lift(
    curves: Sequence[FibredCurve],
    abscissae: Sequence[RealRoot],
    base: Interval,
    fibre: Interval,
    avoided: Sequence[FibredCurve] = (),
    lines: Sequence[UnivariatePolynomial] = (),
) -> tuple[StackData, ...]:
    """The stacks over the open intervals between consecutive critical abscissae.

    Parameters
    ----------
    avoided, lines : curves, and lines by their polynomials in u, that are no walls but on which no
        sample may lie.
    """
    edges = [BaseEnd(RealRoot.of(edge), None) for edge in base]
    ends = [edges[0], *(BaseEnd(r, k) for k, r in enumerate(abscissae)), edges[1]]
    stacks = []
    for left, right in pairwise(ends):
        sample = _simplest_off(left.root.high, right.root.low, lines)
        roots = roots_over(curves, sample, fibre)
        heights = heights_between(
            [r for _, r in roots], fibre, [c.polynomial_over(sample) for c in avoided]
        )
        stacks.append(StackData(left, right, sample, tuple(w for w, _ in roots), heights))
    return tuple(stacks)


def heights_between(
    roots: Sequence[RealRoot], fibre: Interval, avoided: Sequence[UnivariatePolynomial] = ()
) -> tuple[fmpq, ...]:
    """Simple rational heights below, between and above the given roots, within the fibre interval.

    None is a root of the polynomials to be avoided.
    """
    return tuple(_simplest_off(*gap, avoided) for gap in gaps(inside(roots, fibre), fibre))


def _simplest_off(low: fmpq, high: fmpq, avoided: Sequence[UnivariatePolynomial]) -> fmpq:
    """A simple rational strictly between low and high at which none of the polynomials vanishes."""
    value = simplest_between(low, high)
    while any(sign_at(p, value) == 0 for p in avoided):  # as often as they have roots at most
        value = simplest_between(value, high)
    return value


def level_at(curves: Sequence[FibredCurve], u: fmpq, v: fmpq, fibre: Interval) -> int:
    """The number of walls below a point, over an abscissa that is not critical."""
    return sum(len(isolate(c.polynomial_over(u), fibre[0], v)) for c in curves)
