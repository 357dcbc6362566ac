"""The methods that are compared, each as processes to run at a number of settings.

Guarantee: each job gets the same slice, with exact numbers where the method takes them; what a
method cannot do for a slice, or what is not installed, is reported with its reason.
"""

from __future__ import annotations

import json
import shutil
import sys
from dataclasses import dataclass
from enum import Enum
from functools import lru_cache, partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from ptmcad.algebra import msolve
from ptmcad.answer.regionmap import RegionMap
from ptmcad.exact.slicevariety import slice_variety
from ptmcad.question.config import load
from ptmcad.question.slice import Slice
from ptmcad.studies.bench import programs, qepcad
from ptmcad.studies.bench.harness import PTMCAD, Job
from ptmcad.studies.bench.process import run


class Method(Enum):
    """What is compared."""

    EXACT = "exact"
    CERTIFIED = "certified"
    COMPANION = "companion"
    MULTISTART = "multistart"
    QEPCAD = "qepcad"
    SINGULAR = "singular"
    MSOLVE = "msolve"
    GCAD = "gcad"


class Rival(NamedTuple):
    """One of them.

    Attributes
    ----------
    label : of a setting, which goes in the place of the braces.
    settings : from the coarsest.
    quick : how many of them are run when it has to be quick.
    needs : an optional package.
    """

    title: str
    label: str
    settings: tuple[str, ...]
    quick: int
    needs: str = ""


RIVALS = {
    Method.EXACT: Rival("ptmcad, exact engine", "area tolerance {}", ("1e-2", "1e-4", "1e-8", "1e-12"), 2),
    Method.CERTIFIED: Rival("ptmcad, certified engine", "tolerance {}", ("1e-1", "1e-2", "1e-3", "1e-4"), 2, "numba"),
    Method.COMPANION: Rival(
        "grid of companion matrices", "N = {}", ("25", "50", "100", "200", "400", "800", "1600"), 4
    ),
    Method.MULTISTART: Rival("grid of scipy starts", "N = {}", ("12", "25"), 1, "scipy"),
    Method.QEPCAD: Rival("QEPCAD", "{}", ("cells of the curves", "where 6, where 4", "where 2 stable"), 3),
    Method.SINGULAR: Rival("Singular, critical curve alone", "{}", ("critical curve",), 1),
    Method.MSOLVE: Rival("msolve, critical curve alone", "{}", ("critical curve",), 1),
    Method.GCAD: Rival("gcad on the finished curves, no counts", "{}", ("curves",), 1, "gcad"),
}
GRIDS = (Method.COMPANION, Method.MULTISTART)
TRIAL_SECONDS = 20.0


def question(slice: Slice) -> str:
    """The slice as JSON for the rivals, in floats."""
    parameters = {
        name: [[[i, j, float(c)] for i, j, c in terms] for terms in (value.numerator, value.denominator)]
        for name, value in slice.parameters.items()
    }
    window = [[float(a.low), float(a.high)] for a in slice.axes]
    return json.dumps({"window": window, "parameters": parameters})


@dataclass(frozen=True, slots=True)
class Case:
    """What the methods are asked about.

    Attributes
    ----------
    record : the slice's own file.
    exact : its map, for the curves; None where there is none.
    folder : with the question as ``question.json``; answers go there too.
    quick : fewer and coarser settings.
    """

    slice: Slice
    record: Path
    exact: RegionMap | None
    folder: Path
    quick: bool
    seed: int


def jobs(method: Method, case: Case) -> list[Job] | str:
    """A method's jobs, from the shortest, or why there are none."""
    rival, slice = RIVALS[method], case.slice
    if slice.has_free_lengths and method is not Method.CERTIFIED:
        return "square roots: springs have a free length"
    if method in GRIDS and slice.mechanism != "ptm":
        return f"the sextic is the paper's mechanism's, not that of {slice.mechanism}"
    if rival.needs and find_spec(rival.needs) is None:
        return f"{rival.needs} is not installed (make bench installs it)"
    found, reason = [], ""
    for setting in rival.settings[: rival.quick if case.quick else None]:
        asking = _job(method, case, setting)
        if isinstance(asking, str):
            reason = reason or asking
        else:
            asking.setting = rival.label.format(setting)
            found.append(asking)
    return found or reason


