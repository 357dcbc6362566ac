"""The picture of a continuous quantity over a map's window: colours, contour lines, and the map's
exact boundaries.

Guarantee: the same field gives the same bytes with the same matplotlib. Pixels are shown as they
are, without any smoothing, so that none shows a value from the other side of a boundary. No contour
line crosses an edge of `Field.jumps`, nor the border of a region; none stands where an angle goes
from 180 to -180 degrees. Where the branch changes there is an edge, of sides of pixels.
Everything is on the page, in text of at least `ptmcad.show.style.MIN_FONT` points.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, ListedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ptmcad.answer.boundaries import NONE, Boundary
from ptmcad.answer.field import Field
from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.axes import dress, scale_of, with_symbols
from ptmcad.show.render.chartgrid import head_and_foot, lay_out
from ptmcad.show.render.colours import INK, RIM_INK, STRONG, Fill, undetermined_fill
from ptmcad.show.render.fitting import MIN_SIDE, dressed
from ptmcad.show.render.legend import Entry, line_mark
from ptmcad.show.render.printing import settings
from ptmcad.show.render.view import Floats, View
from ptmcad.show.style import DEFAULT, MIN_FONT, PictureStyle
from ptmcad.show.units import with_unit

SIZE = (6.45, 5.95)
"""Inches in 9 points, where no size is given."""
COLOURS, GREYS = "viridis", ("#000000", "#d4d4d4")
"""Perceptually uniform, distinguishable to the colour-blind, and monotone on grey prints; or grey,
none of it white.
"""
_LINES: dict[str, Any] = {"colors": "white", "linewidths": 0.6, "alpha": 0.85}
_EMPTY = "#ffffff"
_WORDS = ("energy", "stiffness", "barrier", "force", "length", "angle")


def title_of(result: RegionMap, field: Field) -> str:
    """What is shown, of which slice."""
    text = _name(field)
    # others are names, coordinates and expressions, which are written as they were asked for: u is
    # not U
    text = text[0].upper() + text[1:] if text.split()[0] in _WORDS else text
    return f"{text} of {pose_words(result, field)}: {result.slice.name}"


def pose_words(result: RegionMap, field: Field) -> str:
    """Such as ``stable pose 1``."""
    word, _, number = field.pose.partition(":")
    solution = result.slice.model.nouns.pose
    return f"{solution} {number}" if word == "pose" else f"{word} {solution} {number}"


def description(field: Field) -> str:
    """What the picture shows, in words."""
    known = field.known
    if not known.size:
        return f"{_absent(field)[0].upper()}{_absent(field)[1:]}."
    return f"{field.quantity} of {field.pose} from {known.min():.6g} to {known.max():.6g}, {field.shares}."


def field_figure(
    result: RegionMap,
    field: Field,
    boundaries: Sequence[Boundary],
    contours: int,
    dpi: int,
    style: PictureStyle = DEFAULT,
) -> Figure:
    """The picture.

    Raises
    ------
    ConfigError
        When it does not fit into the style's size.
    """
    font = style.base_font
    size = style.size or (SIZE[0] * font / 9, SIZE[1] * font / 9)
    view = View.whole(result)
    with settings(style):
        figure = Figure(figsize=size, dpi=dpi, facecolor="white", layout="constrained")
        axes: Any = figure.add_subplot(gid="map")
        axes.set_facecolor(_EMPTY)
        if (field.region == NONE).any():
            fill_empty(axes, field, _extent(view), undetermined_fill(style.palette))
        if field.known.size:
            _fill(figure, axes, field, view, contours, style)
        else:
            axes.text(
                0.5, 0.5, _absent(field), transform=axes.transAxes, ha="center", color=INK, fontsize=font, zorder=5,
                bbox={"facecolor": "white", "edgecolor": "none"},
            )  # fmt: skip
        for boundary in boundaries:
            if boundary.separates:
                shares = _shares(result, boundary.points)
                axes.plot(*shares.T, color=INK, linewidth=style.strong, transform=axes.transAxes)
        dress(axes, result.slice, view.x, view.y, dressed(font, (0.6 * size[0], 0.6 * size[1])))
        legend = _legend(result, field, boundaries, style)
        head, foot, draw = head_and_foot(title_of(result, field), legend, size[0], style)
        lay_out(figure, head, foot, "the map with its scale does", MIN_SIDE * font / 72)
        draw(figure)
    figure.set_label(f"{title_of(result, field)}\n{description(field)}")
    return figure


def _extent(view: View) -> tuple[float, ...]:
    return tuple(
        v for interval in (view.x, view.y) for s in [scale_of(*interval)] for v in (s.low, s.high)
    )


def fill_empty(axes: Any, field: Field, extent: Sequence[float], fill: Fill) -> None:
    """The pixels of which the map says nothing, and in white those of its regions, over which the
    values come.
    """
    axes.patch.set(facecolor=fill.face, hatch=fill.hatch or None, edgecolor=RIM_INK, linewidth=0)
    show_pixels(
        axes,
        np.where(field.region == NONE, np.nan, 0.0),
        extent,
        cmap=ListedColormap([_EMPTY]),
        gid="empty",
    )


def show_pixels(axes: Any, values: Any, extent: Sequence[float], **look: Any) -> Any:
    """An image of values, row after row from the bottom, without any smoothing."""
    return axes.imshow(
        values, origin="lower", extent=tuple(extent), aspect="auto", interpolation="nearest", **look
    )  # fmt: skip


def _fill(
    figure: Figure, axes: Any, field: Field, view: View, number: int, style: PictureStyle
) -> None:
    """The pixels with their lines, and the scale."""
    extent = _extent(view)
    low, high = float(field.known.min()), float(field.known.max())
    span = {"vmin": low, "vmax": high if high > low else low + 1.0}
    image = show_pixels(axes, field.values, extent, cmap=_colours(style), gid="values", **span)
    lines = {**_LINES, "linewidths": 0.6 * style.line_scale}
    levels = contour_lines(axes, field, extent, number)
    for found in filter(None, levels.values()):
        axes.add_collection(LineCollection(found, gid="contours", **lines), autolim=False)
    if field.jumps is not None:
        jumps = pixel_edges(*field.jumps, extent)
        for look in _edge(style):
            drawn = LineCollection(jumps, gid="jumps", capstyle="projecting", zorder=2.5, **look)
            axes.add_collection(drawn, autolim=False)
    bar = figure.colorbar(image, ax=axes, aspect=23, fraction=0.06, pad=0.03)
    font = max(MIN_FONT, style.base_font)
    if levels:
        # the lines' values are among those at the bar, as many as there is room for
        most = 0.6 * 72 * float(figure.get_size_inches()[1]) / (1.3 * font)
        bar.set_ticks(list(levels)[:: 1 + int(len(levels) / most)])
        shown = [level for level, found in levels.items() if found]
        bar.ax.hlines(shown, *bar.ax.get_xlim(), gid="levels", **lines)
    bar.ax.tick_params(labelsize=font, width=0.8 * style.line_scale)
    bar.ax.yaxis.get_offset_text().set_fontsize(font)
    bar.outline.set_linewidth(0.8 * style.line_scale)
    bar.set_label(bar_text(field), fontsize=max(MIN_FONT, 1.1 * style.base_font))


def _colours(style: PictureStyle) -> Any:
    """The palette's, from the least value to the largest."""
    if style.palette == "default":
        return COLOURS
    faces = GREYS if isinstance(style.palette, str) else style.palette
    faces = faces if len(faces) > 1 else (*faces, GREYS[1])
    return LinearSegmentedColormap.from_list("own", list(faces))


