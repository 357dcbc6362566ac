"""The methods of a region map and of what is made of one: pixels, fields, comparisons, motions.

Each imports what it needs when it is called: reading a result must not load the algebra that
locating a point takes.
"""

from __future__ import annotations

from ptmcad.answer import METHODS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from pandas import DataFrame

    from ptmcad.answer.boundaries import Boundary, Grid
    from ptmcad.answer.comparison import Comparison
    from ptmcad.answer.field import Field
    from ptmcad.answer.location import Location
    from ptmcad.answer.motion import Motion
    from ptmcad.answer.regionmap import RegionMap
    from ptmcad.show.widget import Explorer


def _locate(self: RegionMap, point: Any = None, /, **at: Any) -> Location:
    """The region of a rational point, exactly; names are the two axes, values numbers or text such
    as "7/10".

    A float stands for its shortest decimal: 0.1 is 1/10. The values may be given as one
    mapping instead, such as the sample of a cell.

    Raises
    ------
    ConfigError
        When the names are not the two axes, or a value is not an exact number.
    """
    from ptmcad.ask.location import locate

    return locate(self, at if point is None else point)


def _map_to_json(self: RegionMap, timings: bool = True) -> str:
    """The map as JSON text; the same text for the same slice when ``timings`` is False."""
    from ptmcad.show.document.mapdocument import write

    return write(self, timings)


def _map_from_json(_cls: type[RegionMap], text: str) -> RegionMap:
    """The map that `to_json` wrote.

    Raises
    ------
    ValueError
        When the text is not such a map; the message names the place.
    """
    from ptmcad.show.document.mapdocument import read

    return read(text)


def _map_table(self: RegionMap) -> str:
    """Five lines for the terminal: regions, counts, areas, boundary curves, time and error."""
    from ptmcad.show.table import table

    return table(self)


def _map_boundaries(self: RegionMap, tolerance: Any = "1/1000") -> tuple[Boundary, ...]:
    """The boundaries between regions, and the variety's other curves, as polylines.

    No curve is further from its polyline than the tolerance, a share of the window's side, unless
    the polyline says so (`Boundary.distance`). A certified map gives the outlines of its cells,
    between which lies what is undetermined.

    Raises
    ------
    ConfigError
        When the tolerance is not between 0 and 1, or the map has no cells yet.

    >>> import ptmcad
    >>> curve = ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho")).boundaries()[0]
    >>> curve.points.shape, curve.kind.value
    ((3, 2), 'critical')
    """
    from ptmcad.ask.boundaries import boundaries

    return boundaries(self, tolerance)


def _map_grid(self: RegionMap, columns: int = 200, rows: int | None = None) -> Grid:
    """Region and counts at the centres of columns x rows pixels, exactly; as many rows as columns
    if not given.

    Raises
    ------
    ConfigError
        When the numbers are not positive or too large, or the map has no cells yet.

    >>> import ptmcad
    >>> ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho")).grid(4, 2).stable
    array([[1, 2, 2, 1],
           [1, 1, 1, 1]])
    """
    from ptmcad.ask.pixels import grid

    return grid(self, columns, rows)


def _map_field(
    self: RegionMap,
    value: str = "energy",
    pose: str = "stable:1",
    columns: int = 400,
    rows: int | None = None,
) -> Field:
    """A continuous quantity of one equilibrium at the centres of columns x rows pixels, in floating
    point.

    Every pixel has as many different solutions as the map counts there, and 50 of them are compared
    with exact poses: `Field.difference` says how well they agree.

    Parameters
    ----------
    value : ``energy``, ``stiffness`` (least eigenvalue of the Hessian), ``barrier`` (energy to the
        lowest pass towards another stable pose), ``force:SPRING``, ``length:SPRING``,
        ``angle:UNKNOWN`` in degrees, ``x:POINT``, ``y:POINT``, or an expression in unknowns (angles
        in radians), parameters and axes.
    pose : ``stable:1``, ``unstable:2``, ``saddle:1``, ``maximum:1`` or ``pose:3``, in the order of
        `solve`.

    Raises
    ------
    ConfigError
        For a value or pose that has no meaning here, or a map without cells.

    >>> import ptmcad
    >>> result = ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho"))
    >>> [round(float(v), 3) for v in result.field("length:k3", "stable:1", 3, 1).values[0]]
    [0.333, 1.0, 2.0]
    """
    from ptmcad.ask.fields.field import field_of, request_of

    return field_of(self, request_of(self.slice, value, pose), columns, rows)


