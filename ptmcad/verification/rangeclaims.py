"""Checks of the counts along lines: the ends of intervals are values at which counts can change,
and none is missing.

Guarantee: of exact intervals that of `ptmcad.verification.parameterlines`. Of enclosed ones, with free
lengths, counts are those that are stored at the samples and next to both ends; that nothing changes
between these points is not checked.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

from flint import fmpz_poly

from ptmcad.answer.intervals import End
from ptmcad.answer.widths import Maximum
from ptmcad.options import Progress
from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.expressions import axis, constant
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.numerals import fraction_of, integer_of, shortest_text
from ptmcad.text.parsing import parse
from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.certified.parameterdomain import check_domain
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import parameters_of
from ptmcad.verification.normalform.boxes import Unproved
from ptmcad.verification.parameterclaims import check_text
from ptmcad.verification.parameterlines import NotKnown, ParameterLine, SliceLines, check_maxima
from ptmcad.verification.report import (
    Check,
    CheckProgress,
    Unchecked,
    VerifyReport,
    Violation,
    checked,
    drawn,
)
from ptmcad.verification.rootcounts import roots_within
from ptmcad.verification.solutions import map_of

_NEAR = 2**7
"""Counts of enclosed intervals are looked at so small shares of them beside both ends."""
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
    data: Mapping[str, Any],
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
    chosen = drawn(seed)
    claims = Claims(map_of(slice, ()))
    steps = [
        ("parameters as written", "expressions compared", lambda _: check_text(claims)),
        ("signs of parameters", "root counts, elimination", lambda _: check_domain(claims)),
    ]
    steps += [
        (name, method, check)
        for part, name, method, check in (
            ("line", "intervals of the line", "norms read off one fibre, signatures", _check_line),
            ("over", "intervals of the rows", "norms read off one fibre, signatures", _check_rows),
            (
                "over",
                "extremes",
                "ranges on the lines themselves",
                partial(_check_extremes, maxima=maxima),
            ),
            (
                "enclosed",
                "intervals of the enclosed line",
                "Krawczyk's test and exclusion in balls",
                _check_enclosed,
            ),
        )
        if part in data
    ]
    checks = checked((data, slice, chosen), steps, (), CheckProgress(progress))
    checks += [
        Check(name, "", None, words) for part, (name, words) in UNCHECKED.items() if part in data
    ]
    return VerifyReport(tuple(checks))


_Asked = tuple[Mapping[str, Any], Slice, str]
"""The document, its slice, and the seed."""


def _line(slice: Slice, along: Mapping[str, Any], seed: str, value: Fraction) -> ParameterLine:
    """The line along one axis at a value of the other one."""
    low, high = map(fraction_of, along["window"])
    known = {
        name: axis(0) if name == along["name"] else constant(value) for name in slice.axis_names
    }
    texts = {
        name: slice.parameters[name].to_text(slice.axis_names)
        for name in parameters_of(slice.model)
    }
    parameters = {name: parse(text, known) for name, text in texts.items()}
    return ParameterLine(slice.model, parameters, low, high, seed)


def _check_line(asked: _Asked) -> str:
    data, slice, seed = asked
    found = data["line"]
    (value,) = map(fraction_of, found["at"].values())
    try:
        _check_intervals(_line(slice, found["along"], seed, value), found["intervals"], None)
    except NotKnown as reason:
        return Unchecked(str(reason))
    return f"{len(found['intervals'])} intervals; seed {seed}"


def _check_rows(asked: _Asked) -> str:
    data, slice, seed = asked
    found, unknown = data["over"], 0
    parts = [part for row in found["rows"] for part in row["operation"]]
    working = {part["total"] if part["stable"] is None else part["stable"] for part in parts}
    if len(working) > 1:
        raise Violation(f"operation ranges have {working} solutions")
    for row in found["rows"]:
        try:
            line = _line(slice, found["along"], seed, fraction_of(row["value"]))
            _check_intervals(line, row["operation"], next(iter(working), -1))
        except NotKnown:
            unknown += 1
    if unknown:
        return Unchecked(
            f"{len(found['rows']) - unknown} rows; of {unknown} more nothing was found out"
        )
    return f"{len(found['rows'])} rows; seed {seed}"


def _check_extremes(asked: _Asked, maxima: Sequence[Maximum]) -> str:
    data, slice, seed = asked
    found = data["over"]
    if "stable" not in found:
        return Unchecked("an earlier version made it: attainment is not told")
    along, over = (
        next(a for a in slice.axes if a.name == found[key]["name"]) for key in ("along", "over")
    )
    lines = SliceLines(
        partial(_line, slice, found["along"], seed),
        partial(_line, slice, found["over"], seed),
        along,
        over,
        found["stable"],
        seed,
    )
    try:
        return check_maxima(lines, maxima)
    except NotKnown as reason:
        return Unchecked(str(reason))


def _check_intervals(
    line: ParameterLine, entries: Sequence[Mapping[str, Any]], working: int | None
) -> None:
    """The intervals are those between changes: all of them, or those with so many stable solutions.

    Raises
    ------
    Violation, NotKnown
    """
    ends = [(_end(line, entry["low"]), _end(line, entry["high"])) for entry in entries]
    for gap in line.gaps():
        inside = [
            entry
            for entry, (low, high) in zip(entries, ends, strict=True)
            if _is_below(low, gap.sample) and not _is_below(high, gap.sample)
        ]
        where, there = f"at {shortest_text(gap.sample)}", gap.counts
        if len(inside) != (working is None or gap.working == working):
            raise Violation(
                f"{len(inside)} of the intervals are {where}, where there are {there.total} solutions"
            )
        for entry in inside:
            index = None if there.index is None else [*there.index]
            if (entry["total"], entry["stable"], entry["index"]) != (
                there.total,
                there.stable,
                index,
            ):
                raise Violation(
                    f"{entry['total']} solutions are said to be {where}, where there are {there}"
                )


def _end(line: ParameterLine, data: Mapping[str, Any]) -> End:
    """An end of an interval, if counts can change there."""
    if "window" in data:
        if (edge := fraction_of(data["window"])) not in (line.low, line.high):
            raise Violation(f"{shortest_text(edge)} is no end of the window")
        return edge
    polynomial = fmpz_poly(
        [integer_of(c.removeprefix("-")) * (-1 if c[:1] == "-" else 1) for c in data["polynomial"]]
    )
    number = AlgebraicNumber(
        tuple(map(int, polynomial)), fraction_of(data["low"]), fraction_of(data["high"])
    )
    if roots_within(polynomial, from_fraction(number.low), from_fraction(number.high)) != 1:
        raise Violation(
            f"an end near {float(number):.10g} is not the only root of its polynomial there"
        )
    if polynomial.degree() < 1 or bool(line.critical % polynomial):
        raise Violation(f"counts cannot change at the end near {float(number):.10g}")
    return number


def _is_below(end: End, value: Fraction) -> bool:
    return end < value if isinstance(end, Fraction) else end.compare(value) < 0


def _check_enclosed(asked: _Asked) -> str:
    """Counts at the sample and next to both ends of each interval."""
    data, slice, _ = asked
    found, number, unknown = data["enclosed"], 0, 0
    ((other, value),) = found["at"].items()
    counting = CertifiedClaims(map_of(replace(slice, count=Count.TOTAL), ())).counting
    for entry in found["intervals"]:
        low, high = fraction_of(entry["low"]["high"]), fraction_of(entry["high"]["low"])
        near = (high - low) / _NEAR
        if not low < fraction_of(entry["sample"]) < high:
            raise Violation(f"the sample {entry['sample']} is not in its interval")
        for at in (fraction_of(entry["sample"]), low + near, high - near):
            point = (
                (at, fraction_of(value))
                if other == slice.axis_names[1]
                else (fraction_of(value), at)
            )
            try:
                there = counting.at(*point).counts
            except Unproved:
                unknown += 1
                continue
            said = (entry["total"], entry["stable"], entry["index"] and tuple(entry["index"]))
            pairs = [
                (a, b)
                for a, b in zip(said, (there.total, there.stable, there.index), strict=True)
                if a is not None
            ]
            # what is not known here, as stable solutions of loops are not, contradicts nothing
            is_known = bool(pairs) and all(b is not None for _, b in pairs)
            number, unknown = number + is_known, unknown + (not is_known)
            if any(b not in (None, a) for a, b in pairs):
                raise Violation(
                    f"(total, stable, index) {said} are said to be at {shortest_text(at)}; there are {there}"
                )
    return (
        Unchecked(f"{number} points; {unknown} were not decided") if unknown else f"{number} points"
    )
