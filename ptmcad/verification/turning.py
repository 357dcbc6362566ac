"""Branches of curves beside turning points, nodes and cusps: enclosures of their integrals by one series each.

Beside a critical value c let u = c + X s^q and v = v0 + m s^q + s^e w. With the right numbers, which the first terms
of p about the point (c, v0) show, p = s^L P(s, w), and the branch is the only one through its point on s = 0: for a
turning point q = 2, e = 1, for a node q = e = 1, for a cusp q = 2, e = 3, or q = 3, e = 2 where it stands upright.
There `ptmcad.verification.disks.disk` proves w to be analytic about s = 0 itself. (Panels in u would have to be
shorter and shorter towards c.)

None of that has to be exact. Of s^L P the terms of lower order than L vanish for the exact point, and are small for
the one that is known; P is taken without them. With J a bound for what is left out where the panel is, s >= s0 > 0,
the disk's condition holds with J, too. So over each such s the whole polynomial has one root in the disk, which is
therefore the branch if it is so over one s. It is within 2 reach J / m of the root t0 of P, where m is the least
|P| on the disk's edge: P / (t - t0) has no zero in the disk, so its least modulus, at least m / (2 reach), is there.

Guarantee: what is returned contains the integral of the branch that was asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from flint import arb, arb_poly, ctx, fmpq

from ptmcad.verification.branches import Branch, Effort
from ptmcad.verification.disks import Disk, PrecisionTooLow, disk

DEGREE = 4
"""Of the polynomials that branches are compared with."""
_ROOM = fmpq(65, 64)
"""What is counted from c is a little more than the width of a panel that begins beside c."""
_STEPS = 64
"""Of Newton's method towards a multiple root."""


class Chart(NamedTuple):
    """u = c + X s^power and v = v0 + lean s^power + s^exponent w; p has the factor s^order then."""

    power: int
    exponent: int
    order: int
    lean: arb


Abscissa = Callable[[fmpq], arb]
"""A ball around a critical value, at most as wide as a number."""


class Beside(NamedTuple):
    """The panel from ``near`` to ``far`` on one side of a critical value."""

    abscissa: Abscissa
    near: fmpq
    far: fmpq

    @property
    def width(self) -> fmpq:
        """X; negative on the left."""
        return (self.far - self.near) * _ROOM


