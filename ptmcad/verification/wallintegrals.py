"""Branches of curves over panels: enclosures of their integrals.

A branch is a power series in a disk that is proved by `ptmcad.verification.disks`. With
coefficients of at most r / R^n there (Cauchy), what lies beyond the term of order N contributes at
most 2 h r (h/R)^N / ((N+1) (1 - (h/R)^2)) to the integral over a panel of half width h < R. Where R
is too small for the panel, its middle part is proved for which it is large enough. Where no R does,
the panel is halved.

Beside a turning point, a node or a cusp of the curve at (U, V) the branch is V + a s^k + s^j t,
with s^k the distance from U, and t a simple root of p(U +- s^k, V + a s^k + s^j t)/s^e (`_Meeting`;
e is j times the number of branches). This is a polynomial in s and t but for some terms with
negative powers of s, which are nothing at the point itself, and little where U, V and a are
approximations. For each real s from some sigma on they are numbers, times powers of t, that are at
most as large as at sigma. So what a disk proves of all polynomials with such numbers in their
place, whatever they are, holds of t at each such s. Where more branches meet, or in other ways, the
branch is in a disk about V on whose edge the curve has no point over the panel.

Guarantee: what is returned contains the integral of the branch that was asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from flint import arb, arb_poly, ctx, fmpq

from ptmcad.verification.claims import PlaneCurve
from ptmcad.verification.disks import BallsTooWide, Disk, disk, recentered, shifted, size
from ptmcad.verification.rootcounts import numbered_root


@dataclass(frozen=True)
class WallSeries:
    """A wall: the curve, the number of its root, and the curve's coefficients in Z[u] for balls."""

    curve: PlaneCurve
    root: int
    value: list[arb_poly]

    @classmethod
    def of(cls, curve: PlaneCurve, root: int) -> WallSeries:
        return cls(curve, root, [arb_poly(c) for c in curve.in_v])

    def height(self, u: fmpq, low: fmpq, high: fmpq) -> arb | None:
        """The branch over u; None when there are not so many roots between the heights."""
        return numbered_root(self.curve.over(u), low, high, self.root)


@dataclass(frozen=True)
class IntegralEffort:
    """What one attempt spends.

    Attributes
    ----------
    share : error that a panel may have.
    narrowest : panels narrower than this are not halved at this precision.
    heights : the window's edges.
    points : approximations of the critical values, or the window's edges, at the ends of the
        branch's stack.
    """

    share: arb
    narrowest: fmpq
    heights: tuple[fmpq, fmpq]
    points: tuple[fmpq, fmpq]


class PanelPart(NamedTuple):
    """A part of a panel with the branch's integral over it, from the window's lower edge.

    Attributes
    ----------
    tried : whether this part has been the whole of what was tried; else it is what was left of
        something longer, and its integral is known by two heights only.
    run : of what was left how often, one time after the other, it was left at the same end:
        negative at the left one.
    """

    left: fmpq
    right: fmpq
    integral: arb
    tried: bool
    run: int = 0


def integrals_over(
    branch: WallSeries, left: fmpq, right: fmpq, effort: IntegralEffort, run: int = 0
) -> list[PanelPart]:
    """The integral of the branch over a panel, in parts: the best enclosures at hand.

    Parameters
    ----------
    run : as `PanelPart` has it. Where a branch was not proved at an end it is likely to meet
        another one there, so this is tried twice.

    Raises
    ------
    BallsTooWide
    """
    if run and abs(run) <= 2:
        meeting = _beside(
            branch, effort.points[run > 0], (left, right) if run < 0 else (right, left), effort
        )
        if meeting is not None:
            return meeting
    low, high = effort.heights
    middle, half = (left + right) / 2, (right - left) / 2
    height = branch.height(middle, low, high)
    found = None if height is None else _more_precisely(branch, middle, half, height, effort)
    if found is None:
        return _known_by_edges(left, right, effort, tried=True)
    integral, proved = found
    return [
        PanelPart(middle - proved, middle + proved, integral - low * (2 * proved), True),
        *_known_by_edges(left, middle - proved, effort, min(run, 0) - 1),
        *_known_by_edges(middle + proved, right, effort, max(run, 0) + 1),
    ]


def _more_precisely(
    branch: WallSeries, middle: fmpq, half: fmpq, height: arb, effort: IntegralEffort
) -> tuple[arb, fmpq] | None:
    """`_by_series` at the working precision, or at more, which few panels ask for.

    Raises
    ------
    BallsTooWide
    """
    bits = ctx.prec
    for times in (1, 2, 4):
        with ctx.workprec(times * bits):
            finer = height if times == 1 else branch.height(middle, *effort.heights)
            assert finer is not None  # there is a root, as there was with fewer bits
            try:
                return _by_series(branch, middle, half, finer, effort)
            except BallsTooWide:
                continue
    raise BallsTooWide


def _known_by_edges(
    one: fmpq, other: fmpq, effort: IntegralEffort, run: int = 0, *, tried: bool = False
) -> list[PanelPart]:
    """What is between two places, if anything is: nothing is known but that it lies in the window."""
    if one == other:
        return []
    left, right, (low, high) = min(one, other), max(one, other), effort.heights
    return [PanelPart(left, right, arb(0).union(arb(high - low)) * (right - left), tried, run)]