def _job(method: Method, case: Case, setting: str) -> Job | str:
    """The job at a setting, or why there is none."""
    name, folder = case.slice.name, case.folder
    target = folder / f"{method.value}-{setting}"
    match method:
        case Method.EXACT | Method.CERTIFIED:
            option = "--area-tolerance" if method is Method.EXACT else "--tolerance"
            command = [*PTMCAD, "classify", str(case.record), "--engine", method.value, "--count",
                       finest_count(case.slice), option, setting, "--format", "json", "--out", str(target)]  # fmt: skip
            return Job(name, method.value, "", ((command, ""),), target / f"{name}.json")
        case Method.COMPANION | Method.MULTISTART:
            target = target.with_suffix(".npy")
            command = [sys.executable, "-m", "ptmcad.studies.bench.rivals", method.value,
                       str(folder / "question.json"), setting, str(target), str(case.seed)]  # fmt: skip
            return Job(name, method.value, "", ((command, ""),), target)
        case Method.QEPCAD if setting.startswith("where"):
            return _counts_by_qepcad(case.slice, setting)
        case Method.SINGULAR:
            if shutil.which("Singular") is None:
                return "Singular is not installed"
            script = programs.singular_script(programs.elimination(case.slice, case.exact is not None))
            command = ["Singular", "--quiet", "--no-rc"]
            return Job(name, method.value, "", ((command, script),), None, partial(programs.incomplete, programs.END))
        case Method.MSOLVE:
            program = msolve.program()
            if program is None:
                return "msolve is not installed"
            asked = programs.elimination(case.slice, case.exact is not None)
            (folder / "system.ms").write_text(asked.text, encoding="ascii")
            command = [program, "-e", str(len(asked.unknowns)), "-g", "2", "-f", str(folder / "system.ms"),
                       "-o", str(target)]  # fmt: skip
            return Job(name, method.value, "", ((command, ""),), target)
    if case.exact is None:
        return "there are no finished curves"
    if method is Method.GCAD:
        script = programs.gcad_script(case.exact)
        return Job(name, method.value, "", (([sys.executable, "-"], script),))
    there = qepcad.command()
    if there is None:
        return "qepcad is not installed"
    ordered = load(exchanged(case.record, folder)) if case.exact.base else case.slice
    session = slice_variety(ordered).text("qepcad") + programs.STUCK
    return Job(name, method.value, "", ((there, session),), None, partial(programs.incomplete, programs.QUIT))


def finest_count(slice: Slice) -> str:
    """The count that shows most; with free lengths the slice's own."""
    if slice.has_free_lengths:
        return slice.count.value
    return "index" if slice.model.has_potential else "stable" if slice.model.tells_stability else "total"


def exchanged(record: Path, folder: Path) -> Path:
    """The record with its axes exchanged."""
    data: dict[str, Any] = yaml.safe_load(record.read_text(encoding="utf-8"))
    data["axes"] = dict(reversed(data["axes"].items()))
    model = data.get("mechanism")
    if isinstance(model, str) and (beside := record.resolve().parent / model).is_file():
        data["mechanism"] = str(beside)
    target = folder / f"exchanged-{record.name}"
    target.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
    return target


def _counts_by_qepcad(slice: Slice, setting: str) -> Job | str:
    """On the sextic, in the better elimination order, which a trial shows."""
    command, asked = qepcad.command(), qepcad.question(slice)
    if command is None or isinstance(asked, str):
        return "qepcad is not installed" if command is None else str(asked)
    best = _better_order(command, asked)
    if best is None:
        return f"no answer within {TRIAL_SECONDS:.0f} s in either order of the axes"
    tasks = (qepcad.Task.TWO_STABLE,) if "stable" in setting else qepcad.TOTAL
    commands = [(command, asked.text(task, swapped=best)) for task in tasks]
    return Job(slice.name, Method.QEPCAD.value, "", commands, None,
               lambda usage: "" if qepcad.formula(usage.output) else "no answer")  # fmt: skip


@lru_cache(maxsize=1)
def _better_order(command: tuple[str, ...], asked: qepcad.Question) -> bool | None:
    """Whether to exchange the axes; None where neither order ends in time."""
    trials = []
    for swapped in (False, True):
        usage = run(command, text=asked.text(qepcad.Task.SIX, swapped=swapped), timeout=TRIAL_SECONDS)
        if qepcad.formula(usage.output):
            trials.append((usage.seconds, swapped))
    return min(trials)[1] if trials else None
