"""The rivals that are compared: how each is started as a process at a number of settings, and how its answer is read.

Guarantee: each job gets the same slice, with exact numbers where the method takes them; what a method cannot do for a
slice, or what is not installed, is reported with its reason.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from fractions import Fraction
from functools import partial
from importlib.util import find_spec
from typing import NamedTuple

import numpy as np

from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.errors import PtmcadError
from ptmcad.question.slice import Slice
from ptmcad.show.table import area_by_count
from ptmcad.studies.bench import programs
from ptmcad.studies.bench.error import cover_error, exact_error, figures, grid_error, outward, shown_count
from ptmcad.studies.bench.harness import Asked, Case, Job, Row, classification
from ptmcad.studies.bench.records import difference

GRIDS = ("companion", "multistart")
NO_MAP = "no exact map to compare with: the share is the engine's"
NO_WALLS = "errors not measured: the true walls are too steep for chains of chords; shares are the engine's"


class Rival(NamedTuple):
    """One of the methods.

    Attributes
    ----------
    label : of a setting, which goes in the place of the braces.
    settings : from the coarsest.
    quick : how many of them are run when it has to be quick.
    start : what the job at a setting has, or why there is none.
    read : figures and notes of a job that is done, as of a measurement.
    needs : an optional package.
    """

    title: str
    label: str
    settings: tuple[str, ...]
    quick: int
    start: Callable[[Case, str], Asked]
    read: Callable[[Case, Job], Row]
    needs: str = ""


def jobs(method: str, case: Case) -> list[Job] | str:
    """A method's jobs, from the shortest, or why there are none."""
    rival, slice = RIVALS[method], case.slice
    if slice.has_free_lengths and method != "certified":
        return "square roots: springs have a free length"
    if method in GRIDS and slice.mechanism != "ptm":
        return f"the sextic is the paper's mechanism's, not that of {slice.mechanism}"
    if rival.needs and find_spec(rival.needs) is None:
        return f"{rival.needs} is not installed (make bench installs it)"
    settings = rival.settings[: rival.quick if case.quick else None]
    asked = {rival.label.format(setting): rival.start(case, setting) for setting in settings}
    found = [Job(slice.name, method, label, **more) for label, more in asked.items() if not isinstance(more, str)]
    return found or str(next(iter(asked.values())))


# ------------------------------------------------------------------------------------------------- ptmcad and grids


def _start_engine(engine: str, option: str, case: Case, setting: str) -> Asked:
    options = ("--engine", engine, "--count", finest_count(case.slice), option, setting, "--format", "json")
    asked = classification(case.record, case.slice.name, case.folder / f"{engine}-{setting}", *options)
    return asked | {"saves": engine == "certified"}


def finest_count(slice: Slice) -> str:
    """The count that shows most; with free lengths the slice's own."""
    if slice.has_free_lengths:
        return slice.count.value
    return "index" if slice.model.has_potential else "stable" if slice.model.tells_stability else "total"


def _read_map(case: Case, job: Job) -> Row:
    result = RegionMap.from_json(job.said())
    notes = ["stopped at the limit, short of its tolerance"] if result.status is Status.PARTIAL else []
    if case.exact is not None and result.cover is None and (wrong := difference(case.exact, result)):
        raise PtmcadError(f"two exact maps of {case.slice.name} differ: {wrong}")
    if not case.known:
        notes.append(NO_MAP if case.exact is None else NO_WALLS)
        share = outward(result.undetermined, result.undetermined)
        found = {case.slice.count.value: figures(share, share[1])}
    elif result.cover is None:
        found = {count: exact_error(truth) for count, truth in case.known.items()}
    else:
        errors = {count: cover_error(truth, result, count) for count, truth in case.known.items()}
        found = {count: error for count, error in errors.items() if error is not None}
    return {"figures": found, "note": "; ".join(notes), "area_width": outward(0, area_width(result))[1]}


def area_width(result: RegionMap) -> Fraction:
    """The widest bounds of the area of all points with one count, as a share of the window's area."""
    first, second = result.slice.axes
    window = (first.high - first.low) * (second.high - second.low)
    return max((high - low for low, high in area_by_count(result).values()), default=window) / window


def question(slice: Slice) -> str:
    """The slice as JSON for the grids, in floats."""
    parameters = {
        name: [[[i, j, float(c)] for i, j, c in terms] for terms in (value.numerator, value.denominator)]
        for name, value in slice.parameters.items()
    }
    return json.dumps({"window": [[float(a.low), float(a.high)] for a in slice.axes], "parameters": parameters})


def _start_grid(method: str, case: Case, setting: str) -> Asked:
    asked, target = case.folder / "question.json", case.folder / f"{method}-{setting}.npy"
    asked.write_text(question(case.slice), encoding="utf-8")
    command = [sys.executable, "-m", "ptmcad.studies.bench.rivals", method, asked, setting, target]
    return {"command": list(map(str, command)), "answer": target}


def _read_grid(case: Case, job: Job) -> Row:
    if case.exact is None or case.known is None:
        return {"note": NO_MAP if case.exact is None else NO_WALLS}
    assert job.answer is not None
    stable, total = np.load(job.answer).astype(np.int16)
    cells = case.exact.grid(len(stable)).cell.T
    found = {count: grid_error(truth, cells, shown_count(stable, total, count)) for count, truth in case.known.items()}
    return {"figures": found}


RIVALS = {
    "exact": Rival("ptmcad, exact engine", "area tolerance {}", ("1e-2", "1e-4", "1e-8", "1e-12"), 2,
                   partial(_start_engine, "exact", "--area-tolerance"), _read_map),
    "certified": Rival("ptmcad, certified engine", "tolerance {}", ("1e-1", "1e-2", "1e-3", "1e-4"), 2,
                       partial(_start_engine, "certified", "--tolerance"), _read_map, "numba"),
    "companion": Rival("grid of companion matrices", "N = {}", ("25", "50", "100", "200", "400", "800", "1600"), 4,
                       partial(_start_grid, "companion"), _read_grid),
    "multistart": Rival("grid of Newton's starts", "N = {}", ("12", "25"), 1,
                        partial(_start_grid, "multistart"), _read_grid),
    "qepcad": Rival("QEPCAD", "{}", ("cells of the curves",), 1,
                    programs.start_qepcad, partial(programs.beside, programs.by_qepcad)),
    "singular": Rival("Singular, critical curve alone", "{}", ("critical curve",), 1,
                      programs.start_singular, partial(programs.beside, programs.by_singular)),
    "msolve": Rival("msolve, critical curve alone", "{}", ("critical curve",), 1,
                    programs.start_msolve, partial(programs.beside, programs.by_msolve)),
    "gcad": Rival("gcad on the finished curves, no counts", "{}", ("curves",), 1,
                  programs.start_gcad, partial(programs.beside, programs.by_gcad), "gcad"),
}  # fmt: skip