def _map_animate(self: RegionMap, path: Any, pose: str = "stable:1", frames: int = 90) -> Motion:
    """The motion of one pose along a path of the map, through the folds where it vanishes, in
    floating point.

    Every step is one of as many equilibria as the map counts there; steps of a fall, by steepest
    descent of the energy, say that they are none. `Motion.save` writes it as a GIF or, with ffmpeg,
    as MP4.

    Parameters
    ----------
    path : corners, as ``"rho=3/4:6/5,L2=3/2"`` or ``{"rho": ["3/4", "6/5"], "L2": "3/2"}``.
    pose : at its start, as of `field`.
    frames : number of steps along the path, beside those of falls.

    Raises
    ------
    ConfigError
        For a path or pose that has no meaning here, or a map without cells.

    >>> import ptmcad
    >>> result = ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho"))
    >>> result.animate("L2=3/2:1/2,rho=1", "stable:2", frames=20)
    <Motion of stable:2 over slice-L2-rho: 20 steps, 0 falls>
    """
    from ptmcad.ask.fields.motion import motion_of

    return motion_of(self, path, pose, frames)


def _map_explore(self: RegionMap) -> Explorer:
    """The map as a living widget of a notebook, with the extra ``notebook``: one drags a point over
    it.

    Poses and energy follow in the browser in floating point. Where the point rests,
    ``widget.point`` has it, a mapping of the two axes to floats, and ``widget.poses`` the exact
    `Poses` there, as of `solve`; setting ``widget.point`` moves it.

    Raises
    ------
    ConfigError
        When anywidget is not installed, or the map contradicts itself so that it cannot be drawn.
    """
    from ptmcad.ask.fields.field import exact_at
    from ptmcad.extras import Extra, require

    require(Extra.notebook)
    from ptmcad.show.widget import Explorer

    return Explorer(self, lambda x, y: exact_at(self, x, y))


def _motion_save(
    self: Motion,
    path: Any,
    *,
    fps: int = 20,
    size: Any = None,
    palette: Any = None,
    title: Any = None,
    dpi: int = 100,
) -> None:
    """Write the motion as a film: a GIF or, with the program ffmpeg, MP4, by the file's suffix.

    Parameters
    ----------
    fps : pictures in a second.
    size, palette, title : as of `RegionMap.plot`.

    Raises
    ------
    ConfigError For a system, which cannot be drawn, another suffix, a size that is too small, or
        MP4 without ffmpeg.
    OSError
        When the file cannot be written.
    """
    from pathlib import Path

    from ptmcad.show import render
    from ptmcad.show.style import styled

    render.save_film(
        self, Path(path), styled("default", size=size, palette=palette, title=title), fps, dpi
    )


def _motion_repr_html(self: Motion) -> str:
    from ptmcad.show.notebook import motion_html

    return motion_html(self)


def _map_to_dataframe(self: RegionMap, what: str = "regions", **options: Any) -> DataFrame:
    """The map as a pandas data frame: its ``regions``, ``cells``, ``components``, ``boundaries`` or
    ``grid``.

    Options are those of `boundaries` (``tolerance``) and `grid` (``columns``, ``rows``).

    Raises
    ------
    ConfigError
        For another name, an option that the table does not have, or when pandas is not installed.
    """
    from ptmcad.show.data import data_frame

    return data_frame(self, what, options)


