"""What answers members one after another, seen from the process that asks: this machine's workers,
or a cluster's.

Guarantee: of each member that was submitted one outcome is returned, in any order; the death of a
process is one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

Answer = tuple[int, Any]
"""A member's number and what became of it: what the task returned, or a
`ptmcad.workbench.sweeps.member.Failed`.
"""


class Task(Protocol):
    """What is asked of each member; it is sent to the processes."""

    @property
    def timeout(self) -> float | None:
        """Seconds that a member may take."""

    def answer(self, number: int) -> Any:
        """What becomes of a member, in the process that computes it."""


class Workers(Protocol):
    """Processes that compute members."""

    @property
    def room(self) -> bool:
        """Whether one more member is wanted now."""

    @property
    def busy(self) -> bool:
        """Whether there are members of which nothing has been returned yet."""

    def submit(self, number: int) -> None:
        """Have a member computed."""

    def answers(self, seconds: float | None) -> Sequence[Answer]:
        """What has been answered; waits for an answer, for so many seconds at most."""

    def close(self) -> None:
        """End at once; what is not answered is lost."""
