"""The methods of answers about many slices: families and their changes, sweeps, designs.

Each imports what it needs when it is called: reading a result must not load the algebra that
locating a point takes.
"""

from __future__ import annotations

from ptmcad.answer import METHODS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from pandas import DataFrame

    from ptmcad.answer.boundarysurface import BoundarySurface
    from ptmcad.answer.changes import Changes
    from ptmcad.answer.design import BestDesign
    from ptmcad.answer.family import FamilyMap
    from ptmcad.answer.regionmap import RegionMap
    from ptmcad.answer.sweep import Member, Sweep


def _family_table(self: FamilyMap) -> str:
    """A line for each member, for the terminal: its value, regions, counts and areas."""
    from ptmcad.show.familytable import family_table

    return family_table(self)


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


def _family_boundary_surface(
    self: FamilyMap,
    tolerance: Any = "1/100",
    *,
    max_members: int = 120,
    timeout: float | None = None,
    progress: Any = None,
) -> BoundarySurface:
    """The surface between regions of different counts, over the free parameter, as a mesh.

    Its vertices lie on the boundaries of exact members, which are computed for it; between them it
    is linear interpolation. No sheet reaches past a change of the arrangement, which is why the
    changes have to be known: ``ptmcad.family(record, changes=True)``.

    Parameters
    ----------
    tolerance : members are added until the boundary of one halfway between neighbours is this near
        to the sheet between them, as a share of the window.
    max_members : the most members that are computed; what is left then, `BoundarySurface.deviation`
        says.
    timeout : seconds after which `LimitReached` is raised.
    progress : called as progress(stage, done, total).

    Raises
    ------
    ConfigError
        When the changes are not known, and for a tolerance that is not between 0 and 1.
    """
    from ptmcad.ask.boundarysurface import boundary_surface

    return boundary_surface(
        self, tolerance, max_members=max_members, timeout=timeout, progress=progress
    )


def _surface_to_obj(self: BoundarySurface) -> str:
    """The mesh as Wavefront OBJ, a group for each sheet."""
    from ptmcad.show.mesh import obj_text

    return obj_text(self)


def _surface_to_ply(self: BoundarySurface) -> str:
    """The mesh as Stanford PLY, with each face's sheet and the counts on both of its sides."""
    from ptmcad.show.mesh import ply_text

    return ply_text(self)


def _surface_repr_html(self: BoundarySurface) -> str:
    from ptmcad.show.notebook import text_html

    return text_html(f"{self!r}\n{self.words()}")


def _family_repr_html(self: FamilyMap) -> str:
    from ptmcad.show.notebook import family_html

    return family_html(self)


def _family_repr_png(self: FamilyMap) -> bytes:
    from ptmcad.show.notebook import family_png

    return family_png(self)


def _changes_table(self: Changes) -> str:
    """A line for each change, for the terminal: its value, how it is known, and what changes."""
    from ptmcad.show.familytable import changes_table

    return changes_table(self)


def _changes_repr_html(self: Changes) -> str:
    from ptmcad.show.notebook import text_html

    return text_html(self.table())


def _design_table(self: BestDesign) -> str:
    """What was asked, the best design with its value, and what is proved, for the terminal."""
    from ptmcad.show.designtable import design_table

    return design_table(self)


def _design_to_json(self: BestDesign) -> str:
    """The answer as JSON text, docs/design.schema.json; the same text for the same answer."""
    from ptmcad.show.document.designdocument import write_design

    return write_design(self)


def _design_from_json(_cls: type[BestDesign], text: str) -> BestDesign:
    """The answer that `to_json` wrote.

    Raises
    ------
    ValueError
        When the text is not such an answer.
    """
    from ptmcad.show.document.designdocument import read_design

    return read_design(text)


def _design_save(self: BestDesign, path: Any) -> None:
    """Draw the values and bounds over one or two parameters, as PNG, SVG or PDF."""
    from pathlib import Path

    from ptmcad.show import render

    render.save(render.figure_of_design(self), Path(path))


def _design_repr_html(self: BestDesign) -> str:
    from ptmcad.show.notebook import design_html

    return design_html(self)


def _sweep_iter(self: Sweep) -> Iterator[Member]:
    from ptmcad.sweeping.index import members

    return members(self)


def _sweep_getitem(self: Sweep, number: int) -> Member:
    from ptmcad.sweeping.index import members

    return next(members(self, [number]))


def _sweep_table(self: Sweep) -> str:
    """One screen: what has become of the members, and some of them."""
    from ptmcad.show.sweeptable import table

    return table(self, self.__iter__)


def _sweep_result(self: Sweep, number: int) -> RegionMap:
    """The region map of a member.

    Raises
    ------
    ConfigError
        When there is none.
    """
    from ptmcad.sweeping.index import member_map

    return member_map(self, self[number])


def _sweep_to_csv(self: Sweep) -> str:
    """All members as CSV, in their order: the same text however the sweep was computed."""
    from ptmcad.show.sweeptable import csv_text

    return csv_text(self, self.__iter__)


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
    return pandas_frame(
        frame_rows(self, self.__iter__), names, ("same_as", "cells", "regions", "attempts")
    )


def _sweep_repr_html(self: Sweep) -> str:
    from ptmcad.show.notebook import text_html

    return text_html(repr(self))


METHODS["FamilyMap"] = {"table": _family_table, "plot": _family_plot, "boundary_surface": _family_boundary_surface,
                        "_repr_html_": _family_repr_html, "_repr_png_": _family_repr_png}  # fmt: skip
METHODS["BoundarySurface"] = {
    "to_obj": _surface_to_obj,
    "to_ply": _surface_to_ply,
    "_repr_html_": _surface_repr_html,
}
METHODS["BestDesign"] = {
    "table": _design_table,
    "to_json": _design_to_json,
    "from_json": classmethod(_design_from_json),
    "save": _design_save,
    "_repr_html_": _design_repr_html,
}
METHODS["Changes"] = {"table": _changes_table, "_repr_html_": _changes_repr_html}
METHODS["Sweep"] = {
    "__iter__": _sweep_iter,
    "__getitem__": _sweep_getitem,
    "table": _sweep_table,
    "result": _sweep_result,
    "to_csv": _sweep_to_csv,
    "to_dataframe": _sweep_to_dataframe,
    "_repr_html_": _sweep_repr_html,
}
