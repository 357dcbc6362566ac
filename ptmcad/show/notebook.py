"""Results as a notebook shows them: a picture, and the table of the terminal.

Guarantee: everything from a record is escaped; nothing is loaded from elsewhere.
"""

from __future__ import annotations

from base64 import b64encode
from html import escape
from typing import TYPE_CHECKING, Any

from ptmcad.answer.motion import Motion
from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap
from ptmcad.show import render
from ptmcad.show.style import DEFAULT
from ptmcad.show.table import table

if TYPE_CHECKING:
    from ptmcad.answer.boundaries import Grid
    from ptmcad.answer.comparison import Comparison
    from ptmcad.answer.design import BestDesign
    from ptmcad.answer.family import FamilyMap
    from ptmcad.answer.field import Field

DIGITS = 6
FPS, DPI = 20, 80
"""Of a film."""
MAP_DPI, PAGE_DPI = 150, 100


def _picture(result: RegionMap, kind: str) -> bytes | None:
    """The map's picture as the content of a PNG or SVG; None where there is nothing to draw yet."""
    if not result.cells:
        return None
    return _content(render.plot(result, None, DEFAULT, False, MAP_DPI, {}), kind, MAP_DPI)


def map_html(result: RegionMap) -> str:
    """The picture, and the table."""
    image = map_png(result)
    shown = "" if image is None else _image(image, result.slice.heading)
    return f"<div><b>{escape(result.slice.heading)}</b></div>{shown}{text_html(table(result))}"


def poses_html(poses: Poses) -> str:
    """The table."""
    return text_html(poses.table(min(DIGITS, poses.digits)))


def comparison_html(comparison: Comparison) -> str:
    """Both maps and their difference, and how large that is."""
    figure = render.comparison_figure(comparison, PAGE_DPI, DEFAULT)
    words = "".join(f"<div>{escape(line)}</div>" for line in render.difference_words(comparison))
    return f"{_image(_content(figure), repr(comparison))}{words}"


def _content(figure: Any, kind: str = "png", dpi: int = PAGE_DPI) -> bytes:
    image: bytes = render.content(figure, kind, dpi=dpi)
    return image


def _image(data: bytes, what: str, kind: str = "png") -> str:
    """A picture in place, with what it is for those who do not see it."""
    source = f"data:image/{kind};base64,{b64encode(data).decode()}"
    return f'<img alt="{escape(what)}" style="max-width:100%" src="{source}">'


def family_png(family: FamilyMap) -> bytes:
    """The members' maps side by side as the content of a PNG."""
    return _content(render.multiples_figure(family, PAGE_DPI, DEFAULT))


def family_html(family: FamilyMap) -> str:
    """The maps side by side, and the table."""
    return _image(family_png(family), repr(family)) + text_html(family.table())


def design_html(found: BestDesign) -> str:
    """The picture of the values and bounds, and the answer in words."""
    return _image(_content(render.figure_of_design(found)), repr(found)) + text_html(found.table())


def motion_html(motion: Motion) -> str:
    """The film, in place; in words where it cannot be drawn."""
    if motion.result.slice.model.drawable is None:
        return text_html(repr(motion))
    return _image(render.gif_bytes(motion, DEFAULT, FPS, DPI), repr(motion), "gif")


def text_html(text: str) -> str:
    """Text as a terminal shows it."""
    return f"<pre>{escape(text)}</pre>"


def map_svg(result: RegionMap) -> str | None:
    """The map's picture as SVG; None where there is nothing to draw yet."""
    image = _picture(result, "svg")
    return None if image is None else image.decode()


def map_png(result: RegionMap) -> bytes | None:
    """The map's picture as PNG; None where there is nothing to draw yet."""
    return _picture(result, "png")


def grid_html(grid: Grid) -> str:
    """The grid's pixels in place."""
    words = escape("Counts at the pixels' centres, exactly.")
    return f"{_image(render.grid_png(grid), repr(grid))}<div>{words}</div>"


def field_html(field: Field) -> str:
    """The field's pixels in place, and what of it is known."""
    words = f"{render.description(field)} {field.checked} pixels agree with exact poses to {field.difference:.1g}."
    if field.missed:
        words += f" {field.missed} pixels have such a solution that was not found."
    return f"{_image(render.field_png(field), repr(field))}<div>{escape(words)}</div>"