def _edge(style: PictureStyle) -> Sequence[dict[str, Any]]:
    """The double line that makes an edge between branches, from below."""
    looks = ((2.4, INK), (1.0, "white"))
    return [{"color": c, "linewidth": width * style.line_scale} for width, c in looks]


def _legend(
    result: RegionMap, field: Field, boundaries: Sequence[Boundary], style: PictureStyle
) -> list[Entry]:
    """What lines, white and grey mean, as far as they are there."""
    legend = []
    if any(boundary.separates for boundary in boundaries):
        # of the counts on both sides of what a certified map leaves open nothing is known
        words = "the count changes" if result.cover is None else "edge of the undetermined part"
        legend.append(Entry((words,), STRONG))
    if any(jump.any() for jump in field.jumps or ()):
        legend.append(Entry((f"the branch of {pose_words(result, field)} changes",), _edge_mark))
    unknown = field.region == NONE
    if (np.isnan(field.values) & ~unknown).any() and field.known.size:
        what = "barrier" if field.quantity == "barrier" else pose_words(result, field)
        legend.append(
            Entry((f"no {what}" if not field.missed + field.beyond else "no value",), Fill(_EMPTY))
        )
    if unknown.any():
        # a pixel of an exact map is open where its centre is on a curve
        words = "on a curve" if result.cover is None else "undetermined"
        legend.append(Entry((words,), undetermined_fill(style.palette)))
    return legend


