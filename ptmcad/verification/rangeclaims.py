"""Checks of the counts along lines: the ends of intervals are values at which counts can change,
and none is missing.

Guarantee: of exact intervals that of `ptmcad.verification.parameterlines`; they are all, and each is
as long as it can be. Of enclosed ones, with free lengths, that of
`ptmcad.verification.intervalclaims`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

from ptmcad.answer.counts import Counts, operation_number
from ptmcad.answer.widths import Maximum
from ptmcad.options import Progress
from ptmcad.question.slice import Axis, Slice
from ptmcad.text.expressions import axis, constant
from ptmcad.text.numerals import fraction_of, shortest_text
from ptmcad.text.parsing import parse
from ptmcad.verification.certified.parameterdomain import check_domain
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import parameters_of
from ptmcad.verification.intervalclaims import (
    Entry,
    check_changes,
    check_enclosed,
    check_intervals,
)
from ptmcad.verification.parameterclaims import check_text
from ptmcad.verification.parameterlines import (
    ParameterLine,
    SliceLines,
    check_maxima,
    ranges_in,
)
from ptmcad.verification.report import (
    Check,
    CheckProgress,
    NotKnown,
    Unchecked,
    VerifyReport,
    Violation,
    checked,
    drawn,
)
from ptmcad.verification.solutions import map_of

UNCHECKED = {
    "path": ("paths", "that poses are joined as it is said, and where a mechanism snaps to"),
    "critical": ("critical free lengths", "that they are all"),
    "branches": ("branches", "the points of the curves"),
    "enclosed": (
        "changes",
        "that nothing changes between the points that were looked at, and which curves are met",
    ),
    "bands": ("bands", "the ranges at each value of the other axis"),
}


def verify_range(
    data: Entry,
    slice: Slice,
    progress: Progress | None = None,
    maxima: Sequence[Maximum] = (),
    seed: int | None = None,
) -> VerifyReport:
    """Check the document of ``ptmcad range`` without the code that made it.

    Parameters
    ----------
    slice : of which the document is.
    maxima : where it says that ranges over the other axis are longest.
    seed : of the random points of lines; a fresh one when None.
    """
    norms, balls = "norms read off one fibre, signatures", "Krawczyk's test and exclusion in balls"
    steps = (
        ("request", "parameters as written", "expressions compared", _check_request),
        ("request", "signs of parameters", "root counts, elimination", _check_signs),
        ("line", "intervals of the line", norms, _check_line),
        ("over", "intervals of the rows", norms, _check_rows),
        ("over", "extremes", "ranges on the lines themselves", _check_extremes),
        ("enclosed", "intervals of the enclosed line", balls, _check_enclosed_line),
    )
    asked = _AskedRange(data, slice, maxima, drawn(seed))
    chosen = [step[1:] for step in steps if step[0] in data]
    checks = checked(asked, chosen, (), CheckProgress(progress))
    checks += [
        Check(name, "", None, words) for part, (name, words) in UNCHECKED.items() if part in data
    ]
    return VerifyReport(tuple(checks))


@dataclass(frozen=True, slots=True)
class _AskedRange:
    """The document, its slice, where it says that ranges are longest, and the seed."""

    data: Entry
    slice: Slice
    maxima: Sequence[Maximum]
    seed: str

    def line(self, along: Entry, value: Fraction) -> ParameterLine:
        """The line along one axis at a value of the other one."""
        slice, (low, high) = self.slice, map(fraction_of, along["window"])
        known = {
            name: axis(0) if name == along["name"] else constant(value) for name in slice.axis_names
        }
        texts = {
            name: slice.parameters[name].to_text(slice.axis_names)
            for name in parameters_of(slice.model)
        }
        parameters = {name: parse(text, known) for name, text in texts.items()}
        return ParameterLine(slice.model, parameters, low, high, self.seed)


def _check_request(asked: _AskedRange) -> str:
    _check_axes(asked.data, asked.slice)
    return check_text(Claims(map_of(asked.slice, ())))


def _check_signs(asked: _AskedRange) -> str:
    return check_domain(Claims(map_of(asked.slice, ())))


def _check_axes(data: Entry, slice: Slice) -> None:
    """Each part is along an axis of the slice over its whole window, as it was asked for.

    Raises
    ------
    Violation
    """
    request = data["request"]
    axes = {axis.name: axis for axis in slice.axes}
    along = request["along"]
    if along not in axes:
        raise Violation(f"{along} is no axis of the slice")
    other = next(name for name in axes if name != along)
    if request["at"].keys() - {other}:
        raise Violation(f"a value of {other} alone is asked for, not {', '.join(request['at'])}")
    asked = {name: fraction_of(value) for name, value in request["at"].items()}
    for key, found in data.items():
        if key in ("over", "bands"):
            _check_axis(key, "over", found["over"], axes[other])
            number = request["rows"]
            values = [axes[other].at(Fraction(k, number + 1)) for k in range(1, number + 1)]
            if [fraction_of(row["value"]) for row in found["rows"]] != values:
                raise Violation(f"{key}: rows are not at {number} equal distances")
        elif key in ("line", "enclosed", "path", "branches"):
            at = {name: fraction_of(value) for name, value in found["at"].items()}
            if not at or at != asked:
                raise Violation(f"{key}: it is at another value than was asked for")
        if key in ("over", "bands", "line", "enclosed", "path"):
            _check_axis(key, "along", found["along"], axes[along])
        elif key == "branches" and found["along"] != along:
            raise Violation(f"{key}: they are along {found['along']}, not {along}")
    if request.get("critical"):  # free lengths instead, which earlier versions could find
        return
    for is_asked, kinds in ((asked, {"line", "enclosed"}), (request["over"], {"over", "bands"})):
        if is_asked and not kinds & data.keys():
            raise Violation(f"there is no answer {' or '.join(sorted(kinds))}, which was asked for")


def _check_axis(key: str, direction: str, found: Entry, axis: Axis) -> None:
    low, high = map(fraction_of, found["window"])
    if (found["name"], low, high) != (axis.name, axis.low, axis.high):
        raise Violation(f"{key}: {direction} is not the axis {axis} of the slice")


def _check_line(asked: _AskedRange) -> str:
    found = asked.data["line"]
    (value,) = map(fraction_of, found["at"].values())
    line = asked.line(found["along"], value)
    gaps = line.gaps()
    check_intervals(line, gaps, found["intervals"], None)
    check_changes(line, gaps, found["changes"])
    return f"{len(found['intervals'])} intervals; seed {asked.seed}"


def _check_enclosed_line(asked: _AskedRange) -> str:
    return check_enclosed(asked.data["enclosed"], asked.slice)


def _check_rows(asked: _AskedRange) -> str:
    found, unknown = asked.data["over"], 0
    # what earlier versions do not say is the number of the paper's mechanism, or that of all parts
    parts = [part for row in found["rows"] for part in row["operation"]]
    working = found.get("stable", next(map(_working, parts), 2))
    longest = max((m.width.high for m in asked.maxima), default=Fraction(0))
    counts: list[Counts] = []
    for row in found["rows"]:
        value = fraction_of(row["value"])
        line = asked.line(found["along"], value)
        try:
            gaps = line.gaps()
        except NotKnown:
            unknown += 1
            continue
        check_intervals(line, gaps, row["operation"], working)
        counts += [gap.counts for gap in gaps]
        if any(span.width.low > longest for span in ranges_in(gaps, working)):
            where = f"{found['over']['name']} = {shortest_text(value)}"
            raise Violation(f"at {where} there is a longer range than the longest one")
    extent = f"{len(found['rows']) - unknown} rows; seed {asked.seed}"
    if unknown:
        extent = f"{extent}; of {unknown} more nothing was found out"
    if "stable" in found and not _occurs(asked, working, counts):
        return Unchecked(f"{extent}; nor that {working} is the greatest number")
    return Unchecked(extent) if unknown else extent


def _working(part: Entry) -> int:
    return int(part["total"] if part["stable"] is None else part["stable"])


def _occurs(asked: _AskedRange, working: int, counts: Sequence[Counts]) -> bool:
    """Whether the claimed number of an operation range was found on a row, or next to where ranges
    are longest; the least that is asked for need not be anywhere.

    Raises
    ------
    Violation
        When it is not the greatest one that was found, or is nowhere.
    """
    most, least = (operation_number(asked.slice.model, there) for there in (counts, ()))
    if most > working:
        raise Violation(f"operation ranges are said to have {working}; there are {most} solutions")
    if not asked.maxima and working != least:
        raise Violation(f"there is no range with {working} solutions, so they are not the greatest")
    if working == most:
        return True
    for m in asked.maxima:
        line = asked.line(asked.data["over"]["along"], m.at.center)
        try:
            if any(gap.working == working for gap in line.gaps()):
                return True
        except NotKnown:
            continue
    return False


def _check_extremes(asked: _AskedRange) -> str:
    found = asked.data["over"]
    if "stable" not in found:
        return Unchecked("an earlier version made it: attainment is not stated")
    along, over = (
        next(a for a in asked.slice.axes if a.name == found[key]["name"])
        for key in ("along", "over")
    )
    lines = SliceLines(
        partial(asked.line, found["along"]),
        partial(asked.line, found["over"]),
        along,
        over,
        found["stable"],
        asked.seed,
    )
    return check_maxima(lines, asked.maxima)