def _map_repr_html(self: RegionMap) -> str:
    from ptmcad.show.notebook import map_html

    return map_html(self)


def _map_repr_svg(self: RegionMap) -> str | None:
    from ptmcad.show.notebook import picture

    image = picture(self, "svg")
    return None if image is None else image.decode()


def _map_repr_png(self: RegionMap) -> bytes | None:
    from ptmcad.show.notebook import picture

    return picture(self, "png")


def _map_plot(
    self: RegionMap,
    ax: Any = None,
    style: Any = "default",
    *,
    samples: bool = False,
    dpi: int = 150,
    **options: Any,
) -> Any:
    """The picture as objects of matplotlib's: a `Figure` of its own, or the axes ``ax`` with the
    map drawn into them.

    Axes have the units of the map's own axes and a caller's settings, no insets, and a legend
    beside them unless ``legend="none"``. A figure is that of ``ptmcad plot``; `Figure.savefig`
    writes it.

    Parameters
    ----------
    style : "default", "ieee", "elsevier", "springer", "beamer" or "poster".
    samples : whether to draw the cells' sample points.
    dpi : resolution for which thin regions get arrows and insets.
    options : ``size``, ``font_size``, ``font_family``, ``palette``, ``title``, ``legend``,
        ``line_width`` and ``thin_lines``, as on the command line.

    Raises
    ------
    ConfigError For an unknown style or option, a value that cannot be drawn, or what does not fit
        into the size.

    >>> import ptmcad
    >>> figure = ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho")).plot(style="ieee", legend="below")
    >>> [float(side) for side in figure.get_size_inches()]
    [3.5, 2.6]
    """
    from ptmcad.show.render import plot

    return plot(self, ax, style, samples, dpi, options)


def _map_compare(self: RegionMap, other: RegionMap) -> Comparison:
    """Where two maps of the same axes, window and count, both exact or both certified, differ: with
    certified areas.

    Raises
    ------
    ConfigError
        When they are not such maps.

    >>> import ptmcad
    >>> first = ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho"))
    >>> first.compare(first).area
    (Fraction(0, 1), Fraction(0, 1))
    """
    from ptmcad.ask.comparison import compare

    return compare(self, other)


def _grid_repr_html(self: Grid) -> str:
    from ptmcad.show.notebook import grid_png, image_html

    return image_html(grid_png(self), repr(self), "Counts at the pixels' centres, exactly.")


def _grid_repr_png(self: Grid) -> bytes:
    from ptmcad.show.notebook import grid_png

    return grid_png(self)


def _field_repr_html(self: Field) -> str:
    from ptmcad.show.notebook import field_png, field_words, image_html

    return image_html(field_png(self), repr(self), field_words(self))


def _field_repr_png(self: Field) -> bytes:
    from ptmcad.show.notebook import field_png

    return field_png(self)


def _comparison_repr_html(self: Comparison) -> str:
    from ptmcad.show.notebook import comparison_html

    return comparison_html(self)


METHODS["RegionMap"] = {
    "locate": _locate,
    "to_json": _map_to_json,
    "from_json": classmethod(_map_from_json),
    "table": _map_table,
    "boundaries": _map_boundaries,
    "grid": _map_grid,
    "field": _map_field,
    "to_dataframe": _map_to_dataframe,
    "_repr_html_": _map_repr_html,
    "_repr_svg_": _map_repr_svg,
    "_repr_png_": _map_repr_png,
    "plot": _map_plot,
    "compare": _map_compare,
    "animate": _map_animate,
    "explore": _map_explore,
}
METHODS["Grid"] = {"_repr_html_": _grid_repr_html, "_repr_png_": _grid_repr_png}
METHODS["Field"] = {"_repr_html_": _field_repr_html, "_repr_png_": _field_repr_png}
METHODS["Comparison"] = {"_repr_html_": _comparison_repr_html}
METHODS["Motion"] = {"save": _motion_save, "_repr_html_": _motion_repr_html}
