"""The axes of a picture: symbols, units and scales that stay readable for windows of any size and
place.

Guarantee: the numbers at the ticks have few digits: a large offset and a power of ten are taken
out, exactly, and put into the axis's name.
"""

from __future__ import annotations

import re
from collections.abc import Container
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from ptmcad.question.slice import Slice
from ptmcad.show.render.inches import Box, text_width
from ptmcad.show.style import Size
from ptmcad.show.units import unit, with_unit
from ptmcad.text.numerals import decimal_places, magnitude, power_of_ten, shortest_text

Interval = tuple[Fraction, Fraction]
_LETTERS = "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho sigma tau upsilon phi"
_GREEK = dict(
    zip((*_LETTERS.split(), "chi", "psi", "omega"), "αβγδεζηθικλμνξοπρστυφχψω", strict=True)
)
_GREEK |= {name.capitalize(): letter.upper() for name, letter in _GREEK.items()} | {"th": "θ"}
_SUBSCRIPT = str.maketrans("0123456789x", "₀₁₂₃₄₅₆₇₈₉ₓ")


@dataclass(frozen=True, slots=True)
class Scale:
    """What the ticks show: (value - offset) / 10^exponent, from ``low`` to ``high``."""

    offset: Fraction
    exponent: int
    low: float
    high: float

    def name(self, symbol: str, most: int = 24) -> str:
        """The name of what is shown, such as ``(k - 1000) / 10⁻³``; an offset of more characters is
        cut off.
        """
        if self.offset:
            sign = "−" if self.offset > 0 else "+"
            symbol = f"{symbol} {sign} {_offset_text(abs(self.offset), most)}"
        if self.exponent:
            symbol = f"({symbol})" if self.offset else symbol
            symbol = f"{symbol} / {power_of_ten(self.exponent)}"
        return symbol


def _offset_text(value: Fraction, most: int) -> str:
    """A positive decimal, cut off after so many characters; of a small one its first digits are
    among them.

    >>> [_offset_text(Fraction(text), 6) for text in ("0.25", "0.142857", "2.0408163e-53")]
    ['0.25', '0.142…', '2.040…·10⁻⁵³']
    """
    digits, power = _decimal(value), magnitude(value)
    if len(digits) <= most:
        return digits
    if power >= -2:
        return f"{digits[: most - 1]}…"
    return f"{_decimal(value / Fraction(10) ** power)[: most - 1]}…·{power_of_ten(power)}"


def scale_of(low: Fraction, high: Fraction, digits: int = 4) -> Scale:
    """The scale for an interval, low < high, such that ticks have about so many digits more than
    they need.

    >>> scale_of(Fraction(0), Fraction(2))
    Scale(offset=Fraction(0, 1), exponent=0, low=0.0, high=2.0)
    >>> scale_of(Fraction(10**20), Fraction(10**20 + 1)).name("k")
    'k − 100000000000000000000'
    >>> scale_of(Fraction(0), Fraction(1, 10**20)).name("ρ")
    'ρ / 10⁻²⁰'
    """
    largest, width = max(abs(low), abs(high)), high - low
    offset = Fraction(0)
    if largest > width * 10**digits:
        unit = Fraction(10) ** (magnitude(width) + 1)
        offset = low // unit * unit
    largest = max(abs(low - offset), abs(high - offset))
    exponent = magnitude(largest)
    if -min(digits, 3) <= exponent <= digits:
        exponent = 0
    power = Fraction(10) ** exponent
    return Scale(offset, exponent, float((low - offset) / power), float((high - offset) / power))


