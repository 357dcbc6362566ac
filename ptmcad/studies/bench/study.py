"""A study: error against run time of several methods on one slice, measured.

Guarantee: all methods are run at their first setting before any is at its second; there each round runs every method
once, in an order drawn from the seed, beside the reference job. Nothing is measured while something else is run.
Figures of error are rounded outwards, so that bounds stay bounds; everything but times, memory and the machine is the
same whenever the study is made again with the same seed.
"""

from __future__ import annotations

import json
import random
import sys
import tempfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import zip_longest
from pathlib import Path

from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.classification import classify
from ptmcad.errors import LimitReached
from ptmcad.question.slice import Slice
from ptmcad.studies.bench.error import truths
from ptmcad.studies.bench.harness import Case, Job, Row, made_with, take_turns, times
from ptmcad.studies.bench.methods import RIVALS, finest_count, jobs
from ptmcad.studies.bench.process import Outcome
from ptmcad.studies.bench.stored import FORMAT, measurement

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
    seed : of the order within a round.
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
        case = Case(slice, record.resolve(), exact, known, Path(name), quick)
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
    if not job.said().startswith("{"):
        return None
    found = json.loads(job.said())
    seconds = found["timings"]["total"] if "timings" in found else found.get("computing")
    return times([seconds]) if seconds else None
