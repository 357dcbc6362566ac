"""Checks of intervals along a line, and of the changes between them: exact ones against the gaps
between all values at which counts can change, enclosed ones, on which springs have free lengths,
point by point.

Guarantee: exact intervals are all of those that are asked for, each as long as it can be; counts on
the sides of changes are right, and none is missing where counts differ. Of enclosed ones counts are
those that are stored at the samples and next to both ends; with the enclosed changes the intervals
cover the window. That nothing changes between these points is not checked.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import groupby, pairwise
from typing import Any

from flint import fmpz_poly

from ptmcad.answer.intervals import End
from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.numerals import approximate_text, fraction_of, integer_of, shortest_text
from ptmcad.verification.certified.counted import numbers_in
from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.normalform.boxes import Unproved
from ptmcad.verification.parameterlines import LineGap, ParameterLine
from ptmcad.verification.report import Unchecked, Violation
from ptmcad.verification.rootcounts import is_alone
from ptmcad.verification.solutions import in_words, map_of

Entry = Mapping[str, Any]
"""A part of a document, as JSON has it."""


def check_intervals(
    line: ParameterLine,
    gaps: Sequence[LineGap],
    entries: Sequence[Entry],
    working: int | None,
) -> None:
    """The intervals are the longest ones of equal counts between changes: all of them, or those with
    so many stable solutions, in their order.

    Raises
    ------
    Violation, NotKnown
    """
    # ends are window's edges or critical values, so that the samples in an interval tell which it is
    ends = [(_end(line, entry["low"]), _end(line, entry["high"])) for entry in entries]
    covering: list[int] = []
    for gap in gaps:
        inside = [k for k, between in enumerate(ends) if _is_between(gap.sample, *between)]
        where, there = f"at {shortest_text(gap.sample)}", gap.counts
        if len(inside) != (working is None or gap.working == working):
            raise Violation(
                f"{len(inside)} of the intervals are {where}, where there are {there.total} solutions"
            )
        index = None if there.index is None else [*there.index]
        for entry in (entries[k] for k in inside):
            if (entry["total"], entry["stable"], entry["index"]) != (
                there.total,
                there.stable,
                index,
            ):
                raise Violation(
                    f"{entry['total']} solutions are said to be {where}, where there are {in_words(there)}"
                )
        covering += inside
    runs = [
        counts
        for counts, _ in groupby(gap.counts for gap in gaps)
        if working in (None, counts.working)
    ]
    if len(runs) != len(entries):
        raise Violation(f"there are {len(runs)} intervals of equal counts, not {len(entries)}")
    if [k for k, _ in groupby(covering)] != [*range(len(entries))]:
        raise Violation("the intervals are not in their order")
    for entry, (low, high) in zip(entries, ends, strict=True):
        if _side(low, line.low) < 0 or _side(high, line.high) > 0:
            raise Violation(f"the interval about {entry['sample']} is not in the window")
        if not _is_between(fraction_of(entry["sample"]), low, high):
            raise Violation(f"the sample {entry['sample']} is not in its interval")


def check_changes(line: ParameterLine, gaps: Sequence[LineGap], changes: Sequence[Entry]) -> None:
    """Counts on the sides of changes are right, and a change is listed where they differ.

    Raises
    ------
    Violation, NotKnown
    """
    places = []
    for change in changes:
        number, polynomial = _root(change["at"])
        sides = change["before"], change["after"]
        if not line.critical % polynomial:
            place = sum(_side(number, gap.sample) >= 0 for gap in gaps)
            true = tuple(map(_written_counts, gaps[max(place - 1, 0) : place + 1]))
            if sides != true:
                raise Violation(f"counts do not change as is said near {float(number):.10g}")
            places.append(place)
        elif sides[0] != sides[1]:  # a critical value of solutions that do not count is one, too
            raise Violation(f"counts cannot change near {float(number):.10g}")
    missing = {n for n, (a, b) in enumerate(pairwise(gaps), start=1) if a.counts != b.counts} - set(
        places
    )
    if missing or places != sorted(set(places)):
        raise Violation("a change is missing, or they are not in their order")


def _written_counts(gap: LineGap) -> list[int] | dict[str, int | None]:
    """Counts as a document has them."""
    there = gap.counts
    if there.index is not None:
        return [*there.index]
    return {"total": there.total, "stable": there.stable}


def _end(line: ParameterLine, data: Entry) -> End:
    """An end of an interval, if counts can change there."""
    if "window" in data:
        if (edge := fraction_of(data["window"])) not in (line.low, line.high):
            raise Violation(f"{shortest_text(edge)} is no end of the window")
        return edge
    number, polynomial = _root(data)
    if bool(line.critical % polynomial):
        raise Violation(f"counts cannot change at the end near {float(number):.10g}")
    return number


def _enclosed_end(data: Entry) -> tuple[Fraction, Fraction]:
    """The numbers between which an end is said to be.

    Raises
    ------
    Violation
    """
    low, high = fraction_of(data["low"]), fraction_of(data["high"])
    if low > high:
        raise Violation(f"an end is said to be from {data['low']} to {data['high']}")
    return low, high


def _root(data: Entry) -> tuple[AlgebraicNumber, fmpz_poly]:
    """The only root of an irreducible polynomial between two numbers, and the polynomial."""
    polynomial = fmpz_poly(
        [integer_of(c.removeprefix("-")) * (-1 if c[:1] == "-" else 1) for c in data["polynomial"]]
    )
    number = AlgebraicNumber(tuple(map(int, polynomial)), *_enclosed_end(data))
    if sum(multiplicity for _, multiplicity in polynomial.factor()[1]) != 1:
        raise Violation(f"the polynomial of an end near {float(number):.10g} is not irreducible")
    if not is_alone(number):
        raise Violation(
            f"an end near {float(number):.10g} is not the only root of its polynomial there"
        )
    return number, polynomial


def _side(end: End, value: Fraction) -> int:
    """The sign of an end minus a value."""
    return AlgebraicNumber.of(end).compare(value)


def _is_between(value: Fraction, low: End, high: End) -> bool:
    return _side(low, value) < 0 <= _side(high, value)


_COUNTS = ("total", "stable", "index")
_NEAR = 2**7
"""Both ends are looked at from inside, such a share of the interval away."""


def check_enclosed(found: Entry, slice: Slice) -> str:
    """Counts at the sample and next to both ends of each interval.

    Raises
    ------
    Violation
    """
    number, unknown = 0, 0
    ((other, value),) = found["at"].items()
    _check_cover(found, slice)
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
            said = {name: entry[name] for name in _COUNTS if entry[name] is not None}
            true = numbers_in(there)
            # what is not known here, as stable solutions of loops are not, contradicts nothing
            is_known = bool(said) and said.keys() <= true.keys()
            number, unknown = number + is_known, unknown + (not is_known)
            for name in said.keys() & true.keys():
                if said[name] != (list(index) if isinstance(index := true[name], tuple) else index):
                    counts = ", ".join(f"{count} {n}" for count, n in said.items())
                    raise Violation(
                        f"{counts} is said to be at {shortest_text(at)}; there are {there}"
                    )
    checked = f"{number} points"
    if unknown or not number:
        return Unchecked(f"{checked}; {unknown} were not decided")
    return checked


def _check_cover(found: Entry, slice: Slice) -> None:
    """Enclosed intervals are in order and end where changes or the window do; no part of the window
    is in neither.

    Raises
    ------
    Violation
    """
    axis = next(axis for axis in slice.axes if axis.name == found["along"]["name"])
    changes = [_enclosed_end(change["at"]) for change in found["changes"]]
    known = {*changes, (axis.low, axis.low), (axis.high, axis.high)}
    intervals = [
        (_enclosed_end(entry["low"]), _enclosed_end(entry["high"])) for entry in found["intervals"]
    ]
    for low, high in intervals:
        if low not in known or high not in known:
            raise Violation("an enclosed interval ends where nothing changes")
        if not (axis.low <= low[1] < high[0] <= axis.high):
            raise Violation("the ends of an enclosed interval are not in their order")
    for (_, end), (start, _) in pairwise(intervals):
        if end[0] > start[0] or end[1] > start[1]:
            raise Violation("enclosed intervals overlap, or are not in their order")
    reach = axis.low
    for part in sorted([*changes, *((low[1], high[0]) for low, high in intervals)]):
        if part[0] > reach:
            break
        reach = max(reach, part[1])
    if reach < axis.high:
        raise Violation(
            f"nothing is said of {axis.name} next to {approximate_text(reach)}, which is in the window"
        )
