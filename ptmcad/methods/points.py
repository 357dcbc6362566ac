"""The methods of answers at points and along lines: poses, varieties, intervals, paths, widths.

Each imports what it needs when it is called: reading a result must not load the algebra that
locating a point takes.
"""

from __future__ import annotations

from ptmcad.answer import METHODS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from ptmcad.answer.intervals import CountIntervals
    from ptmcad.answer.paths import PosePaths
    from ptmcad.answer.poses import Poses
    from ptmcad.answer.slicevariety import SliceVariety
    from ptmcad.answer.widths import OperationWidths


def _poses_repr_html(self: Poses) -> str:
    from ptmcad.show.notebook import poses_html

    return poses_html(self)


def _variety_repr_html(self: SliceVariety) -> str:
    from ptmcad.show.notebook import text_html

    return text_html(self.text())


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


def _intervals_repr_html(self: CountIntervals) -> str:
    from ptmcad.show.notebook import text_html
    from ptmcad.show.ranges.linetable import table

    return text_html(table(self))


def _paths_repr_html(self: PosePaths) -> str:
    from ptmcad.show.notebook import text_html
    from ptmcad.show.ranges.pathtable import path_table

    return text_html(path_table(self))


def _widths_repr_html(self: OperationWidths) -> str:
    from ptmcad.show.notebook import text_html
    from ptmcad.show.ranges.linetable import width_table

    return text_html(width_table(self))


METHODS["SliceVariety"] = {"text": _variety_text, "_repr_html_": _variety_repr_html}
METHODS["Poses"] = {
    "table": _poses_table,
    "to_json": _poses_to_json,
    "from_json": classmethod(_poses_from_json),
    "_repr_html_": _poses_repr_html,
}
METHODS["CountIntervals"] = {"_repr_html_": _intervals_repr_html}
METHODS["PosePaths"] = {"_repr_html_": _paths_repr_html}
METHODS["OperationWidths"] = {"_repr_html_": _widths_repr_html}
