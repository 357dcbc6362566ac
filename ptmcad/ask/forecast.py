"""What an exact map will take, in seconds and memory, from counts of what there is to compute.

Not guaranteed: the time is a sum over the stages of what each has to do, with constants fitted to
measurements (docs/benchmarks/forecast.csv), within a factor of three on the shipped and on most
random slices.

Equations become a curve by arithmetic with the entries of multiplication tables, as many as the
square of the number of solutions, each product of which takes time as the square of their terms;
and by an interpolation of the norm. The curve's discriminant follows the product of its degrees.
All that comes after grows with the cells of the window and the walls between them. Where the curve
and its discriminant are quick they are computed, and the cells counted (`ptmcad.exact.curvesizes`);
where they are not, the number of cells is not known, and what is usual at the curve's size is
taken.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ptmcad.exact.curvesizes import CurveSizes, Survey

MAX_DEGREE = 50
"""Of the curve in an axis, in the mean of both: beyond, the map may take hours."""
QUICK = 0.8
"""Seconds for the curve and its discriminant, up to which they are computed to know better what
comes after.
"""
_START = 0.2
"""Seconds that a process takes before it computes."""
_TABLE, _NORM = 5.6e-7, 2.25e-6
"""Seconds for the product of two terms in an entry of the multiplication tables, and for a term of
the norm.
"""
_UNIT = 144
"""A product of the curve's degrees, to which the next seconds belong."""
_DISCRIMINANT, _BY_SIZE = 0.034, 1.8
"""Seconds for the curve's discriminant, and with what power of the product they grow."""
_CELL = 7.1e-6
"""Seconds to count in a cell, by the square of the number of solutions and the root of the terms of
an entry.
"""
_WALLS, _BY_WALLS, _BY_DEGREE = 1.3e-4, 0.94, 1.69
"""Seconds for adjacency and area along one wall of degree 1, and with what powers of both numbers
they grow.
"""
_USUAL, _BY_USUAL = 0.0178, 1.24
"""Seconds, for each solution, of all that comes after the discriminant where cells are not counted.
"""
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

    sizes: CurveSizes
    seconds: float
    megabytes: float

    @property
    def reachable(self) -> bool:
        """Whether the curve is of a degree that the exact engine is for."""
        across, up = _powers(self.sizes)
        return across * up <= MAX_DEGREE**2

    @property
    def points(self) -> int:
        """At how many points the curve's discriminant is evaluated, over the axis that takes fewer."""
        across, up = _powers(self.sizes)
        return min(across * 2 * max(up - 1, 0), up * 2 * max(across - 1, 0)) + 1


def _powers(sizes: CurveSizes) -> tuple[int, int]:
    """The degrees in the least powers of the axes that occur."""
    across, up = (max(d // s, 1) for d, s in zip(sizes.degrees, sizes.steps, strict=True))
    return across, up


def seconds_to_discriminant(solutions: int, sizes: CurveSizes) -> float:
    """What the curve and its discriminant are predicted to take."""
    across, up = _powers(sizes)
    tables = _TABLE * (solutions * sizes.table_terms) ** 2
    return (
        tables
        + _NORM * solutions**2 * sizes.terms
        + _DISCRIMINANT * math.pow(across * up / _UNIT, _BY_SIZE)
    )


def seconds_after(solutions: int, sizes: CurveSizes, seen: Survey | None) -> float:
    """What all stages after the discriminant are predicted to take."""
    if seen is None:
        across, up = _powers(sizes)
        return _USUAL * solutions * math.pow(across * up / _UNIT, _BY_USUAL)
    counts = _CELL * seen.cells * solutions**2 * math.sqrt(sizes.table_terms)
    return counts + _WALLS * math.pow(seen.walls, _BY_WALLS) * math.pow(seen.degree, _BY_DEGREE)


def forecast(solutions: int, sizes: CurveSizes, seen: Survey | None = None) -> Forecast:
    """The forecast for a number of complex solutions, a critical curve, and what is known of the
    cells.

    >>> found = forecast(6, CurveSizes((24, 12), 24, (2, 1)))
    >>> found.seconds < 1, found.reachable, found.points
    (True, True, 265)
    """
    across, up = _powers(sizes)
    seconds = (
        _START + seconds_to_discriminant(solutions, sizes) + seconds_after(solutions, sizes, seen)
    )
    return Forecast(
        sizes, seconds, _LIBRARIES + _MEGABYTES * (across * up / _UNIT) ** _MEMORY_BY_SIZE
    )


def curve_text(found: Forecast, names: tuple[str, str]) -> str:
    """The critical curve's size in words.

    >>> curve_text(Forecast(CurveSizes((5, 3), 5, (1, 1), lines=(True, False)), 1, 40), ("a", "b"))
    'critical of degree 5, 5 in a, 3 in b: up to 18 terms; and the line a = 0'
    >>> curve_text(Forecast(CurveSizes((0, 0), 0, (1, 1), lines=(True, True)), 1, 40), ("a", "b"))
    'critical the lines a = 0 and b = 0 alone'
    """
    (dx, dy), total = found.sizes.degrees, found.sizes.total
    zero = [f"{name} = 0" for name, line in zip(names, found.sizes.lines, strict=True) if line]
    lines = f"the line{'s' * (len(zero) > 1)} {' and '.join(zero)}" if zero else ""
    if total == 0:
        return f"critical {lines} alone" if lines else "none critical"
    curve = f"critical of degree {total}, {dx} in {names[0]}, {dy} in {names[1]}: up to {found.sizes.terms} terms"
    return f"{curve}; and {lines}" if lines else curve


def cost_text(found: Forecast) -> str:
    """What the map is predicted to take, in words."""
    return f"about {duration(found.seconds)} and {_round(found.megabytes):.0f} MB, up to a factor of {WITHIN}"


def way_text(found: Forecast) -> str:
    """How the discriminant is predicted to be computed."""
    return f"the curve's discriminant from {found.points} values in integers"


def duration(seconds: float) -> str:
    """A time to one or two digits.

    >>> [duration(s) for s in (0.26, 8.2, 95, 5000, 200000)]
    ['0.3 s', '8 s', '1.6 min', '1.4 h', '2.3 days']
    """
    if seconds < 60:
        return f"{_round(seconds):g} s"
    units = (("min", 60, 3600), ("h", 3600, 86400), ("days", 86400, math.inf))
    return next(f"{seconds / size:.2g} {unit}" for unit, size, end in units if seconds < end)


def _round(x: float) -> float:
    digits = -math.floor(math.log10(x))
    return round(x, digits if x < 10 else digits + 1)