def integral_beside(branch: Branch, beside: Beside, margin: fmpq, effort: Effort) -> tuple[arb, fmpq] | None:
    """The integral of the branch from ``near`` as far as a series about the critical value reaches, and how far.

    None when there is no such series, or none is proved.

    Parameters
    ----------
    margin : by how much ``near`` is away from the critical value, about.
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


def _enclosed(branch: Branch, beside: Beside, effort: Effort) -> tuple[arb, fmpq] | None:
    width = beside.width
    abscissa = beside.abscissa(abs(width) / fmpq(2) ** ctx.prec)
    height, distant = (branch.height(u, *effort.heights) for u in (beside.near, beside.far))
    if height is None or distant is None:
        return None
    rows = [row(arb_poly([abscissa, width])) for row in branch.value]
    found = _chart_at(rows, height, distant)
    if found is None:
        return None
    origin, chart = found
    low, regular = _straightened(rows, origin, chart)

    def parameter(u: fmpq) -> arb:
        return ((u - abscissa) / width).root(chart.power)

    def within(u: fmpq, v: arb) -> arb:
        s = parameter(u)
        return (v - origin - chart.lean * s**chart.power) / s**chart.exponent

    start = parameter(beside.near)
    root = _simple_root(arb_poly([row[0] for row in regular]), within(beside.near, height))
    if root is None:
        return None
    most = abs(root.mid()) * 2 + 1
    left_out = sum((abs(c) * start ** (i - chart.order) * most**j for j, row in enumerate(low)
                    for i, c in enumerate(row)), arb(0))  # fmt: skip
    # a tube no wider than rounding could not be seen to hold the branch
    room = abs(arb_poly([row[0] for row in regular]).derivative()(root)) * arb(2) ** (-ctx.prec // 2)
    tube = disk(regular, fmpq(1), root, DEGREE, (left_out + room, most))
    if tube is None:
        return None
    cut = beside.far if tube.proved == 1 else _cut(abscissa, width * tube.proved**chart.power)
    end = parameter(cut)
    at_cut = branch.height(cut, *effort.heights)
    if at_cut is None or not (end < tube.proved and start < end):
        return None
    off = within(cut, at_cut) - tube.center - tube.along(end)
    if not abs(off) < tube.reach:
        return None  # another branch, or not to be told apart from one
    beyond = 2 * tube.spread * left_out
    return _integrated(tube, chart, origin, (start, end), beyond, abs(width), effort), cut


def _integrated(
    tube: Disk, chart: Chart, origin: arb, ends: tuple[arb, arb], error: arb, width: fmpq, effort: Effort
) -> arb:
    """The integral of v0 + lean s^q + s^e w over u, with an error of w."""
    ratio, order = 1 / tube.factor, 4
    while order < ctx.prec and not tube.reach * arb(ratio) ** order * width < effort.share:
        order += 4
    coefficients = tube.coefficients(order)
    error = error + tube.reach * arb(ratio) ** order / (1 - arb(ratio))
    height = arb_poly([origin] + [arb(0)] * (chart.power - 1) + [chart.lean])
    height += arb_poly([arb(0)] * chart.exponent + coefficients)
    whole = (height * arb_poly([arb(0)] * (chart.power - 1) + [arb(chart.power)])).integral()
    size = ends[1] ** (chart.power + chart.exponent)
    return (whole(ends[1]) - whole(ends[0]) + size * error * arb(0, 1)) * width


def _cut(abscissa: arb, reach: fmpq) -> fmpq:
    """A dyadic number a little nearer to a place than so far from it."""
    at = abscissa.mid().fmpq() + reach * fmpq(15, 16)
    scale = fmpq(2) ** (8 - int((abs(reach)).floor()).bit_length() + int((1 / abs(reach)).ceil()).bit_length())
    return (at * scale).floor() / scale


def _chart_at(rows: Sequence[arb_poly], height: arb, distant: arb) -> tuple[arb, Chart] | None:
    """The multiple root over s = 0 near a height, and the chart that its local terms ask for; None for no such point.

    Parameters
    ----------
    rows : coefficients of the powers of v, in x = (u - c) / X.
    distant : the branch's height over x = 1, about: its distance is the unit in which small is small.
    """
    fibre = arb_poly([row[0] for row in rows])
    for multiplicity in (2, 3):
        origin = _near(fibre, height, multiplicity)
        if origin is None:
            return None
        unit = abs((distant - origin).mid())
        if not unit > 0:
            return None
        derivative, local = list(rows), []
        for j in range(min(4, len(rows))):
            # Horner's division by v - origin, again and again: the remainders are the local coefficients
            for k in range(len(derivative) - 2, -1, -1):
                derivative[k] = derivative[k] + derivative[k + 1] * origin
            local.append([derivative[0][i] * unit**j for i in range(3)])
            derivative = derivative[1:]
        chart = _chart(local, unit)
        if chart is not None:
            return origin, chart
    return None


def _chart(local: Sequence[Sequence[arb]], unit: arb) -> Chart | None:
    """The chart for a point, given its coefficients of t^j x^i, t in so large units."""
    flat = [abs(c).upper() for row in local for c in row]
    small = max(flat[1:], default=arb(0)) * arb(2) ** (-ctx.prec // 4)

    def vanishes(j: int, i: int) -> bool:
        return j >= len(local) or bool(abs(local[j][i]) < small)

    if not (vanishes(0, 0) and vanishes(1, 0)):
        return None
    if not vanishes(2, 0):
        if not vanishes(0, 1):
            return Chart(2, 1, 2, arb(0))
        a, b, c = local[2][0], local[1][1], local[0][2]
        if not abs(b * b - 4 * a * c) < small * abs(a):
            return Chart(1, 1, 2, arb(0))
        return Chart(2, 3, 6, (-b * unit / (2 * a)).mid())
    if not vanishes(3, 0):
        if not vanishes(0, 1):
            return Chart(3, 1, 3, arb(0))
        if vanishes(1, 1) and not vanishes(0, 2):
            return Chart(3, 2, 6, arb(0))
    return None


def _near(p: arb_poly, height: arb, multiplicity: int) -> arb | None:
    """An exact number near a root of so high a multiplicity: a simple one of a derivative."""
    for _ in range(multiplicity - 1):
        p = p.derivative()
    slope, at = p.derivative(), height.mid()
    for _ in range(_STEPS):
        steepness = slope(at)
        if steepness.contains(0):
            return None
        step = (p(at) / steepness).mid()
        at = (at - step).mid()
        if not abs(step) > (abs(at) + 1) * arb(2) ** (8 - ctx.prec):
            break
    return at


def _straightened(rows: Sequence[arb_poly], origin: arb, chart: Chart) -> tuple[list[list[arb]], list[arb_poly]]:
    """Coefficients of the powers of w in p: those of lower order in s than what p is divided by, and P."""
    shifted = [_inflated(row, chart.power) for row in rows]
    along = arb_poly([origin] + [arb(0)] * (chart.power - 1) + [chart.lean])
    if chart.lean == 0:
        along = arb_poly([origin])
    for start in range(len(shifted) - 1):
        for j in range(len(shifted) - 2, start - 1, -1):
            shifted[j] = shifted[j] + shifted[j + 1] * along
    low, regular = [], []
    for j, row in enumerate(shifted):
        coefficients = [arb(0)] * (chart.exponent * j) + row.coeffs()
        low.append(coefficients[: chart.order])
        regular.append(arb_poly(coefficients[chart.order :]))
    return low, regular


def _inflated(row: arb_poly, power: int) -> arb_poly:
    coefficients = [arb(0)] * (power * len(row.coeffs()))
    coefficients[::power] = row.coeffs()
    return arb_poly(coefficients)


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
