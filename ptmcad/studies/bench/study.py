"""A study: error against run time of several methods on one slice, as rows that are stored, read back and compared.

Guarantee: figures of error are rounded outwards, so that bounds stay bounds; everything but times,
memory and the machine is the same whenever the study is made again with the same seed.
`study_of(write_study(s))` equals s; a file that is not such a document is refused with the place
of the fault. ``docs/bench.schema.json`` is its schema, and says what each key means.

Of two studies an error is worse only if its bounds do not overlap the earlier ones. Times are compared
as multiples of each study's own floor, so that machines of different speed compare; one is slower
only if its fastest run is slower than the slowest run of the other by `MARGIN`, with the spread of
both floors allowed for.

Not guaranteed: that a small change is found; a median within the spread of the earlier runs says nothing.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Sequence
from io import StringIO
from pathlib import Path
from typing import Any

from ptmcad.errors import ConfigError
from ptmcad.studies.bench.error import Figures
from ptmcad.studies.bench.harness import Row
from ptmcad.studies.tables import columns
from ptmcad.text.codec import TEXT, TRUTH, Codec, line, listed, named, optional, record
from ptmcad.text.node import Node
from ptmcad.text.textfile import read_as

FORMAT = "ptmcad-bench/1"
MAX_BYTES = 10_000_000
MAX_COUNTED = 10**12
SEEN_SHARE = 0.99
"""A grid sees a region when it shows this share of it, at least, with its count."""
MARGIN = 1.1
SINGLE_RUN_MARGIN = 1.5
"""The same where one of the two was run once only, so that its spread is not known."""
BAD = ("slower", "worse", "lost")
"""Verdicts that are no good news; the others are faster, better, gained and same."""
_COMPARED = ("wrong", "undetermined", "wrong_centres", "missed", "distance")
"""Figures, numbers or bounds, larger being worse."""
_COLUMNS = (
    "slice", "method", "setting", "seconds_median", "seconds_min", "seconds_max", "runs", "computing_median",
    "peak_mib", "count", "wrong_low", "wrong_high", "undetermined", "wrong_centres", "regions", "missed",
    "faintest_low", "faintest_high", "distance_low", "distance_high", "area_width", "reason",
)  # fmt: skip


def measurement(
    method: str,
    setting: str,
    seconds: Row | None = None,
    computing: Row | None = None,
    peak: float | None = None,
    reason: str = "",
    note: str = "",
    figures: dict[str, Figures] | None = None,
    area_width: float | None = None,
) -> Row:
    """The row of one method at one setting.

    Parameters
    ----------
    seconds : of whole processes, start-up included; None when it was not run to its end.
    computing : of the computation in them, where the process reports them.
    peak : largest resident set in MiB.
    reason : why there are no times; empty when there are.
    note : what the figures rest on, where it is not a measurement of ours.
    figures : by count.
    area_width : of the widest bounds of the area of all points with one count, as a share of the window.
    """
    return {
        "method": method, "setting": setting, "seconds": seconds, "computing": computing, "peak": peak,
        "reason": reason, "note": note, "figures": figures, "area_width": area_width,
    }  # fmt: skip


def grid_of(m: Row) -> int | None:
    """Pixels along each side, for a grid."""
    label, _, number = m["setting"].partition(" = ")
    return int(number) if label == "N" else None


def main_figures(m: Row) -> Figures | None:
    """The figures for the finest count that the method gives."""
    found = m["figures"] or {}
    finest = ("index", "total", "stable", "admissible")
    return next((found[count] for count in finest if count in found), None)


def smallest_grid(study: Row, method: str, count: str, seen: bool) -> int | None:
    """The smallest grid that finds every region of a count, or that sees every one; None when none of them does.

    Parameters
    ----------
    seen : ask for grids that see every region (see `SEEN_SHARE`), and not just find some pixel of it.
    """
    fit = []
    for m in study["measurements"]:
        n, f = grid_of(m), (m["figures"] or {}).get(count)
        if m["method"] == method and n is not None and f is not None:
            shown = f["faintest"] is not None and f["faintest"][0] >= SEEN_SHARE
            if shown if seen else f["missed"] == 0:
                fit.append(n)
    return min(fit, default=None)


def write_study(study: Row) -> str:
    """The study as JSON text."""
    return json.dumps(study, indent=1, ensure_ascii=False) + "\n"


def write_table(study: Row) -> str:
    """The study as CSV, one row for each measurement and count."""
    text = StringIO()
    table = csv.DictWriter(text, _COLUMNS, restval=None, extrasaction="ignore", lineterminator="\n")
    table.writeheader()
    for m in study["measurements"]:
        row = {**m, "slice": study["slice"], "peak_mib": m["peak"]}
        row |= {f"seconds_{name[:3] if name != 'median' else name}": x for name, x in (m["seconds"] or {}).items()}
        row |= {"runs": row.pop("seconds_run", None), "computing_median": (m["computing"] or {}).get("median")}
        for count, f in (m["figures"] or {None: {}}).items():
            bounds = {
                f"{name}_{end}": x
                for name in ("wrong", "faintest", "distance")
                for end, x in zip(("low", "high"), f.get(name) or (), strict=False)
            }
            table.writerow({**row, **f, **bounds, "count": count})
    return text.getvalue()


def read_study(path: Path) -> Row:
    """Read a study's JSON file.

    Raises
    ------
    ConfigError
        When the file is missing or is no such document.
    """
    return read_as(path, MAX_BYTES, FORMAT, study_of)


def study_of(text: str) -> Row:
    """The study that `write_study` wrote.

    Raises
    ------
    ValueError
        When the text is not such a document; the message names the place.
    """
    node = Node(json.loads(text), "")
    if (found := node.mapping().get("format")) is not None and found.text() != FORMAT:
        raise found.fault(f"is not {FORMAT!r}")
    return _STUDY.read(node)


def _whole(node: Node) -> int:
    """Of pixels or regions, a seed: what nobody can count is not one."""
    if type(node.value) is not int:
        raise node.fault("is not a whole number")
    if node.value > MAX_COUNTED:
        raise node.fault(f"is more than {MAX_COUNTED}")
    return node.value


def _positive(node: Node) -> float:
    seconds = node.number()
    if not seconds > 0:
        raise node.fault("is not a positive number of seconds")
    return seconds


_WHOLE: Codec[int] = Codec(lambda value: value, _whole)
_NUMBER: Codec[float] = Codec(lambda value: value, Node.number)
_SECONDS: Codec[float] = Codec(lambda value: value, _positive)
_PAIR = listed(_NUMBER, 2)
_TIMES: Codec[Row] = record(dict, runs=_WHOLE, median=_SECONDS, minimum=_SECONDS, maximum=_SECONDS)
_FIGURES: Codec[Figures] = record(
    dict, wrong=_PAIR, undetermined=_NUMBER, wrong_centres=optional(_WHOLE), regions=optional(_WHOLE),
    missed=optional(_WHOLE), faintest=optional(_PAIR), distance=optional(_PAIR),
)  # fmt: skip
_MEASUREMENT: Codec[Row] = record(
    dict, method=line(60), setting=line(60), seconds=optional(_TIMES), computing=optional(_TIMES),
    peak=optional(_NUMBER), reason=line(1000), note=line(1000), figures=optional(named(_FIGURES)),
    area_width=optional(_NUMBER),
)  # fmt: skip
_STUDY: Codec[Row] = record(
    dict, format=TEXT, slice=line(200), heading=line(1000), machine=named(line(300)), versions=named(line(300)),
    seed=_WHOLE, rounds=_WHOLE, time_limit=_NUMBER, quick=TRUTH, verified=optional(TRUTH), floor=_TIMES,
    measurements=listed(_MEASUREMENT),
)  # fmt: skip


# ------------------------------------------------------------------------------------------------------- two compared


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
        for verdict, detail in _changes(old["floor"], before.get(place), new["floor"], after.get(place))
    )


def _changes(old_floor: Row, before: Row | None, new_floor: Row, after: Row | None) -> Iterator[tuple[str, str]]:
    old, new = (m["seconds"] if m is not None else None for m in (before, after))
    if old is None or before is None:
        if new is not None:
            why = "not in the old study" if before is None else f"before: {before['reason']}"
            yield "gained", f"{new['median']:g} s; {why}"
        return
    if new is None or after is None:
        yield "lost", "not in the new study" if after is None else after["reason"]
        return
    differences = list(_errors(before, after))
    yield from differences
    margin = MARGIN if old["runs"] > 1 and new["runs"] > 1 else SINGLE_RUN_MARGIN
    verdict = "same"
    if new["minimum"] / new_floor["maximum"] > margin * old["maximum"] / old_floor["minimum"]:
        verdict = "slower"
    elif old["minimum"] / old_floor["maximum"] > margin * new["maximum"] / new_floor["minimum"]:
        verdict = "faster"
    if verdict != "same" or not differences:
        ratio = (new["median"] / new_floor["median"]) / (old["median"] / old_floor["median"])
        yield (
            verdict,
            f"{ratio:.2f} times the time, machine allowed for ({old['median']:g} s at a floor of "
            f"{old_floor['median']:g} s, now {new['median']:g} at {new_floor['median']:g})",
        )


def _errors(before: Row, after: Row) -> Iterator[tuple[str, str]]:
    """Differences of the figures of error."""
    pairs: list[tuple[str, Any, Any]] = [("width of area bounds", before["area_width"], after["area_width"])]
    for count, f in (before["figures"] or {}).items():
        g = (after["figures"] or {}).get(count)
        if g is None:
            yield "lost", f"{count}: no error is reported any more"
            continue
        for name in _COMPARED:
            pairs.append((f"{count}, {name.replace('_', ' ')}", f[name], g[name]))
    for name, a, b in pairs:
        if a is None or b is None:
            continue
        (low, high), (least, most) = (x if isinstance(x, tuple) else (x, x) for x in (a, b))
        if least > high or most < low:
            yield "worse" if least > high else "better", f"{name}: {high:g}, now {most:g}"


def comparison_table(changes: Sequence[Row]) -> str:
    """A line for each change, the bad ones first, and a line that sums up."""
    ordered = sorted(changes, key=lambda c: (c["verdict"] not in BAD, c["verdict"] == "same"))
    lines = columns([(c["verdict"], c["method"], c["setting"], c["detail"]) for c in ordered])
    tally = {verdict: sum(c["verdict"] == verdict for c in changes) for verdict in BAD}
    summary = ", ".join(f"{number} {verdict}" for verdict, number in tally.items() if number)
    return "\n".join([*lines, summary or "nothing became slower or worse beyond noise"])
