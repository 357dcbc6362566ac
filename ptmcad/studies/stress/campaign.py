"""A run of stress cases, and its record.

Guarantee: everything in a record but the seconds and their ratios is the same in the next run with the same versions.
A run that was stopped by a time limit says so and keeps the cases that were done.
"""

from __future__ import annotations

import platform
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter

from ptmcad.process.extras import Extra, require
from ptmcad.studies.stress.case import Case
from ptmcad.studies.stress.judgement import judge
from ptmcad.studies.stress.measure import Outcome, run
from ptmcad.studies.tables import installed
from ptmcad.version import __version__

PACKAGES = ("python-flint", "numpy", "numba")
MAX_COST = 5.0
"""An extreme case may cost at most so many times what its tame sibling does."""

Progress = Callable[[str, int, int], None]


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
        return tuple(o for o in self.outcomes if o.cost.ratio > MAX_COST)


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
        outcomes.append(run(case, 1 if case.slow else repeats, judge))
    return Campaign(
        tuple(outcomes), len(cases), seed, repeats, _machine(), {"ptmcad": __version__, **installed(PACKAGES)}
    )


def _machine() -> dict[str, str]:
    return {"system": platform.system(), "processor": platform.machine(), "python": platform.python_version()}
