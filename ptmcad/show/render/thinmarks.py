"""Arrows with counts to regions that a drawing's resolution hides.

Guarantee: labels are apart from each other and within the drawing; regions whose label has no room
are counted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.axes import Dress, dress
from ptmcad.show.render.inches import Box, axes_at
from ptmcad.show.render.labels import Placement, place
from ptmcad.show.render.legend import INK
from ptmcad.show.render.painting import Paint, paint_map
from ptmcad.show.render.slivers import Sliver, inside, thin_regions
from ptmcad.show.render.view import Shapes
from ptmcad.show.style import Size
from ptmcad.show.table import count_text

RESOLVED = 42
"""What is thinner than three pixels of this many to the inch (5 points) is taken for hidden by the
walls around it.
"""
RIMMED = 126
"""The same where it has a rim of its own colour instead of walls (1.7 points)."""


@dataclass(frozen=True, slots=True)
class Marks:
    """Thin regions with the places of their labels, and how many there are without one."""

    slivers: Sequence[Sliver] = ()
    placed: Sequence[Placement] = ()
    names: Sequence[str] = ()
    hidden: int = 0


def ranked(whole: Shapes, slivers: Sequence[Sliver], thin: Sequence[int]) -> list[Sliver]:
    """First the largest region of each count that is seen nowhere else, then by size.

    Parameters
    ----------
    thin : the numbers of all regions that are not seen.
    """
    regions, count = whole.result.regions, whole.result.slice.count
    told = {count_text(region, count) for n, region in enumerate(regions) if n not in thin}
    first: list[Sliver] = []
    by_size = sorted(slivers, key=lambda sliver: -regions[sliver.region].area[0])
    for sliver in by_size:
        text = count_text(regions[sliver.region], count)
        if text not in told:
            told.add(text)
            first.append(sliver)
    return [*first, *(sliver for sliver in by_size if sliver not in first)]


def placed_marks(
    whole: Shapes, marks: Marks, told: Sequence[str], sides: Size, size: float, skip: bool
) -> Marks:
    """The marks with places for their names.

    Parameters
    ----------
    told : what is said of each region of the map: the label of one best stands where the same is
        true.
    sides, size, skip : as of `place`.
    """
    tips = [whole.view.approximate_position(sliver.at) for sliver in marks.slivers]
    homes = [
        [n for n, text in enumerate(told) if text == told[sliver.region]]
        for sliver in marks.slivers
    ]
    return replace(
        marks, placed=place(tips, marks.names, whole, sides, size, skip=skip, homes=homes)
    )


def counts_of(result: RegionMap) -> list[str]:
    """The counts of all regions as texts."""
    return [count_text(region, result.slice.count) for region in result.regions]


def marks_of(
    whole: Shapes, sides: Size, dpi: int, size: float, names: Sequence[str] | None = None
) -> Marks:
    """The marks of a map in a drawing of its own, without insets.

    Parameters
    ----------
    sides : of the drawing, in inches.
    size : of the labels, in points.
    names : of the regions, in their order, empty for those that need no mark; else their counts.
        Regions with names are drawn with rims of their own colour, so that thinner ones are seen.
    """
    result = whole.result
    resolved = RESOLVED if names is None else RIMMED
    told = names if names is not None else counts_of(result)
    thin = [n for n in thin_regions(whole, round(min(sides) * min(dpi, resolved))) if told[n]]
    if not thin:
        return Marks()
    slivers = ranked(whole, [Sliver(n, inside(whole, n)) for n in thin], thin)
    labels = [told[sliver.region] for sliver in slivers]
    marks = Marks(slivers, names=labels)
    found = placed_marks(whole, marks, told, (72 * sides[0], 72 * sides[1]), size, skip=True).placed
    clear = [k for k, placement in enumerate(found) if placement.clear]
    return Marks(
        [slivers[k] for k in clear],
        [found[k] for k in clear],
        [labels[k] for k in clear],
        len(thin) - len(clear),
    )


def draw_chart(
    figure: Any, box: Box, seen: Shapes, paint: Paint, marks: Marks, how: Dress, prefix: str = ""
) -> Any:
    """A map in a box on the page, with its marks and its axes' numbers; its axes."""
    axes = axes_at(figure, box)
    paint_map(axes, seen, prefix, paint)
    dress(axes, seen.result.slice, seen.view.x, seen.view.y, how)
    draw_marks(axes, marks, how.scale)
    return axes


def draw_marks(axes: Any, marks: Marks, scale: float) -> None:
    """The arrows and their labels."""
    for sliver, mark, name in zip(marks.slivers, marks.placed, marks.names, strict=True):
        axes.annotate(
            name, xy=mark.tip, xytext=mark.label, xycoords="axes fraction", textcoords="axes fraction",
            ha="center", va="center", fontsize=mark.size, color=INK, zorder=6, gid=f"arrow-{sliver.region}",
            annotation_clip=False,
            bbox={"boxstyle": "round,pad=0.25", "facecolor": "white", "edgecolor": INK, "linewidth": 0.5},
            arrowprops={
                "arrowstyle": "-|>", "color": INK, "linewidth": 0.9 * scale, "mutation_scale": 8 * scale,
                "shrinkA": 0, "shrinkB": 0,
            },
        )  # fmt: skip
