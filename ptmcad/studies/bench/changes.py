"""Two studies of one slice compared: what became slower or faster, worse or better, was lost or gained.

Guarantee: an error is worse only if its bounds do not overlap the earlier ones. Times are compared as multiples of each
study's own floor, so that machines of different speed compare; one is slower only if its fastest run is slower than the
slowest run of the other by `MARGIN`, with the spread of both floors allowed for. That a small change is found is not
guaranteed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ptmcad.errors import ConfigError
from ptmcad.show.ranges.table import aligned
from ptmcad.studies.bench.harness import Row

MARGIN = 1.1
SINGLE_RUN_MARGIN = 1.5
"""The same where one of the two was run once only, so that its spread is not known."""
BAD = ("slower", "worse", "lost")
"""Verdicts that are no good news; the others are faster, better, gained and same."""
_COMPARED = ("wrong", "undetermined", "wrong_centres", "missed", "distance")
"""Figures, numbers or bounds, larger being worse."""


def compare(old: Row, new: Row) -> tuple[Row, ...]:
    """What changed from the old study to the new one, in the old one's order: method, setting, verdict and detail.

    Raises
    ------
    ConfigError
        When they are of different slices, or were made with different settings that figures depend on.
    """
    for key in ("slice", "seed"):
        if old[key] != new[key]:
            raise ConfigError(f"the two studies differ in {key}: {old[key]} and {new[key]}", key=key)
    before, after = ({(m["method"], m["setting"]): m for m in study["measurements"]} for study in (old, new))
    return tuple(
        {"method": place[0], "setting": place[1], "verdict": verdict, "detail": detail}
        for place in dict.fromkeys([*before, *after])
        for verdict, detail in _changes(before.get(place), old["floor"], after.get(place), new["floor"])
    )


def _changes(before: Row | None, old_floor: Row, after: Row | None, new_floor: Row) -> Iterator[tuple[str, str]]:
    old, new = (m["seconds"] if m is not None else None for m in (before, after))
    if old is None or before is None:
        if new is not None:
            why = "not in the old study" if before is None else f"before: {before['reason']}"
            yield "gained", f"{new['median']:g} s; {why}"
        return
    if new is None or after is None:
        yield "lost", "not in the new study" if after is None else after["reason"]
        return
    one, two = _bounds(before, old_floor), _bounds(after, new_floor)
    gone = (before["figures"] or {}).keys() - (after["figures"] or {}).keys()
    verdicts = [("lost", f"{count}: no error is reported any more") for count in sorted(gone)]
    ratio = (new["median"] / new_floor["median"]) / (old["median"] / old_floor["median"])
    times = (
        f"{ratio:.2f} times the time, machine allowed for ({old['median']:g} s at a floor of "
        f"{old_floor['median']:g} s, now {new['median']:g} at {new_floor['median']:g})"
    )
    for name in (name for name in one if name in two):
        (low, high), (least, most) = one[name], two[name]
        margin, words, detail = 1.0, ("worse", "better"), f"{name}: {high:g}, now {most:g}"
        if name == "time":
            margin = MARGIN if old["runs"] > 1 and new["runs"] > 1 else SINGLE_RUN_MARGIN
            words, detail = ("slower", "faster"), times
        if least > margin * high:
            verdicts.append((words[0], detail))
        elif low > margin * most:
            verdicts.append((words[1], detail))
    yield from verdicts or [("same", times)]


def _bounds(m: Row, floor: Row) -> dict[str, tuple[float, float]]:
    """What is compared of a measurement: bounds of the time in floors, and of figures of error."""
    found = {"time": (m["seconds"]["minimum"] / floor["maximum"], m["seconds"]["maximum"] / floor["minimum"])}
    figures = {
        f"{count}, {name.replace('_', ' ')}": f[name] for count, f in (m["figures"] or {}).items() for name in _COMPARED
    }
    for name, x in ({"width of area bounds": m["area_width"]} | figures).items():
        if x is not None:
            found[name] = x if isinstance(x, tuple) else (x, x)
    return found


def comparison_table(changes: Sequence[Row]) -> str:
    """A line for each change, the bad ones first, and a line that sums up."""
    ordered = sorted(changes, key=lambda c: (c["verdict"] not in BAD, c["verdict"] == "same"))
    lines = aligned([(c["verdict"], c["method"], c["setting"], c["detail"]) for c in ordered])
    tally = {verdict: sum(c["verdict"] == verdict for c in changes) for verdict in BAD}
    summary = ", ".join(f"{number} {verdict}" for verdict, number in tally.items() if number)
    return "\n".join([*lines, summary or "nothing became slower or worse beyond noise"])
