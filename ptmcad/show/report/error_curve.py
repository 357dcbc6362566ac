"""The curve of error against run time, read from a measurement's file and drawn with logarithmic
axes.

Guarantee: a file that is not such a measurement is refused with the place of the fault; every point
of it is drawn and given in the table.
"""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from math import ceil, floor, log10
from pathlib import Path
from typing import TypeVar

from ptmcad.show.report.sections import table
from ptmcad.text.codec import Codec, line, listed, reading, record
from ptmcad.text.node import Node, opened
from ptmcad.text.numerals import power_of_ten
from ptmcad.text.textfile import read_as

FORMAT = "ptmcad-error-time/1"
MAX_BYTES = 1_000_000
_MAX_SERIES, _MAX_POINTS = 8, 1000
_WIDTH, _HEIGHT, _LEFT, _BOTTOM = 600, 360, 110, 100
_TICKS = (
    f'<path class="grid" d="M{{0:.1f}} 0V{_HEIGHT}"/>'
    f'<text class="number x" x="{{0:.1f}}" y="{_HEIGHT + 14}" dy=".8em">{{1}}</text>',
    f'<path class="grid" d="M0 {{0:.1f}}H{_WIDTH}"/>'
    '<text class="number y" x="-14" y="{0:.1f}" dy=".36em">{1}</text>',
)
"""A line of the grid and its number, of each axis."""
_MARKS = (
    "M-6 0a6 6 0 1 0 12 0a6 6 0 1 0 -12 0",
    "M-6 -6H6V6H-6Z",
    "M0 -7L7 6H-7Z",
    "M0 -8L8 0L0 8L-8 0Z",
)


T = TypeVar("T")


Series = tuple[str, tuple[tuple[float, float], ...]]
"""Measurements of one method: its name and pairs (seconds, error), both positive, in the order in
which they are joined.
"""


ErrorCurve = tuple[str, tuple[Series, ...]]
"""What the error is, in words, and its measurements."""


def read_error_curve(path: Path) -> ErrorCurve:
    """Read a measurement: ``{"format": FORMAT, "error": text, "series": [{"name": text, "points":
    [[s, e], ...]}]}``.

    Raises
    ------
    ConfigError
        When the file is missing or is no such measurement.
    """
    return read_as(
        path,
        MAX_BYTES,
        FORMAT,
        lambda text: _CURVE.read(opened(text, FORMAT, MAX_BYTES, "ptmcad bench")),
    )


def _positive(node: Node) -> float:
    value = node.number()
    if value < 1e-300:
        raise node.fault("is not positive")
    return value


def _some(codec: Codec[T], most: int) -> Codec[tuple[T, ...]]:
    """A list of at most so many entries, and one at least."""

    def read(node: Node) -> tuple[T, ...]:
        if not (found := node.each(codec.read, most=most)):
            raise node.fault("is empty")
        return found

    return reading(read)


_SERIES: Codec[Series] = record(
    lambda name, points: (name, points),
    name=line(60),
    points=_some(listed(reading(_positive), 2), _MAX_POINTS),
)
_CURVE: Codec[ErrorCurve] = record(
    lambda error, series: (error, series),
    error=line(200),
    series=_some(_SERIES, _MAX_SERIES),
)


def error_section(curve: ErrorCurve) -> str:
    """The section: picture, legend and table."""
    rows = ((escape(name), f"{x:.4g}", f"{y:.3g}") for name, points in curve[1] for x, y in points)
    legend = "".join(
        f"<li>{_sample(k)}<span>{escape(name)}</span></li>" for k, (name, _) in enumerate(curve[1])
    )
    return (
        '<section aria-labelledby="h-errors"><h2 id="h-errors">Error against time</h2>'
        f'<p>{escape(curve[0])}</p>{"".join(_picture(curve))}<ul class="legend">{legend}</ul>'
        f"<details><summary>The measurements</summary>{table(('method', 'seconds', 'error'), rows, 'Measurements')}"
        "</details></section>"
    )


def _sample(number: int) -> str:
    """The line and the mark of a series, for the legend."""
    mark = _MARKS[number % len(_MARKS)]
    return (
        '<svg class="swatch line" viewBox="-15 -9 30 18" aria-hidden="true">'
        f'<path class="series s{number}" d="M-14 0H14"/><path class="point s{number}" d="{mark}"/></svg>'
    )


def _picture(curve: ErrorCurve) -> Iterator[str]:
    decades = [_decades([point[k] for _, own in curve[1] for point in own]) for k in (0, 1)]
    yield f'<svg class="map chart" viewBox="0 0 {_LEFT + _WIDTH + 24} {24 + _HEIGHT + _BOTTOM}" role="img" '
    yield f'aria-label="{escape(curve[0])}, against seconds"><g transform="translate({_LEFT} 24)">'

    def place(axis: int, decade: float) -> float:
        low, high = decades[axis]
        share = (decade - low) / (high - low)
        return _HEIGHT - share * _HEIGHT if axis else share * _WIDTH

    for axis, (low, high) in enumerate(decades):
        for decade in range(low, high + 1, max(1, (high - low) // 6)):
            yield _TICKS[axis].format(place(axis, decade), power_of_ten(decade))
    yield f'<text class="name" x="{_WIDTH / 2}" y="{_HEIGHT + _BOTTOM - 16}">seconds</text>'
    yield f'<text class="name" transform="translate({36 - _LEFT} {_HEIGHT / 2}) rotate(-90)">error</text>'
    yield f'<rect class="frame" width="{_WIDTH}" height="{_HEIGHT}"/>'
    for k, (_, own) in enumerate(curve[1]):
        places = [(place(0, log10(x)), place(1, log10(y))) for x, y in own]
        yield f'<path class="series s{k}" d="M{"L".join(f"{x:.1f} {y:.1f}" for x, y in places)}"/>'
        for x, y in places:
            mark = _MARKS[k % len(_MARKS)]
            yield f'<path class="point s{k}" transform="translate({x:.1f} {y:.1f})" d="{mark}"/>'
    yield "</g></svg>"


def _decades(values: list[float]) -> tuple[int, int]:
    low, high = floor(log10(min(values))), ceil(log10(max(values)))
    return (low, high) if low < high else (low, low + 1)
