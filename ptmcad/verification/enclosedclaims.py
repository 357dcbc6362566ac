"""Checks of enclosed intervals along a line on which springs have free lengths.

Guarantee: counts are those that are stored at the samples and next to both ends; with the enclosed
changes the intervals cover the window. That nothing changes between these points is not checked.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice
from ptmcad.text.numerals import approximate_text, fraction_of, shortest_text
from ptmcad.verification.certified.counted import numbers_in
from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.intervalclaims import Entry, enclosed_end
from ptmcad.verification.normalform.boxes import Unproved
from ptmcad.verification.report import Unchecked, Violation
from ptmcad.verification.solutions import map_of

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
    changes = [enclosed_end(change["at"]) for change in found["changes"]]
    known = {*changes, (axis.low, axis.low), (axis.high, axis.high)}
    intervals = [
        (enclosed_end(entry["low"]), enclosed_end(entry["high"])) for entry in found["intervals"]
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
