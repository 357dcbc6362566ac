"""Results as a notebook shows them: a picture and a small table in HTML.

Guarantee: everything from a record is escaped; nothing is loaded from elsewhere.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from ptmcad.answer.motion import Motion
from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap
from ptmcad.model import Mechanism
from ptmcad.show.style import DEFAULT
from ptmcad.show.table import NOT_COMPUTED, area_digits, areas_are_known, count_text, index_heading
from ptmcad.text.enclosure import Enclosure

if TYPE_CHECKING:
    from ptmcad.answer.boundaries import Grid
    from ptmcad.answer.comparison import Comparison
    from ptmcad.answer.design import BestDesign
    from ptmcad.answer.family import FamilyMap
    from ptmcad.answer.field import Field
    from ptmcad.answer.regionmap import Region

DIGITS = 6
MAX_ROWS = 20
FPS, DPI = 20, 80
"""Of a film."""
PAGE_DPI = 100


def picture(result: RegionMap, kind: str) -> bytes | None:
    """The map's picture as the content of a PNG or SVG; None where there is nothing to draw yet."""
    if not result.cells:
        return None
    from ptmcad.show.render import draw

    with TemporaryDirectory(prefix="ptmcad-") as folder:
        path = Path(folder) / f"map.{kind}"
        draw(result, path)
        return path.read_bytes()


def map_html(result: RegionMap) -> str:
    """The picture, and the regions with their counts and areas."""
    image = picture(result, "png")
    shown = "" if image is None else (
        f'<img alt="{escape(result.slice.heading)}" style="max-width:100%" '
        f'src="data:image/png;base64,{b64encode(image).decode()}">'
    )  # fmt: skip
    rows = [_region_row(result, k, r) for k, r in enumerate(result.regions[:MAX_ROWS])]
    if len(result.regions) > MAX_ROWS:
        rows.append(("…", f"{len(result.regions) - MAX_ROWS} more", "", "", ""))
    head = ("region", result.slice.count.value, "in all", index_heading(result.slice.model), "area")
    return f"<div><b>{escape(result.slice.heading)}</b>, {result.status.value}</div>{shown}{_table(head, rows)}"


def _region_row(result: RegionMap, number: int, region: Region) -> tuple[str, ...]:
    index = " ".join(map(str, region.index)) if region.index else "varies"
    total = "varies" if region.total is None else str(region.total)
    area = area_digits(result, region.area) if areas_are_known(result) else NOT_COMPUTED
    return str(number), count_text(region, result.slice.count), total, index, area


def poses_html(poses: Poses) -> str:
    """Every solution with its unknowns, energy and stability; angles in degrees."""
    model = poses.model
    head = ("", "stable", *(f"{n} (°)" for n in model.angles), *model.reals, "energy", "index")
    rows = [
        (
            str(k), {True: "yes", False: "no", None: "–"}[p.stable], *map(_text, p.degrees), *map(_text, p.reals),
            "–" if p.energy is None else _text(p.energy), "–" if p.index is None else str(p.index),
        )
        for k, p in enumerate(poses.equilibria, 1)
    ]  # fmt: skip
    given = ", ".join(f"{name} = {value}" for name, value in poses.parameters.items())
    note = f"<div>{escape(poses.remark)}</div>" if poses.remark else ""
    return f"<div><b>{escape(model.name)}</b>: {escape(given)}, {poses.status.value}</div>{_table(head, rows)}{note}"


def comparison_html(comparison: Comparison) -> str:
    """Both maps and their difference, and how large that is."""
    from ptmcad.show.render.backend import load_matplotlib

    load_matplotlib()
    from ptmcad.show.render.comparing import draw_comparison, in_words

    with TemporaryDirectory(prefix="ptmcad-") as folder:
        path = Path(folder) / "difference.png"
        draw_comparison(comparison, path, PAGE_DPI, DEFAULT)
        data = b64encode(path.read_bytes()).decode()
    words = "".join(f"<div>{escape(line)}</div>" for line in in_words(comparison))
    return f'<img alt="{escape(repr(comparison))}" style="max-width:100%" src="data:image/png;base64,{data}">{words}'


def image_html(data: bytes, what: str, words: str) -> str:
    """A picture in place, with what it is for those who do not see it, and words below."""
    shown = f'<img alt="{escape(what)}" style="max-width:100%" src="data:image/png;base64,{b64encode(data).decode()}">'
    return f"{shown}<div>{escape(words)}</div>"


def grid_png(grid: Grid) -> bytes:
    """The grid's pixels as the content of a PNG."""
    from ptmcad.show.render.backend import load_matplotlib

    load_matplotlib()
    from ptmcad.show.render import pixelmap

    return pixelmap.grid_png(grid, PAGE_DPI)


def field_png(field: Field) -> bytes:
    """The field's pixels as the content of a PNG."""
    from ptmcad.show.render.backend import load_matplotlib

    load_matplotlib()
    from ptmcad.show.render import pixelmap

    return pixelmap.field_png(field, PAGE_DPI)


def field_words(field: Field) -> str:
    """What of the field is known."""
    from ptmcad.show.render.field import description

    missed = f" {field.missed} pixels have such a solution that was not found." if field.missed else ""
    return f"{description(field)} {field.checked} pixels agree with exact poses to {field.difference:.1g}.{missed}"


def family_png(family: FamilyMap) -> bytes:
    """The members' maps side by side as the content of a PNG."""
    from ptmcad.show.render.backend import load_matplotlib

    load_matplotlib()
    from ptmcad.show.render.multiples import draw_multiples

    with TemporaryDirectory(prefix="ptmcad-") as folder:
        path = Path(folder) / "family.png"
        draw_multiples(family, path, PAGE_DPI, DEFAULT)
        return path.read_bytes()


def family_html(family: FamilyMap) -> str:
    """The maps side by side, and the table."""
    data = b64encode(family_png(family)).decode()
    image = f'<img alt="{escape(repr(family))}" style="max-width:100%" src="data:image/png;base64,{data}">'
    return image + text_html(family.table())


def design_html(found: BestDesign) -> str:
    """The picture of the values and bounds, and the answer in words."""
    from ptmcad.show.render.backend import load_matplotlib

    load_matplotlib()
    from ptmcad.show.render.design import draw_design

    with TemporaryDirectory(prefix="ptmcad-") as folder:
        path = Path(folder) / "design.png"
        draw_design(found, path, PAGE_DPI)
        data = b64encode(path.read_bytes()).decode()
    image = f'<img alt="{escape(repr(found))}" style="max-width:100%" src="data:image/png;base64,{data}">'
    return f"{image}{text_html(found.table())}"


def motion_html(motion: Motion) -> str:
    """The film, in place; in words where it cannot be drawn."""
    if not isinstance(motion.result.slice.model, Mechanism):
        return text_html(repr(motion))
    from ptmcad.show.render.backend import load_matplotlib

    load_matplotlib()
    from ptmcad.show.render.film import gif_bytes

    data = b64encode(gif_bytes(motion, DEFAULT, FPS, DPI)).decode()
    return f'<img alt="{escape(repr(motion))}" style="max-width:100%" src="data:image/gif;base64,{data}">'


def text_html(text: str) -> str:
    """Text as a terminal shows it."""
    return f"<pre>{escape(text)}</pre>"


def _text(value: Enclosure) -> str:
    return value.text(DIGITS)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    columns = "".join(f"<th>{escape(h)}</th>" for h in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(v)}</td>" for v in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{columns}</tr></thead><tbody>{body}</tbody></table>"
