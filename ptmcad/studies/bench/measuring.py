"""Running a study: methods take turns, times are taken, and each answer is measured against the exact map.

Guarantee: all methods are run at their first setting before any is at its second; there each round
runs every method once, in an order drawn from the seed, beside the reference job. Nothing is
measured while something else is run.
"""

from __future__ import annotations

import json
import random
import sys
import tempfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import zip_longest
from pathlib import Path

import numpy as np

from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.ask.classification import classify
from ptmcad.errors import LimitReached, PtmcadError
from ptmcad.question.slice import Slice
from ptmcad.show.table import count_text
from ptmcad.studies.bench import programs, qepcad
from ptmcad.studies.bench.error import Figures, cover_error, exact_error, figures, grid_error, outward
from ptmcad.studies.bench.harness import Job, Row, made_with, take_turns, times
from ptmcad.studies.bench.methods import GRIDS, Case, Method, finest_count, jobs, question
from ptmcad.studies.bench.process import Outcome, Usage, run
from ptmcad.studies.bench.records import difference
from ptmcad.studies.bench.study import FORMAT, measurement
from ptmcad.studies.bench.truth import Truth, cells_at_centres, shown_count, truths

FLOOR = (
    sys.executable,
    "-c",
    "import flint, numpy, click, yaml; numpy.linalg.eigvals(numpy.random.default_rng(1).random((8000, 6, 6)))",
)
"""The reference job: start-up, and some linear algebra that is always the same."""
MAX_REPEATED_SECONDS = 1.25
"""Seconds from which on a job is not repeated."""
NO_MAP = "no exact map to compare with: the share is the engine's"
NO_WALLS = "errors not measured: the true walls are too steep for chains of chords; shares are the engine's"
FORMULA = "an exact formula by its own claim, up to a set of measure zero; the sextic was given"
MAP_SECONDS = 120.0
"""For the map that errors are measured against, at least; without it shares are the engines'."""
GRACE_SECONDS = 1.0
"""Seconds that an engine has to save what it has when its time is over."""
GROWTH = 4.5
"""A grid is taken to need so many times the time of the one before, which has a quarter of its pixels."""

Report = Callable[[str], None]


