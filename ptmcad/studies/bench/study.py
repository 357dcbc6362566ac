"""A study: error against run time of several methods on one slice, as rows that are stored, read back and compared.

Guarantee: all methods are run at their first setting before any is at its second; there each round runs every method
once, in an order drawn from the seed, beside the reference job. Nothing is measured while something else is run.
Figures of error are rounded outwards, so that bounds stay bounds; everything but times, memory and the machine is the
same whenever the study is made again with the same seed. `study_of(write_study(s))` equals s; a file that is not such a
document is refused with the place of the fault. ``docs/bench.schema.json`` is its schema, and says what each key means.

Of two studies an error is worse only if its bounds do not overlap the earlier ones. Times are compared as multiples of
each study's own floor, so that machines of different speed compare; one is slower only if its fastest run is slower
than the slowest run of the other by `MARGIN`, with the spread of both floors allowed for. That a small change is found
is not guaranteed.
"""

from __future__ import annotations

import json
import random
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from itertools import zip_longest
from pathlib import Path
from typing import Any

import pandas as pd

from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.classification import classify
from ptmcad.errors import ConfigError, LimitReached
from ptmcad.question.slice import Count, Slice
from ptmcad.studies.bench.error import Figures, truths
from ptmcad.studies.bench.harness import Case, Job, Row, made_with, take_turns, times
from ptmcad.studies.bench.methods import RIVALS, finest_count, jobs
from ptmcad.studies.bench.process import Outcome
from ptmcad.studies.tables import columns
from ptmcad.text.codec import (
    NATURAL,
    POSITIVE,
    SECONDS,
    TRUTH,
    WHOLE,
    Codec,
    document_schema,
    line,
    listed,
    named,
    optional,
    record,
)
from ptmcad.text.node import Node, opened
from ptmcad.text.textfile import read_as

FORMAT = "ptmcad-bench/1"
MAX_BYTES = 10_000_000
MARGIN = 1.1
SINGLE_RUN_MARGIN = 1.5
"""The same where one of the two was run once only, so that its spread is not known."""
BAD = ("slower", "worse", "lost")
"""Verdicts that are no good news; the others are faster, better, gained and same."""
_COMPARED = ("wrong", "undetermined", "wrong_centres", "missed", "distance")
"""Figures, numbers or bounds, larger being worse."""
_FINEST = ("index", "total", "stable", "admissible")
_COLUMNS = [
    "slice",
    "method",
    "setting",
    "seconds_median",
    "seconds_min",
    "seconds_max",
    "runs",
    "computing_median",
    "peak_mib",
    "count",
    "wrong_low",
    "wrong_high",
    "undetermined",
    "wrong_centres",
    "regions",
    "missed",
    "faintest_low",
    "faintest_high",
    "distance_low",
    "distance_high",
    "area_width",
    "reason",
    "note",
]
_SHORT = {
    "seconds_minimum": "seconds_min",
    "seconds_maximum": "seconds_max",
    "seconds_runs": "runs",
    "peak": "peak_mib",
}
_WHOLE = ["runs", "wrong_centres", "regions", "missed"]
FLOOR = (
    sys.executable,
    "-c",
    "import flint, numpy, click, yaml; numpy.linalg.eigvals(numpy.random.default_rng(1).random((8000, 6, 6)))",
)
"""The reference job: start-up, and some linear algebra that is always the same."""
MAX_REPEATED_SECONDS = 1.25
"""Seconds from which on a job is not repeated."""
MAP_SECONDS = 120.0
"""For the map that errors are measured against, at least; without it shares are the engines'."""
WARM_UP_SECONDS = 300.0


