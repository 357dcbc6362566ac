"""The style of a region map's picture: size, text, colours, title, legend and lines, with presets
for where it goes.

Guarantee: a style is plain data; what cannot be drawn at all is refused when it is made, before
anything is computed.
"""

import re
from collections.abc import Callable, Mapping
from enum import Enum
from functools import partial
from typing import Any, NamedTuple

from ptmcad.errors import ConfigError

MIN_FONT, MAX_FONT = 6.0, 96.0
"""In points, at the printed size: smaller text is not read on paper."""
MIN_SIDE, MAX_SIDE = 1.0, 60.0
"""Of a picture, in inches."""
PAGE_HEIGHT = 9.0
"""Inches that a picture over both columns of a journal may be tall: what its page has, less a
caption.
"""
MAX_LINE = 10.0
MAX_TITLE = 200
_TO_INCHES = {"in": 1.0, "mm": 1 / 25.4, "cm": 1 / 2.54, "pt": 1 / 72}
NAMED = {
    "white": "#ffffff", "silver": "#c0c0c0", "grey": "#808080", "gray": "#808080", "black": "#000000",
    "red": "#ff0000", "maroon": "#800000", "orange": "#ffa500", "gold": "#ffd700", "yellow": "#ffff00",
    "olive": "#808000", "lime": "#00ff00", "green": "#008000", "teal": "#008080", "cyan": "#00ffff",
    "blue": "#0000ff", "navy": "#000080", "purple": "#800080", "magenta": "#ff00ff", "pink": "#ffc0cb",
    "brown": "#a52a2a", "beige": "#f5f5dc", "lightblue": "#add8e6", "lightgreen": "#90ee90", "salmon": "#fa8072",
}  # fmt: skip
"""Colours of CSS."""
_COLOUR = re.compile(r"#(?:[0-9a-f]{3}|[0-9a-f]{6})", re.ASCII)
_SIZE = re.compile(r"\s*(\d*\.?\d+)\s*[x×*]\s*(\d*\.?\d+)\s*(in|mm|cm|pt)\s*", re.ASCII)

Size = tuple[float, float]


class LegendPlace(Enum):
    """Where the legend stands."""

    RIGHT = "right"
    BELOW = "below"
    NONE = "none"


PALETTES = ("default", "grey")
LINES = ("solid", "dashed", "dotted")


class PictureStyle(NamedTuple):
    """How a picture of a map looks; what is None is chosen to fit.

    Attributes
    ----------
    size : width and height in inches, of the whole picture; None for one that grows with what it
        shows.
    font_size : of the legend and the numbers at the axes, in points; other text is in proportion,
        none below `MIN_FONT`.
    font_family : families, the first that is installed; empty for the one that comes with
        matplotlib.
    palette : one of `PALETTES`, or colours for the map's counts in increasing order.
    title : instead of the slice's heading; empty for none.
    legend : where it stands; None where it fits best.
    line_width : in points, of curves where the count changes; other lines are in proportion.
    thin_lines : one of `LINES`, for curves where it does not.
    wide : width in inches of a picture over both columns of a journal, which is what needs more
        room than one column has (poses around a map, two maps and their difference); None where the
        size is given.
    """

    size: Size | None = None
    font_size: float | None = None
    font_family: tuple[str, ...] = ()
    palette: str | tuple[str, ...] = "default"
    title: str | None = None
    legend: LegendPlace | None = None
    line_width: float | None = None
    thin_lines: str = "solid"
    wide: float | None = None

    @property
    def widest(self) -> float | None:
        """The width of a picture that needs much room; None for as much as it needs."""
        return self.wide if self.wide is not None or self.size is None else self.size[0]

    @property
    def base_font(self) -> float:
        """The font's size, where it is not given in proportion to the picture's width."""
        if self.font_size is not None:
            return self.font_size
        return 9.0 if self.size is None else round(max(8.0, 1.06 * self.size[0]), 1)

    @property
    def line_scale(self) -> float:
        """Of widths of lines and of marks, against those of a picture in 9 points."""
        return self.base_font / 9

    @property
    def strong(self) -> float:
        """Width in points of the curves where the count changes."""
        return self.line_width if self.line_width is not None else 1.3 * self.line_scale


DEFAULT = PictureStyle()


def _mm(width: float, height: float) -> Size:
    return width / 25.4, height / 25.4


PRESETS: Mapping[str, PictureStyle] = {
    "default": DEFAULT,
    "ieee": PictureStyle(size=(3.5, 2.6), font_size=8.0, title="", line_width=1.0, wide=7.16),
    "elsevier": PictureStyle(
        size=_mm(90, 68), font_size=7.5, title="", line_width=1.0, wide=190 / 25.4
    ),
    "springer": PictureStyle(
        size=_mm(84, 64), font_size=8.0, title="", line_width=1.0, wide=174 / 25.4
    ),
    "beamer": PictureStyle(size=_mm(120, 70), font_size=9.0, title=""),
    "poster": PictureStyle(size=_mm(600, 420), font_size=28.0),
}
"""For a column of a journal, whose captions are the titles; for a slide and for a poster."""


