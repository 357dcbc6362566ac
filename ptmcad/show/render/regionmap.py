"""The picture of a region map: regions coloured by count, walls, legend, and an inset for every sliver.

Guarantee: the same map gives the same bytes (SVG and PNG) with the same matplotlib; regions that the drawing's
resolution hides are marked by an arrow and shown in insets. What a certified map leaves undetermined is grey, with a
hairline around it, so that it is seen however narrow it is. Global state of matplotlib is neither used nor changed.

Not guaranteed: anything that only the picture shows. It is drawn in floating point from the exact map.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.words import noun
from ptmcad.show.render.axes import dress
from ptmcad.show.render.colours import UNDETERMINED, fill_of
from ptmcad.show.render.labels import Placement, place
from ptmcad.show.render.legend import INK, RIM, RIM_INK, STRONG, THIN, draw_legend, entries, height
from ptmcad.show.render.printing import printed, settings, suffix_of
from ptmcad.show.render.shapes import shapes
from ptmcad.show.render.slivers import Sliver, Zoom, thin_regions, zooms
from ptmcad.show.render.view import Shapes
from ptmcad.show.table import certified_digits, count_text

RESOLVED = 42
"""What is thinner than three pixels of this many to the inch (5 points) is taken for hidden by the walls around it."""

SIDE, LEFT, BOTTOM, COLUMN, GAP, MARGIN = 4.6, 0.85, 0.65, 2.6, 0.25, 0.15
"""In inches: the map's side, the space at its left and below, a column at its right, the space before, the rim."""
INSET_WIDTH, INSET_HEIGHT, INSET_LEFT, INSET_BELOW, INSET_ABOVE = 1.75, 1.2, 0.62, 0.48, 0.42
BLOCK = INSET_ABOVE + INSET_HEIGHT + INSET_BELOW
TITLE_LINE, TITLE_COLUMNS, TITLE_LINES = 0.22, 80, 3


def draw(result: RegionMap, path: Path, *, samples: bool = False, dpi: int = 150) -> None:
    """Write the picture of a map.

    Parameters
    ----------
    path : its suffix gives the format: png, svg or pdf.
    samples : whether to draw the cells' sample points.
    dpi : resolution of a PNG; slivers are what is not seen at this resolution, in every format.

    Raises
    ------
    ValueError
        For another suffix.
    OSError
        When the file cannot be written.

    Guarantee
    ---------
    No region is invisible.
    """
    suffix = suffix_of(path)
    with settings():
        data = printed(figure_of(result, samples, dpi), suffix, dpi, " ".join(_title(result)), description(result))
    path.write_bytes(data)


def figure_of(result: RegionMap, samples: bool, dpi: int, beside: float = 0.0, tallest: float = 0.0) -> Figure:
    """The picture, with so many inches left free at its right and at least so tall there."""
    whole = shapes(result)
    thin = thin_regions(whole, round(SIDE * min(dpi, RESOLVED)))
    views = zooms(whole, thin)
    marked = [sliver for zoom in views for sliver in zoom.slivers]
    legend = entries(
        result,
        thin=any(not separates for _, separates, _ in whole.walls()),
        samples=samples,
        hidden=len(thin) - len(marked),
    )
    title = _title(result)

    below = height(legend) + 0.1
    tall = max(SIDE + BOTTOM, below + 0.1, BLOCK, tallest)
    places = _places(len(views), below, tall)
    columns = 1 + max((column for column, _ in places), default=0)
    size = (LEFT + SIDE + GAP + columns * COLUMN + MARGIN + beside, tall + TITLE_LINE * len(title) + 2 * MARGIN)
    top = tall

    figure = Figure(figsize=size, dpi=dpi, facecolor="white")
    inches = figure.dpi_scale_trans
    for k, line in enumerate(title):
        figure.text(LEFT, size[1] - MARGIN - TITLE_LINE * (k + 0.5), line, transform=inches, fontsize=11, va="center")
    axes = _axes(figure, (LEFT, top - SIDE, SIDE, SIDE), "map")
    _paint(axes, whole, "")
    if samples:
        points = np.array([whole.view.approximate_position(c.sample) for c in result.cells])
        axes.plot(*points.T, "o", markersize=2.5, color=INK, transform=axes.transAxes, gid="samples", clip_on=False)
    dress(axes, result.slice, whole.view.x, whole.view.y, small=False)
    draw_legend(figure, legend, LEFT + SIDE + GAP, top)
    names = {s.region: _name_of(result, s.region, k if len(marked) > 1 else None) for k, s in enumerate(marked)}
    for zoom, (column, down) in zip(views, places, strict=True):
        corner = (LEFT + SIDE + GAP + column * COLUMN + INSET_LEFT, top - down - INSET_ABOVE - INSET_HEIGHT)
        _inset(figure, zoom, [names[s.region] for s in zoom.slivers], corner)
    _mark(axes, whole, marked, list(names.values()))
    return figure


