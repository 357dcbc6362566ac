"""What a verification found: one line for each claim, with the method that checked it.

Guarantee: `VerifyReport.ok` is True only when no check failed; a claim that was not checked is
listed as such.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from html import escape
from textwrap import fill
from typing import Any, TypeVar

from ptmcad.errors import LimitReached, shown
from ptmcad.options import Progress
from ptmcad.text.numerals import fraction_of

C = TypeVar("C")

COLUMNS = 80
WIDTH = 22
"""Of the column of names, where these are not known yet."""


def drawn(seed: int | None) -> str:
    """The seed of all random choices; a fresh one where none is given, to which no claims can be fitted."""
    return str(int.from_bytes(os.urandom(8)) if seed is None else seed)


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
        return fill(
            text,
            COLUMNS,
            initial_indent=head,
            subsequent_indent=" " * len(head),
            break_on_hyphens=False,
        )


class Unchecked(str):
    """What a check returns when it could not decide its claim, or a part of it: the reason."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class VerifyReport:
    """The checks in their order; those after a failed one, or one that a limit stopped, are not
    reached.
    """

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
        held, false, open_ = (
            sum(c.passed is answer for c in self.checks) for answer in (True, False, None)
        )
        parts = (
            [f"{held} claim{'s hold' if held != 1 else ' holds'}"]
            if not false
            else [
                f"{false} claim{'s are' if false != 1 else ' is'} false",
                f"{held} hold{'s' * (held == 1)}",
            ]
        )
        return ", ".join(parts + [f"{open_} not checked"] * (open_ > 0))

    def table(self) -> str:
        """A row of at most 80 columns for each check: the answer, the claim, the detail and the
        method; the verdict.
        """
        width = max([len(c.name) for c in self.checks], default=0)
        return "\n".join([heading(width), *(c.row(width) for c in self.checks), self.verdict])


def heading(width: int = WIDTH) -> str:
    """Over the rows of checks."""
    return f"{'':<13}{'claim':<{width}}  what was checked, and how"


FINISHED: ContextVar[Callable[[Check], None]] = ContextVar("FINISHED", default=lambda _check: None)
"""Receives each check as soon as it is finished: a process that is ended has printed those."""


def check_anew(
    stored: Any,
    found: Any,
    finer: Callable[[], Any] = lambda: None,
    rightly: Collection[str] | None = None,
) -> Check:
    """Compare a document, as JSON's data, with the one that the same question gives now.

    Of a document of another version it is said in what it differs. That this is false is said where
    it is known what may differ rightly.

    Parameters
    ----------
    rightly : the keys of what another version may have written otherwise. Besides, its enclosures
        may be wider, and it may not have decided what is true or false now.
    finer : asked where they differ, gives the document with more digits. An enclosure that has the
        one in there holds, whatever the one found now is; of one that only meets it nothing is
        said.
    """
    name, method = "all entries", "answered anew, and compared"
    versions = [
        part.get("versions") if isinstance(part, dict) else None for part in (stored, found)
    ]
    earlier = versions[0] != versions[1]
    if earlier and rightly is not None:
        places = list(_contradictions(stored, found, rightly))
        if (wrong := next((p for p in places if not isinstance(p, Unchecked)), None)) is not None:
            return Check(name, method, False, shown(wrong))
        detail = "of another version; the answer now agrees with it"
        if not places:
            return Check(name, method, True, detail)
        return Check(name, method, None, f"another version made it; now {places[0]}")
    if next(_differences(stored, found, None, earlier), None) is None:
        return Check(name, method, True, "the answer is the same now")
    places = list(_differences(stored, found, finer(), earlier))
    if not places:
        return Check(
            name, method, True, "the answer is the same now; enclosures have those with more digits"
        )
    if earlier:
        return Check(name, method, None, f"another version made it; now {places[0]}")
    false = next((place for place in places if not isinstance(place, Unchecked)), None)
    return Check(name, method, None if false is None else False, shown(false or places[0]))


