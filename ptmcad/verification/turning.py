"""Branches of curves beside turning points, nodes and cusps, and towards infinity: their integrals by one series each.

Beside a critical value c let u = c + X x, towards infinity u = X / x. `ptmcad.verification.straightening` finds x = s^q
and v = z(s) + s^e w so that p = s^L P(s, w), and the branch is the only one through its point on s = 0. There
`ptmcad.verification.disks.disk` proves w to be analytic about s = 0 itself. (Panels in u would have to be shorter and
shorter towards c, and on the way to the edge of a large window there would be one for each doubling of u.)

None of that has to be exact. Of s^L P the terms of lower order than L vanish for the exact point, and are small for
the one that is known; P is taken without them. With J a bound for what is left out where the panel is, s >= s0 > 0,
the disk's condition holds with J, too. So over each such s the whole polynomial has one root in the disk, which is
therefore the branch if it is so over one s. It is within 2 reach J / m of the root t0 of P, where m is the least
|P| on the disk's edge: P / (t - t0) has no zero in the disk, so its least modulus, at least m / (2 reach), is there.

Guarantee: what is returned contains the integral of the branch that was asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from flint import arb, arb_poly, ctx, fmpq

from ptmcad.verification.branches import Branch, Effort
from ptmcad.verification.disks import Disk, PrecisionTooLow, disk
from ptmcad.verification.places import Abscissa
from ptmcad.verification.straightening import Chart, straightened

DEGREE = 4
"""Of the polynomials that branches are compared with."""
_ROOM = fmpq(65, 64)
"""What is counted from c is a little more than the width of a panel that begins beside c."""
_STEPS = 64
"""Of Newton's method."""
_FARTHEST = 2**16
"""So many times its size at the panel's other end w may be; more would only count what is left out as more."""


class Beside(NamedTuple):
    """The panel from ``near`` to ``far`` on one side of a critical value, or of zero and towards infinity.

    Attributes
    ----------
    abscissa : None for infinity, to which ``near`` is nearer, on the same side of zero as ``far``.
    """

    abscissa: Abscissa | None
    near: fmpq
    far: fmpq

    @property
    def width(self) -> fmpq:
        """X; negative on the left."""
        return self.far if self.abscissa is None else (self.far - self.near) * _ROOM

    @property
    def side(self) -> int:
        """The power of x that u is linear in."""
        return -1 if self.abscissa is None else 1

    def place(self) -> arb:
        """The critical value as well as it is asked for; zero for infinity."""
        return arb(0) if self.abscissa is None else self.abscissa(abs(self.width) / fmpq(2) ** ctx.prec)

    def rows(self, value: Sequence[arb_poly], place: arb) -> list[arb_poly]:
        """Coefficients in x of the powers of v, given those in u."""
        linear = [row(arb_poly([place, self.width])) for row in value]
        if self.abscissa is not None:
            return linear
        degree = max(len(row.coeffs()) for row in linear)
        return [arb_poly((row.coeffs() + [arb(0)] * (degree - len(row.coeffs())))[::-1]) for row in linear]


def integral_beside(branch: Branch, beside: Beside, margin: fmpq, effort: Effort) -> tuple[arb, fmpq] | None:
    """The integral of the branch from ``near`` as far as a series about the critical value reaches, and how far.

    None when there is no such series, or none is proved.

    Parameters
    ----------
    margin : by how much ``near`` is away from the critical value, about; of infinity, what ``far`` is beside ``near``
        times ``far``.
    """
    # low orders are divided by powers of the distance from c
    bits = ctx.prec + 3 * int(abs(beside.width) / margin).bit_length()
    for times in (1, 2):
        with ctx.workprec(times * bits):
            try:
                return _enclosed(branch, beside, effort)
            except PrecisionTooLow:
                continue
    return None


class _Local(NamedTuple):
    """A panel in its coordinates: v in units, x > 0 over a place."""

    beside: Beside
    place: arb
    unit: fmpq
    chart: Chart

    def parameter(self, u: fmpq) -> arb:
        """s."""
        return _distance(self.beside, self.place, u).root(self.chart.power)

    def within(self, u: fmpq, v: arb) -> arb:
        """w."""
        return self.chart.within(self.parameter(u), v / self.unit)


def _distance(beside: Beside, place: arb, u: fmpq) -> arb:
    """x."""
    return ((u - place) / beside.width) ** beside.side


