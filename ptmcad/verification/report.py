"""What a verification found: one line for each claim, with the method that checked it.

Guarantee: `VerifyReport.ok` is True only when no check failed; a claim that was not checked is listed as such.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from html import escape
from typing import TypeVar

from ptmcad.errors import shown
from ptmcad.options import Progress

C = TypeVar("C")


class Violation(Exception):
    """A claim of the result is false; the message holds the claim and a witness."""


@dataclass(frozen=True, slots=True)
class Check:
    """One kind of claim.

    Attributes
    ----------
    passed : None when the claim was not checked; ``detail`` then says why.
    detail : how many were checked; of a failed check the violated claim with a witness.
    """

    name: str
    method: str
    passed: bool | None
    detail: str


class Unchecked(str):
    """What a check returns when it could not decide its claim, or a part of it: the reason."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class VerifyReport:
    """The checks in their order; those after a failed one are not reached."""

    checks: tuple[Check, ...]

    @property
    def ok(self) -> bool:
        """Whether no check failed."""
        return all(c.passed is not False for c in self.checks)

    @property
    def violation(self) -> str | None:
        """The first violated claim with its witness."""
        return next((f"{c.name}: {c.detail}" for c in self.checks if c.passed is False), None)

    def __str__(self) -> str:
        return self.table()

    def __repr__(self) -> str:
        return f"<VerifyReport: {self.violation or f'{sum(c.passed is True for c in self.checks)} checks passed'}>"

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self.table())}</pre>"

    def table(self) -> str:
        """One line for each check: the answer, the claim, the method and the detail."""
        words = {True: "ok", False: "FALSE", None: "not checked"}
        rows = [("", "claim", "method", "detail")]
        rows += [(words[c.passed], c.name, c.method, c.detail) for c in self.checks]
        widths = [max(len(row[k]) for row in rows) for k in range(3)]
        return "\n".join("  ".join([*(row[k].ljust(widths[k]) for k in range(3)), row[3]]).rstrip() for row in rows)


PARTS = 100
"""Of each check, for a bar that shows how far a verification is."""


@dataclass(slots=True)
class Headway:
    """How far a verification is, for whoever watches: told as progress(words, done, total), which only grows."""

    progress: Progress | None
    number: int = 0
    now: str = ""
    before: int = -1

    def begins(self, name: str) -> None:
        """The next of the checks begins."""
        self.before += 1
        self.now = f"check {self.before + 1} of {self.number}: {name}"
        if self.progress is not None:
            self.progress(f"{self.now} ...", PARTS * self.before, PARTS * self.number)

    def within(self, done: int, total: int) -> None:
        """Of the check that runs so many parts are done, of so many."""
        if self.progress is not None and total > 0:
            part = PARTS * done // total
            self.progress(f"{self.now}, {part} %", PARTS * self.before + part, PARTS * self.number)


def checked(
    claims: C,
    steps: Sequence[tuple[str, str, Callable[[C], str]]],
    missing: Collection[str] = (),
    headway: Headway | None = None,
) -> list[Check]:
    """Run checks, given as name, method and function, in their order; none after a failed one, none of the missing."""
    checks: list[Check] = []
    failed = False
    headway = headway or Headway(None)
    headway.number = len(steps)
    for name, method, check in steps:
        headway.begins(name)
        if failed or name in missing:
            checks.append(Check(name, method, None, "not reached" if failed else "not complete in this partial result"))
            continue
        try:
            detail = check(claims)
            checks.append(Check(name, method, None if isinstance(detail, Unchecked) else True, detail))
        except Violation as violation:
            failed = True
            checks.append(Check(name, method, False, shown(str(violation))))
    return checks
