"""What ``ptmcad range`` answers: texts, JSON and pictures of lines, of bands over the other axis, paths and branches.

Guarantee: only the engine that a question needs is loaded.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ptmcad.cli.progress import ProgressBar
from ptmcad.cli.question import question_of
from ptmcad.question.slice import Slice

if TYPE_CHECKING:
    from ptmcad.ask.branches import SolutionsOnLine
    from ptmcad.text.codec import Codec

MAX_TEXT = 10_000


@dataclass(frozen=True, slots=True)
class RangeRequest:
    """What is asked for beside the slice.

    Attributes
    ----------
    at : the value of the slice's other axis, empty when only ``over`` is asked for.
    over : whether to tabulate the widths over the other axis, in so many rows.
    start, pose : of the paths; ``start`` None for none.
    quantities : of which to draw all branches.
    """

    along: str
    at: Mapping[str, str]
    over: bool
    rows: int
    start: Fraction | None
    pose: int | None
    digits: int
    quantities: tuple[str, ...]


def request_codec() -> Codec[RangeRequest]:
    """A request as JSON's data, with which `answer` gives the same once more.

    Earlier versions could be asked for critical free lengths instead (``critical``); now the paper's study finds them.
    """
    from ptmcad.text.codec import TRUTH, Key, line, record_of

    def made(critical: bool, **asked: Any) -> RangeRequest:
        return RangeRequest(**asked)

    return record_of(RangeRequest, {str: line(MAX_TEXT)}, made, critical=Key(TRUTH, lambda _: False))


@dataclass(frozen=True, slots=True)
class RangeAnswer:
    """What was found, for the terminal, the JSON and the pictures."""

    text: str
    parts: Mapping[str, Any]
    pictures: Mapping[str, Callable[[Path], None]]

    def added(self, text: str, part: Mapping[str, Any], end: str, picture: Callable[[Path], None]) -> RangeAnswer:
        """The same with one more table, part of the JSON, and picture under the end of its name."""
        return RangeAnswer(f"{self.text}\n\n{text}", {**self.parts, **part}, {**self.pictures, end: picture})


def answer(slice: Slice, request: RangeRequest) -> RangeAnswer:
    """Compute all that is asked for.

    Raises
    ------
    PtmcadError
        Of any kind.
    """
    from ptmcad.ask import ranges
    from ptmcad.exact.ranges.strips import refuse_free_lengths
    from ptmcad.show.ranges import document, table

    known = RangeAnswer(question_of(slice), {}, {})
    if is_enclosed(slice, request):
        known = _enclosed(slice, request) if request.at else known
        known = _with_bands(known, slice, request) if request.over else known
        return _with_poses(known, slice, request)
    if request.over:
        refuse_free_lengths(slice)  # before the line is asked for, whose refusal would not say what to leave out
    digits = request.digits
    if request.at:
        found = ranges.intervals(slice, request.along, request.at)
        text, part = table.table(found, digits), document.part(found, digits)
        known = known.added(text, part, "", partial(_picture, "line", slice, found))
    if request.over:
        widths = ranges.operation_widths(slice, request.along, request.rows)
        text, part = table.width_table(widths, digits), document.part(widths, digits)
        known = known.added(text, part, "-over", partial(_picture, "over", slice, widths))
    return _with_poses(known, slice, request)


def is_enclosed(slice: Slice, request: RangeRequest) -> bool:
    """Whether the certified engine answers, as springs have free lengths."""
    from ptmcad.question.line import has_free_lengths

    if not request.at:
        return request.over and slice.has_free_lengths
    return has_free_lengths(slice, request.along, request.at)


def _with_bands(found: RangeAnswer, slice: Slice, request: RangeRequest) -> RangeAnswer:
    """The answer with the operation ranges over the other axis, where springs have free lengths."""
    from ptmcad.ask.bands import certified_widths
    from ptmcad.show.ranges import certified, document

    with ProgressBar() as progress:
        widths = certified_widths(slice, request.along, request.rows, request.digits, progress)
    text, part = certified.width_table(widths, request.digits), document.part(widths, request.digits)
    return found.added(text, part, "-over", partial(_picture, "over", slice, widths))


def _with_poses(found: RangeAnswer, slice: Slice, request: RangeRequest) -> RangeAnswer:
    """The answer with the paths of stable poses and the branches of quantities that were asked for."""

    @cache
    def line() -> SolutionsOnLine:  # a picture of the paths shows branches too: those of the same solutions
        from ptmcad.ask.branches import solutions_on_line

        return solutions_on_line(slice, request.along, request.at)

    return _with_branches(_with_paths(found, slice, request, line), slice, request, line)


def _with_paths(
    found: RangeAnswer, slice: Slice, request: RangeRequest, line: Callable[[], SolutionsOnLine]
) -> RangeAnswer:
    """The answer with the paths of stable poses, where they were asked for."""
    if request.start is None:
        return found
    from ptmcad.ask.ranges import pose_paths
    from ptmcad.show.ranges import document, table

    with ProgressBar() as progress:
        paths = pose_paths(slice, request.along, request.at, request.start, request.pose, progress)
    text, part = table.path_table(paths, min(request.digits, 10)), document.part(paths, request.digits)
    return found.added(text, part, "-path", partial(_picture, "path", slice, paths, line=line))


def _with_branches(
    found: RangeAnswer, slice: Slice, request: RangeRequest, line: Callable[[], SolutionsOnLine]
) -> RangeAnswer:
    """The answer with the branches of the quantities that were asked for."""
    if not request.quantities:
        return found
    from ptmcad.ask.branches import branch_diagram
    from ptmcad.show.ranges import branches, document

    with ProgressBar() as progress:
        diagram = branch_diagram(slice, request.along, request.at, request.quantities, progress, line())
    text, part = branches.table(diagram), document.part(diagram, request.digits)
    return found.added(text, part, "-branches", partial(_picture, "branches", slice, diagram))


def _enclosed(slice: Slice, request: RangeRequest) -> RangeAnswer:
    """The answer where springs have free lengths."""
    from ptmcad.certified.intervals import certified_intervals
    from ptmcad.show.ranges import certified, document

    line = certified_intervals(slice, request.along, request.at, request.digits)
    text = f"{question_of(slice)}\n\n{certified.table(line, request.digits)}"
    return RangeAnswer(text, document.part(line, request.digits), {})


def _picture(
    kind: str, slice: Slice, found: Any, path: Path, line: Callable[[], SolutionsOnLine] | None = None
) -> None:
    from ptmcad.show.render import ranges as pictures
    from ptmcad.show.render.printing import save

    if kind == "line":
        figure = pictures.draw_range(slice, found)
    elif kind == "over":
        figure = pictures.draw_widths(slice, found)
    elif kind == "branches":
        from ptmcad.show.render.branches import draw_branches

        figure = draw_branches(slice, found)
    else:
        figure = _paths_and_branches(slice, found, line)
    save(figure, path)


MAX_UNKNOWNS = 2
"""Of a model of which a picture of paths shows the unstable branches unasked: of others they take minutes."""


def _paths_and_branches(slice: Slice, found: Any, line: Callable[[], SolutionsOnLine] | None) -> Any:
    from ptmcad.ask.branches import branch_diagram
    from ptmcad.show.render.branches import draw_paths_and_branches
    from ptmcad.show.render.paths import draw_paths

    model = found.model
    if len(model.unknowns) > MAX_UNKNOWNS or "stable" not in model.criterion.counts:
        return draw_paths(slice, found)
    unknowns = model.sorted_unknowns
    known = None if line is None else line()
    diagram = branch_diagram(slice, found.along.name, found.at, unknowns, line=known)
    return draw_paths_and_branches(slice, found, diagram)