def measure(
    slice: Slice,
    record: Path,
    verified: Callable[[RegionMap], bool],
    *,
    methods: Sequence[str] = tuple(RIVALS),
    rounds: int = 3,
    seed: int = 1,
    time_limit: float = 60.0,
    quick: bool = False,
    warm_up: bool = True,
    report: Callable[[str], None] = lambda _: None,
) -> Row:
    """Measure error against run time on one slice.

    Parameters
    ----------
    record : the slice's own file.
    verified : whether an independent check confirms a map, such as `ptmcad.verify`; the errors rest on it.
    rounds : runs of each job that takes no longer than `MAX_REPEATED_SECONDS`; others are run once.
    seed : of the order within a round, and of the starts of the scipy grid.
    time_limit : seconds for each method's measured runs; settings that do not fit are left out, with the reason.
    quick : fewer and coarser settings.
    warm_up : run the certified engine once before, because the first run on a machine compiles.
    report : called with what is being done.

    Raises
    ------
    PtmcadError
        When the slice has no map, or an answer of ours contradicts the reference.
    """
    exact, known, sound = None, None, None
    if not slice.has_free_lengths:
        report(f"{slice.name}: the exact map that errors are measured against")
        with suppress(LimitReached):
            exact = classify(slice, count=finest_count(slice), timeout=max(MAP_SECONDS, time_limit))
            sound = verified(exact)
            known = truths(exact)
    with tempfile.TemporaryDirectory() as name:
        case = Case(slice, record.resolve(), exact, known, Path(name), quick, seed)
        found = {method: jobs(method, case) for method in methods}
        ranked = [asked for asked in found.values() if not isinstance(asked, str)]
        floor = Job(slice.name, "", "reference job", FLOOR)
        floor.attempt(WARM_UP_SECONDS)  # fills caches
        for job in [asked[0] for asked in ranked if asked[0].saves and warm_up]:
            job.attempt(WARM_UP_SECONDS)  # compiles
            job.usages.clear()
        floor.usages.clear()
        _run_all(ranked, floor, rounds, seed, time_limit, report)
        report(f"{slice.name}: errors")
        measured = [_measured(case, job) for asked in ranked for job in asked]
    return {
        "format": FORMAT,
        "slice": slice.name,
        "heading": slice.heading,
        **made_with(),
        "seed": seed,
        "rounds": rounds,
        "time_limit": time_limit,
        "quick": quick,
        "verified": sound,
        "floor": times([usage.seconds for usage in floor.usages]),
        "measurements": (
            *measured,
            *(measurement(method, "", reason=why) for method, why in found.items() if isinstance(why, str)),
        ),
    }


def _run_all(
    ranked: Sequence[Sequence[Job]], floor: Job, rounds: int, seed: int, limit: float, report: Callable[[str], None]
) -> None:
    """Run all jobs, so that those of a method have so many seconds together."""
    left = {asked[0].what: limit for asked in ranked}
    last = dict.fromkeys(left, 0.0)  # a finer setting takes no less than the one before it

    def attempt(job: Job) -> None:
        if job is floor:
            job.attempt(WARM_UP_SECONDS)
            return
        if job.usages and job.usages[0].seconds > MAX_REPEATED_SECONDS:
            return
        if left[job.what] <= last[job.what]:
            if not job.usages:
                job.reason = f"left out: it does not fit into the {limit:g} s for each method"
            return
        report(f"{job.what}, {job.setting}")
        usage = job.attempt(left[job.what])
        last[job.what] = usage.seconds
        left[job.what] -= usage.seconds
        if usage.outcome is Outcome.TIMED_OUT:
            job.reason = f"stopped: the {limit:g} s for each method were used up"

    order = random.Random(seed)
    for rank in zip_longest(*ranked):
        take_turns([floor, *filter(None, rank)], rounds, order, attempt)


def _measured(case: Case, job: Job) -> Row:
    """The figures of a job's runs, and of its answer."""
    if not job.usages:
        return measurement(job.what, job.setting, reason=job.reason or "not run")
    return measurement(
        job.what,
        job.setting,
        seconds=times([usage.seconds for usage in job.usages]),
        computing=_computing(job),
        peak=round(max(usage.peak_mebibytes for usage in job.usages), 1),
        **RIVALS[job.what].read(case, job),
    )


def _computing(job: Job) -> Row | None:
    """The seconds of the computation alone, where the process says them, as JSON."""
    said = job.usages[-1].output if job.answer is None or job.answer.suffix != ".json" else job.said()
    if not said.startswith("{"):
        return None
    found = json.loads(said)
    seconds = found["timings"]["total"] if "timings" in found else found.get("computing")
    return times([seconds]) if seconds else None


_KEYS = ("method", "setting", "seconds", "computing", "peak", "reason", "note", "figures", "area_width")


