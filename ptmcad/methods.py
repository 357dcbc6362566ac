"""The convenience methods of answers, entered for their classes (see `ptmcad.answer`).

Each imports what it needs when it is called: reading a result must not load the algebra that locating a point takes.
"""

from __future__ import annotations

from ptmcad.answer import METHODS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from ptmcad.answer.poses import Poses
    from ptmcad.answer.regionmap import Location, RegionMap
    from ptmcad.answer.slicevariety import SliceVariety


def _locate(self: RegionMap, **at: Any) -> Location:
    """The region of a rational point, exactly; names are the two axes, values numbers or text such as "7/10".

    A float stands for its exact binary value: 0.1, unlike the text "0.1", is not 1/10.

    Raises
    ------
    ConfigError
        When the names are not the two axes, or a value is not an exact number.
    """
    from ptmcad.ask.location import locate

    return locate(self, at)


def _map_to_json(self: RegionMap, timings: bool = True) -> str:
    """The map as JSON text; the same text for the same slice when ``timings`` is False."""
    from ptmcad.show.document import write

    return write(self, timings)


def _map_from_json(_cls: type[RegionMap], text: str) -> RegionMap:
    """The map that `to_json` wrote.

    Raises
    ------
    ValueError
        When the text is not such a map; the message names the place.
    """
    from ptmcad.show.document import read

    return read(text)


def _map_table(self: RegionMap) -> str:
    """Five lines for the terminal: regions, counts, areas, boundary curves, time and error."""
    from ptmcad.show.table import table

    return table(self)


def _variety_text(self: SliceVariety, format: str = "text") -> str:
    """The variety in one of the formats of `ptmcad.show.export.FORMATS`.

    Raises
    ------
    ConfigError
        For an unknown format.
    """
    from ptmcad.show.export import variety_text

    return variety_text(self, format)


def _poses_table(self: Poses, digits: int | None = None) -> str:
    """Everything about each equilibrium as text for a terminal, with fewer digits when asked for."""
    from ptmcad.show.posetable import table

    return table(self, digits)


def _poses_to_json(self: Poses) -> str:
    """The poses as JSON text (docs/poses.schema.json)."""
    from ptmcad.show.document.poses import write_poses

    return write_poses(self)


def _poses_from_json(_cls: type[Poses], text: str) -> Poses:
    """The poses that `to_json` wrote.

    Raises
    ------
    ValueError
        When the text is not such a document; the message names the place.
    """
    from ptmcad.show.document.poses import read_poses

    return read_poses(text)


METHODS["RegionMap"] = {
    "locate": _locate,
    "to_json": _map_to_json,
    "from_json": classmethod(_map_from_json),
    "table": _map_table,
}
METHODS["SliceVariety"] = {"text": _variety_text}
METHODS["Poses"] = {
    "table": _poses_table,
    "to_json": _poses_to_json,
    "from_json": classmethod(_poses_from_json),
}