def ticks(interval: Interval, scale: Scale, most: int = 6) -> list[tuple[str, Fraction]]:
    """Round numbers of a scale between the ends, as text, and where they are (0 to 1).

    Parameters
    ----------
    most : intervals between them.
    """
    power = Fraction(10) ** scale.exponent
    low, high = ((end - scale.offset) / power for end in interval)
    step = Fraction(10) ** magnitude((high - low) / most)
    step *= next(f for f in (1, 2, Fraction(5, 2), 5, 10) if (high - low) / (step * f) <= most)
    values = [k * step for k in range(int(-(-low // step)), int(high // step) + 1)]
    decimals = max((len(shortest_text(v).partition(".")[2]) for v in values), default=0)
    return [(fixed(v, decimals), (v - low) / (high - low)) for v in values]


def symbol(name: str) -> str:
    """A parameter's name as it is printed: ``L1`` as L₁, ``F3x`` as F₃ₓ, ``rho`` as ρ, ``rho_max``
    as ρ_max; other names as they are.
    """
    match = re.fullmatch(r"([A-Za-z]+?)(\d{1,2}x?)?(_\w*)?", name)
    if match is None or not (
        letter := _GREEK.get(match[1], match[1] if len(match[1]) == 1 and not match[3] else "")
    ):
        return name
    return letter + (match[2] or "").translate(_SUBSCRIPT) + (match[3] or "")


def with_symbols(text: str) -> str:
    """A sum with the symbols of its names and true minus signs, such as ``φ − 2*θ``."""
    return re.sub(r"\b[A-Za-z]\w*", lambda match: symbol(match[0]), text).replace("-", "−")


def heading_of(slice: Slice) -> str:
    """The slice's heading, with the symbols of its names: where axes have them, so has all that is
    said.
    """
    model = slice.model
    return named(
        slice.heading, {*slice.parameters, *slice.axis_names, *model.unknowns, *model.shorthands}
    )


def named(text: str, names: Container[str]) -> str:
    """A text with symbols in place of these names."""
    return re.sub(
        r"[^\W\d]\w*", lambda match: symbol(match[0]) if match[0] in names else match[0], text
    )


def axis_name(slice: Slice, axis: int) -> str:
    """An axis's symbol with its unit, such as ``L₂ (length)``."""
    return with_unit(symbol(slice.axes[axis].name), unit(slice, axis))


@dataclass(frozen=True, slots=True)
class Dress:
    """Sizes in points of the numbers at the ticks and of the axes' names, and the most intervals on
    each axis.
    """

    ticks: float = 9
    names: float = 11
    intervals: tuple[int, int] = (8, 8)
    small: bool = False
    scale: float = 1.0

    @property
    def tick_length(self) -> float:
        return (2 if self.small else 3.5) * self.scale


_TICK_PAD, _NAME_PAD, _TALL = 3.5, 4.0, 1.17
"""In points, from a tick to its number and from there to the axis's name; a line of text against its
size.
"""


def _marks(
    slice: Slice, number: int, interval: Interval, how: Dress
) -> tuple[Scale, str, list[tuple[str, Fraction]]]:
    """An axis's scale, its name and its ticks; in small axes (insets) without units."""
    scale = scale_of(*interval, digits=2 if how.small else 4)
    short = _cut(symbol(slice.axes[number].name), 10 if how.small else 40)
    name = scale.name(short, 9 if how.small else 24)
    name = with_unit(name, "" if how.small else unit(slice, number))
    return scale, name, ticks(interval, scale, how.intervals[number])


def dress(axes: Any, slice: Slice, x: Interval, y: Interval, how: Dress | None = None) -> None:
    """Give matplotlib axes their limits, ticks and names; in small ones (insets) without units."""
    from matplotlib import rcParams

    how = how or Dress()
    for spine in axes.spines.values():
        spine.set_linewidth(how.scale * rcParams["axes.linewidth"])
    for number, (axis, interval) in enumerate(((axes.xaxis, x), (axes.yaxis, y))):
        scale, name, marks = _marks(slice, number, interval, how)
        (axes.set_ylim if number else axes.set_xlim)(scale.low, scale.high)
        at = [scale.low + float(share) * (scale.high - scale.low) for _, share in marks]
        axis.set_ticks(at, [text for text, _ in marks])
        axis.set_label_text(name, fontsize=how.names)
        axis.labelpad = _NAME_PAD
        axis.set_tick_params(
            labelsize=how.ticks, length=how.tick_length, pad=_TICK_PAD,
            width=how.scale * rcParams["xtick.major.width"],
        )  # fmt: skip


def margins(slice: Slice, x: Interval, y: Interval, how: Dress, sides: Size) -> Box:
    """Inches that numbers and names take at the left of axes of these sides, below, at the right and
    above.
    """
    found = [_marks(slice, number, interval, how) for number, interval in enumerate((x, y))]
    wide = [max((text_width(text, how.ticks) for text, _ in of), default=0.0) for _, _, of in found]
    tall = _TALL * how.ticks / 72
    rest = (how.tick_length + _TICK_PAD + _NAME_PAD + _TALL * how.names) / 72
    # a name may be longer than its axis
    across, up = (
        (text_width(name, how.names) - side) / 2
        for (_, name, _), side in zip(found, sides, strict=True)
    )
    return (
        max(rest + wide[1], across),
        max(rest + tall, up),
        max(wide[0] / 2, across),
        max(tall / 2, up),
    )


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else text[: most - 1] + "…"


def _decimal(value: Fraction) -> str:
    """A decimal fraction, exactly."""
    return fixed(value, decimal_places(value) or 0)


def fixed(value: Fraction, decimals: int) -> str:
    """A number that has so many decimals at most, with just as many."""
    digits = str(abs(value) * 10**decimals).zfill(decimals + 1)
    text = f"{digits[:-decimals]}.{digits[-decimals:]}" if decimals else digits
    return f"−{text}" if value < 0 else text