_edge_mark = line_mark(*_edge(DEFAULT))


def bar_text(field: Field) -> str:
    """The quantity with its unit, beside the scale."""
    return with_unit(_name(field), field.unit)


def _name(field: Field) -> str:
    """The quantity with the symbols of its names."""
    return with_symbols(field.quantity.replace(":", " "))


def _absent(field: Field) -> str:
    """Why nothing is shown."""
    if field.beyond:
        return f"{_name(field)} is beyond doubles"
    return "no pixel has a value"


def _shares(result: RegionMap, points: Floats) -> Floats:
    """Points as fractions of the window's sides."""
    lows = np.array([float(a.low) for a in result.slice.axes])
    widths = np.array([float(a.width) for a in result.slice.axes])
    shares: Floats = (points - lows) / widths
    return shares


MIN_RING, MIN_PIECE = 16.0, 1.0
"""Pixels of the field: shorter rings, which pixels alone make along a ridge just above a level, and
shorter lines are left out.
"""
HALF_TURN = 180.0
"""Degrees by which neighbours of one branch differ where their angle is written with another turn.
"""

Flags = NDArray[np.bool_]
Segment = tuple[tuple[float, float], tuple[float, float]]


def contour_lines(
    axes: Any, field: Field, extent: Sequence[float], number: int
) -> dict[float, list[Floats]]:
    """About so many lines of equal value, at round values: polylines in the units of the extent, by
    their values.

    A value whose lines are all too short has none. Lines end a pixel before the edge of a region.

    Parameters
    ----------
    axes : matplotlib's, in which they are traced; nothing is left there.
    extent : left, right, bottom, top of the field.
    """
    values = np.where(_before_an_edge(field), np.nan, field.values)
    known = values[~np.isnan(values)]
    if number < 1 or min(values.shape) < 2 or not known.size:
        return {}
    low, high = known.min(), known.max()
    levels = [v for v in MaxNLocator(number + 1).tick_values(low, high) if low < v < high]
    if not levels:
        return {}
    centres = [(side[1:] + side[:-1]) / 2 for side in _sides(values.shape, extent)]
    pixel = [side[1] - side[0] for side in centres]
    traced = axes.contour(*centres, values, levels=levels)
    found = {}
    for level, path in zip(levels, traced.get_paths(), strict=True):
        lines = map(np.asarray, path.to_polygons(closed_only=False))
        found[float(level)] = [line for line in lines if _is_long(line / pixel)]
    traced.remove()
    return found


def _before_an_edge(field: Field) -> Flags:
    """The pixels whose neighbour at the right or above is of another region or branch, or has its
    angle written with another turn.
    """
    found = np.zeros(field.values.shape, np.bool_)
    for axis, here in ((1, np.s_[:, :-1]), (0, np.s_[:-1])):
        edge = np.diff(field.region, axis=axis) != 0
        if field.jumps is not None:
            edge |= field.jumps[1 - axis]
        if field.quantity.startswith("angle:"):
            edge |= np.abs(np.diff(field.values, axis=axis)) > HALF_TURN
        found[here] |= edge
    return found


def _is_long(line: Floats) -> bool:
    """Whether a line, in units of pixels, is drawn."""
    ring = bool((line[0] == line[-1]).all())
    length = float(np.hypot(*np.diff(line, axis=0).T).sum())
    return length >= (MIN_RING if ring else MIN_PIECE)


def _sides(shape: tuple[int, ...], extent: Sequence[float]) -> tuple[Floats, Floats]:
    """Where columns and rows of pixels begin and end."""
    left, right, bottom, top = extent
    return np.linspace(left, right, shape[1] + 1), np.linspace(bottom, top, shape[0] + 1)


def pixel_edges(right: Flags, above: Flags, extent: Sequence[float]) -> list[Segment]:
    """The sides of pixels, in the units of the extent, which part a pixel from that at its right, or
    from that above.
    """
    x, y = (side.tolist() for side in _sides((len(right), above.shape[1]), extent))
    upright = [((x[c + 1], y[r]), (x[c + 1], y[r + 1])) for r, c in np.argwhere(right)]
    level = [((x[c], y[r + 1]), (x[c + 1], y[r + 1])) for r, c in np.argwhere(above)]
    return [*upright, *level]