_DEGREES = (2, 10)
"""Of the polynomials that a branch is compared with: the closer the next branch, the better it has
to be.
"""
_POOR = 4
"""The higher degree is worth its cost where a smaller share of a panel is proved than the inverse of
this, as beside a point that limits each disk, or none.
"""


def _by_series(
    branch: WallSeries, middle: fmpq, half: fmpq, height: arb, effort: IntegralEffort
) -> tuple[arb, fmpq] | None:
    """The integral of the branch over a panel's middle part, by its power series, and half that
    part's width.

    None when no disk of convergence is proved.

    Raises
    ------
    BallsTooWide
    """
    best: tuple[arb, fmpq] | None = None
    shifted = [c(arb_poly([middle, 1])) for c in branch.value]
    for degree in _DEGREES:
        if best is not None and best[1] * _POOR >= half:
            break
        found = _along(shifted, half, height, degree, effort)
        if found is not None and (best is None or found[1] > best[1]):
            best = found
    return best


def _along(
    rows: Sequence[arb_poly], half: fmpq, height: arb, degree: int, effort: IntegralEffort
) -> tuple[arb, fmpq] | None:
    """As `_by_series`, of the polynomial with these coefficients of the powers of v."""
    found = disk(rows, half, height, degree)
    if found is None:
        return None
    coefficients, tail = _terms(found, effort.share)
    total, power = arb(0), arb(found.proved)
    for k in range(0, len(coefficients), 2):
        total += coefficients[k] * power * fmpq(2, k + 1)
        power = power * found.proved * found.proved
    if (
        total.rad() > effort.share
        and total.rad() * 2**_ROUNDED_BITS > arb(found.proved) * found.reach
    ):
        raise BallsTooWide  # the disk alone says nearly as much as the series
    return total + arb(0).union(2 * tail) - tail, found.proved


def _terms(found: Disk, share: arb) -> tuple[list[arb], arb]:
    """A disk's power series to an order at which the tail is negligible, and a bound of the tail's
    integral.
    """
    ratio, order = 1 / arb(found.factor), 4
    while True:
        tail = 2 * arb(found.proved) * found.reach * ratio**order / ((order + 1) * (1 - ratio))
        if tail < share or order >= ctx.prec:
            return found.coefficients(order), tail
        order += 4


_NEWTON = 8
"""Steps to a point at which branches meet, from a place that is very near to it."""
_SPREAD = 2**20
"""So many times as large as what is left out beside a critical value is a panel there at least."""
_TOGETHER = 6
"""Branches, real or not, that are looked for at a point."""
_LITTLE = 2**10
"""Part of the window's height in which branches that meet have to stay for the panel to be left
whole.
"""
_FEW_BITS = 40
_NEAREST = 2**40
"""Part of a panel beside a critical value that is a rational number: so much is left out."""


def _beside(
    branch: WallSeries, at: fmpq, ends: tuple[fmpq, fmpq], effort: IntegralEffort
) -> list[PanelPart] | None:
    """The parts of a panel beside a critical value at which the branch meets another one; None
    where it is not proved.

    Parameters
    ----------
    at : the critical value, nearly.
    ends : of the panel, the one next to the critical value first.
    """
    (near, far), (low, high) = ends, effort.heights
    if abs(near - at) * _SPREAD > abs(far - near):
        return None  # this is no end of the stack
    if near == at:
        near += (far - at) / _NEAREST
    with ctx.workprec(2 * ctx.prec):
        height = branch.height(near, low, high)
        if height is None:
            return None
        over = arb_poly([row(at) for row in branch.value])
        for multiplicity in range(2, min(len(branch.value), _TOGETHER + 1)):
            place = _meeting_place(over, multiplicity, height, abs(near - at))
            if place is None:
                continue
            rows = recentered(
                [row(arb_poly([at, 1 if far > at else -1])) for row in branch.value], place
            )
            for meeting in (m for m in _MEETINGS if m.multiplicity == multiplicity):
                found = _from_point(
                    rows, meeting, abs(near - at), abs(far - at), height - place, effort
                )
                if found is not None:
                    total, length = found
                    end = at + length if far > at else at - length
                    integral = total + (place - low) * abs(end - near)
                    return [
                        PanelPart(min(near, end), max(near, end), integral, True),
                        *_known_by_edges(end, far, effort, 1 if far > at else -1),
                        *_known_by_edges(ends[0], near, effort),
                    ]
            reach = _cluster_radius(rows, multiplicity, arb(abs(far - at)))
            if reach is not None and abs(height - place) < reach < (high - low) / _LITTLE:
                integral = (arb(place, reach) - low) * abs(far - ends[0])
                run = 1 if at > far else -1
                return [PanelPart(min(ends), max(ends), integral, True, run)]
    return None