def _differences(
    stored: Any, found: Any, finer: Any, earlier: bool, place: str = ""
) -> Iterator[str]:
    if stored != found and _is_enclosure(stored) and _is_enclosure(finer):
        (low, high), (least, most) = _ends(stored), _ends(finer)
        is_rounded = _is_decimal_of(stored["decimal"], (least, most))
        if not (low <= least and most <= high and is_rounded):
            differs = f"{place} is in {least!s:.30} to {most!s:.30}, not {stored!r:.80}"
            yield Unchecked(differs) if low <= most and least <= high and is_rounded else differs
        return
    # what an earlier version did not write of a part is no difference
    fits = isinstance(stored, dict) and isinstance(found, dict) and stored.keys() <= found.keys()
    if fits and (stored.keys() == found.keys() or (place and earlier)):
        for key in sorted(stored.keys() - {"versions"}):
            part = finer.get(key) if isinstance(finer, dict) else None
            yield from _differences(
                stored[key], found[key], part, earlier, f"{place}.{key}".lstrip(".")
            )
    elif isinstance(stored, list) and isinstance(found, list) and len(stored) == len(found):
        parts = (
            finer if isinstance(finer, list) and len(finer) == len(found) else [None] * len(found)
        )
        for k, (one, other, part) in enumerate(zip(stored, found, parts, strict=True)):
            yield from _differences(one, other, part, earlier, f"{place}[{k}]")
    elif (type(stored), stored) != (type(found), found):
        yield f"{place} is {found!r:.80}, not {stored!r:.80}"


def _contradictions(
    stored: Any, found: Any, rightly: Collection[str], place: str = ""
) -> Iterator[str]:
    """Where a document contradicts one of another version; `Unchecked` where they differ without a
    contradiction.
    """
    differs = f"{place} is {found!r:.80}, not {stored!r:.80}"
    if _is_number(stored) and _is_number(found):
        (low, high), (least, most) = _reach(stored), _reach(found)
        if not (low <= least and most <= high):
            yield Unchecked(differs) if low <= most and least <= high else differs
    elif isinstance(stored, dict) and isinstance(found, dict):
        for key in sorted((stored.keys() | found.keys()) - {"versions"}):
            where = f"{place}.{key}".lstrip(".")
            if key in rightly:
                if stored.get(key) != found.get(key):
                    differs = f"{where} is {found.get(key)!r:.80}, not {stored.get(key)!r:.80}"
                    yield Unchecked(differs)
            elif key not in found or key not in stored:
                yield f"{where} is {'not there' if key in stored else 'missing'}"
            else:
                yield from _contradictions(stored[key], found[key], rightly, where)
    elif isinstance(stored, list) and isinstance(found, list) and len(stored) == len(found):
        for k, (one, other) in enumerate(zip(stored, found, strict=True)):
            yield from _contradictions(one, other, rightly, f"{place}[{k}]")
    elif (type(stored), stored) != (type(found), found):
        is_open = {type(stored), type(found)} == {bool, type(None)}
        yield Unchecked(differs) if is_open else differs


def _is_number(entry: Any) -> bool:
    return isinstance(entry, dict) and entry.keys() == {"text", "center", "radius"}


def _reach(number: Mapping[str, str]) -> tuple[Fraction, Fraction]:
    center, radius = fraction_of(number["center"]), fraction_of(number["radius"])
    return center - radius, center + radius


def _is_enclosure(entry: Any) -> bool:
    return isinstance(entry, dict) and entry.keys() == {"low", "high", "decimal"}


def _ends(enclosure: Mapping[str, str]) -> tuple[Fraction, Fraction]:
    return fraction_of(enclosure["low"]), fraction_of(enclosure["high"])


def _is_decimal_of(text: str | None, ends: tuple[Fraction, Fraction]) -> bool:
    """Whether a decimal, where there is one, is within a unit of its last digit from a number."""
    if text is None:
        return True
    unit = Fraction(10) ** int(Decimal(text).as_tuple().exponent)
    return all(abs(fraction_of(text) - end) <= unit for end in ends)


PARTS = 100
"""Of each check, for a bar that shows how far a verification is."""


@dataclass(slots=True)
class CheckProgress:
    """The progress of a verification, reported as progress(words, done, total), which only
    grows.
    """

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
    bar: CheckProgress | None = None,
) -> list[Check]:
    """Run checks, given as name, method and function, in their order; none after a failed one, none
    of the missing.
    """
    checks: list[Check] = []
    ended, finished = "", FINISHED.get()
    within = FINISHED.set(lambda _check: None)  # of the checks inside of these
    bar = bar or CheckProgress(None)
    bar.number = len(steps)
    for name, method, check in steps:
        passed: bool | None = None
        detail = ended or "not complete in this partial result"
        if not ended and name not in missing:
            try:
                bar.begins(name)
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
