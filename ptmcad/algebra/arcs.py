"""Branches of a plane curve between parabolic arcs: proved enclosures of their integrals where
branches nearly meet.

Guarantee: an enclosure that is returned contains the integral of the branch that was asked for;
None means not proved.

Over a panel without turning points a branch is a continuous graph. If it runs between z - d and
z + d at one place of the panel, and the curve meets neither of these two arcs over the panel, then
it runs between them everywhere. Nothing is asked of the other branches: many may lie in the same
tube, at any distance from each other, where a Taylor series of one of them would need hundreds of
bits to distinguish them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from flint import arb, fmpq, fmpq_poly, fmpz_poly

from ptmcad.algebra.real_roots import Interval, RealRoot, has_root_between, refine

NODES = (fmpq(-7, 8), fmpq(0), fmpq(7, 8))
"""Where the arc meets the branch, on the panel as [-1, 1]."""
PROBE = fmpq(-1, 2)
"""Where its distance from the branch is measured, which shows how wide the tube has to be about."""
BITS = 7
"""The branch is isolated this much finer than the height is wanted."""
TUBES = (2, 8, 64)
"""Widths of the tubes that are tried, in units of that distance."""


def arc_integral(
    in_v: Sequence[fmpz_poly],
    branch: Callable[[fmpq], RealRoot],
    middle: fmpq,
    radius: fmpq,
    fibre: Interval,
    wanted: fmpq,
) -> arb | None:
    """An enclosure of the integral of a branch over a panel.

    Parameters
    ----------
    in_v : coefficients in Z[u] of p as a polynomial in v.
    branch : the branch's value at a rational abscissa, isolated.
    middle, radius : of the panel, over whose interior no branches of the curve meet.
    wanted : half the width of a tube that would do; positive.

    Returns
    -------
    The enclosure, or None when no tube of those tried was proved.
    """
    unit = fmpq(2) ** (
        int(wanted.p).bit_length() - int(wanted.q).bit_length() - BITS
    )  # short, as all starts from it
    left, here, right = (_rounded(branch(middle + radius * x), unit) for x in NODES)
    slope = (right - left) / (NODES[2] - NODES[0])
    curvature = (left + right - 2 * here) / (2 * NODES[2] ** 2)
    arc = fmpq_poly([here, slope, curvature])
    miss = abs(_rounded(branch(middle + radius * PROBE), unit) - arc(PROBE)) + unit
    along = fmpq_poly([middle, radius])
    rows = [fmpq_poly(c)(along) for c in in_v]
    for tube in TUBES:
        distance = tube * miss
        if distance * 16 > fibre[1] - fibre[0]:
            return None
        if not any(
            has_root_between(on_graph(rows, arc + end), fmpq(-1), fmpq(1))
            for end in (-distance, distance)
        ):
            mean = here + curvature / 3
            return (arb(mean) + arb(distance) * arb(0, 1)) * arb(2 * radius)
    return None


def _rounded(root: RealRoot, unit: fmpq) -> fmpq:
    """A multiple of the unit within two units of the root."""
    return unit * (refine(root, unit).middle / unit).floor()


def on_graph(rows: Sequence[fmpz_poly | fmpq_poly], graph: fmpq_poly) -> fmpz_poly:
    """A positive multiple of p(u, graph(u)); zero where the graph is a part of the curve.

    Parameters
    ----------
    rows : coefficients of p as a polynomial in v.
    """
    total = fmpq_poly([0])
    for row in reversed(rows):
        total = total * graph + row
    return total.numer()


def graph_integral(in_v: Sequence[fmpz_poly], low: fmpq, high: fmpq) -> fmpq | None:
    """The integral of v over [low, high] on the curve p(u, v) = 0; None where it is not the graph
    of a polynomial in u.

    Parameters
    ----------
    in_v : coefficients in Z[u] of p as a polynomial in v.
    """
    if len(in_v) != 2 or in_v[1].degree() > 0:
        return None
    whole = fmpq_poly(-in_v[0]).integral()
    return (whole(high) - whole(low)) / fmpq(in_v[1][0])
