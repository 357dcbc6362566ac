"""A study: error against run time of several rivals on one slice, measured; how each is started,
and its answer read.

Guarantee: each job gets the same slice, with exact numbers where the method takes them; what a
method cannot do for a slice, or what is not installed, is reported with its reason. All methods are
run at their first setting before any is at its second; there each round runs every method once, in
an order drawn from the seed, beside the reference job. Nothing is measured while something else is
run. Figures of error are rounded outwards, so that bounds stay bounds; everything but times, memory
and the machine is the same whenever the study is made again with the same seed.
"""

from __future__ import annotations

import json
import random
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from itertools import zip_longest
from pathlib import Path

import numpy as np

from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.ask.classification import classify
from ptmcad.ask.comparison import compare
from ptmcad.errors import LimitReached, PtmcadError
from ptmcad.question.slice import Slice
from ptmcad.show.table import area_by_count
from ptmcad.studies.bench import programs
from ptmcad.studies.bench.error import (
    cover_error,
    figures,
    grid_error,
    outward,
    shown_count,
    truths,
)
from ptmcad.studies.bench.harness import (
    FORMAT,
    Asked,
    Case,
    Job,
    Row,
    classification,
    made_with,
    measurement,
    take_turns,
    times,
)

ENGINES = {"exact": "--area-tolerance", "certified": "--tolerance"}
"""Those of ptmcad, with the option whose value is the setting."""
GRIDS = ("companion", "multistart")
NO_MAP = "no exact map to compare with: the share is the engine's"
NO_WALLS = "errors not measured: the true walls are too steep for chains of chords; shares are the engine's"
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


RIVALS: Mapping[str, Row] = programs.TEXTS["rivals"]
"""The methods as ``programs.yaml`` has them: its title, how a setting is called, the settings from
the coarsest, how many of them are run when it has to be quick, and the package that it may need.
"""


def jobs(method: str, case: Case) -> list[Job] | str:
    """A method's jobs, from the shortest, or why there are none."""
    rival, slice = RIVALS[method], case.slice
    if slice.has_free_lengths and method != "certified":
        return "square roots: springs have a free length"
    if method in GRIDS and slice.mechanism != "ptm":
        return f"the sextic is the paper's mechanism's, not that of {slice.mechanism}"
    if (package := rival.get("needs")) and find_spec(package) is None:
        return f"{package} is not installed (make bench installs it)"
    settings = rival["settings"][: rival["quick"] if case.quick else None]
    start = (
        _start_engine if method in ENGINES else _start_grid if method in GRIDS else programs.start
    )
    asked = {rival["label"].format(setting): start(method, case, setting) for setting in settings}
    found = [
        Job(slice.name, method, label, **more)
        for label, more in asked.items()
        if not isinstance(more, str)
    ]
    return found or str(next(iter(asked.values())))


# ------------------------------------------------------------------------------------------------- ptmcad and grids


def _start_engine(engine: str, case: Case, setting: str) -> Asked:
    folder = case.folder / f"{engine}-{setting}"
    options = ("--engine", engine, "--count", finest_count(case.slice), ENGINES[engine], setting)
    asked = classification(case.record, case.slice.name, folder, *options, "--format", "json")
    return asked | {"saves": engine == "certified"}


def finest_count(slice: Slice) -> str:
    """The count that shows most; with free lengths the slice's own."""
    if slice.has_free_lengths:
        return slice.count.value
    return slice.model.criterion.counts[-1]


def _read_map(case: Case, job: Job) -> Row:
    result = RegionMap.from_json(job.said())
    partial = result.status is Status.PARTIAL
    notes = ["stopped at the limit, short of its tolerance"] * partial
    exact = result.cover is None
    if case.exact is not None and exact and (wrong := difference(case.exact, result)):
        raise PtmcadError(f"two exact maps of {case.slice.name} differ: {wrong}")
    if not case.known:
        notes.append(NO_MAP if case.exact is None else NO_WALLS)
        share = outward(result.undetermined, result.undetermined)
        found = {case.slice.count.value: figures(share, share[1])}
    elif exact:
        right = figures((0.0, 0.0), 0.0, missed=0, faintest=(1.0, 1.0), distance=(0.0, 0.0))
        found = {
            count: right | {"regions": len(truth.counts)} for count, truth in case.known.items()
        }
    else:
        errors = {count: cover_error(truth, result, count) for count, truth in case.known.items()}
        found = {count: error for count, error in errors.items() if error is not None}
    window = result.slice.area
    widest = max((high - low for low, high in area_by_count(result).values()), default=window)
    width = outward(0, widest / window)[1]
    return {"figures": found, "note": "; ".join(notes), "area_width": width}


