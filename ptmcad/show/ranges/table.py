"""Ranges, widths and paths as text for the terminal.

Guarantee: every digit that is shown is right.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import arb, ctx

from ptmcad.answer.counts import MorseIndex
from ptmcad.answer.intervals import CertifiedIntervals, CountIntervals, End, OperationSpan, Span
from ptmcad.answer.paths import Fate, PathEnd, PathPoint, PosePath, PosePaths, Target
from ptmcad.answer.widths import CertifiedWidths, Maximum, OperationWidths, WidthRow
from ptmcad.answer.words import assignments, followed, listed, noun, sought, with_article
from ptmcad.model import Model, built_in
from ptmcad.model.work import acting
from ptmcad.show.columns import aligned
from ptmcad.show.ranges.numbers import end_text, line_head, narrowly_known, settled, width_text
from ptmcad.text.balls import ball_of, enclosure_of
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import decimal, shortest_text
from ptmcad.text.plane import PlanePolynomial

MAX_POLYNOMIAL = 60
"""Characters of a polynomial; of longer ones the degree is reported."""
_ANGLE_DIGITS = 8


def table(found: CountIntervals, digits: int = 10) -> str:
    """One row for each interval, then what happens at their ends, then the operation range."""
    name = found.along.name
    first = found.intervals[0]
    heads = {"total": "total"}
    if first.stable is not None:
        heads["stable"] = "stable"
    if first.index is not None:
        heads["index"] = _INDEX_HEADS.get(len(first.index), "index")
    lines = interval_rows(
        found, heads, lambda i: (end_text(i.low, digits), end_text(i.high, digits))
    )
    if found.changes:
        lines.append("")
        changes = [["at", f"as {name} increases", "root of"]]
        changes += [[end_text(c.at, digits), c.text, formula(c.at, name)] for c in found.changes]
        lines += aligned(changes)
    lines.append("")
    range_name = operation_name(found.model, found.working)
    if not found.operation:
        lines.append(f"{range_name}: none, {nowhere(found.model, found.working)}")
    lines += [f"{range_name}: {_range_text(i, digits)}" for i in found.operation]
    return "\n".join(lines)


def interval_rows(
    found: CountIntervals | CertifiedIntervals,
    heads: Mapping[str, str],
    ends: Callable[[Any], Iterable[str]],
) -> list[str]:
    """A line for each interval, below what is fixed.

    Parameters
    ----------
    heads : of the columns of counts, by the names of these.
    """
    rows = [["from", "to", *heads.values(), "sample"]]
    for each in found.intervals:
        counts = (_counted(name, getattr(each, name)) for name in heads)
        rows.append([*ends(each), *counts, shortest_text(each.sample)])
    return [line_head(found.along, found.at), "", *aligned(rows)]


def _counted(name: str, count: int | MorseIndex | None) -> str:
    if count is None:
        return "undecided" if name == "total" else ""
    return "-".join(map(str, count)) if isinstance(count, tuple) else str(count)


_INDEX_HEADS = {2: "min-max", 3: "min-saddle-max"}
_WORDS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")


def operation_name(model: Model, number: int) -> str:
    """What the range of so many stable solutions is called: only a mechanism operates."""
    nouns = model.nouns
    return (
        nouns.range
        if number == nouns.usual
        else nouns.range_with.format(working_text(model, number))
    )


def working_text(model: Model, number: int) -> str:
    """What there is in an operation range, such as two stable equilibria."""
    many = _WORDS[number] if number < len(_WORDS) else str(number)
    return f"{many} {sought(model, number)}"


def nowhere(model: Model, number: int) -> str:
    """Why there is no operation range."""
    return f"there {'is' if number == 1 else 'are'} nowhere {working_text(model, number)}"


def _range_text(interval: Span, digits: int) -> str:
    edges = [
        side
        for side, end in (("lower", interval.low), ("upper", interval.high))
        if isinstance(end, Fraction)
    ]
    note = ""
    if edges:
        note = (
            f" (its {edges[0]} end is the window's edge)"
            if len(edges) == 1
            else " (the whole window)"
        )
    low, high = end_text(interval.low, digits), end_text(interval.high, digits)
    return f"{low} to {high}, width {width_text(interval, digits)}{note}"


def formula(end: End, name: str) -> str:
    """The polynomial of which an end is a root, or its degree when it is long."""
    if isinstance(end, Fraction):
        return ""
    text = PlanePolynomial.of((k, 0, c) for k, c in enumerate(end.polynomial)).text((name, "_"))
    return (
        text if len(text) <= MAX_POLYNOMIAL else f"a polynomial of degree {end.degree}, in the JSON"
    )


def width_rows(
    found: OperationWidths | CertifiedWidths,
    range_name: str,
    note: Callable[[Any], str],
    cells: Callable[[Any, Any], Iterable[str]],
) -> list[str]:
    """A line for each range of each row, and what a mark at an end means, where there is one.

    Parameters
    ----------
    note : what is said of a row without a range.
    cells : of a row and one of its ranges the ends and the width.
    """
    rows = [[found.over.name, f"{range_name} from", "to", "width"]]
    for row in found.rows:
        value = shortest_text(row.value)
        rows += [[value, *cells(row, one)] for one in row.operation] or [[value, note(row), "", ""]]
    marked = any("*" in cell for cells in rows for cell in cells)
    return [*aligned(rows), *[f"* the edge of the window of {found.along.name}"] * marked]


def width_table(found: OperationWidths, digits: int = 10) -> str:
    """The operation ranges at the tabulated values, and where they are widest."""
    range_name = operation_name(found.model, found.working)

    def cells(_: WidthRow, span: OperationSpan) -> Iterator[str]:
        for end in (span.low, span.high):
            yield end_text(end, digits) + " *" * isinstance(end, Fraction)
        yield width_text(span, digits)

    lines = [
        *width_rows(found, range_name, lambda row: "degenerate" if row.remark else "none", cells),
        "",
    ]
    if not found.maxima:
        lines.append(f"widest {range_name}: none, {nowhere(found.model, found.working)}")
    for m in found.maxima:
        lines.append(f"widest {range_name}: {maximum_text(m, found.over.name, digits)}")
    return "\n".join(lines)


def maximum_text(found: Maximum, over: str, digits: int) -> str:
    """A maximum in words."""
    low, high = (
        decimal(end, up, 4) for end, up in ((found.width.low, False), (found.width.high, True))
    )
    return f"width {settled(found.width, digits) or f'from {low} to {high}'}, {found.words(over, digits)}"


def path_table(found: PosePaths, digits: int = _ANGLE_DIGITS) -> str:
    """What becomes of each pose in both directions."""
    name, model = found.along.name, found.model
    lines = []
    for path in found.paths:
        place = next(p for p in path.points if p.value == path.start)
        heights = _heights(model)
        side = f"; {_side(path, heights)} on the path" if heights else ""
        at = f"{name} = {shortest_text(path.start)}"
        lines.append(
            f"{model.nouns.pose} {path.number} at {at}: {_unknowns(place, model, digits)}{side}"
        )
        ends = (("down", path.low), ("up", path.high))
        lines += [f"  {direction}: {_end(e, found, digits)}" for direction, e in ends]
    return (
        "\n".join(lines)
        if lines
        else f"no {followed(model)} at {name} = {shortest_text(found.start)}"
    )


def _heights(model: Model) -> list[str]:
    """What the heights of the moving points are called, such as y3 of A3; none of a system."""
    own = model.name in built_in()  # whose points are numbered
    rising = () if model.drawable is None else model.drawable.rising
    return [f"y{name[1:]}" if own and name[1:].isdigit() else f"y of {name}" for name in rising]


def _side(path: PosePath, heights: Sequence[str]) -> str:
    if path.upright or path.reverse:
        return " and ".join(_signed(heights, ">" if path.upright else "<"))
    return (
        f"{', '.join(heights)} of mixed sign"
        if len(heights) > 1
        else f"{heights[0]} of either sign"
    )


def _signed(heights: Sequence[str], sign: str) -> list[str]:
    return [f"{y} {sign} 0" for y in heights]


def _end(end: PathEnd, found: PosePaths, digits: int) -> str:
    name, model = found.along.name, found.model
    at = f"{name} = {end_text(end.at, 10)}"
    if end.fate is Fate.WINDOW:
        return f"{model.criterion.adjective or 'goes on '}up to the window's edge {at}"
    if end.fate in (Fate.UNSTABLE, Fate.EXCLUDED):
        return f"{at}: {end.fate.value}"
    if end.fate is Fate.UNDECIDED:
        return f"could not be followed beyond {name} = {shortest_text(end.last.value)}, before {at}"
    what = f"{at}: {_event(end, model)}"
    if end.target is None:
        rests = (
            f"under the {acting(model, found.moved)} it may never come to rest: "
            if found.moved
            else ""
        )
        unsaid = model.criterion.no_target
        return f"{what}; {rests}{unsaid}" if unsaid else what
    target = _unknowns(end.target, model, digits)
    if end.fate is Fate.MERGE:
        return f"{what}; the pose goes on, without a snap, as {target}"
    drop = None
    if end.energy is not None and end.target_energy is not None:
        drop = settled(
            Enclosure(
                end.energy.low - end.target_energy.high, end.energy.high - end.target_energy.low
            ),
            5,
        )
    heights = _heights(model)
    kind = f" ({_posture(end.target, heights)})" if heights else ""
    lower = drop or "an undecided amount"
    snaps = (
        f"{what}; {model.nouns.whole} snaps to {target}{kind}, where the energy is lower by {lower}"
    )
    chosen = ", which of several stable ones steepest descent in floating point chose"
    return snaps + chosen * end.fallen


def _event(end: PathEnd, model: Model) -> str:
    """What becomes of the pose that was followed, and of those that it meets."""
    what = f"the {followed(model)}"
    others = [_kind(k, model) for k in end.meeting[1:]]
    left = listed([_kind(k, model) for k in end.leaving]) or "nothing"
    if not others:
        return f"{what} goes on as {left}" if end.leaving else f"{what} vanishes alone"
    if end.among:
        return f"{what} meets one or more of {listed(others)} and vanishes"
    merges = f"{what} merges with {listed(others)}"
    if not end.leaving:
        return f"fold: {merges} and both vanish" if len(others) == 1 else f"{merges} and all vanish"
    return f"{merges}, which leaves {left}"


def _kind(negative: int, model: Model) -> str:
    """A solution by its Morse index; without a potential by whether it is stable."""
    return with_article(model.criterion.ranked(negative, noun(model, 1)))


def _posture(point: Target, heights: Sequence[str]) -> str:
    """The signs of the moving points' heights, such as y3 and y4."""
    if set(point.sides) == {1}:
        return ", ".join(_signed(heights, ">"))
    if set(point.sides) == {-1}:
        return "reverse: " + ", ".join(_signed(heights, "<"))
    return (
        f"{', '.join(heights)} of mixed sign or zero"
        if len(heights) > 1
        else f"{heights[0]} near zero"
    )


def _unknowns(point: PathPoint | Target, model: Model, digits: int) -> str:
    angles = (degrees(angle, digits) for angle in point.angles)
    reals = (narrowly_known(x, digits) or UNDECIDED for x in point.reals)
    return ", ".join(assignments(model, angles, reals))


UNDECIDED = "undecided"


def degrees(angle: Enclosure, digits: int) -> str:
    """An angle in degrees, with as many digits as are settled; zero where it cannot be told from
    it.
    """
    with ctx.workprec(200):
        ball = ball_of(angle.low).union(ball_of(angle.high)) * 180 / arb.pi()
        text = narrowly_known(enclosure_of(ball), digits)
    return UNDECIDED if text is None else f"{text}°"
