"""Power laws y = c x^p fitted to measured cost, with bounds for the exponent and a verdict on whether there is one.

Guarantee: the same points and seed give the same fit. Points that follow a power law exactly give its exponent.

The exponent is the slope of the least-squares line through (log x, log y). Its bounds are the 5 % and 95 % quantiles of
the slopes of points drawn from the given ones with repetition (pairs bootstrap). A line can be drawn through anything:
so the slopes over the lower and over the upper half of the range of x are given as well, and when these two differ, the
verdict is that the exponent rises or falls, and the slope over the upper half is the one that predicts; unless
y = a + c x^p fits well, a being what every run costs and p how the rest grows.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from math import exp, log
from statistics import median

RESAMPLES, FEW_RESAMPLES = 500, 100
"""Drawings of points for bounds; with a fixed cost each takes as long as hundreds without."""
BEND, SHARE = 0.35, 0.15
"""The halves' slopes differ when their difference exceeds both the first and this share of the larger."""
STRAIGHT, GOOD = 0.9, 0.98
"""R^2 from which on a line through few noisy points is taken for one; the same with a fixed cost, a freedom more."""
BETTER, NOTICEABLE, CURVED = 0.4, 0.05, 0.2
"""A fixed cost has to lessen the sum of squares to the first part, to be the second part of the smallest y, and the
halves' slopes have to differ by the third: a little noise is explained by it too."""
MIN_SIZES = 4
PARTS, COARSE_PARTS = 400, 40
"""Fixed costs that are tried, and for points that were drawn for the bounds."""
MAX_FLAT_RATIO = 1.3
"""A quantity whose largest value is less than this many times its smallest does not grow."""

Points = Sequence[tuple[float, float]]


class Verdict(Enum):
    """What the points say about a power law."""

    POWER_LAW = "power law"
    FIXED_COST = "fixed cost and power law"
    RISES = "no power law: the exponent rises"
    FALLS = "no power law: the exponent falls"
    FLAT = "does not grow"
    SCATTERED = "no power law: scattered"
    TOO_FEW = "too few sizes to tell"


@dataclass(frozen=True, slots=True)
class Fit:
    """A fitted power law.

    Attributes
    ----------
    exponent, low, high : the slope, and its 5 % and 95 % bounds.
    factor : c, of the law that the verdict gives.
    determination : R^2 of the line.
    lower, upper : slopes over the two halves of the range of log x.
    first, last : the range of x.
    points : number of different x.
    fixed, growth : a and p of y = a + c x^p where that is the verdict; else 0 and the exponent.
    growth_low, growth_high : bounds for that p, of the same kind as those of the exponent.
    """

    exponent: float
    low: float
    high: float
    factor: float
    determination: float
    lower: float
    upper: float
    first: float
    last: float
    points: int
    fixed: float
    growth: float
    growth_low: float
    growth_high: float
    verdict: Verdict


def medians(points: Points) -> tuple[tuple[float, float], ...]:
    """The median of y for each x, by x."""
    return tuple((x, median(y for u, y in points if u == x)) for x in sorted({x for x, _ in points}))


def fit(points: Points, seed: int = 1) -> Fit | None:
    """The power law through points; those with the same x count as one, with their median.

    Returns
    -------
    None when there are fewer than two different x, or something is not positive.
    """
    middle = medians(points)
    if len(middle) < 2 or any(x <= 0 or y <= 0 for x, y in middle):
        return None
    logs = [(log(x), log(y)) for x, y in middle]
    slope, height = _line(logs)
    low, high = _bounds([(log(x), log(y)) for x, y in points if y > 0], (RESAMPLES, 2), seed, lambda p: _line(p)[0])
    between = low, high
    # both halves hold the point next to the middle, so that they are joined
    centre = (logs[0][0] + logs[-1][0]) / 2
    joint = min(range(1, len(logs) - 1), key=lambda i: abs(logs[i][0] - centre), default=0)
    lower = _line(logs[: joint + 1])[0] if joint else slope
    upper = _line(logs[joint:])[0] if joint else slope
    mean = sum(v for _, v in logs) / len(logs)
    spread = sum((v - mean) ** 2 for _, v in logs)
    left = sum((v - height - slope * u) ** 2 for u, v in logs)
    determination = 1 - left / spread if spread > 0 else 1.0
    misfit, fixed, growth, height_beyond = _beyond_fixed_cost(middle, PARTS)
    better = misfit < min(BETTER * left, (1 - GOOD) * spread) and fixed > NOTICEABLE * middle[0][1]
    verdict = _verdict(middle, lower, upper, determination, better)
    if verdict is Verdict.FIXED_COST:
        wanted = FEW_RESAMPLES, MIN_SIZES
        between = _bounds(points, wanted, seed, lambda p: _beyond_fixed_cost(medians(p), COARSE_PARTS)[2])
    else:
        fixed, growth, height_beyond = 0.0, slope, height
    return Fit(
        slope, min(low, slope), max(high, slope), exp(height_beyond), determination, lower, upper,
        middle[0][0], middle[-1][0], len(middle), fixed, growth,
        min(between[0], growth), max(between[1], growth), verdict,
    )  # fmt: skip


def _beyond_fixed_cost(middle: Points, parts: int) -> tuple[float, float, float, float]:
    """The misfit, a, p and log c of y = a + c x^p with the least squares of log y; a is a part of the smallest y."""
    least = min(y for _, y in middle)
    tried = []
    for part in range(parts):
        fixed = least * part / parts
        slope, height = _line([(log(x), log(y - fixed)) for x, y in middle])
        misfit = sum((log(fixed + exp(height + slope * log(x))) - log(y)) ** 2 for x, y in middle)
        tried.append((misfit, fixed, slope, height))
    return min(tried)


def _verdict(middle: Points, lower: float, upper: float, determination: float, fixed_cost: bool) -> Verdict:
    values = [y for _, y in middle]
    if max(values) < MAX_FLAT_RATIO * min(values):
        return Verdict.FLAT
    if len(middle) < MIN_SIZES:
        return Verdict.TOO_FEW
    bends = abs(upper - lower) > max(BEND, SHARE * max(abs(lower), abs(upper)))
    if fixed_cost and upper > lower + CURVED:
        return Verdict.FIXED_COST
    if not bends and determination >= STRAIGHT:
        return Verdict.POWER_LAW
    if not bends:
        return Verdict.SCATTERED
    return Verdict.RISES if upper > lower else Verdict.FALLS


def _line(points: Points) -> tuple[float, float]:
    """Slope and height at 0 of the least-squares line; at least two of the abscissae differ."""
    n = len(points)
    x0, y0 = sum(x for x, _ in points) / n, sum(y for _, y in points) / n
    slope = sum((x - x0) * (y - y0) for x, y in points) / sum((x - x0) ** 2 for x, _ in points)
    return slope, y0 - slope * x0


def _bounds(
    points: Points, wanted: tuple[int, int], seed: int, slope: Callable[[Points], float]
) -> tuple[float, float]:
    """The 5 % and 95 % quantiles of the slopes of resampled points: how often, and of how many different sizes."""
    source = random.Random(seed)
    slopes: list[float] = []
    while len(slopes) < wanted[0]:
        drawn = source.choices(points, k=len(points))
        if len({x for x, _ in drawn}) >= wanted[1]:
            slopes.append(slope(drawn))
    slopes.sort()
    return slopes[wanted[0] // 20], slopes[-wanted[0] // 20 - 1]
