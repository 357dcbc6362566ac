"""A run of stress cases: each put to ptmcad and to double precision, judged, and its cost beside its tame sibling's.

Guarantee: everything in a campaign but the seconds and their ratios is the same in the next run with the same versions.
A run that was stopped by a time limit says so and keeps the cases that were done.
"""

from __future__ import annotations

import gc
import platform
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import median
from time import perf_counter, process_time
from typing import Any

from ptmcad.answer.poses import DIGITS
from ptmcad.process.extras import Extra, require
from ptmcad.studies.slices import ptm_slice
from ptmcad.studies.stress.case import Case, Question
from ptmcad.studies.stress.judgement import Verdict, judge
from ptmcad.studies.tables import installed
from ptmcad.version import __version__

PACKAGES = ("python-flint", "numpy", "numba")
MAX_COST = 5.0
"""An extreme case may cost at most so many times what its tame sibling does."""

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, slots=True)
class Outcome:
    """A case with its verdict, and what it and its sibling cost.

    Attributes
    ----------
    calls, sibling_calls : functions called, Python's and built in: work that is the same in every run.
    seconds, sibling_seconds : processor time, medians of runs that take turns.
    ratio_low, ratio_high : smallest and largest of the ratios of the runs.
    """

    case: Case
    verdict: Verdict
    calls: int
    sibling_calls: int
    seconds: float
    sibling_seconds: float
    ratio_low: float
    ratio_high: float

    @property
    def ratio(self) -> float:
        """Of the medians of processor time."""
        return self.seconds / max(self.sibling_seconds, 1e-9)

    @property
    def work_ratio(self) -> float:
        """Of the numbers of calls."""
        return self.calls / max(self.sibling_calls, 1)


@dataclass(frozen=True, slots=True)
class Campaign:
    """What came out, and what is needed to judge it.

    Attributes
    ----------
    wanted : how many cases were to be run; more than there are outcomes when the run was stopped.
    """

    outcomes: tuple[Outcome, ...]
    wanted: int
    seed: int
    repeats: int
    machine: dict[str, str]
    versions: dict[str, str]

    @property
    def complete(self) -> bool:
        return len(self.outcomes) == self.wanted

    @property
    def wrong(self) -> tuple[Outcome, ...]:
        """Where ptmcad is wrong, or undecided where it should decide."""
        return tuple(o for o in self.outcomes if not o.verdict.right)

    @property
    def double_wrong(self) -> tuple[Outcome, ...]:
        """Where double precision is wrong."""
        return tuple(o for o in self.outcomes if not o.verdict.double_right)

    @property
    def expensive(self) -> tuple[Outcome, ...]:
        """What costs more than `MAX_COST` times its sibling, in processor time."""
        return tuple(o for o in self.outcomes if o.ratio > MAX_COST)


def campaign(
    cases: Sequence[Case], *, seed: int, repeats: int, deadline: float | None = None, progress: Progress | None = None
) -> Campaign:
    """Run the cases.

    Parameters
    ----------
    seed : of random cases among them; recorded.
    repeats : runs of each case and of its sibling, in turns, for the medians of their times; one of slow cases.
    deadline : reading of `time.perf_counter` after which no further case is begun.
    progress : called as progress(name, done, total).

    Raises
    ------
    ConfigError
        Before the first case, when one has springs with free lengths and numba is not installed.
    """
    if any(case.has_free_lengths for case in cases):
        require(Extra.certified)
    outcomes = []
    for k, case in enumerate(cases):
        if deadline is not None and perf_counter() > deadline:
            break
        if progress is not None:
            progress(case.name, k, len(cases))
        outcomes.append(run(case, 1 if case.slow else repeats))
    machine = {"system": platform.system(), "processor": platform.machine(), "python": platform.python_version()}
    versions = {"ptmcad": __version__, **installed(PACKAGES)}
    return Campaign(tuple(outcomes), len(cases), seed, repeats, machine, versions)


def run(case: Case, repeats: int) -> Outcome:
    """Answer, judge and time a case."""
    verdict = judge(case, answer(case.question, case.name))
    calls, sibling_calls = work_of(case.question), work_of(case.sibling)
    pairs = [(_seconds(case.question), _seconds(case.sibling)) for _ in range(repeats)]
    ratios = [a / max(b, 1e-9) for a, b in pairs]
    mine, its = (median(times) for times in zip(*pairs, strict=True))
    return Outcome(case, verdict, calls, sibling_calls, mine, its, min(ratios), max(ratios))


def answer(question: Question, name: str = "case") -> Any:
    """ptmcad's answer: `Poses`, a `RegionMap` or `CountIntervals`."""
    import ptmcad

    if not question.axes:
        return ptmcad.solve(None, DIGITS, None, **question.parameters)
    slice = ptm_slice(name, question.axes, **question.parameters)
    if question.along:
        return ptmcad.intervals(slice, question.along, question.fixed)
    if question.tolerance is not None:
        return ptmcad.classify(slice, tolerance=question.tolerance, jobs=1)
    return ptmcad.classify(slice)


def work_of(question: Question) -> int:
    """How many functions are called to answer a question: a measure of work that depends on no clock.

    The first answer in a process also loads modules and writes out systems, so that it is not counted.
    """
    answer(question)
    calls = 0

    def count(_frame: object, event: str, _argument: object) -> None:
        nonlocal calls
        calls += event in ("call", "c_call")

    before, collecting = sys.getprofile(), gc.isenabled()
    gc.disable()  # what it calls, and when, depends on what else the process has made
    sys.setprofile(count)
    try:
        answer(question)
    finally:
        sys.setprofile(before)
        if collecting:
            gc.enable()
    return calls


def _seconds(question: Question) -> float:
    started = process_time()
    answer(question)
    return process_time() - started