def difference(one: RegionMap, other: RegionMap) -> str:
    """Where two maps of one slice have other counts, whatever their decompositions; empty when
    nowhere.

    Raises
    ------
    ConfigError
        When one of them is not complete.
    """
    changes = compare(one, other).changes
    if not changes:
        return ""
    return (
        f"other counts on {len(changes)} parts, the largest of area {float(changes[0].area[1]):.3g}"
    )


def question(slice: Slice) -> str:
    """The slice as JSON for the grids, in floats."""
    parameters = {
        name: [
            [[i, j, float(c)] for i, j, c in terms]
            for terms in (value.numerator, value.denominator)
        ]
        for name, value in slice.parameters.items()
    }
    return json.dumps(
        {"window": [[float(a.low), float(a.high)] for a in slice.axes], "parameters": parameters}
    )


def _start_grid(method: str, case: Case, setting: str) -> Asked:
    asked, target = case.folder / "question.json", case.folder / f"{method}-{setting}.npy"
    asked.write_text(question(case.slice), encoding="utf-8")
    command = [sys.executable, "-m", "ptmcad.studies.byhand", method, asked, setting, target]
    return {"command": list(map(str, command)), "answer": target}


def _read_grid(case: Case, job: Job) -> Row:
    if case.exact is None or case.known is None:
        return {"note": NO_MAP if case.exact is None else NO_WALLS}
    assert job.answer is not None
    stable, total = np.load(job.answer).astype(np.int16)
    cells = case.exact.grid(len(stable)).cell.T
    found = {
        count: grid_error(truth, cells, shown_count(stable, total, count))
        for count, truth in case.known.items()
    }
    return {"figures": found}


# ---------------------------------------------------------------------------------------------------------- measured


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
    verified : whether an independent check confirms a map, such as `ptmcad.verify`; the errors rest
        on it.
    rounds : runs of each job that takes no longer than `MAX_REPEATED_SECONDS`; others are run once.
    seed : of the order within a round.
    time_limit : seconds for each method's measured runs; settings that do not fit are left out,
        with the reason.
    quick : fewer and coarser settings.
    warm_up : run the certified engine once before, because the first run on a machine compiles.
    report : called with what is being done.

    Raises
    ------
    PtmcadError
        When the slice has no map, or an answer of ours contradicts the reference.
    """
    exact = _exact(slice, max(MAP_SECONDS, time_limit), report)
    sound = None if exact is None else verified(exact)
    known = None if exact is None else truths(exact)
    with tempfile.TemporaryDirectory() as name:
        case = Case(slice, record.resolve(), exact, known, Path(name), quick)
        found = {method: jobs(method, case) for method in methods}
        ranked = [asked for asked in found.values() if not isinstance(asked, str)]
        floor = Job(slice.name, "", "reference job", FLOOR)
        # this fills caches, and compiles
        for job in [floor, *(asked[0] for asked in ranked if asked[0].saves and warm_up)]:
            job.attempt(WARM_UP_SECONDS)
            job.usages.clear()
        _run_all(ranked, floor, rounds, seed, time_limit, report)
        report(f"{slice.name}: errors")
        measured = [_measured(case, job) for asked in ranked for job in asked]
    for method, why in found.items():
        if isinstance(why, str):
            measured.append(measurement(method, "", reason=why))
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
        "floor": floor.times,
        "measurements": tuple(measured),
    }


def _exact(slice: Slice, seconds: float, report: Callable[[str], None]) -> RegionMap | None:
    """The map that errors are measured against; None where there is none, or not in the time."""
    if slice.has_free_lengths:
        return None
    report(f"{slice.name}: the exact map that errors are measured against")
    try:
        return classify(slice, count=finest_count(slice), timeout=seconds)
    except LimitReached:
        return None


def _run_all(
    ranked: Sequence[Sequence[Job]],
    floor: Job,
    rounds: int,
    seed: int,
    limit: float,
    report: Callable[[str], None],
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
        last[job.what] = job.attempt(left[job.what]).seconds
        left[job.what] -= last[job.what]

    order = random.Random(seed)
    for rank in zip_longest(*ranked):
        take_turns([floor, *filter(None, rank)], rounds, order, attempt)


def _measured(case: Case, job: Job) -> Row:
    """The figures of a job's runs, and of its answer."""
    if not job.usages:
        return measurement(job.what, job.setting, reason=job.reason or "not run")
    read = _read_map if job.what in ENGINES else _read_grid if job.what in GRIDS else programs.read
    return measurement(
        job.what,
        job.setting,
        seconds=job.times,
        computing=times([json.loads(job.said())["timings"]["total"]])
        if job.said().startswith("{")
        else None,
        peak=round(max(usage.peak_mebibytes for usage in job.usages), 1),
        **read(case, job),
    )