def _places(number: int, below: float, tall: float) -> list[tuple[int, float]]:
    """Columns and distances from the top for insets: the first ones go below the legend, others to further columns."""
    first = int((tall - below) // BLOCK)
    places = [(0, below + k * BLOCK) for k in range(first)]
    per_column = int(tall // BLOCK)
    places += [(1 + k // per_column, k % per_column * BLOCK) for k in range(max(0, number - first))]
    return places[:number]


def _title(result: RegionMap) -> list[str]:
    text = "".join(c if c.isprintable() else " " for c in result.slice.heading)
    return textwrap.wrap(text, TITLE_COLUMNS, max_lines=TITLE_LINES, placeholder=" …") or [""]


def _name_of(result: RegionMap, region: int, number: int | None) -> str:
    """A sliver's count, after a letter when there are several."""
    text = count_text(result.regions[region], result.slice.count)
    if number is None:
        return text
    letters = ""
    while number >= 0:
        number, rest = divmod(number, 26)
        letters, number = chr(ord("A") + rest) + letters, number - 1
    return f"{letters}: {text}"


def _axes(figure: Figure, box: tuple[float, float, float, float], gid: str) -> Any:
    """Axes at a place given in inches: left, bottom, width, height."""
    width, tall = figure.get_size_inches()
    axes = figure.add_axes((box[0] / width, box[1] / tall, box[2] / width, box[3] / tall))
    axes.set_gid(gid)
    return axes


def _paint(axes: Any, seen: Shapes, prefix: str) -> None:
    """Fill the regions and draw the walls."""
    from matplotlib.collections import LineCollection
    from matplotlib.patches import PathPatch, Rectangle
    from matplotlib.path import Path as Curve

    result = seen.result
    if result.cover is not None:
        axes.add_artist(
            Rectangle(
                (0, 0), 1, 1, transform=axes.transAxes, facecolor=UNDETERMINED.face, linewidth=0, snap=False,
                gid=f"{prefix}undetermined",
            )
        )  # fmt: skip
    for number, region in enumerate(result.regions):
        polygons = [Curve(p, closed=False) for p in seen.polygons(number)]
        if not polygons:
            continue
        fill = fill_of(region, result.slice.count)
        # one path for all parts: where two of them share an edge, their coverage adds up and no seam is left
        axes.add_artist(
            PathPatch(
                Curve.make_compound_path(*polygons), transform=axes.transAxes, facecolor=fill.face, edgecolor=INK,
                hatch=fill.hatch or None, linewidth=0, snap=False, gid=f"{prefix}region-{number}",
            )
        )  # fmt: skip
    edges = list(seen.edges())
    if edges:
        axes.add_artist(
            LineCollection(
                edges, transform=axes.transAxes, colors=RIM_INK, linewidths=RIM, joinstyle="round", zorder=2,
                gid=f"{prefix}edges",
            )
        )  # fmt: skip
    lines: dict[tuple[bool, int], list[Any]] = {}
    for component, separates, line in seen.walls():
        lines.setdefault((separates, component), []).append(line)
    for (separates, component), parts in sorted(lines.items()):
        axes.add_artist(
            LineCollection(
                parts, transform=axes.transAxes, colors=INK, linewidths=STRONG if separates else THIN,
                capstyle="round", joinstyle="round", zorder=3 if separates else 2,
                gid=f"{prefix}curve-{component}" + ("" if separates else "-thin"),
            )
        )  # fmt: skip


def _inset(figure: Figure, zoom: Zoom, names: Sequence[str], corner: tuple[float, float]) -> None:
    """Axes with the zoomed view of one or more slivers."""
    result = zoom.outline.result
    number = zoom.slivers[0].region
    axes = _axes(figure, (*corner, INSET_WIDTH, INSET_HEIGHT), f"sliver-{number}")
    _paint(axes, zoom.outline, f"sliver-{number}-")
    dress(axes, result.slice, zoom.outline.view.x, zoom.outline.view.y, small=True)
    if len(names) == 1:
        title = f"{names[0]}\narea {certified_digits(result.regions[number].area, 4)}, zoomed"
    else:
        title = textwrap.shorten(", ".join(names), 34, placeholder=" …") + "\nzoomed"
    axes.set_title(title, fontsize=7.5, loc="left", pad=3)


def _mark(axes: Any, whole: Shapes, thin: Sequence[Sliver], names: Sequence[str]) -> None:
    """An arrow to every sliver, labels apart from each other."""
    tips = [whole.view.approximate_position(s.at) for s in thin]
    marks: list[Placement] = place(tips, names, whole, SIDE * 72)
    for sliver, mark, name in zip(thin, marks, names, strict=True):
        axes.annotate(
            name, xy=mark.tip, xytext=mark.label, xycoords="axes fraction", textcoords="axes fraction",
            ha="center", va="center", fontsize=mark.size, color=INK, zorder=6, gid=f"arrow-{sliver.region}",
            annotation_clip=False,
            bbox={"boxstyle": "round,pad=0.25", "facecolor": "white", "edgecolor": INK, "linewidth": 0.5},
            arrowprops={
                "arrowstyle": "-|>", "color": INK, "linewidth": 0.9, "mutation_scale": 8, "shrinkA": 0, "shrinkB": 0,
            },
        )  # fmt: skip


def description(result: RegionMap) -> str:
    """What the picture shows, in words."""
    count = result.slice.count
    window = " and ".join(f"{a.name} from {a.low} to {a.high}" for a in result.slice.axes)
    regions = "; ".join(f"{count_text(r, count)} ({certified_digits(r.area, 7)})" for r in result.regions)
    return (
        f"Regions of equal count ({count.value} {noun(result.slice.model)}; area in brackets) over {window}: {regions}."
    )
