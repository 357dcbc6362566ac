"""What a sweep will cost, from the time that some of its members take.

Guarantee: nothing is said of sweeps whose members take long; what is said is an estimate and no
bound.
"""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

from ptmcad.ask.checking import CheckedSlice
from ptmcad.ask.forecast import duration
from ptmcad.question.config.sweeps import Sweeping
from ptmcad.workbench.sweeps.member import Wanted, computing
from ptmcad.workbench.sweeps.run import axes_of, processors

MAX_SOLUTIONS = 8
"""Complex solutions of a member that is computed for its time: with more of them it may take
minutes.
"""
MEMBERS = 4
"""That are computed for their time, ..."""
ENOUGH = 1.0
"""... until they have taken so many seconds together."""


def sweep_text(question: Sweeping, first: CheckedSlice) -> Iterator[str]:
    """The number of members and the time that they take here, as lines of text."""
    yield f"{'sweep':<12}{len(question)} members over {', '.join(question.names)}; above is the first member"
    if (
        first.engine != "exact"
        or first.complex_solutions is None
        or first.complex_solutions > MAX_SOLUTIONS
    ):
        yield f"{'time':<12}{len(question)} times that of a member, on {_these_processors()}: see cost"
        return
    taken = _seconds(question)
    whole = sum(taken) / len(taken) * len(question) / processors()
    low, high = (f"{seconds:.2g}" for seconds in (min(taken), max(taken)))
    each = (
        f"a member took {high} s"
        if len(taken) == 1
        else f"{len(taken)} members took {low} to {high} s"
    )
    yield f"{'time':<12}about {duration(max(1.0, whole))} on {_these_processors()}: {each} with ranges"


def _seconds(question: Sweeping) -> list[float]:
    """What members here and there take; a sweep's middle, and its corners, are often slices that
    are easier.
    """
    compute = computing(question, Wanted(along=axes_of(question)[0]))
    taken: list[float] = []
    for number in Random(0).sample(range(len(question)), min(MEMBERS, len(question))):
        outcome = compute(number)
        # it cannot have failed: there is neither another version nor a time limit
        assert outcome.seconds is not None, outcome.error
        taken.append(outcome.seconds)
        if sum(taken) > ENOUGH:
            break
    return taken


def _these_processors() -> str:
    number = processors()
    return "one processor" if number == 1 else f"{number} processors"
