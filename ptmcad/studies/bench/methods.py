"""The methods that are compared, each as processes to run at a number of settings.

Guarantee: each job gets the same slice, with exact numbers where the method takes them; what a method cannot do for a
slice, or what is not installed, is reported with its reason.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from enum import Enum
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from ptmcad.answer.regionmap import RegionMap
from ptmcad.mechanism import ptm
from ptmcad.question.slice import Slice
from ptmcad.studies.bench import qepcad
from ptmcad.studies.bench.process import Outcome, run
from ptmcad.studies.moments import source


class Method(Enum):
    """What is compared."""

    EXACT = "exact"
    CERTIFIED = "certified"
    COMPANION = "companion"
    MULTISTART = "multistart"
    QEPCAD = "qepcad"
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
    Method.QEPCAD: Rival("QEPCAD on the sextic made by hand", "where {}", ("6, where 4", "2 stable"), 2),
    Method.GCAD: Rival("gcad on the finished curves, no counts", "{}", ("curves",), 1, "gcad"),
}
OURS = (Method.EXACT, Method.CERTIFIED)
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
    """The slice as JSON for the rivals: floats, the exact map's curves, and the paper's equations as code."""
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
            "moments": source() if slice.model == ptm() else "",
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
    rival = RIVALS[method]
    if method is Method.EXACT and slice.has_free_lengths:
        return "square roots: springs have a free length"
    if method not in OURS and slice.has_free_lengths:
        return "with free lengths there is no sextic"
    if method not in OURS and slice.mechanism != "ptm":
        return f"the sextic is the paper's mechanism's, not that of {slice.mechanism}"
    if rival.needs and find_spec(rival.needs) is None:
        return f"{rival.needs} is not installed (make bench installs it)"
    if method is Method.QEPCAD:
        return _qepcad(slice)
    found = []
    for rank, setting in enumerate(rival.settings[: rival.quick if quick else None]):
        target = folder / f"{method.value}-{setting}"
        if method in OURS:
            command = (*_classify(method, slice, record), setting, "--format", "json", "--out", str(target))
            target /= f"{slice.name}.json"
        else:
            target = target.with_suffix(".json" if method is Method.GCAD else ".npy")
            more = (str(seed),) if method is Method.MULTISTART else ()
            asked = (str(folder / "question.json"), setting, str(target), *more)
            module = "gcad_curves" if method is Method.GCAD else method.value
            command = (sys.executable, "-m", f"ptmcad.studies.bench.{module}", *asked)
        grows = rank > 0 and method not in OURS
        found.append(Job(method, rival.label.format(setting), ((command, ""),), target, rank, grows))
    return tuple(found)


def _classify(method: Method, slice: Slice, record: Path) -> tuple[str, ...]:
    """The command without its setting."""
    count = slice.count.value if slice.has_free_lengths else "index"
    option = "--area-tolerance" if method is Method.EXACT else "--tolerance"
    return (sys.executable, "-m", "ptmcad", "classify", str(record), "--engine", method.value, "--count", count, option)


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
    texts = {task: (command, asked.text(task, swapped=best)) for task in qepcad.Task}
    commands = (tuple(texts[task] for task in qepcad.TOTAL), (texts[qepcad.Task.TWO_STABLE],))
    rival = RIVALS[Method.QEPCAD]
    return tuple(
        Job(Method.QEPCAD, rival.label.format(setting), asking, None, rank)
        for rank, (setting, asking) in enumerate(zip(rival.settings, commands, strict=True))
    )
