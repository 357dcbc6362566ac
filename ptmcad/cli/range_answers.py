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

    def added(
        self, text: str, found: Any, digits: int, end: str = "", draw: Callable[[], Any] | None = None
    ) -> RangeAnswer:
        """The same with one more table, part of the JSON and, where it is drawn, picture under the end of its name."""
        from ptmcad.show.ranges.document import part

        pictures = dict(self.pictures)
        if draw is not None:
            pictures[end] = partial(_save, draw)
        return RangeAnswer(f"{self.text}\n\n{text}", {**self.parts, **part(found, digits)}, pictures)


def _save(draw: Callable[[], Any], path: Path) -> None:
    from ptmcad.show.render.printing import save

    save(draw(), path)


def answer(slice: Slice, request: RangeRequest) -> RangeAnswer:
    """Compute all that is asked for.

    Raises
    ------
    PtmcadError
        Of any kind.
    """
    known, enclosed = RangeAnswer(question_of(slice), {}, {}), is_enclosed(slice, request)
    if request.over and not enclosed:
        from ptmcad.exact.ranges.strips import refuse_free_lengths

        refuse_free_lengths(slice)  # before the line is asked for, whose refusal would not say what to leave out
    if request.at:
        known = (_enclosed if enclosed else _with_line)(known, slice, request)
    if request.over:
        known = (_with_bands if enclosed else _with_widths)(known, slice, request)
    return _with_poses(known, slice, request)


def _with_line(found: RangeAnswer, slice: Slice, request: RangeRequest) -> RangeAnswer:
    """The answer with the intervals along the line."""
    from ptmcad.ask.ranges import intervals
    from ptmcad.show.ranges.table import table

    line = intervals(slice, request.along, request.at)

    def draw() -> Any:
        from ptmcad.show.render.ranges import draw_range

        return draw_range(slice, line)

    return found.added(table(line, request.digits), line, request.digits, "", draw)


def _with_widths(found: RangeAnswer, slice: Slice, request: RangeRequest) -> RangeAnswer:
    """The answer with the operation ranges over the other axis."""
    from ptmcad.ask.ranges import operation_widths
    from ptmcad.show.ranges.table import width_table

    widths = operation_widths(slice, request.along, request.rows)
    text = width_table(widths, request.digits)
    return found.added(text, widths, request.digits, "-over", partial(_draw_widths, slice, widths))


def _draw_widths(slice: Slice, found: Any) -> Any:
    from ptmcad.show.render.ranges import draw_widths

    return draw_widths(slice, found)


def is_enclosed(slice: Slice, request: RangeRequest) -> bool:
    """Whether the certified engine answers, as springs have free lengths."""
    from ptmcad.question.line import has_free_lengths

    if not request.at:
        return request.over and slice.has_free_lengths
    return has_free_lengths(slice, request.along, request.at)


def _with_bands(found: RangeAnswer, slice: Slice, request: RangeRequest) -> RangeAnswer:
    """The answer with the operation ranges over the other axis, where springs have free lengths."""
    from ptmcad.ask.bands import certified_widths
    from ptmcad.show.ranges.certified import width_table

    with ProgressBar() as progress:
        widths = certified_widths(slice, request.along, request.rows, request.digits, progress)
    text = width_table(widths, request.digits)
    return found.added(text, widths, request.digits, "-over", partial(_draw_widths, slice, widths))


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
    from ptmcad.show.ranges.table import path_table

    with ProgressBar() as progress:
        paths = pose_paths(slice, request.along, request.at, request.start, request.pose, progress)
    text = path_table(paths, min(request.digits, 10))
    return found.added(text, paths, request.digits, "-path", partial(_draw_paths, slice, paths, line))


def _with_branches(
    found: RangeAnswer, slice: Slice, request: RangeRequest, line: Callable[[], SolutionsOnLine]
) -> RangeAnswer:
    """The answer with the branches of the quantities that were asked for."""
    if not request.quantities:
        return found
    from ptmcad.ask.branches import branch_diagram
    from ptmcad.show.ranges.branches import table

    with ProgressBar() as progress:
        diagram = branch_diagram(slice, request.along, request.at, request.quantities, progress, line())

    def draw() -> Any:
        from ptmcad.show.render.branches import draw_branches

        return draw_branches(slice, diagram)

    return found.added(table(diagram), diagram, request.digits, "-branches", draw)


def _enclosed(found: RangeAnswer, slice: Slice, request: RangeRequest) -> RangeAnswer:
    """The answer with the intervals along the line, where springs have free lengths."""
    from ptmcad.certified.intervals import certified_intervals
    from ptmcad.show.ranges.certified import table

    line = certified_intervals(slice, request.along, request.at, request.digits)
    return found.added(table(line, request.digits), line, request.digits)


MAX_UNKNOWNS = 2
"""Of a model of which a picture of paths shows the unstable branches unasked: of others they take minutes."""


def _draw_paths(slice: Slice, found: Any, line: Callable[[], SolutionsOnLine]) -> Any:
    """The paths, and behind them the branches that no path follows."""
    from ptmcad.ask.branches import branch_diagram
    from ptmcad.show.render.branches import draw_paths_and_branches
    from ptmcad.show.render.paths import draw_paths

    model = found.model
    if len(model.unknowns) > MAX_UNKNOWNS or not model.criterion.is_told:
        return draw_paths(slice, found)
    unknowns = (*model.angles, *model.reals)
    diagram = branch_diagram(slice, found.along.name, found.at, unknowns, line=line())
    return draw_paths_and_branches(slice, found, diagram)
