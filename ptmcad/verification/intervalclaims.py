"""Checks of exact intervals along a line, and of the changes between them, against the gaps between
all values at which counts can change.

Guarantee: intervals are all of those that are asked for, each as long as it can be; counts on the
sides of changes are right, and none is missing where counts differ.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import groupby, pairwise
from typing import Any

from flint import fmpz_poly

from ptmcad.answer.intervals import End, lower, upper
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.numerals import approximate_text, fraction_of, integer_of, shortest_text
from ptmcad.verification.parameterlines import LineGap, ParameterLine
from ptmcad.verification.report import Violation
from ptmcad.verification.rootcounts import roots_within


def check_intervals(
    line: ParameterLine,
    gaps: Sequence[LineGap],
    entries: Sequence[Mapping[str, Any]],
    working: int | None,
) -> None:
    """The intervals are the longest ones of equal counts between changes: all of them, or those with
    so many stable solutions, in their order.

    Raises
    ------
    Violation, NotKnown
    """
    ends = [(_end(line, entry["low"]), _end(line, entry["high"])) for entry in entries]
    for gap in gaps:
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
    runs = [
        (group[0], group[-1])
        for _, group in ((c, list(g)) for c, g in groupby(gaps, lambda gap: gap.counts))
        if working is None or group[0].working == working
    ]
    if len(runs) != len(entries):
        raise Violation(f"there are {len(runs)} intervals of equal counts, not {len(entries)}")
    samples = [line.low, *(gap.sample for gap in gaps), line.high]
    for (first, last), entry, (low, high) in zip(runs, entries, ends, strict=True):
        # between neighbouring samples is one value at which counts can change
        before = samples[gaps.index(first)]
        after = samples[gaps.index(last) + 2]
        if not (
            _is_below(low, first.sample)
            and not _is_below(low, before)
            and not _is_below(high, last.sample)
            and not _is_above(high, after)
        ):
            raise Violation(
                f"an interval said to be about {entry['sample']} is not from "
                f"{approximate_text(lower(first.low))} to {approximate_text(upper(last.high))}"
            )
        sample = fraction_of(entry["sample"])
        if not _is_below(low, sample) or _is_below(high, sample):
            raise Violation(f"the sample {entry['sample']} is not in its interval")


def check_changes(
    line: ParameterLine, gaps: Sequence[LineGap], changes: Sequence[Mapping[str, Any]]
) -> None:
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
            place = sum(not _is_below(number, gap.sample) for gap in gaps)
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


def _end(line: ParameterLine, data: Mapping[str, Any]) -> End:
    """An end of an interval, if counts can change there."""
    if "window" in data:
        if (edge := fraction_of(data["window"])) not in (line.low, line.high):
            raise Violation(f"{shortest_text(edge)} is no end of the window")
        return edge
    number, polynomial = _root(data)
    if bool(line.critical % polynomial):
        raise Violation(f"counts cannot change at the end near {float(number):.10g}")
    return number


def _root(data: Mapping[str, Any]) -> tuple[AlgebraicNumber, fmpz_poly]:
    """The only root of an irreducible polynomial between two numbers, and the polynomial."""
    polynomial = fmpz_poly(
        [integer_of(c.removeprefix("-")) * (-1 if c[:1] == "-" else 1) for c in data["polynomial"]]
    )
    number = AlgebraicNumber(
        tuple(map(int, polynomial)), fraction_of(data["low"]), fraction_of(data["high"])
    )
    if number.low > number.high:
        raise Violation(f"an end is said to be from {data['low']} to {data['high']}")
    if sum(multiplicity for _, multiplicity in polynomial.factor()[1]) != 1:
        raise Violation(f"the polynomial of an end near {float(number):.10g} is not irreducible")
    if roots_within(polynomial, from_fraction(number.low), from_fraction(number.high)) != 1:
        raise Violation(
            f"an end near {float(number):.10g} is not the only root of its polynomial there"
        )
    return number, polynomial


def _is_below(end: End, value: Fraction) -> bool:
    return end < value if isinstance(end, Fraction) else end.compare(value) < 0


def _is_above(end: End, value: Fraction) -> bool:
    return end > value if isinstance(end, Fraction) else end.compare(value) > 0