def styled(name: str | PictureStyle = "default", **options: Any) -> PictureStyle:
    """A preset, or a style, with options of its own; those that are None are the preset's.

    Parameters
    ----------
    options : fields of `PictureStyle`, each as its type or as text: ``size="90x70mm"``,
        ``palette="grey"``, ``legend="below"``.

    Raises
    ------
    ConfigError
        For an unknown preset or option, or a value that cannot be drawn; its key is the option.

    >>> styled("ieee", legend="below").legend
    <LegendPlace.BELOW: 'below'>
    """
    if isinstance(name, PictureStyle):
        base = name
    elif name in PRESETS:
        base = PRESETS[name]
    else:
        raise ConfigError(f"{name!r} is not among {', '.join(PRESETS)}", key="style")
    given = {key: _read(key, value) for key, value in options.items() if value is not None}
    made = base._replace(**given)
    if "size" in given:
        made = made._replace(wide=None)
    if "size" in given and "font_size" not in given and made.font_size is not None:
        # a preset's font is for its size: on a narrower one it stays, on a much wider one it would
        # be lost
        return made._replace(font_size=max(made.font_size, round(1.06 * given["size"][0], 1)))
    return made


def _read(key: str, value: Any) -> Any:
    if key not in _READERS:
        raise ConfigError(f"a picture has no {key!r}; there are {', '.join(_READERS)}", key=key)
    read, what = _READERS[key]
    try:
        return read(value)
    except (TypeError, ValueError) as error:
        raise ConfigError(f"{value!r:.60} is not {what}", key=key) from error


def _size(value: Any) -> Size:
    """Inches of a text such as 3.5x2.6in or 90x70mm, or of two numbers of inches."""
    unit = "in"
    if isinstance(value, str):
        if (match := _SIZE.fullmatch(value)) is None:
            raise ValueError
        *value, unit = match.groups()
    width, height = (float(side) * _TO_INCHES[unit] for side in value)
    return _within(width, MIN_SIDE, MAX_SIDE), _within(height, MIN_SIDE, MAX_SIDE)


def _within(number: float, least: float, most: float) -> float:
    if not least <= number <= most:
        raise ValueError
    return number


def _points(value: Any, least: float, most: float) -> float:
    text = value.strip().removesuffix("pt") if isinstance(value, str) else value
    return _within(float(text), least, most)


def _parts(value: Any) -> list[Any]:
    """Of a list, or of a text that is divided by commas."""
    return [part.strip() for part in value.split(",")] if isinstance(value, str) else list(value)


def _family(value: Any) -> tuple[str, ...]:
    names = _parts(value)
    if not names or not all(isinstance(name, str) and name for name in names):
        raise ValueError
    return tuple(names)


def _palette(value: Any) -> str | tuple[str, ...]:
    if value in PALETTES:
        return str(value)
    faces = tuple(map(_hexadecimal, _parts(value)))
    if not faces or len({*faces}) < len(faces):  # two counts would look alike
        raise ValueError
    return faces


def _hexadecimal(colour: Any) -> str:
    found = NAMED.get(str(colour).lower(), str(colour).lower())
    if not _COLOUR.fullmatch(found):
        raise ValueError
    return found if len(found) == 7 else "#" + "".join(2 * digit for digit in found[1:])


def _title(value: Any) -> str:
    text = "".join(c if c.isprintable() else " " for c in str(value)).strip()
    if len(text) > MAX_TITLE:
        raise ValueError
    return text


def _line(value: Any) -> str:
    return LINES[LINES.index(value)]


_READERS: Mapping[str, tuple[Callable[[Any], Any], str]] = {
    "size": (_size, f"a size such as 3.5x2.6in or 90x70mm, of sides from {MIN_SIDE:g} to {MAX_SIDE:g} inches"),
    "font_size": (
        partial(_points, least=MIN_FONT, most=MAX_FONT),
        f"from {MIN_FONT:g} to {MAX_FONT:g} points: smaller text is not read on paper",
    ),
    "font_family": (_family, "a font's family such as serif or Times New Roman"),
    "palette": (
        _palette, f"{', '.join(PALETTES)} or several colours such as #c7e4f6 or orange, each once",
    ),
    "title": (_title, f"a title of at most {MAX_TITLE} characters"),
    "legend": (LegendPlace, f"among {', '.join(place.value for place in LegendPlace)}"),
    "line_width": (partial(_points, least=0.1, most=MAX_LINE), f"from 0.1 to {MAX_LINE:g} points"),
    "thin_lines": (_line, f"among {', '.join(LINES)}"),
}  # fmt: skip
"""How each option is read, and what a value is that can be."""
