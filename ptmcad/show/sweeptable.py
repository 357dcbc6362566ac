"""A sweep as a table: a screen of text, CSV, rows of a data frame.

Guarantee: the CSV is the sweep's canonical form, ordered by member: it is the same text whatever
the order in which members were computed, the processes or the interruptions. What differs between
runs, seconds and attempts, is not in it. Numbers are exact, or decimals that bound from outside;
cells that begin as a spreadsheet's formula would are texts of this program's, but for errors, which
are quoted with an apostrophe then.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from typing import Any

from ptmcad.answer.sweep import Bounds, CountedArea, Member, State, Sweep
from ptmcad.show import data
from ptmcad.show.table import aligned, in_order
from ptmcad.text.numerals import fraction_of, shortest_text

Row = dict[str, Any]
_FIRST = ("member", "state", "status", "same_as", "cells", "regions", "undetermined")
_LAST = (
    "along", "width_low", "width_high", "at_low", "at_high", "attainment", "proof", "remark", "error", "file", "digest",
)  # fmt: skip
_SHOWN = 12
"""Members on a screen; half of them are the first ones, and half the last."""
_WORDS = {
    State.DONE: "done",
    State.REFUSED: "refused, as no map of these values is possible",
    State.FAILED: "failed",
    State.WAITING: "waiting",
}


def table(sweep: Sweep) -> str:
    """One screen: what has become of the members, and some of them."""
    states = "; ".join(f"{number} {_WORDS[state]}" for state, number in sweep.states.items())
    lines = [f"sweep {sweep.name} over {', '.join(sweep.names)}: {len(sweep)} members, {states}"]
    shown, left_out = _some(sweep, len(sweep))
    if not shown:
        return lines[0]
    head = [*sweep.names, "regions", "areas", "widest range"]
    rows = [head, *(_cells(sweep, member) for member in shown)]
    if left_out:
        rows.insert(1 + _SHOWN // 2, ["…"] + [""] * (len(head) - 1))
    return "\n".join([*lines, *aligned(rows)])


def _some(members: Iterable[Member], number: int) -> tuple[list[Member], bool]:
    """The first and the last members, and whether there are others between."""
    few = number <= _SHOWN
    kept = [m for m in members if few or m.number < _SHOWN // 2 or m.number >= number - _SHOWN // 2]
    return kept, not few


def _cells(sweep: Sweep, member: Member) -> list[str]:
    values = [shortest_text(fraction_of(member.parameters[name])) for name in sweep.names]
    found = member.summary
    if found is None:
        return [*values, member.state.value, member.error[:60], ""]
    areas = "; ".join(
        f"{area.count}: {_rounded(area.area)}" for area in found.areas if area.area[0]
    )
    widest = ""
    if found.widest is not None and found.widest.width is not None:
        widest = f"{_rounded(found.widest.width)}, {found.widest.attainment}"
    return [*values, str(found.regions), areas, widest]


def _rounded(bounds: Bounds) -> str:
    return f"{float(middle(bounds)):.4g}"


def middle(bounds: Bounds) -> Fraction:
    """The middle of two bounds."""
    return (fraction_of(bounds[0]) + fraction_of(bounds[1])) / 2


def csv_text(sweep: Sweep) -> str:
    """All members as CSV, in their order: the same text however the sweep was computed."""
    counts = counts_in(sweep)
    return data.csv_text((row(sweep, member, counts) for member in sweep), columns(sweep, counts))


def counts_in(members: Iterable[Member]) -> tuple[str, ...]:
    """The counts of regions that occur in any member, in increasing order."""
    found = {area.count for member in members if member.summary for area in member.summary.areas}
    return tuple(sorted(found, key=in_order))


def columns(sweep: Sweep, counts: Iterable[str]) -> list[str]:
    """The names of the columns."""
    by_count = [f"{what}_{count}{end}" for count in counts for what, end in _BY_COUNT]
    return [_FIRST[0], *parameter_columns(sweep).values(), *_FIRST[1:], *by_count, *_LAST]


_BY_COUNT = (("regions", ""), ("area", "_low"), ("area", "_high"))


def parameter_columns(sweep: Sweep) -> dict[str, str]:
    """The columns of what is swept: the names, with an underscore where the table has such a column
    already.
    """
    own = {*_FIRST, *_LAST, "seconds", "attempts"}
    return {
        name: f"{name}_" if name in own or name.startswith(("area_", "regions_")) else name
        for name in sweep.names
    }


def row(sweep: Sweep, member: Member, counts: Iterable[str]) -> Row:
    """A member's cells by the names of their columns."""
    found = member.summary
    cells: Row = {
        "member": member.number, "state": member.state.value, "same_as": member.same_as,
        "error": _harmless(member.error), "file": member.file, "digest": member.digest,
        **{column: member.parameters[name] for name, column in parameter_columns(sweep).items()},
    }  # fmt: skip
    if found is None:
        return cells
    cells |= {name: getattr(found, name) for name in ("status", "cells", "regions", "undetermined")}
    areas = {area.count: area for area in found.areas}
    for count in counts:
        area = areas.get(count, CountedArea(count, 0, ("0", "0")))
        own = (area.regions, *area.area)
        cells |= {f"{what}_{count}{end}": n for (what, end), n in zip(_BY_COUNT, own, strict=True)}
    if (widest := found.widest) is not None:
        low, high = widest.width or ("", "")
        at_low, at_high = widest.places[0] if widest.places else ("", "")
        cells |= {
            "along": widest.along, "width_low": low, "width_high": high, "at_low": at_low, "at_high": at_high,
            "attainment": "" if widest.width is None else widest.attainment, "proof": widest.proof,
            "remark": _harmless(widest.remark),
        }  # fmt: skip
    return cells


def _harmless(text: str) -> str:
    """A text that no spreadsheet takes for a formula."""
    return f"'{text}" if text[:1] in ("=", "+", "-", "@") else text


def frame_rows(sweep: Sweep) -> Iterator[Row]:
    """Rows with numbers as floats, and what differs between runs."""
    counts = counts_in(sweep)
    exact = {"undetermined", *parameter_columns(sweep).values()}
    exact |= {name for name in columns(sweep, counts) if name.endswith(("_low", "_high"))}
    for member in sweep:
        cells = row(sweep, member, counts)
        floats = {
            name: float(fraction_of(cells[name])) if cells.get(name) else None for name in exact
        }
        yield {**cells, **floats, "seconds": member.seconds, "attempts": member.attempts}
