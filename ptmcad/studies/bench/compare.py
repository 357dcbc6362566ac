"""Two studies of one slice compared: what became slower or worse, beyond noise.

Guarantee: figures of error are compared as they are, because they are the same in every run of the same program. Times
are compared as multiples of each study's own floor, so that machines of different speed compare; one is slower only if
its fastest run is slower than the slowest run of the other by `MARGIN`, with the spread of both floors allowed for.

Not guaranteed: that a small change is found; a median within the spread of the earlier runs says nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

from ptmcad.errors import ConfigError
from ptmcad.studies.bench.harness import Times
from ptmcad.studies.bench.study import Figures, Measurement, Study
from ptmcad.studies.tables import columns

MARGIN = 1.1
SINGLE_RUN_MARGIN = 1.5
"""The same where one of the two was run once only, so that its spread is not known."""


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
    before = {(m.method, m.setting): m for m in old.measurements}
    after = {(m.method, m.setting): m for m in new.measurements}
    found: list[Change] = []
    for place, m in before.items():
        found += _changes(old, new, m, after.get(place))
    for place, m in after.items():
        if place not in before and m.seconds is not None:
            found.append(Change(*place, Verdict.GAINED, "not in the old study"))
    return tuple(found)


def _changes(old: Study, new: Study, before: Measurement, after: Measurement | None) -> Iterator[Change]:
    place = (before.method, before.setting)
    if before.seconds is None:
        if after is not None and after.seconds is not None:
            yield Change(*place, Verdict.GAINED, f"{after.seconds.median:g} s; before: {before.reason}")
        return
    if after is None or after.seconds is None:
        yield Change(*place, Verdict.LOST, "not in the new study" if after is None else after.reason)
        return
    differences = list(_worse(before, after))
    yield from differences
    verdict, ratio = _time(old.floor, before.seconds, new.floor, after.seconds)
    detail = (
        f"{ratio:.2f} times the time, machine allowed for ({before.seconds.median:g} s at a floor of "
        f"{old.floor.median:g} s, now {after.seconds.median:g} at {new.floor.median:g})"
    )
    if verdict is not Verdict.SAME or not differences:
        yield Change(*place, verdict, detail)


def _time(old_floor: Times, before: Times, new_floor: Times, after: Times) -> tuple[Verdict, float]:
    """The verdict, and the ratio of medians over their floors."""
    margin = MARGIN if before.runs > 1 and after.runs > 1 else SINGLE_RUN_MARGIN
    ratio = (after.median / new_floor.median) / (before.median / old_floor.median)
    if after.minimum / new_floor.maximum > margin * before.maximum / old_floor.minimum:
        return Verdict.SLOWER, ratio
    if before.minimum / old_floor.maximum > margin * after.maximum / new_floor.minimum:
        return Verdict.FASTER, ratio
    return Verdict.SAME, ratio


def _worse(before: Measurement, after: Measurement) -> Iterator[Change]:
    """Differences of the figures of error."""
    place = (before.method, before.setting)
    old, new = before.figures or {}, after.figures or {}
    for count, f in old.items():
        if count not in new:
            yield Change(*place, Verdict.LOST, f"{count}: no error is reported any more")
            continue
        for name, a, b in _pairs(f, new[count]):
            if a != b:
                yield Change(*place, Verdict.WORSE if b > a else Verdict.BETTER, f"{count}, {name}: {a:g}, now {b:g}")
    if before.area_width is not None and after.area_width is not None and before.area_width != after.area_width:
        worse = after.area_width > before.area_width
        yield Change(*place, Verdict.WORSE if worse else Verdict.BETTER,
                     f"width of area bounds: {before.area_width:g}, now {after.area_width:g}")  # fmt: skip


def _pairs(old: Figures, new: Figures) -> Iterator[tuple[str, float, float]]:
    """Figures that both have, larger being worse."""
    yield "wrong share", old.wrong[1], new.wrong[1]
    yield "undetermined share", old.undetermined, new.undetermined
    for name, a, b in (
        ("wrong centres", old.wrong_centres, new.wrong_centres),
        ("missed regions", old.missed, new.missed),
    ):
        if a is not None and b is not None:
            yield name, a, b
    if old.distance is not None and new.distance is not None:
        yield "distance of the boundary", old.distance[1], new.distance[1]


def comparison_table(changes: tuple[Change, ...]) -> str:
    """A line for each change, the bad ones first, and a line that sums up."""
    ordered = sorted(changes, key=lambda c: (c.verdict not in BAD, c.verdict is Verdict.SAME))
    lines = columns([(c.verdict.value, c.method, c.setting, c.detail) for c in ordered])
    bad = [c for c in changes if c.verdict in BAD]
    tally = {v: sum(c.verdict is v for c in bad) for v in (Verdict.SLOWER, Verdict.WORSE, Verdict.LOST)}
    summary = ", ".join(f"{number} {verdict.value}" for verdict, number in tally.items() if number)
    return "\n".join([*lines, summary or "nothing became slower or worse beyond noise"])
