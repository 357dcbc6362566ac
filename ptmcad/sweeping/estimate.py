"""What a sweep will cost, from the time that one of its members takes.

Guarantee: nothing is said of sweeps whose members take long; what is said is an estimate and no bound.
"""

from __future__ import annotations

from collections.abc import Iterator

from ptmcad.ask.checking import Check
from ptmcad.question.config.sweeps import Sweeping
from ptmcad.sweeping.member import Failed, Wanted, Work, compute
from ptmcad.sweeping.run import axes_of, processors

MAX_SOLUTIONS = 8
"""Complex solutions of a member that is computed for its time: with more of them it may take minutes."""


def sweep_text(question: Sweeping, first: Check) -> Iterator[str]:
    """The number of members and the time that they take here, as lines of text."""
    yield f"{'sweep':<12}{len(question)} members over {', '.join(question.sweep.names)}; above is the first member"
    if first.engine != "exact" or first.complex_solutions is None or first.complex_solutions > MAX_SOLUTIONS:
        yield f"{'time':<12}{len(question)} times that of a member, on {_these_processors()}: see cost"
        return
    number = len(question) // 2
    outcome = compute(Work(question, Wanted(along=axes_of(question)[0])), number)
    if isinstance(outcome, Failed):  # of another version or a time limit, of which there is neither
        raise AssertionError(outcome.error)
    each = outcome.seconds
    whole = each * len(question) / processors()
    why = f"member {number} took {each:.2f} s with ranges"
    yield f"{'time':<12}about {_duration(whole)} on {_these_processors()}: {why}"


def _these_processors() -> str:
    number = processors()
    return "one processor" if number == 1 else f"{number} processors"


def _duration(seconds: float) -> str:
    """A time to one or two digits.

    >>> [_duration(seconds) for seconds in (0.04, 8.2, 95, 5000, 200000)]
    ['1 s', '8 s', '1.6 min', '1.4 h', '2.3 days']
    """
    if seconds < 60:
        return f"{max(1, round(seconds))} s"
    for unit, size, limit in (("min", 60, 3600), ("h", 3600, 86400)):
        if seconds < limit:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds / 86400:.2g} days"