def _cluster_radius(rows: Sequence[arb_poly], multiplicity: int, far: arb) -> arb | None:
    """A modulus that no height has over distances up to `far`, as one power's term outweighs the
    others there (Pellet's theorem). Branches below it stay so. None where it is not proved.

    Parameters
    ----------
    rows : coefficients in the distance from a point of the powers of the height above it.
    multiplicity : the number of branches that meet at the point.
    """
    sizes = [size(row, far) for row in rows]
    least = 2 * abs(rows[multiplicity][0]) - sizes[multiplicity]
    if not least > 0:
        return None
    terms = enumerate(sizes[:multiplicity])
    powers = ((2 * multiplicity * a / least).upper().root(multiplicity - j) for j, a in terms)
    reach = max(powers).upper()
    others = sum((a * reach**j for j, a in enumerate(sizes) if j != multiplicity), arb(0))
    return reach if others < least * reach**multiplicity else None


class _Meeting(NamedTuple):
    """How branches meet: at the distance s^k they have the heights slope s^k + s^j t, with
    different t for s = 0.

    Attributes
    ----------
    multiplicity : of the height as a root, so many branches, real or not, meet.
    sheared : whether there is a slope that they have in common; else it is 0.
    """

    k: int
    j: int
    multiplicity: int
    sheared: bool


_MEETINGS = (
    _Meeting(2, 1, 2, False),  # a turning point
    _Meeting(1, 1, 2, False),  # a node
    _Meeting(2, 3, 2, True),  # a cusp
    _Meeting(3, 2, 3, False),  # an upright cusp
)


def _meeting_place(over: arb_poly, multiplicity: int, height: arb, away: fmpq) -> arb | None:
    """A height that is nearly a root so often, near a branch's height at a short distance; None
    where none is seen.
    """
    derivatives = [over]
    for _ in range(multiplicity):
        derivatives.append(derivatives[-1].derivative())
    v = height.mid()
    for _ in range(_NEWTON):
        v = (v - derivatives[-2](v) / derivatives[-1](v)).mid()
    reach = abs(height - v) ** multiplicity + arb(away) ** multiplicity
    return v if abs(over(v)) * _SPREAD < abs(derivatives[-1](v)) * reach else None


def _from_point(
    rows: Sequence[arb_poly],
    meeting: _Meeting,
    near: fmpq,
    far: fmpq,
    height: arb,
    effort: IntegralEffort,
) -> tuple[arb, fmpq] | None:
    """The integral of the height over distances from `near` on, and up to where; None when no disk
    is proved.

    Parameters
    ----------
    rows : coefficients in the distance from the point of the powers of the height above it.
    height : of the branch at `near`.
    """
    k, j, multiplicity, sheared = meeting
    slope = arb(0)
    if sheared:
        slope = (-rows[1][1] / (2 * rows[2][0])).mid()
        rows = shifted(rows, arb_poly([0, slope]), len(rows))
    sigma = arb(near).root(k)
    divided = [_divided(row, k, j * n, j * multiplicity, sigma) for n, row in enumerate(rows)]
    there = (height - slope * near) / sigma**j
    root = _simple_root(arb_poly([row[0] for row in divided]), there.mid())
    with ctx.workprec(_FEW_BITS):
        # at most the root, so that no disk reaches beyond `far`
        whole = arb(far).root(k).lower().fmpq()
    if root is None:
        return None
    try:
        found = disk(divided, whole, root, _DEGREES[0])
    except BallsTooWide:
        return None  # halved panels may do with what precision there is
    # the branch is that of the disk over the nearest place, and so over all others
    if found is None or not (
        root.rad() < found.reach and abs(there - found.center - found.along(sigma)) < found.reach
    ):
        return None
    coefficients, tail = _terms(found, effort.share)
    h, total = arb(found.proved), arb(0)
    for n, c in enumerate(coefficients, j + k):
        total += c * (h**n - sigma**n) * fmpq(k, n)
    tail = tail * h ** (j + k - 1) * k
    end = found.proved**k
    return total + arb(0).union(2 * tail) - tail + slope * (end * end - near * near) / 2, end


def _simple_root(p: arb_poly, t: arb) -> arb | None:
    """A ball near t in which each polynomial of a ball of polynomials has one root; None where it
    is not proved.
    """
    slope = p.derivative()
    for _ in range(_NEWTON):
        t = (t - p(t) / slope(t)).mid()
    step = p(t) / slope(t)
    if not step.is_finite() or step == 0:
        return t if step == 0 else None
    around = arb(t, (8 * abs(step) + abs(t) / arb(2) ** (ctx.prec // 2)).upper())
    root = t - p(t) / slope(around)
    return root if around.contains_interior(root) else None


def _divided(row: arb_poly, k: int, height: int, order: int, sigma: arb) -> arb_poly:
    """A coefficient in s^k of s^height, divided by s^order; with balls for negative powers of
    s >= sigma.
    """
    found = [arb(0)] * (k * len(row.coeffs()) + height)
    for i, c in enumerate(row.coeffs()):
        power = k * i + height - order
        found[max(power, 0)] += c if power >= 0 else arb(0, (abs(c) * sigma**power).upper())
    return arb_poly(found)


_ROUNDED_BITS = 20
"""By so many bits is a series to be better known than by the disk's size."""
