"""Running a study: methods take turns, times are taken, and each answer is measured against the exact map.

Guarantee: all methods are run at their first setting before any is at its second; there each round runs every method
once, in an order drawn from the seed, beside the reference job. Nothing is measured while something else is run.
"""

from __future__ import annotations

import json
import os
import random
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from fractions import Fraction
from multiprocessing import get_all_start_methods, get_context
from pathlib import Path

import numpy as np

from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.ask.classification import classify
from ptmcad.errors import PtmcadError
from ptmcad.question.slice import Slice
from ptmcad.show.table import count_text
from ptmcad.studies.bench import qepcad
from ptmcad.studies.bench.cover_error import cover_error
from ptmcad.studies.bench.error import MapError, exact_error, grid_error
from ptmcad.studies.bench.harness import Times, made_with, rounds, times
from ptmcad.studies.bench.methods import Job, Method, jobs, question
from ptmcad.studies.bench.process import Outcome, Usage, run
from ptmcad.studies.bench.reference import COUNTS, Column, Reference, Walls, centres, reference, shown_count, walls
from ptmcad.studies.bench.study import Figures, Measurement, Study, figures, outward

FLOOR = (
    sys.executable,
    "-c",
    "import flint, numpy, click, yaml; numpy.linalg.eigvals(numpy.random.default_rng(1).random((8000, 6, 6)))",
)
"""The reference job: start-up, and some linear algebra that is always the same."""
MAX_REPEATED_SECONDS = 1.25
"""Seconds from which on a job is not repeated."""
MAX_PANELS = 10_000
"""Of all walls together: what is steep takes many, and some slices have walls too steep for the measurement."""
NO_MAP = "no exact map to compare with: the share is the engine's"
NO_WALLS = "errors not measured: the true walls are too steep for chains of chords; shares are the engine's"
GRACE_SECONDS = 1.0
"""Seconds that an engine has to save what it has when its time is over."""
GROWTH = 4.5
"""A grid is taken to need so many times the time of the one before, which has a quarter of its pixels."""

Report = Callable[[str], None]


@dataclass(slots=True)
class _Runs:
    """What the runs of one job gave so far."""

    job: Job
    usages: list[Usage]
    computing: list[float]
    reason: str = ""

    @property
    def due(self) -> bool:
        return not self.reason and not (self.usages and self.usages[0].seconds > MAX_REPEATED_SECONDS)


@dataclass(frozen=True, slots=True)
class Settings:
    """How a study is made.

    Attributes
    ----------
    rounds : runs of each job that takes no longer than `MAX_REPEATED_SECONDS`; others are run once.
    seed : of the order within a round, and of the starts of the scipy grid.
    time_limit : seconds for each method's measured runs; settings that do not fit are left out, with the reason.
    quick : fewer and coarser settings.
    """

    methods: Sequence[Method] = tuple(Method)
    rounds: int = 3
    seed: int = 1
    time_limit: float = 60.0
    quick: bool = False


def measure(
    slice: Slice,
    record: Path,
    verified: Callable[[RegionMap], bool],
    settings: Settings,
    *,
    warm_up: bool = True,
    report: Report = lambda _: None,
) -> Study:
    """Measure error against run time on one slice.

    Parameters
    ----------
    record : the slice's own file.
    verified : whether an independent check confirms a map, such as `ptmcad.verify`; the errors rest on it.
    warm_up : run the certified engine once before, because the first run on a machine compiles.
    report : called with what is being done.

    Raises
    ------
    PtmcadError
        When the slice has no map, or an answer of ours contradicts the reference.
    """
    exact, sides, sound = None, None, None
    if not slice.has_free_lengths:
        report(f"{slice.name}: the exact map that errors are measured against")
        result = classify(slice, count="index")
        sound = verified(result)
        exact = reference(result)
        sides = _walls(exact)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        asked = question(slice, None if exact is None else exact.result)
        (folder / "question.json").write_text(asked, encoding="utf-8")
        started, absent = _begin(slice, record, folder, settings)
        if warm_up:
            _compile(started)
        report(f"{slice.name}: {len(started)} jobs")
        floor = _rounds(started, settings, report)
        report(f"{slice.name}: errors")
        measured = _all_measured(_Known(started, slice, exact, sides))
    return Study(
        slice=slice.name, heading=slice.heading, **made_with(), seed=settings.seed,
        rounds=settings.rounds, time_limit=settings.time_limit, quick=settings.quick, verified=sound, floor=floor,
        measurements=(*measured, *absent),
    )  # fmt: skip


def _walls(exact: Reference) -> dict[str, Walls] | None:
    """The exact map's walls as chains of chords; None where that takes more than `MAX_PANELS` panels."""
    panels = 0

    def count() -> None:
        nonlocal panels
        panels += 1
        if panels > MAX_PANELS:
            raise _TooManyError

    try:
        return walls(exact, count)
    except _TooManyError:
        return None


