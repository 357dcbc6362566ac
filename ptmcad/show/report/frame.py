"""The frame of a map in SVG: its size, ticks, numbers and the names of the axes.

Guarantee: a tick is exactly where its number says, up to the picture's own rounding to a tenth of a
unit. Numbers and names have room beside each other also in the larger type of phones, in a font
that is no wider than DejaVu Sans.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from html import escape
from math import ceil

from ptmcad.show.render.axes import Scale, fixed, scale_of, symbol
from ptmcad.show.render.view import Interval, Shapes
from ptmcad.show.units import unit, with_unit
from ptmcad.text.numerals import magnitude, shortest_text

SIDE, RIM = 600, 24
"""In the picture's own units: the window's side, the rim."""
_LEFT, _BOTTOM = 110, 100
"""The least room for the axes' numbers and names."""
_NUMBER, _NAME, _DETAIL = 29, 31, 36
"""The sizes of their type on phones, as page.css has them: in the map, and of both in a view of
thin regions.
"""
_WIDTHS = {".": 0.32, "−": 0.84}
"""Of characters against the type's size; digits are 0.64 wide."""
_MAX_TICKS = 6
_MAX_NAME = 24


@dataclass(frozen=True, slots=True)
class Margins:
    """What is left around the window for numbers and names, and the size of the names' type on
    phones.
    """

    left: float
    right: float
    bottom: float
    name: float

    @property
    def view(self) -> str:
        """The picture's own coordinates, as SVG has them."""
        return f"0 0 {self.left + SIDE + self.right} {RIM + SIDE + self.bottom}"

    @property
    def place(self) -> str:
        """Where the window begins."""
        return f"translate({self.left} {RIM})"


def room(seen: Shapes, detail: bool) -> Margins:
    """The room that the numbers of a view need: of the whole window, or of thin regions, where the
    type is larger.
    """
    number, name = (_DETAIL, _DETAIL) if detail else (_NUMBER, _NAME)
    across, up = (ticks(interval, scale_of(*interval)) for interval in (seen.view.x, seen.view.y))
    beside = max((_width(text) for text, _ in up), default=0) * number
    beyond = max(
        ((float(at) - 1) * SIDE + _width(text) * number / 2 for text, at in across), default=0
    )
    return Margins(
        left=ceil(max(_LEFT, 14 + beside + 6 + 1.3 * name)),
        right=ceil(max(RIM, beyond + 2)),
        bottom=ceil(max(_BOTTOM, 18 + 1.1 * number + 1.1 * name + 20)),
        name=name,
    )


def _width(text: str) -> float:
    """Of a number, against its type's size."""
    return sum(_WIDTHS.get(character, 0.64) for character in text)


def frame(seen: Shapes, room: Margins) -> Iterator[str]:
    """The frame with ticks, numbers and names, as elements of a group whose origin is its upper
    left corner.
    """
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
        text = escape(with_unit(text, known))
        if number == 0:
            yield f'<text class="name" x="{SIDE / 2}" y="{SIDE + room.bottom - 16}">{text}</text>'
        else:
            place = f"translate({room.name - room.left:g} {SIDE / 2}) rotate(-90)"
            yield f'<text class="name" transform="{place}">{text}</text>'


def ticks(interval: Interval, scale: Scale) -> list[tuple[str, Fraction]]:
    """At most `_MAX_TICKS` + 1 round numbers of a scale, as text, and where they are between the
    ends (0 to 1).
    """
    low, high = interval
    power = Fraction(10) ** scale.exponent
    shown = ((low - scale.offset) / power, (high - scale.offset) / power)
    step = Fraction(10) ** magnitude((shown[1] - shown[0]) / _MAX_TICKS)
    factor = next(
        f for f in (1, 2, Fraction(5, 2), 5, 10) if (shown[1] - shown[0]) / (step * f) <= _MAX_TICKS
    )
    step *= factor
    first, last = -(-shown[0] // step), shown[1] // step
    values = [k * step for k in range(int(first), int(last) + 1)]
    decimals = max((len(shortest_text(v).partition(".")[2]) for v in values), default=0)
    return [(fixed(v, decimals), (v - shown[0]) / (shown[1] - shown[0])) for v in values]
