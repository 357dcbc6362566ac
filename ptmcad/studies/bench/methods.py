"""The methods that are compared, each as processes to run at a number of settings.

Guarantee: each job gets the same slice, with exact numbers where the method takes them; what a method cannot do for a
slice, or what is not installed, is reported with its reason.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from importlib.util import find_spec
from pathlib import Path

from ptmcad.answer.regionmap import RegionMap
from ptmcad.question.slice import Slice
from ptmcad.studies.bench import qepcad
from ptmcad.studies.bench.process import Outcome, run


class Method(Enum):
    """What is compared."""

    EXACT = "exact"
    CERTIFIED = "certified"
    COMPANION = "companion"
    MULTISTART = "multistart"
    QEPCAD = "qepcad"
    GCAD = "gcad"


TITLES = {
    Method.EXACT: "ptmcad, exact engine",
    Method.CERTIFIED: "ptmcad, certified engine",
    Method.COMPANION: "grid of companion matrices",
    Method.MULTISTART: "grid of scipy starts",
    Method.QEPCAD: "QEPCAD on the sextic made by hand",
    Method.GCAD: "gcad on the finished curves, no counts",
}
AREA_TOLERANCES = ("1e-2", "1e-4", "1e-8", "1e-12")
TOLERANCES = ("1e-1", "1e-2", "1e-3", "1e-4")
GRIDS = (25, 50, 100, 200, 400, 800, 1600)
START_GRIDS = (12, 25)
TRIAL_SECONDS = 20.0


@dataclass(frozen=True, slots=True)
class Job:
    """Processes that answer the question at one setting; their times are added.

    Attributes
    ----------
    commands : each with its standard input.
    answer : the file that they write, None where the answer is on standard output.
    rank : jobs of a method are run in this order, the shortest first.
    grows : whether it is known to need more time than the job before it.
    """

    method: Method
    setting: str
    commands: tuple[tuple[tuple[str, ...], str], ...]
    answer: Path | None
    rank: int
    grows: bool = False


def question(slice: Slice, exact: RegionMap | None) -> str:
    """The slice as JSON for the rivals: floats, and the exact map's curves."""
    curves = () if exact is None else [c.polynomial.terms for c in exact.components if not c.left_out]
    return json.dumps(
        {
            "window": [[float(a.low), float(a.high)] for a in slice.axes],
            "rational_window": [[str(a.low), str(a.high)] for a in slice.axes],
            "base": 0 if exact is None else exact.base,
            "parameters": {
                name: [[[i, j, float(c)] for i, j, c in terms] for terms in (value.numerator, value.denominator)]
                for name, value in slice.parameters.items()
            },
            "curves": [[[i, j, str(c)] for i, j, c in terms] for terms in curves],
        }
    )


def jobs(method: Method, slice: Slice, record: Path, folder: Path, quick: bool, seed: int) -> tuple[Job, ...] | str:
    """A method's jobs for a slice, or why there are none.

    Parameters
    ----------
    record : the slice's own file.
    folder : with the question as ``question.json``; answers go there too.
    quick : fewer and coarser settings.
    """
    if method is Method.EXACT:
        if slice.has_free_lengths:
            return "square roots: springs have a free length"
        return _classify(method, slice, record, folder, AREA_TOLERANCES[: 2 if quick else None])
    if method is Method.CERTIFIED:
        if find_spec("numba") is None:
            return "numba is not installed"
        return _classify(method, slice, record, folder, TOLERANCES[: 2 if quick else None])
    if slice.has_free_lengths:
        return "with free lengths there is no sextic"
    if slice.mechanism != "ptm":
        return f"the sextic is the paper's mechanism's, not that of {slice.mechanism}"
    given = str(folder / "question.json")
    if method is Method.COMPANION:
        return tuple(_grid(method, folder, n, rank, given) for rank, n in enumerate(GRIDS[: 4 if quick else None]))
    if method is Method.MULTISTART:
        if find_spec("scipy") is None:
            return "scipy is not installed"
        return tuple(
            _grid(method, folder, n, rank, given, str(seed))
            for rank, n in enumerate(START_GRIDS[: 1 if quick else None])
        )
    if method is Method.GCAD:
        if find_spec("gcad") is None:
            return "gcad is not installed"
        target = folder / "gcad.json"
        return (Job(method, "curves", ((_module("gcad_curves", given, str(target)), ""),), target, 0),)
    return _qepcad(slice)


def _classify(method: Method, slice: Slice, record: Path, folder: Path, settings: Sequence[str]) -> tuple[Job, ...]:
    count = slice.count.value if slice.has_free_lengths else "index"
    option = "--area-tolerance" if method is Method.EXACT else "--tolerance"
    found = []
    for rank, setting in enumerate(settings):
        out = folder / f"{method.value}-{setting}"
        command = (sys.executable, "-m", "ptmcad", "classify", str(record), "--engine", method.value, "--count", count,
                   option, setting, "--format", "json", "--out", str(out))  # fmt: skip
        label = f"{'area ' * (method is Method.EXACT)}tolerance {setting}"
        found.append(Job(method, label, ((command, ""),), out / f"{slice.name}.json", rank))
    return tuple(found)


def _grid(method: Method, folder: Path, n: int, rank: int, given: str, *more: str) -> Job:
    target = folder / f"{method.value}-{n}.npy"
    command = _module(method.value, given, str(n), str(target), *more)
    return Job(method, f"N = {n}", ((command, ""),), target, rank, grows=rank > 0)


def _module(name: str, *arguments: str) -> tuple[str, ...]:
    return (sys.executable, "-m", f"ptmcad.studies.bench.{name}", *arguments)


def _qepcad(slice: Slice) -> tuple[Job, ...] | str:
    """Both total counts in the better elimination order, which a trial shows."""
    command = qepcad.command()
    if command is None:
        return "qepcad is not installed"
    asked = qepcad.question(slice)
    if isinstance(asked, str):
        return asked
    seconds = {}
    for swapped in (False, True):
        usage = qepcad.judged(run(command, text=asked.text(qepcad.Task.SIX, swapped=swapped), timeout=TRIAL_SECONDS))
        if usage.outcome is Outcome.DONE:
            seconds[swapped] = usage.seconds
    if not seconds:
        return f"no answer within {TRIAL_SECONDS:.0f} s in either order of the axes"
    best = min(seconds, key=lambda swapped: seconds[swapped])
    texts = {task: asked.text(task, swapped=best) for task in qepcad.Task}
    totals = tuple((command, texts[task]) for task in qepcad.TOTAL)
    return (
        Job(Method.QEPCAD, "where 6, where 4", totals, None, 0),
        Job(Method.QEPCAD, "where 2 stable", ((command, texts[qepcad.Task.TWO_STABLE]),), None, 1),
    )
