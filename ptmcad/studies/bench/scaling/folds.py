"""Slices that show the same picture many times: Chebyshev polynomials of the axes fold the window over itself.

Guarantee: `regions_of_fold` and `regions_of_grid` are the numbers of regions of these slices, by stable count, known
from how they are made and not from any engine.

T_n maps each of the n intervals between neighbouring points cos(i pi / n) onto [-1, 1], with T_n = (-1)^i at those
points. Without loads the stable count is 2 where |L2 - L1| < 2 rho < L2 + L1 and 1 elsewhere (REFERENCE: unloaded).
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import cos, pi

from ptmcad.question.slice import Slice
from ptmcad.studies.slices import ptm_slice
from ptmcad.text.expressions import Expression, axis, constant

MAX_FOLDS = 32
"""Folds of the slice whose window is widened: the largest degree of a parameter."""


def chebyshev(n: int, x: Expression) -> Expression:
    """T_n(x), by its recurrence T_(n+1) = 2 x T_n - T_(n-1)."""
    before, last = constant(1), x
    if n == 0:
        return before
    for _ in range(n - 1):
        before, last = last, 2 * x * last - before
    return last


def fold(n: int, half_width: Fraction = Fraction(1)) -> Slice:
    """rho = y and L2 = 1 + T_n(x)/2: n folds along x, over -half_width < x < half_width and 0 < y < 2."""
    axes = {"x": (-half_width, half_width), "y": (Fraction(0), Fraction(2))}
    slice = ptm_slice(f"fold-{n}", axes, L1=1, k=100, rho="y", L2="1 + x/2")
    return with_parameters(slice, L2=1 + chebyshev(n, axis(0)) / 2)


def regions_of_fold(n: int) -> int:
    """n + 3: below 2 rho = |T_n|/2 one region on either side of each of the n zeros; that of two; that above."""
    return n + 3


def window_of_fold(folds: int) -> Slice:
    """The fold of `MAX_FOLDS` with a window that holds only its innermost ``folds`` folds, an even number."""
    if folds >= MAX_FOLDS:
        return fold(MAX_FOLDS)
    # T_n = +-1 at this point, so the zeros on both sides of it are far away: any number near it holds the same ones
    end = Fraction(round(cos((MAX_FOLDS - folds) / 2 * pi / MAX_FOLDS) * 1000), 1000)
    return fold(MAX_FOLDS, end)


def grid(n: int) -> Slice:
    """L2 = 1 + T_n(x)/2 and rho = 1/2 + T_n(y)/3: n by n copies, mirrored in turn, of one square."""
    slice = ptm_slice(f"grid-{n}", {"x": (-1, 1), "y": (-1, 1)}, L1=1, k=100, rho="1/2 + y/3", L2="1 + x/2")
    return with_parameters(slice, L2=1 + chebyshev(n, axis(0)) / 2, rho=Fraction(1, 2) + chebyshev(n, axis(1)) / 3)


def regions_of_grid(n: int) -> int:
    """One region of two stable poses, and one around each corner of the copies but those where L2 and rho are largest.

    In the square -1 < a, b < 1 with L2 = 1 + a/2, rho = 1/2 + b/3 the three lines cut off the corners (-1, 1), (1, -1)
    and (-1, -1), each by a triangle; copies that share a corner are mirrored there, so their triangles join.
    """
    even = n // 2 + 1
    return 1 + (n + 1) ** 2 - even**2


def with_parameters(slice: Slice, **parameters: Expression) -> Slice:
    """The slice with other expressions for some parameters, and without the text that they had."""
    text = {name: text for name, text in slice.text.items() if name not in parameters}
    return replace(slice, parameters={**slice.parameters, **parameters}, text=text)
