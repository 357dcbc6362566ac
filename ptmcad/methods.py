"""The convenience methods of answers, entered for their classes (see `ptmcad.answer`).

Most are functions of other modules, which one table names; some put a few of those together. Each
imports what it needs when it is called: reading a result must not load the algebra that locating a
point takes.
"""

from __future__ import annotations

from ptmcad.answer import METHODS, Method

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from pandas import DataFrame

    from ptmcad.answer.boundarysurface import BoundarySurface
    from ptmcad.answer.comparison import Comparison
    from ptmcad.answer.design import BestDesign
    from ptmcad.answer.family import FamilyMap
    from ptmcad.answer.field import Field
    from ptmcad.answer.motion import Motion
    from ptmcad.answer.regionmap import RegionMap
    from ptmcad.answer.sweep import Member, Sweep
    from ptmcad.show.widget import Explorer


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
    from ptmcad.workbench.fields.quantityfield import field_of, request_of

    return field_of(self, request_of(self.slice, value, pose), columns, rows)


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
    from ptmcad.extras import require
    from ptmcad.workbench.fields.quantityfield import exact_at

    require("notebook")
    from ptmcad.show.widget import Explorer

    return Explorer(self, lambda x, y: exact_at(self, x, y))


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
    next to them unless ``legend="none"``. A figure is that of ``ptmcad plot``; `Figure.savefig`
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
    ConfigError
        For an unknown style or option, a value that cannot be drawn, or what does not fit into the
        size.

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
    ConfigError
        For a system, which cannot be drawn, another suffix, a size that is too small, or MP4
        without ffmpeg.
    OSError
        When the file cannot be written.
    """
    from pathlib import Path

    from ptmcad.show import render
    from ptmcad.show.style import styled

    render.save_film(
        self, Path(path), styled("default", size=size, palette=palette, title=title), fps, dpi
    )


def _family_plot(
    self: FamilyMap,
    style: Any = "default",
    *,
    solid: bool = False,
    surface: BoundarySurface | None = None,
    dpi: int = 150,
    **options: Any,
) -> Any:
    """The members' maps side by side, all alike, as a `Figure` of matplotlib's.

    Parameters
    ----------
    solid : draw the maps one above the other in three dimensions.
    surface : what `boundary_surface` gave: drawn in three dimensions with the members' curves,
        instead of their maps.
    style, dpi, options : as of `RegionMap.plot`.

    Raises
    ------
    ConfigError
        For an unknown style or option, or what does not fit into the size.
    """
    from ptmcad.show import render
    from ptmcad.show.style import styled

    made = styled(style, **options)
    if solid or surface is not None:
        return render.solid_figure(self, dpi, made, surface)
    return render.multiples_figure(self, dpi, made)


def _design_save(self: BestDesign, path: Any) -> None:
    """Draw the values and bounds over one or two parameters, as PNG, SVG or PDF."""
    from pathlib import Path

    from ptmcad.show import render

    render.save(render.figure_of_design(self), Path(path))


def _sweep_getitem(self: Sweep, number: int) -> Member:
    from ptmcad.workbench.sweeps.index import members

    return next(members(self, [number]))


def _sweep_result(self: Sweep, number: int) -> RegionMap:
    """The region map of a member.

    Raises
    ------
    ConfigError
        When there is none.
    """
    from ptmcad.workbench.sweeps.index import member_map

    return member_map(self, self[number])


def _sweep_to_dataframe(self: Sweep) -> DataFrame:
    """A row for each member as a pandas data frame, with the extra ``data``.

    Raises
    ------
    ConfigError
        When pandas is not installed.
    """
    from ptmcad.show.data import pandas_frame
    from ptmcad.show.sweeptable import columns, counts_in, frame_rows

    names = [*columns(self, counts_in(self)), "seconds", "attempts"]
    return pandas_frame(frame_rows(self), names, ("same_as", "cells", "regions", "attempts"))


def _html(text: Callable[[Any], str]) -> Callable[[Any], str]:
    """A method that shows an answer's text in a notebook."""

    def _repr_html_(self: Any) -> str:
        from ptmcad.show.notebook import text_html

        return text_html(text(self))

    return _repr_html_


def _html_by(home: str) -> Callable[[Any], str]:
    """The same, of the text that a function of another module makes."""
    return _html(lambda answer: Method(home).function(answer))


METHODS |= {
    "RegionMap": {
        "locate": "ask.location:locate",
        "to_json": "show.document.mapdocument:write",
        "from_json": Method("show.document.mapdocument:read", bound=False),
        "table": "show.table:table",
        "boundaries": "ask.boundaries:boundaries",
        "grid": "ask.pixels:grid",
        "field": _map_field,
        "to_dataframe": _map_to_dataframe,
        "_repr_html_": "show.notebook:map_html",
        "_repr_svg_": "show.notebook:map_svg",
        "_repr_png_": "show.notebook:map_png",
        "plot": _map_plot,
        "compare": _map_compare,
        "animate": "workbench.fields.posemotion:motion_of",
        "explore": _map_explore,
    },
    "Grid": {
        "_repr_html_": "show.notebook:grid_html",
        "_repr_png_": "show.render:grid_png",
    },
    "Field": {
        "_repr_html_": "show.notebook:field_html",
        "_repr_png_": "show.render:field_png",
    },
    "Comparison": {"_repr_html_": "show.notebook:comparison_html"},
    "Motion": {"save": _motion_save, "_repr_html_": "show.notebook:motion_html"},
    "FamilyMap": {
        "table": "show.table:family_table",
        "plot": _family_plot,
        "boundary_surface": "workbench.boundarymesh:boundary_surface",
        "_repr_html_": "show.notebook:family_html",
        "_repr_png_": "show.notebook:family_png",
    },
    "BoundarySurface": {
        "to_obj": "show.mesh:obj_text",
        "to_ply": "show.mesh:ply_text",
        "_repr_html_": _html(lambda surface: f"{surface!r}\n{surface.words()}"),
    },
    "BestDesign": {
        "table": "show.designtable:design_table",
        "to_json": "show.document.designdocument:write_design",
        "from_json": Method("show.document.designdocument:read_design", bound=False),
        "save": _design_save,
        "_repr_html_": "show.notebook:design_html",
    },
    "Changes": {
        "table": "show.table:changes_table",
        "_repr_html_": _html_by("show.table:changes_table"),
    },
    "Sweep": {
        "__iter__": "workbench.sweeps.index:members",
        "__getitem__": _sweep_getitem,
        "table": "show.sweeptable:table",
        "result": _sweep_result,
        "to_csv": "show.sweeptable:csv_text",
        "to_dataframe": _sweep_to_dataframe,
        "_repr_html_": _html(repr),
    },
    "SliceVariety": {
        "text": "show.varietytext:variety_text",
        "_repr_html_": _html_by("show.varietytext:variety_text"),
    },
    "Poses": {
        "table": "show.posetable:table",
        "to_json": "show.document.posedocument:write_poses",
        "from_json": Method("show.document.posedocument:read_poses", bound=False),
        "_repr_html_": "show.notebook:poses_html",
    },
    "CountIntervals": {"_repr_html_": _html_by("show.ranges.linetable:table")},
    "PosePaths": {"_repr_html_": _html_by("show.ranges.pathtable:path_table")},
    "OperationWidths": {"_repr_html_": _html_by("show.ranges.linetable:width_table")},
}
