"""What ``ptmcad range`` answers: texts, JSON and pictures of lines, of bands over the other axis,
paths and branches.

Guarantee: only the engine that a question needs is loaded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, partial
from typing import TYPE_CHECKING, Any

from ptmcad.cli.slices import question_of
from ptmcad.options import Progress
from ptmcad.question.counts import USUAL
from ptmcad.question.slice import Slice
from ptmcad.show import render

if TYPE_CHECKING:
    from ptmcad.ask.lines.diagram import SolutionsOnLine
    from ptmcad.text.codec import Codec

MAX_TEXT = 10_000


@dataclass(frozen=True, slots=True)
class RangeRequest:
    """What is asked for besides the slice.

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

    Earlier versions could be asked for critical free lengths instead (``critical``); now the
    paper's study finds them.
    """
    from ptmcad.text.codec import TRUTH, Key, line, record_of

    def made(critical: bool, **asked: Any) -> RangeRequest:
        return RangeRequest(**asked)

    return record_of(
        RangeRequest, {str: line(MAX_TEXT)}, made, critical=Key(TRUTH, lambda _: False)
    )


def answer(
    slice: Slice, request: RangeRequest, progress: Progress
) -> tuple[str, dict[str, Any], dict[str, Callable[[], Any]]]:
    """Compute all that is asked for.

    Returns
    -------
    The text for the terminal, the parts of the JSON, and the pictures by the ends of their names.

    Raises
    ------
    PtmcadError
        Of any kind.
    """
    from ptmcad.show.ranges import rangedocument

    # a table of intervals has no column of a predicate
    counted = slice if slice.count.kind.predicate is None else replace(slice, count=USUAL)
    texts, parts = [question_of(counted)], dict[str, Any]()
    pictures = dict[str, Callable[[], Any]]()
    for found, text, end, make in _answers(slice, request, progress):
        texts.append(text)
        parts |= rangedocument.part(found, request.digits)
        pictures[end] = make
    return "\n\n".join(texts), parts, pictures


def _answers(
    slice: Slice, request: RangeRequest, progress: Progress
) -> Iterator[tuple[Any, str, str, Callable[[], Any]]]:
    """Whatever is asked for, with its table, the end of its picture's name, and what draws that."""
    from ptmcad.show.ranges import linetable, pathtable

    along, at, digits = request.along, request.at, request.digits
    found: Any
    if at:
        from ptmcad.ask.lines.along import intervals

        found = intervals(slice, along, at, digits=digits)
        yield found, linetable.table(found, digits), "", partial(_drawn, "draw_range", slice, found)
    if request.over:
        from ptmcad.ask.lines.along import operation_widths

        found = operation_widths(slice, along, request.rows, digits, progress)
        text = linetable.width_table(found, digits)
        yield found, text, "-over", partial(_drawn, "draw_widths", slice, found)

    @cache
    def line() -> SolutionsOnLine:
        """A picture of the paths shows branches too: those of the same solutions."""
        from ptmcad.ask.lines.diagram import SolutionsOnLine
        from ptmcad.question.line import line_of

        return SolutionsOnLine(line_of(slice, along, at, free=True))

    if request.start is not None:
        from ptmcad.ask.lines.follower import pose_paths

        found = pose_paths(slice, along, at, request.start, request.pose, progress)
        text = pathtable.path_table(found, min(digits, 10))
        yield found, text, "-path", partial(_paths_and_branches, slice, found, line)
    if request.quantities:
        from ptmcad.ask.lines.diagram import branch_diagram

        found = branch_diagram(slice, line(), request.quantities, progress)
        text = pathtable.branch_table(found)
        yield found, text, "-branches", partial(_drawn, "draw_branches", slice, found)


def _drawn(function: str, slice: Slice, found: Any) -> Any:
    """A picture by a function of `render`, which loads matplotlib when it is named."""
    return getattr(render, function)(slice, found)


def is_enclosed(slice: Slice, request: RangeRequest) -> bool:
    """Whether the certified engine answers, as springs have free lengths."""
    from ptmcad.question.line import has_free_lengths

    if request.over and slice.has_free_lengths:
        return True
    return bool(request.at) and has_free_lengths(slice, request.along, request.at)


MAX_UNKNOWNS = 2
"""Of a model of which a picture of paths shows the unstable branches unasked: of others they take
minutes.
"""


def _paths_and_branches(slice: Slice, found: Any, line: Callable[[], SolutionsOnLine]) -> Any:
    from ptmcad.ask.lines.diagram import branch_diagram

    model = found.model
    if len(model.unknowns) > MAX_UNKNOWNS or not model.criterion.is_told:
        return render.draw_paths(slice, found)
    diagram = branch_diagram(slice, line(), model.sorted_unknowns)
    return render.draw_paths_and_branches(slice, found, diagram)