def _enclosed(branch: Branch, beside: Beside, effort: Effort) -> tuple[arb, fmpq] | None:
    height, distant = (branch.height(u, *effort.heights) for u in (beside.near, beside.far))
    if height is None or distant is None:
        return None
    place, unit = beside.place(), _unit(abs(distant) if beside.side < 0 else abs(distant) + abs(height))
    rows = [row * unit**j for j, row in enumerate(beside.rows(branch.value, place))]
    chart = straightened(rows, _distance(beside, place, beside.near), height / unit)
    if chart is None:
        return None
    local = _Local(beside, place, unit, chart)
    regular = chart.regular
    root = _simple_root(arb_poly([row[0] for row in regular]), chart.there)
    if root is None:
        return None
    start = local.parameter(beside.near)
    sizes = (abs(root), abs(local.within(beside.far, distant)), *(abs(c) for _, c in chart.along))
    most = (1 + sum(sizes, arb(0))).upper() * _FARTHEST
    left_out = sum((abs(c) * start ** (i - chart.lowered) * most**j for j, row in enumerate(chart.low)
                    for i, c in enumerate(row) if c != 0), arb(0))  # fmt: skip
    # a tube no wider than rounding could not be seen to hold the branch
    room = abs(arb_poly([row[0] for row in regular]).derivative()(root)) * arb(2) ** (-ctx.prec // 2)
    tube = disk(regular, fmpq(1), root, DEGREE, (left_out + room, most))
    if tube is None:
        return None
    cut = beside.far if tube.proved == 1 else _cut(place, beside, tube.proved**chart.power)
    end = local.parameter(cut)
    at_cut = branch.height(cut, *effort.heights)
    if at_cut is None or not (end < tube.proved * _ROOM and start < end):
        return None
    off = local.within(cut, at_cut) - tube.center - tube.along(end)
    if not abs(off) < tube.reach:
        return None  # another branch, or not to be told apart from one
    return _integrated(tube, local, (start, end), 2 * tube.spread * left_out, effort), cut


def _unit(size: arb) -> fmpq:
    """A power of two next to a size, 1 for zero."""
    number = size.upper().mid().fmpq()
    return fmpq(1) if number == 0 else fmpq(2) ** (int(number.p).bit_length() - int(number.q).bit_length())


def _integrated(tube: Disk, local: _Local, ends: tuple[arb, arb], error: arb, effort: Effort) -> arb:
    """The integral over u of v, units times z + s^e w, with an error of w."""
    chart, inverse = local.chart, 1 / arb(tube.proved * tube.factor)
    lift = chart.power * local.beside.side  # |du| = X q s^(lift - 1) ds
    size = abs(local.beside.width) * local.unit * chart.power
    order = max(4, 4 - chart.exponent - lift)

    def tail() -> arb:
        # of the coefficients of w from the order on, which are at most reach / R^n
        return tube.reach * inverse**order / (1 - ends[1] * inverse) * _power(chart.exponent + lift + order, ends)

    while order < ctx.prec and not tail() * size < effort.share:
        order += 4
    total = sum((c * _power(k + lift, ends) for k, c in chart.along), arb(0))
    for k, c in enumerate(tube.coefficients(order)):
        total += c * _power(chart.exponent + lift + k, ends)
    return (total + (tail() + error * _power(chart.exponent + lift, ends)) * arb(0, 1)) * size


def _power(k: int, ends: tuple[arb, arb]) -> arb:
    """The integral of s^(k - 1)."""
    if k == 0:
        return (ends[1] / ends[0]).log()
    return (ends[1] ** k - ends[0] ** k) / k


def _cut(place: arb, beside: Beside, reach: fmpq) -> fmpq:
    """A dyadic number a little nearer to a place than where x is so large."""
    along = beside.width * (reach * fmpq(15, 16)) ** beside.side
    at = place.mid().fmpq() + along
    scale = fmpq(2) ** (8 - int((abs(along)).floor()).bit_length() + int((1 / abs(along)).ceil()).bit_length())
    return (at * scale).floor() / scale


def _simple_root(p: arb_poly, near: arb) -> arb | None:
    """A ball with one root of p near a number; None where Newton's method does not prove one.

    Raises
    ------
    PrecisionTooLow
    """
    slope, at = p.derivative(), near.mid()
    for _ in range(_STEPS):
        steepness = slope(at)
        if steepness.contains(0):
            raise PrecisionTooLow
        step = p(at) / steepness
        at = (at - step).mid()
        if not abs(step).upper() > (abs(at) + 1) * arb(2) ** (-ctx.prec // 2):
            break
    room = 2 * abs(p(at) / slope(at)).upper() + (abs(at) + 1) * arb(2) ** (-ctx.prec)
    around = at + room * arb(0, 1)
    steepness = slope(around)
    if steepness.contains(0):
        raise PrecisionTooLow
    closer = at - p(at) / steepness
    return closer if around.contains_interior(closer) else None
