"""What an exact map will take, in seconds and memory, from the size of its critical curve.

Not guaranteed: these are figures fitted to measurements (docs/benchmarks/forecast.md), within a factor of three on
the shipped and on most random slices; how many real points the curve has in the window, on which time depends too, is
not looked at.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ptmcad.algebra.resultants import LONG
from ptmcad.exact.sizes import Sizes

MOST_DEGREE = 50
"""Of the curve in an axis, in the mean of both: beyond, the map may take hours."""
_START = 0.2
"""Seconds that a process takes before it computes."""
_UNIT, _SECONDS, _BY_SIZE, _BY_SOLUTIONS = 144, 0.22, 1.5, 1.0
"""A map with 6 solutions whose degrees have this product takes so long; with what powers of both it grows."""
_LIBRARIES, _MEGABYTES, _MEMORY_BY_SIZE = 38, 3.0, 1.3
"""Of memory likewise."""
WITHIN = 3
"""The factor within which forecasts mostly are."""


class Forecast(NamedTuple):
    """What is predicted of an exact map with areas.

    Attributes
    ----------
    sizes : of the critical curve.
    seconds, megabytes : of the whole process, on one processor.
    """

    sizes: Sizes
    seconds: float
    megabytes: float

    @property
    def reachable(self) -> bool:
        """Whether the curve is of a degree that the exact engine is for."""
        across, up = _powers(self.sizes)
        return across * up <= MOST_DEGREE**2

    @property
    def points(self) -> int:
        """At how many points the curve's discriminant is evaluated, over the axis that takes fewer."""
        across, up = _powers(self.sizes)
        return min(across * 2 * max(up - 1, 0), up * 2 * max(across - 1, 0)) + 1

    @property
    def modular(self) -> bool:
        """Whether the discriminant is so long that its values are taken modulo primes."""
        across, up = _powers(self.sizes)
        return self.points * min(across, up) * max(min(across, up) - 1, 1) >= LONG


def _powers(sizes: Sizes) -> tuple[int, int]:
    """The degrees in the least powers of the axes that occur."""
    across, up = (max(d // s, 1) for d, s in zip(sizes.degrees, sizes.steps, strict=True))
    return across, up


def forecast(solutions: int, sizes: Sizes) -> Forecast:
    """The forecast for a number of complex solutions and a critical curve.

    >>> found = forecast(6, Sizes((24, 12), 24, (2, 1)))
    >>> found.seconds < 1, found.reachable, found.points, found.modular
    (True, True, 265, False)
    """
    across, up = _powers(sizes)
    size = across * up / _UNIT
    seconds = _SECONDS * size**_BY_SIZE * (solutions / 6) ** _BY_SOLUTIONS
    return Forecast(sizes, _START + seconds, _LIBRARIES + _MEGABYTES * size**_MEMORY_BY_SIZE)


def curve_text(found: Forecast, names: tuple[str, str]) -> str:
    """The critical curve's size in words."""
    (dx, dy), total = found.sizes.degrees, found.sizes.total
    return f"critical of degree {total}, {dx} in {names[0]}, {dy} in {names[1]}: up to {found.sizes.terms} terms"


def cost_text(found: Forecast) -> str:
    """What the map is predicted to take, in words."""
    return f"about {duration(found.seconds)} and {_round(found.megabytes):.0f} MB, up to a factor of {WITHIN}"


def way_text(found: Forecast) -> str:
    """How the discriminant is predicted to be computed."""
    how = "modulo primes" if found.modular else "in integers"
    return f"the curve's discriminant from {found.points} values {how}"


def duration(seconds: float) -> str:
    """A time to one or two digits.

    >>> [duration(s) for s in (0.26, 8.2, 95, 5000)]
    ['0.3 s', '8 s', '1.6 min', '1.4 h']
    """
    if seconds < 60:
        return f"{_round(seconds):g} s"
    return f"{seconds / 60:.2g} min" if seconds < 3600 else f"{seconds / 3600:.2g} h"


def _round(x: float) -> float:
    digits = -math.floor(math.log10(x))
    return round(x, digits if x < 10 else digits + 1)
