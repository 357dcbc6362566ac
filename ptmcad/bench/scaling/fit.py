"""Power laws y = c x^p fitted to measured cost, with bounds for the exponent and a verdict on whether there is one.

Guarantee: the same points and seed give the same fit. Points that follow a power law exactly give its exponent.

The exponent is the slope of the least-squares line through (log x, log y). Its bounds are the 5 % and 95 % quantiles of
the slopes of points drawn from the given ones with repetition (pairs bootstrap). A line can be drawn through anything:
so the slopes over the lower and over the upper half of the range of x are given as well, and when these two differ, the
verdict is that the exponent rises or falls, and the slope over the upper half is the one that predicts.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from math import exp, log
from statistics import median

RESAMPLES = 500
BEND = 0.35
"""Difference of the two halves' slopes from which on there is no power law, and by more than this share of the larger."""
SHARE = 0.15
FLAT = 1.3
"""A quantity whose largest value is less than this many times its smallest does not grow."""

Points = Sequence[tuple[float, float]]


class Verdict(Enum):
    """What the points say about a power law."""

    POWER_LAW = "power law"
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
    factor : c.
    determination : R^2 of the line.
    lower, upper : slopes over the two halves of the range of log x.
    first, last : the range of x.
    points : number of different x.
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
    low, high = _bounds([(log(x), log(y)) for x, y in points if y > 0], seed)
    # both halves hold the point next to the middle, so that they are joined
    centre = (logs[0][0] + logs[-1][0]) / 2
    joint = min(range(1, len(logs) - 1), key=lambda i: abs(logs[i][0] - centre), default=0)
    lower = _line(logs[: joint + 1])[0] if joint else slope
    upper = _line(logs[joint:])[0] if joint else slope
    mean = sum(v for _, v in logs) / len(logs)
    spread = sum((v - mean) ** 2 for _, v in logs)
    left = sum((v - height - slope * u) ** 2 for u, v in logs)
    determination = 1 - left / spread if spread > 0 else 1.0
    return Fit(
        slope, min(low, slope), max(high, slope), exp(height), determination, lower, upper,
        middle[0][0], middle[-1][0], len(middle), _verdict(middle, lower, upper, determination),
    )  # fmt: skip


def _verdict(middle: Points, lower: float, upper: float, determination: float) -> Verdict:
    values = [y for _, y in middle]
    if max(values) < FLAT * min(values):
        return Verdict.FLAT
    if len(middle) < 4:
        return Verdict.TOO_FEW
    if abs(upper - lower) > max(BEND, SHARE * max(abs(lower), abs(upper))):
        return Verdict.RISES if upper > lower else Verdict.FALLS
    return Verdict.POWER_LAW if determination >= 0.9 else Verdict.SCATTERED


def _line(points: Points) -> tuple[float, float]:
    """Slope and height at 0 of the least-squares line; at least two of the abscissae differ."""
    n = len(points)
    x0, y0 = sum(x for x, _ in points) / n, sum(y for _, y in points) / n
    slope = sum((x - x0) * (y - y0) for x, y in points) / sum((x - x0) ** 2 for x, _ in points)
    return slope, y0 - slope * x0


def _bounds(points: Points, seed: int) -> tuple[float, float]:
    """The 5 % and 95 % quantiles of the slopes of resampled points."""
    source = random.Random(seed)
    slopes = []
    while len(slopes) < RESAMPLES:
        drawn = source.choices(points, k=len(points))
        if len({x for x, _ in drawn}) > 1:
            slopes.append(_line(drawn)[0])
    slopes.sort()
    return slopes[RESAMPLES // 20], slopes[-RESAMPLES // 20 - 1]