def measurement(method: str, setting: str, **more: Any) -> Row:
    """What is known of one method at one setting; ``docs/bench.schema.json`` says what each key means."""
    return dict.fromkeys(_KEYS) | {"method": method, "setting": setting, "reason": "", "note": "", **more}


def frame(study: Row) -> pd.DataFrame:
    """A row for each measurement and count, with the columns of the CSV file and the notes."""
    rows = []
    for m in study["measurements"]:
        for count, figures in (m["figures"] or {None: {}}).items():
            parts = {
                name: dict(zip(("low", "high"), x, strict=True)) if isinstance(x, tuple) else x
                for name, x in figures.items()
            }
            rows.append({"slice": study["slice"], "count": count, **m, **parts, "figures": None})
    table = pd.json_normalize(rows, sep="_").rename(columns=_SHORT).reindex(columns=_COLUMNS)
    return table.astype(dict.fromkeys(_WHOLE, "Int64"))


def finest(study: Row) -> pd.DataFrame:
    """A row for each measurement, with the figures for the finest count that the method gives."""
    table = frame(study)
    ranks = table["count"].map({count: rank for rank, count in enumerate(_FINEST)})
    return table.loc[ranks.sort_values(kind="stable").index].drop_duplicates(["method", "setting"]).sort_index()


def records(table: pd.DataFrame) -> list[Row]:
    """The rows of a table."""
    return [{str(name): x for name, x in row.items()} for row in table.to_dict("records")]


def write_study(study: Row) -> str:
    """The study as JSON text."""
    return json.dumps(study, indent=1, ensure_ascii=False) + "\n"


def write_table(study: Row) -> str:
    """The study as CSV, one row for each measurement and count."""
    text: str = frame(study).drop(columns="note").to_csv(index=False, lineterminator="\n")
    return text


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
    return _STUDY.read(opened(text, FORMAT, MAX_BYTES, "ptmcad bench"))


def study_schema() -> dict[str, Any]:
    """The schema of a study's JSON, without prose."""
    return document_schema(FORMAT, _STUDY.schema)


def _positive(node: Node) -> float:
    seconds = node.number()
    if not seconds > 0:
        raise node.fault("is not a positive number of seconds")
    return seconds


_TAKEN: Codec[float] = Codec(SECONDS.write, _positive, {"type": "number", "exclusiveMinimum": 0})
_PAIR = listed(SECONDS, 2)
_TIMES: Codec[Row] = record(dict, runs=POSITIVE, median=_TAKEN, minimum=_TAKEN, maximum=_TAKEN)
_FIGURES: Codec[Figures] = record(
    dict,
    wrong=_PAIR,
    undetermined=SECONDS,
    wrong_centres=optional(NATURAL),
    regions=optional(POSITIVE),
    missed=optional(NATURAL),
    faintest=optional(_PAIR),
    distance=optional(_PAIR),
)
_MEASUREMENT: Codec[Row] = record(
    dict,
    method=line(60).narrowed(enum=[*RIVALS]),
    setting=line(60),
    seconds=optional(_TIMES),
    computing=optional(_TIMES),
    peak=optional(SECONDS),
    reason=line(1000),
    note=line(1000),
    figures=optional(named(_FIGURES).narrowed(propertyNames={"enum": [count.value for count in Count]})),
    area_width=optional(SECONDS),
)
_STUDY: Codec[Row] = record(
    lambda **keys: {"format": FORMAT, **keys},
    slice=line(200),
    heading=line(1000),
    machine=named(line(300)),
    versions=named(line(300)),
    seed=WHOLE,
    rounds=POSITIVE,
    time_limit=_TAKEN,
    quick=TRUTH,
    verified=optional(TRUTH),
    floor=_TIMES,
    measurements=listed(_MEASUREMENT),
)


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
    lines = columns([(c["verdict"], c["method"], c["setting"], c["detail"]) for c in ordered])
    tally = {verdict: sum(c["verdict"] == verdict for c in changes) for verdict in BAD}
    summary = ", ".join(f"{number} {verdict}" for verdict, number in tally.items() if number)
    return "\n".join([*lines, summary or "nothing became slower or worse beyond noise"])
