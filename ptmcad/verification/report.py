"""What a verification found: one line for each claim, with the method that checked it.

Guarantee: `VerifyReport.ok` is True only when no check failed; a claim that was not checked is listed as such.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from html import escape
from textwrap import fill
from typing import Any, TypeVar

from ptmcad.errors import LimitReached, shown
from ptmcad.options import Progress

C = TypeVar("C")

COLUMNS = 80
WIDTH = 22
"""Of the column of names, where these are not known yet."""


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

    def row(self, width: int = WIDTH) -> str:
        """Of a table, with a column for the names."""
        answer = {True: "ok", False: "FALSE", None: "not checked"}[self.passed]
        head = f"{answer:<13}{self.name:<{width}}  "
        text = f"{self.detail} ({self.method})" if self.method else self.detail
        return fill(text, COLUMNS, initial_indent=head, subsequent_indent=" " * len(head), break_on_hyphens=False)


class Unchecked(str):
    """What a check returns when it could not decide its claim, or a part of it: the reason."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class VerifyReport:
    """The checks in their order; those after a failed one, or one that a limit stopped, are not reached."""

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

    @property
    def verdict(self) -> str:
        """How many claims hold, are false, or were not checked.

        >>> VerifyReport((Check("a", "", True, ""), Check("b", "", None, ""))).verdict
        '1 claim holds, 1 not checked'
        """
        held, false, open_ = (sum(c.passed is answer for c in self.checks) for answer in (True, False, None))
        parts = [f"{held} claim{'s hold' if held != 1 else ' holds'}"] if not false else [
            f"{false} claim{'s are' if false != 1 else ' is'} false", f"{held} hold{'s' * (held == 1)}"]  # fmt: skip
        return ", ".join(parts + [f"{open_} not checked"] * (open_ > 0))

    def table(self) -> str:
        """A row of at most 80 columns for each check: the answer, the claim, the detail and the method; the verdict."""
        width = max([len(c.name) for c in self.checks], default=0)
        return "\n".join([heading(width), *(c.row(width) for c in self.checks), self.verdict])


def heading(width: int = WIDTH) -> str:
    """Over the rows of checks."""
    return f"{'':<13}{'claim':<{width}}  what was checked, and how"


FINISHED: ContextVar[Callable[[Check], None]] = ContextVar("FINISHED", default=lambda _check: None)
"""Is told each check as soon as it is finished: a process that is ended has printed those."""


def check_anew(stored: Any, found: Any) -> Check:
    """Compare a document, as JSON's data, with the one that the same question gives now.

    Of a document of another version it is said in what it differs, and not that this is false.
    """
    name, method = "all entries", "answered anew, and compared"
    versions = [part.get("versions") if isinstance(part, dict) else None for part in (stored, found)]
    place = next(_differences(stored, found, versions[0] != versions[1]), "")
    if not place:
        return Check(name, method, True, "the answer is the same now")
    if versions[0] != versions[1]:
        return Check(name, method, None, f"another version made it; now {place}")
    return Check(name, method, False, shown(place))


def _differences(stored: Any, found: Any, earlier: bool, place: str = "") -> Iterator[str]:
    # what an earlier version did not write of a part is no difference
    fits = isinstance(stored, dict) and isinstance(found, dict) and stored.keys() <= found.keys()
    if fits and (stored.keys() == found.keys() or (place and earlier)):
        for key in sorted(stored.keys() - {"versions"}):
            yield from _differences(stored[key], found[key], earlier, f"{place}.{key}".lstrip("."))
    elif isinstance(stored, list) and isinstance(found, list) and len(stored) == len(found):
        for k, (one, other) in enumerate(zip(stored, found, strict=True)):
            yield from _differences(one, other, earlier, f"{place}[{k}]")
    elif (type(stored), stored) != (type(found), found):
        yield f"{place} is {found!r:.80}, not {stored!r:.80}"


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
    ended, finished = "", FINISHED.get()
    within = FINISHED.set(lambda _check: None)  # of the checks inside of these
    headway = headway or Headway(None)
    headway.number = len(steps)
    for name, method, check in steps:
        passed: bool | None = None
        detail = ended or "not complete in this partial result"
        if not ended and name not in missing:
            try:
                headway.begins(name)
                detail = check(claims)
                passed = None if isinstance(detail, Unchecked) else True
            except Violation as violation:
                ended, passed, detail = "not reached", False, shown(str(violation))
            except LimitReached as limit:
                ended, detail = f"not reached: {limit}", f"not finished: {limit}"
        checks.append(Check(name, method, passed, detail))
        finished(checks[-1])
    FINISHED.reset(within)
    return checks
