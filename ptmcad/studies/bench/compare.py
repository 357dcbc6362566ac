"""Two studies of one slice compared: what became slower or worse, beyond noise.

Guarantee: an error is worse only if its bounds do not overlap the earlier ones. Times are compared
as multiples of each study's own floor, so that machines of different speed compare; one is slower
only if its fastest run is slower than the slowest run of the other by `MARGIN`, with the spread of
both floors allowed for.

Not guaranteed: that a small change is found; a median within the spread of the earlier runs says nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Any

from ptmcad.errors import ConfigError
from ptmcad.studies.bench.harness import Times
from ptmcad.studies.bench.study import Measurement, Study
from ptmcad.studies.tables import columns

MARGIN = 1.1
SINGLE_RUN_MARGIN = 1.5
"""The same where one of the two was run once only, so that its spread is not known."""
_COMPARED = ("wrong", "undetermined", "wrong_centres", "missed", "distance")
"""Figures, numbers or bounds, larger being worse."""


class Verdict(Enum):
    """What became of a measurement."""

    SLOWER = "slower"
    FASTER = "faster"
    WORSE = "worse"
    BETTER = "better"
    LOST = "lost"
    GAINED = "gained"
    SAME = "same"


BAD = frozenset({Verdict.SLOWER, Verdict.WORSE, Verdict.LOST})


@dataclass(frozen=True, slots=True)
class Change:
    """One finding about one measurement, with the figures that show it."""

    method: str
    setting: str
    verdict: Verdict
    detail: str


def compare(old: Study, new: Study) -> tuple[Change, ...]:
    """What changed from the old study to the new one, in the old one's order.

    Raises
    ------
    ConfigError
        When they are of different slices, or were made with different settings that figures depend on.
    """
    for key in ("slice", "seed"):
        if getattr(old, key) != getattr(new, key):
            raise ConfigError(f"the two studies differ in {key}: {getattr(old, key)} and {getattr(new, key)}", key=key)
    before, after = ({(m.method, m.setting): m for m in study.measurements} for study in (old, new))
    return tuple(
        Change(*place, *found)
        for place in dict.fromkeys([*before, *after])
        for found in _changes(old.floor, before.get(place), new.floor, after.get(place))
    )


def _changes(
    old_floor: Times, before: Measurement | None, new_floor: Times, after: Measurement | None
) -> Iterator[tuple[Verdict, str]]:
    old, new = (m.seconds if m is not None else None for m in (before, after))
    if old is None or before is None:
        if new is not None:
            why = "not in the old study" if before is None else f"before: {before.reason}"
            yield Verdict.GAINED, f"{new.median:g} s; {why}"
        return
    if new is None or after is None:
        yield Verdict.LOST, "not in the new study" if after is None else after.reason
        return
    differences = list(_errors(before, after))
    yield from differences
    margin = MARGIN if old.runs > 1 and new.runs > 1 else SINGLE_RUN_MARGIN
    verdict = Verdict.SAME
    if new.minimum / new_floor.maximum > margin * old.maximum / old_floor.minimum:
        verdict = Verdict.SLOWER
    elif old.minimum / old_floor.maximum > margin * new.maximum / new_floor.minimum:
        verdict = Verdict.FASTER
    if verdict is not Verdict.SAME or not differences:
        ratio = (new.median / new_floor.median) / (old.median / old_floor.median)
        yield (
            verdict,
            f"{ratio:.2f} times the time, machine allowed for ({old.median:g} s at a floor of "
            f"{old_floor.median:g} s, now {new.median:g} at {new_floor.median:g})",
        )


def _errors(before: Measurement, after: Measurement) -> Iterator[tuple[Verdict, str]]:
    """Differences of the figures of error."""
    widths = (before.area_width, after.area_width)
    pairs: list[tuple[str, Any, Any]] = [("width of area bounds", *widths)]
    for count, f in (before.figures or {}).items():
        g = (after.figures or {}).get(count)
        if g is None:
            yield Verdict.LOST, f"{count}: no error is reported any more"
            continue
        for name in _COMPARED:
            pairs.append((f"{count}, {name.replace('_', ' ')}", getattr(f, name), getattr(g, name)))
    for name, a, b in pairs:
        if a is None or b is None:
            continue
        (low, high), (least, most) = (x if isinstance(x, tuple) else (x, x) for x in (a, b))
        if least > high or most < low:
            yield Verdict.WORSE if least > high else Verdict.BETTER, f"{name}: {high:g}, now {most:g}"


def comparison_table(changes: tuple[Change, ...]) -> str:
    """A line for each change, the bad ones first, and a line that sums up."""
    ordered = sorted(changes, key=lambda c: (c.verdict not in BAD, c.verdict is Verdict.SAME))
    lines = columns([(c.verdict.value, c.method, c.setting, c.detail) for c in ordered])
    tally = {verdict: sum(c.verdict is verdict for c in changes) for verdict in Verdict if verdict in BAD}
    summary = ", ".join(f"{number} {verdict.value}" for verdict, number in tally.items() if number)
    return "\n".join([*lines, summary or "nothing became slower or worse beyond noise"])
