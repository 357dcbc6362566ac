"""One stress case put to ptmcad and to double precision: answers, errors, condition, precision and cost.

Guarantee: ``right`` means that the counts are those expected, that the second method found the same, and that every
enclosed angle contains the one to 100 digits. Everything but the seconds is the same in the next run.

The condition number of an equilibrium is S |H^-1|, the largest summand S of the gradient (a moment of a spring or a
load about a joint) over the smallest modulus of an eigenvalue of the Hessian H: when every summand changes by a small
share e, the pose turns by at most about 2 e S |H^-1| radians. A point's is the largest of its equilibria.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from statistics import median
from time import process_time
from typing import Any

from ptmcad.answer.poses import DIGITS
from ptmcad.studies.slices import ptm_slice
from ptmcad.studies.stress.case import Case, PointQuestion, Question


@dataclass(frozen=True, slots=True)
class Verdict:
    """What came out of a case, without its cost.

    Attributes
    ----------
    expected, found, double : the answers as text.
    remarks : what is not right of ptmcad's answer; a decided wrong one is as wrong as an undecided one.
    double_right : whether the double-precision method's answer is right.
    error : largest error of ptmcad's angles (the middles of its enclosures) in radians; for lines, of the ends relative
        to the window. None where nothing is compared.
    double_error : the same of the double-precision method, over the poses that it has; for maps the share of the
        grid's points with a wrong count.
    condition : see the module; None for maps and lines.
    bits : of precision that ptmcad needed; the largest over its stages.
    """

    expected: str
    found: str
    double: str
    remarks: tuple[str, ...]
    double_right: bool
    error: float | None = None
    double_error: float | None = None
    condition: float | None = None
    bits: int = 0

    @property
    def right(self) -> bool:
        """Whether ptmcad's answer is, by all checks."""
        return not self.remarks


@dataclass(frozen=True, slots=True)
class Cost:
    """What a case and its sibling cost.

    Attributes
    ----------
    calls, sibling_calls : functions called, Python's and built in: work that is the same in every run.
    seconds, sibling_seconds : processor time, medians of runs that take turns.
    ratio_low, ratio_high : smallest and largest of the ratios of the runs.
    """

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
class Outcome:
    """A case with its verdict and cost."""

    case: Case
    verdict: Verdict
    cost: Cost


def answer(question: Question, name: str = "case") -> Any:
    """ptmcad's answer: `Poses`, a `RegionMap` or `CountIntervals`."""
    import ptmcad

    if isinstance(question, PointQuestion):
        return ptmcad.solve(None, DIGITS, None, **question.parameters)
    slice = ptm_slice(name, question.axes, **question.parameters)
    if question.along:
        return ptmcad.intervals(slice, question.along, question.at)
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


def cost_of(case: Case, repeats: int) -> Cost:
    """The case's and its sibling's cost, in turns."""
    calls, sibling_calls = work_of(case.question), work_of(case.sibling)
    pairs = [(_seconds(case.question), _seconds(case.sibling)) for _ in range(repeats)]
    ratios = [a / max(b, 1e-9) for a, b in pairs]
    mine, its = (median(times) for times in zip(*pairs, strict=True))
    return Cost(calls, sibling_calls, mine, its, min(ratios), max(ratios))


def _seconds(question: Question) -> float:
    started = process_time()
    answer(question)
    return process_time() - started


def run(case: Case, repeats: int, judge: Callable[[Case, Any], Verdict]) -> Outcome:
    """Answer, judge and time a case."""
    return Outcome(case, judge(case, answer(case.question, case.name)), cost_of(case, repeats))


def as_float(value: Fraction) -> float:
    """A rational as a float; infinite or zero beyond a float's range."""
    try:
        return float(value)
    except OverflowError:
        return float("inf") if value > 0 else float("-inf")