def measure(
    slice: Slice,
    record: Path,
    verified: Callable[[RegionMap], bool],
    *,
    methods: Sequence[Method] = tuple(Method),
    rounds: int = 3,
    seed: int = 1,
    time_limit: float = 60.0,
    quick: bool = False,
    warm_up: bool = True,
    report: Report = lambda _: None,
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
        folder = Path(name)
        (folder / "question.json").write_text(question(slice), encoding="utf-8")
        case = Case(slice, record.resolve(), exact, folder, quick, seed)
        ranked: list[Sequence[Job]] = []
        absent: list[Row] = []
        for method in methods:
            found = jobs(method, case)
            if isinstance(found, str):
                absent.append(measurement(method.value, "", reason=found))
            else:
                ranked.append(found)
        if warm_up:
            _compile(ranked)
        floor = _run_all(ranked, rounds, seed, time_limit, report)
        report(f"{slice.name}: errors")
        measured = [_measured(slice, exact, known, job) for found in ranked for job in found]
    return {
        "format": FORMAT, "slice": slice.name, "heading": slice.heading, **made_with(), "seed": seed,
        "rounds": rounds, "time_limit": time_limit, "quick": quick, "verified": sound, "floor": times(floor),
        "measurements": (*measured, *absent),
    }  # fmt: skip


def _compile(ranked: Sequence[Sequence[Job]]) -> None:
    """Run the certified engine's first job, if there is one: what is reported is the time of every later run."""
    for found in ranked:
        if found[0].what == Method.CERTIFIED.value:
            run(found[0].commands[0][0], timeout=300)


def _run_all(ranked: Sequence[Sequence[Job]], rounds: int, seed: int, limit: float, report: Report) -> list[float]:
    """Run all jobs; the seconds of the reference job are returned."""
    spent = {method.value: 0.0 for method in Method}
    last = dict(spent)
    floor = Job("", "", "reference job", ((FLOOR, ""),))

    def attempt(job: Job) -> None:
        if job is floor:
            job.attempt(300)
            return
        repeated = bool(job.usages)
        if repeated and job.usages[0].seconds > MAX_REPEATED_SECONDS:
            return
        left = limit - spent[job.what]
        certified = job.what == Method.CERTIFIED.value
        # a finer tolerance takes no less than the coarser one before it
        growth = 1.0 if certified else 0.0 if job.what == Method.EXACT.value else GROWTH
        needed = job.usages[-1].seconds if repeated else growth * last[job.what]
        if left <= needed:
            if not repeated:
                job.reason = f"left out: it does not fit into the {limit:g} s for each method"
            return
        report(f"{job.what}, {job.setting}")
        usage = _until(job, left) if certified else job.attempt(left)
        last[job.what] = usage.seconds
        spent[job.what] += usage.seconds
        if usage.outcome is Outcome.TIMED_OUT:
            job.reason = f"stopped: the {limit:g} s for each method were used up"

    run(FLOOR)  # fills caches
    order = random.Random(seed)
    for rank in zip_longest(*ranked):
        take_turns([floor, *filter(None, rank)], rounds, order, attempt)
    return [usage.seconds for usage in floor.usages]


def _until(job: Job, left: float) -> Usage:
    """A run that has an answer at any time, and a smaller error later: it is done when there is an answer."""
    assert job.answer is not None
    job.answer.unlink(missing_ok=True)
    command = (*job.commands[0][0], "--timeout", f"{max(left - GRACE_SECONDS, 0.1):.2f}")
    usage = run(command, timeout=left + GRACE_SECONDS)
    if job.answer.exists():
        usage = replace(usage, outcome=Outcome.DONE)
    elif "time limit" in usage.message:
        usage = replace(usage, outcome=Outcome.TIMED_OUT)
    job.record(usage, left)
    return usage


def _measured(slice: Slice, exact: RegionMap | None, known: dict[str, Truth] | None, job: Job) -> Row:
    method = Method(job.what)
    if not job.usages:
        return measurement(job.what, job.setting, reason=job.reason or "not run")
    found: dict[str, Figures] = {}
    width: float | None = None
    note = ""
    output = job.usages[-1].output
    if method in (Method.EXACT, Method.CERTIFIED):
        assert job.answer is not None
        result = RegionMap.from_json(output := job.answer.read_text(encoding="utf-8"))
        width = outward(0, area_width(result))[1]
        note = "stopped at the limit, short of its tolerance" if result.status is Status.PARTIAL else ""
        if method is Method.EXACT and exact is not None and (result.undetermined or difference(exact, result)):
            raise PtmcadError(f"two exact maps of {slice.name} differ: {difference(exact, result) or 'one is open'}")
        if not known:
            share = outward(result.undetermined, result.undetermined)
            found[slice.count.value] = figures(share, share[1])
            note = "; ".join(filter(None, [note, NO_MAP if exact is None else NO_WALLS]))
        elif method is Method.EXACT:
            found = {count: exact_error(truth) for count, truth in known.items()}
        else:
            errors = {count: cover_error(truth, result, count) for count, truth in known.items()}
            found = {count: error for count, error in errors.items() if error is not None}
    elif method in GRIDS:
        assert job.answer is not None and exact is not None
        if known is None:
            return measurement(job.what, job.setting, reason=NO_WALLS)
        found = grid_figures(exact, known, np.load(job.answer))
        note = qepcad.LOSES_PI if qepcad.question(slice) == qepcad.LOSES_PI else ""
    elif job.setting.startswith("where"):
        found["stable" if "stable" in job.setting else "total"] = figures((0.0, 0.0), 0.0)
        note = FORMULA
    elif exact is not None:
        answer = output if job.answer is None else job.answer.read_text(encoding="utf-8")
        asked = programs.elimination(slice, True)
        note = f"no counts; {programs.agreement(job.what, answer, exact, asked)}"
    return measurement(
        job.what,
        job.setting,
        seconds=times([u.seconds for u in job.usages]),
        computing=_computing(output),
        peak=round(max(u.peak_mebibytes for u in job.usages), 1),
        note=note,
        figures=found,
        area_width=width,
    )


def _computing(output: str) -> Row | None:
    """The seconds of the computation alone, where the answer, JSON, says them."""
    if not output.startswith("{"):
        return None
    said = json.loads(output)
    seconds = said["timings"]["total"] if "timings" in said else said.get("computing")
    return times([seconds]) if seconds else None


def grid_figures(exact: RegionMap, known: dict[str, Truth], drawn: np.ndarray) -> dict[str, Figures]:
    """The figures of a grid for each count.

    Parameters
    ----------
    drawn : stable and total counts, of shape (2, n, n).
    """
    stable, total = drawn.astype(np.int16)
    cells = cells_at_centres(exact, len(stable))
    return {count: grid_error(truth, cells, shown_count(stable, total, count)) for count, truth in known.items()}


def area_width(result: RegionMap) -> Fraction:
    """The widest bounds of the area of all points with one count, as a share of the window's area."""
    first, second = result.slice.axes
    window = (first.high - first.low) * (second.high - second.low)
    if result.cover is not None:  # the undetermined part may belong to any count
        return result.undetermined if result.regions else Fraction(1)
    widths: dict[str, Fraction] = {}
    for region in result.regions:
        key = count_text(region, result.slice.count)
        widths[key] = widths.get(key, Fraction(0)) + (region.area[1] - region.area[0]) / window
    return max(widths.values(), default=Fraction(1))