class _TooManyError(Exception):
    """More panels than the measurement may take."""


def _begin(slice: Slice, record: Path, folder: Path, settings: Settings) -> tuple[list[_Runs], list[Measurement]]:
    started: list[_Runs] = []
    absent: list[Measurement] = []
    for method in settings.methods:
        found = jobs(method, slice, record.resolve(), folder, settings.quick, settings.seed)
        if isinstance(found, str):
            absent.append(Measurement(method.value, "", None, reason=found))
        else:
            started += [_Runs(job, [], []) for job in found]
    return started, absent


def _compile(started: Sequence[_Runs]) -> None:
    """Run the certified engine's first job, if there is one: what is reported is the time of every later run."""
    for r in started:
        if r.job.method is Method.CERTIFIED:
            run(r.job.commands[0][0], timeout=300)
            return


def _rounds(runs: Sequence[_Runs], settings: Settings, report: Report) -> Times:
    """Run all jobs; the times of the reference job are returned."""
    order, limit = random.Random(settings.seed), settings.time_limit
    spent = {r.job.method: 0.0 for r in runs}
    last = dict(spent)
    floor = []
    run(FLOOR)
    for rank in range(1 + max((r.job.rank for r in runs), default=0)):
        ranked = [r for r in runs if r.job.rank == rank]
        for turns in rounds(settings.rounds, lambda _, ranked=ranked: ranked, order):  # type: ignore[misc]
            floor.append(run(FLOOR).seconds)
            for r in turns:
                method = r.job.method
                left = limit - spent[method]
                # a finer tolerance takes no less than the coarser one before it
                growth = GROWTH if r.job.grows else 1.0 if method is Method.CERTIFIED else 0.0
                needed = r.usages[-1].seconds if r.usages else growth * last[method]
                if not r.due or (r.usages and left < needed):
                    continue
                if left <= needed:
                    r.reason = f"left out: it does not fit into the {limit:g} s for each method"
                    continue
                report(f"{method.value}, {r.job.setting}")
                last[method] = _run(r, left, limit)
                spent[method] += last[method]
    return times(floor)


def _run(r: _Runs, left: float, time_limit: float) -> float:
    """Run a job once, record it, and return the seconds that it took."""
    job = r.job
    if job.method is Method.CERTIFIED:
        total = [_until(job, left)]
    else:
        total = []
        for command, text in job.commands:
            usage = run(command, text=text, timeout=max(left - sum(u.seconds for u in total), 0.1))
            total.append(qepcad.judged(usage) if job.method is Method.QEPCAD else usage)
            if total[-1].outcome is not Outcome.DONE:
                break
    seconds, last = sum(u.seconds for u in total), total[-1]
    if last.outcome is Outcome.DONE:
        processor, peak = sum(u.processor_seconds for u in total), max(u.peak_mebibytes for u in total)
        r.usages.append(Usage(last.outcome, seconds, processor, peak))
        if job.method in (Method.COMPANION, Method.MULTISTART, Method.GCAD):
            r.computing.append(json.loads(last.output)["computing"])
        elif job.answer is not None:
            r.computing.append(json.loads(job.answer.read_text(encoding="utf-8"))["timings"]["total"])
    elif not r.usages:
        message = last.message.strip().splitlines()
        r.reason = (
            f"stopped: the {time_limit:g} s for each method were used up"
            if last.outcome is Outcome.TIMED_OUT
            else f"{last.outcome.value}: {message[-1] if message else 'no message'}"
        )
    return seconds


def _until(job: Job, left: float) -> Usage:
    """A run that has an answer at any time, and a smaller error later: it is done when there is an answer."""
    assert job.answer is not None
    job.answer.unlink(missing_ok=True)
    command = (*job.commands[0][0], "--timeout", f"{max(left - GRACE_SECONDS, 0.1):.2f}")
    usage = run(command, timeout=left + GRACE_SECONDS)
    if job.answer.exists():
        return replace(usage, outcome=Outcome.DONE)
    return replace(usage, outcome=Outcome.TIMED_OUT) if "time limit" in usage.message else usage


@dataclass(frozen=True, slots=True)
class _Known:
    """What errors are measured with: the runs, and the exact map and its walls where there are any."""

    runs: Sequence[_Runs]
    slice: Slice
    exact: Reference | None
    sides: dict[str, Walls] | None


def _all_measured(known: _Known) -> tuple[Measurement, ...]:
    """The errors of all jobs' answers, computed side by side where a system can fork: nothing is timed by now."""
    processes = min(os.cpu_count() or 1, len(known.runs))
    if processes < 2 or "fork" not in get_all_start_methods():
        return tuple(_measured(known, r) for r in known.runs)
    with ProcessPoolExecutor(processes, get_context("fork"), _inherit, (known, os.getpid())) as pool:
        return tuple(pool.map(_measured_here, range(len(known.runs))))


