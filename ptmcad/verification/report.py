"""What a verification found: one line for each claim, with the method that checked it.

Guarantee: `VerifyReport.ok` is True only when no check failed; a claim that was not checked is
listed as such.
"""

from __future__ import annotations

import os
import random
from collections.abc import Callable, Collection, Iterator, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import partial
from html import escape
from textwrap import fill
from typing import Any, TypeVar

from ptmcad.errors import LimitReached, shown
from ptmcad.options import Progress
from ptmcad.text.numerals import fraction_of

C = TypeVar("C")
Within = Callable[[int, int], None]
"""Called with the numbers of parts of a check that are done, and of all."""

COLUMNS = 80
WIDTH = 22
"""Of the column of names, where these are not known yet."""


def drawn(seed: int | None) -> str:
    """The seed of all random choices; a fresh one where none is given, to which no claims can be fitted."""
    return str(int.from_bytes(os.urandom(8)) if seed is None else seed)


def share(source: random.Random, parts: int = 2**20) -> Fraction:
    """The middle of one of so many equal parts of the numbers from 0 to 1."""
    return Fraction(2 * source.randrange(parts) + 1, 2 * parts)


class Violation(Exception):
    """A claim of the result is false; the message holds the claim and a witness."""


class NotKnown(ArithmeticError):
    """What decides a claim was not found out: the claim is not checked."""


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

    Of a document of another version its differences are not checked, but where it is known what may
    differ rightly: there all others are false.

    Parameters
    ----------
    rightly : the keys of what another version may have written otherwise. In addition, its
        enclosures may be wider, and it may have left open what is decided now.
    finer : asked where they differ, gives the document with more digits. An enclosure that has the
        one in there holds, whatever the one found now is; of one that only meets it nothing is
        said.
    """
    name, method = "all entries", "answered anew, and compared"
    versions = [
        part.get("versions") if isinstance(part, dict) else None for part in (stored, found)
    ]
    earlier = versions[0] != versions[1]
    differences = partial(_differences, stored, found, earlier=earlier, rightly=rightly)
    detail = "the answer is the same now"
    places = list(differences(None))
    if places and (more := finer()) is not None:
        detail += "; enclosures have those with more digits"
        places = list(differences(more))
    if earlier:
        detail = "of another version; the answer now agrees with it"
    if not places:
        return Check(name, method, True, detail)
    can_be_false = not earlier or rightly is not None
    false = [place for place in places if not isinstance(place, Unchecked)] if can_be_false else []
    first = (false or places)[0]
    if earlier and not false:
        first = f"another version made it; now {first}"
        first += f"; {len(places) - 1} more entries differ" * (len(places) > 1)
    return Check(name, method, False if false else None, shown(first))


def _differences(
    stored: Any,
    found: Any,
    finer: Any,
    place: str = "",
    *,
    earlier: bool,
    rightly: Collection[str] | None,
) -> Iterator[str]:
    """In what a document differs; `Unchecked` where that is no contradiction."""
    differs = f"{place.lstrip('.')} is {found!r:.80}, not {stored!r:.80}"
    ends, true = _ends(stored), _ends(finer) or (_ends(found) if earlier else None)
    parts, others, fine = _parts(stored), _parts(found), _parts(finer)
    if ends and true:
        (low, high), (least, most) = ends, true
        is_rounded = _is_decimal_of(stored.get("decimal"), true)
        if not (low <= least and most <= high and is_rounded):
            differs = f"{place.lstrip('.')} is in {least!s:.30} to {most!s:.30}, not {stored!r:.80}"
            yield Unchecked(differs) if low <= most and least <= high and is_rounded else differs
    elif earlier and place.rpartition(".")[2] in (rightly or ()):
        if stored != found:
            yield Unchecked(differs)
    elif (
        type(stored) is type(found)
        and (parts or others)
        and (isinstance(stored, dict) or len(parts) == len(others))
    ):
        for key in dict.fromkeys([*parts, *others]):
            where = f"{place}{key}"
            if key in parts and key in others:
                pair = parts[key], others[key], fine.get(key), where
                yield from _differences(*pair, earlier=earlier, rightly=rightly)
            # what an earlier version did not write of a part is no difference
            elif key in parts or not (place and earlier and rightly is None):
                yield f"{where.lstrip('.')} is {'not there' if key in parts else 'missing'}"
    elif (type(stored), stored) != (type(found), found):
        is_open = earlier and {type(stored), type(found)} == {bool, type(None)}
        yield Unchecked(differs) if is_open else differs


def _parts(entry: Any) -> dict[str, Any]:
    """What is in a mapping or a list, by its place there; nothing in anything else."""
    if isinstance(entry, dict):
        return {f".{key}": part for key, part in entry.items() if key != "versions"}
    return {f"[{k}]": part for k, part in enumerate(entry if isinstance(entry, list) else ())}


def _ends(entry: Any) -> tuple[Fraction, Fraction] | None:
    """Of an enclosure, as documents have them; None of anything else."""
    if not isinstance(entry, dict):
        return None
    if entry.keys() == {"low", "high", "decimal"}:
        return fraction_of(entry["low"]), fraction_of(entry["high"])
    if entry.keys() == {"text", "center", "radius"}:
        center, radius = fraction_of(entry["center"]), fraction_of(entry["radius"])
        return center - radius, center + radius
    return None


def _is_decimal_of(text: str | None, ends: tuple[Fraction, Fraction]) -> bool:
    """Whether a decimal, where there is one, is within a unit of its last digit from a number."""
    if text is None:
        return True
    unit = Fraction(10) ** int(Decimal(text).as_tuple().exponent)
    return all(abs(fraction_of(text) - end) <= unit for end in ends)


PROVENANCE = Check(
    "provenance",
    "",
    None,
    "name, title, reference, versions, precision, timings: no claims about the regions",
)
"""What no check is of."""
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
            except NotKnown as reason:
                detail = str(reason)
            except LimitReached as limit:
                ended, detail = f"not reached: {limit}", f"not finished: {limit}"
        checks.append(Check(name, method, passed, detail))
        finished(checks[-1])
    FINISHED.reset(within)
    return checks
