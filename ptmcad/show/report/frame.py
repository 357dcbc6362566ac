"""The frame of a map in SVG: its size, ticks, numbers and the names of the axes.

Guarantee: a tick is exactly where its number says, up to the picture's own rounding to a tenth of a unit.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from html import escape

from ptmcad.show.render.axes import Scale, scale_of, symbol
from ptmcad.show.render.view import Shapes
from ptmcad.show.units import unit
from ptmcad.text.numerals import magnitude, shortest_text

SIDE, LEFT, BOTTOM, RIM = 600, 110, 100, 24
"""In the picture's own units: the window's side, the room for the axes' numbers and names, the rim."""
_MAX_TICKS = 6
_MAX_NAME = 24


def frame(seen: Shapes) -> Iterator[str]:
    """The frame with ticks, numbers and names, as elements of a group whose origin is its upper left corner."""
    yield f'<rect class="frame" width="{SIDE}" height="{SIDE}"/>'
    slice = seen.result.slice
    for number, interval in enumerate((seen.view.x, seen.view.y)):
        scale = scale_of(*interval)
        for value, position in ticks(interval, scale):
            at = float(position) * SIDE
            if number == 0:
                yield f'<path class="tick" d="M{at:.1f} {SIDE}v8"/>'
                yield f'<text class="number x" x="{at:.1f}" y="{SIDE + 18}" dy=".8em">{value}</text>'
            else:
                yield f'<path class="tick" d="M0 {SIDE - at:.1f}h-8"/>'
                yield f'<text class="number y" x="-14" y="{SIDE - at:.1f}" dy=".36em">{value}</text>'
        name = slice.axes[number].name
        text = scale.name(symbol(name if len(name) <= _MAX_NAME else name[: _MAX_NAME - 1] + "…"))
        known = unit(slice, number)
        text = escape(f"{text} ({known})" if known else text)
        if number == 0:
            yield f'<text class="name" x="{SIDE / 2}" y="{SIDE + BOTTOM - 16}">{text}</text>'
        else:
            yield f'<text class="name" transform="translate({36 - LEFT} {SIDE / 2}) rotate(-90)">{text}</text>'


def ticks(interval: tuple[Fraction, Fraction], scale: Scale) -> list[tuple[str, Fraction]]:
    """At most `_MAX_TICKS` + 1 round numbers of a scale, as text, and where they are between the ends (0 to 1)."""
    low, high = interval
    power = Fraction(10) ** scale.exponent
    shown = ((low - scale.offset) / power, (high - scale.offset) / power)
    step = Fraction(10) ** magnitude((shown[1] - shown[0]) / _MAX_TICKS)
    factor = next(f for f in (1, 2, Fraction(5, 2), 5, 10) if (shown[1] - shown[0]) / (step * f) <= _MAX_TICKS)
    step *= factor
    first, last = -(-shown[0] // step), shown[1] // step
    values = [k * step for k in range(int(first), int(last) + 1)]
    decimals = max((len(shortest_text(v).partition(".")[2]) for v in values), default=0)
    return [(_fixed(v, decimals), (v - shown[0]) / (shown[1] - shown[0])) for v in values]


def _fixed(value: Fraction, decimals: int) -> str:
    digits = str(abs(value) * 10**decimals).zfill(decimals + 1)
    text = f"{digits[:-decimals]}.{digits[-decimals:]}" if decimals else digits
    return f"−{text}" if value < 0 else text
