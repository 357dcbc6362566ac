"""Of the paper's mechanism the configurations in which spring 3 has no length: whether the energy
has a peak there.

Guarantee: decided exactly. Rational arithmetic in Q(sqrt(W)) only, so that no sign is rounded.

With |L1 - L2| < rho < L1 + L2 there are two, mirror images: A3 and A4 meet at the corner of the
triangle with sides rho, L1, L2, at height H = +-sqrt(W). Springs 1 and 2 are as long as the bars
there. Near such a point U is -k3 l0_3 l3 plus a smooth function whose slope along d3 is g: a peak
where |g| < k3 l0_3, and a regular point where |g| is larger.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction


def peaks(values: Mapping[str, Fraction]) -> tuple[int, bool]:
    """The number of peaks, and whether Euler's sum holds with it; not where a peak is about to
    appear or vanish, or where springs degenerate.

    That is: minima - saddles + maxima + peaks = 0 (if there are finitely many equilibria, none
    degenerate).

    Parameters
    ----------
    values : of all variables of the mechanism's description, in any unit of stiffness.
    """
    rho, p1, p2 = values["rho"], values["L1"], values["L2"]
    regular = not any(creases_at(values))
    if values["k3"] * values["l0_3"] == 0:
        return 0, regular
    if rho == 0:
        return 0, regular and p1 != p2
    square = height_squared(values)
    if square <= 0:
        return 0, regular and square < 0
    even, odd = excess_of_pull(values)
    signs = [_sign(even, side * odd, square) for side in (1, -1)]
    return signs.count(-1), regular and 0 not in signs


def creases_at(values: Mapping[str, Fraction]) -> tuple[bool, bool]:
    """Whether rho = L2 and rho = L1 at a point, so that spring 1 or 2, if it has a free length, may
    have no length.
    """
    rho = values["rho"]
    return (
        rho == values["L2"] and bool(values["k1"] * values["l0_1"]),
        rho == values["L1"] and bool(values["k2"] * values["l0_2"]),
    )


def height_squared(values: Mapping[str, Fraction]) -> Fraction:
    """H^2; not positive where spring 3 always has a length. rho is not zero."""
    rho, p1, p2 = values["rho"], values["L1"], values["L2"]
    return p1**2 - ((rho**2 + p1**2 - p2**2) / (2 * rho)) ** 2


def excess_of_pull(values: Mapping[str, Fraction]) -> tuple[Fraction, Fraction]:
    """The numbers a, b of which a + b H is (|g|^2 - (k3 l0_3)^2) sin(th1 + th2)^2; rho is not zero."""
    rho, p1, p2 = values["rho"], values["L1"], values["L2"]
    pull1, pull2, pull3 = (values[f"k{i}"] * values[f"l0_{i}"] for i in (1, 2, 3))
    c1, c2 = (rho**2 + p1**2 - p2**2) / (2 * rho * p1), (rho**2 + p2**2 - p1**2) / (2 * rho * p2)
    c12 = (rho**2 - p1**2 - p2**2) / (2 * p1 * p2)
    # r1 = a1 H + b1 and r2 = a2 H + b2 are E1 and E2 without spring 3, whose quadratic part
    # vanishes
    a1 = (values["k2"] * rho - pull2 * rho / p2 + values["F3x"]) / p1
    a2 = (values["k1"] * rho - pull1 * rho / p1 - values["F4x"]) / p2
    b1, b2 = -values["F3"] * c1, -values["F4"] * c2
    # |g|^2 s12^2 - pull3^2 s12^2 = even + odd H, with s12 = rho H/(L1 L2)
    even = (a1**2 + a2**2 + 2 * a1 * a2 * c12 - (pull3 * rho / (p1 * p2)) ** 2) * height_squared(
        values
    )
    even += b1**2 + b2**2 + 2 * b1 * b2 * c12
    odd = 2 * (a1 * b1 + a2 * b2 + (a1 * b2 + a2 * b1) * c12)
    return even, odd


def _sign(a: Fraction, b: Fraction, square: Fraction) -> int:
    """The sign of a + b sqrt(square)."""
    first, second = (a > 0) - (a < 0), (b > 0) - (b < 0)
    if first * second >= 0:
        return first or second
    difference = a**2 - b**2 * square
    return first * ((difference > 0) - (difference < 0))