_inherited: list[_Known] = []
"""In a forked process, what it computes with: far too much to be sent to it."""


def _inherit(known: _Known, parent: int) -> None:
    _inherited[:] = [known]
    threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: int) -> None:
    """End this process when its parent has ended, however that did: the other processes keep its pipes open."""
    while os.getppid() == parent:
        time.sleep(0.2)
    os._exit(1)


def _measured_here(number: int) -> Measurement:
    return _measured(_inherited[0], _inherited[0].runs[number])


def _measured(known: _Known, r: _Runs) -> Measurement:
    job, exact, sides = r.job, known.exact, known.sides
    if not r.usages:
        return Measurement(job.method.value, job.setting, None, reason=r.reason or "not run")
    found: dict[str, Figures] = {}
    width: float | None = None
    note = ""
    if job.method in (Method.EXACT, Method.CERTIFIED):
        assert job.answer is not None
        result = RegionMap.from_json(job.answer.read_text(encoding="utf-8"))
        width = outward((Fraction(0), area_width(result)))[1]
        if result.status is Status.PARTIAL:
            note = "stopped at the limit, short of its tolerance"
        if job.method is Method.EXACT and exact is not None:
            _agree(result, exact)
        if exact is None or sides is None:
            share = outward((result.undetermined, result.undetermined))
            found[known.slice.count.value] = Figures(wrong=share, undetermined=share[1])
            note = "; ".join([note] * bool(note) + [NO_MAP if exact is None else NO_WALLS])
        elif job.method is Method.EXACT:
            found = {count: figures(exact_error(sides[count])) for count in COUNTS}
        else:
            errors = {count: cover_error(exact, sides[count], result, count) for count in COUNTS}
            found = {count: figures(error) for count, error in errors.items() if error is not None}
    elif job.method in (Method.COMPANION, Method.MULTISTART):
        assert job.answer is not None and exact is not None
        if sides is None:
            return Measurement(job.method.value, job.setting, None, reason=NO_WALLS)
        found = grid_figures(exact, sides, np.load(job.answer))
        note = qepcad.LOSES_PI if qepcad.question(known.slice) == qepcad.LOSES_PI else ""
    elif job.method is Method.QEPCAD:
        count = "stable" if "stable" in job.setting else "total"
        found[count] = Figures(wrong=(0.0, 0.0), undetermined=0.0)
        note = "an exact formula by its own claim, up to a set of measure zero; the sextic was given"
    else:
        found["index"] = Figures(wrong=(0.0, 0.0), undetermined=0.0)
        note = "cells by its own claim; the curves were given, and nothing is counted"
    return Measurement(
        method=job.method.value,
        setting=job.setting,
        seconds=times([u.seconds for u in r.usages]),
        computing=times(r.computing) if r.computing else None,
        peak=round(max(u.peak_mebibytes for u in r.usages), 1),
        note=note,
        figures=found,
        area_width=width,
    )


def grid_figures(exact: Reference, sides: dict[str, Walls], drawn: np.ndarray) -> dict[str, Figures]:
    """The figures of a grid for each count.

    Parameters
    ----------
    drawn : stable and total counts, of shape (2, n, n).
    """
    stable, total = drawn.astype(np.int16)
    columns: tuple[Column, ...] = centres(exact, len(stable))
    found: dict[str, MapError] = {
        count: grid_error(exact, sides[count], columns, shown_count(stable, total, count), count) for count in COUNTS
    }
    return {count: figures(error) for count, error in found.items()}


def area_width(result: RegionMap) -> Fraction:
    """The widest bounds of the area of all points with one count, as a share of the window's area."""
    first, second = result.slice.axes
    window = (first.high - first.low) * (second.high - second.low)
    low: dict[str, Fraction] = {}
    high: dict[str, Fraction] = {}
    for region in result.regions:
        key = count_text(region, result.slice.count)
        low[key] = low.get(key, Fraction(0)) + region.area[0]
        high[key] = high.get(key, Fraction(0)) + region.area[1]
    widths = [
        # in a certified map the undetermined part may belong to any count
        (high[key] - low[key]) / window if result.cover is None else result.undetermined
        for key in low
    ]
    return max(widths, default=Fraction(1))


def _agree(result: RegionMap, exact: Reference) -> None:
    """Refuse an exact map that says other than the reference at one of its samples, or leaves something open."""
    for cell in result.cells:
        found = exact.result.locate(**dict(cell.sample))
        if (found.stable, found.total) != (cell.stable, cell.total) or result.undetermined:
            raise PtmcadError(f"two exact maps of {result.slice.name} differ at {dict(cell.sample)}")
