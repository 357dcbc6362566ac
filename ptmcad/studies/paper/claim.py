"""Claims of the paper and what computation says of them: frozen data, with the rule that turns evidence into a verdict.

Guarantee: a verdict is reached only through `judge`; a printed statement that fails is called corrected only when the
right one was shown to hold, and refuted only with a witness. What no computation can decide says why (`unchecked`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum

Fact = bool | int | str | tuple[int, ...] | tuple[str, ...]
"""One computed result: what a test can compute again. Exact numbers that are not integers are text."""


class Verdict(Enum):
    """What computation says of a claim."""

    CONFIRMED = "confirmed"
    CORRECTED = "corrected"
    REFUTED = "refuted"
    NOT_CHECKED = "not checked"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True)
class Finding:
    """What a check computed; the sentences that tell it are the claim's, in ``claims.yaml``.

    Attributes
    ----------
    printed : whether the statement holds as it is printed.
    facts : the computed values.
    corrected : whether the statement that the claim's text calls right was shown to hold in its place.
    said : further values that the sentences name; several sentences, where one is nothing but such a name.
    missing : why the check cannot be made here, where that is so.
    """

    printed: bool
    facts: Mapping[str, Fact]
    corrected: bool = False
    said: Mapping[str, object] = field(default_factory=dict)
    missing: str = ""


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of one check.

    Attributes
    ----------
    evidence : sentences, each stating something that was computed.
    facts : the computed values behind them.
    right : the right formula or statement where the verdict is CORRECTED.
    witness : where the statement fails when it is REFUTED.
    reason : why it was NOT_CHECKED or stayed UNDECIDED.
    """

    verdict: Verdict
    evidence: tuple[str, ...]
    facts: Mapping[str, Fact]
    right: str = ""
    witness: str = ""
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Claim:
    """One statement of the paper.

    Attributes
    ----------
    name : unique, such as ``3.1-parallelogram``; it begins with the section.
    section : of the paper; ``abstract`` and ``conclusions`` are sections too.
    quotation : a few words by which a reader finds the place.
    statement : the claim in other words.
    check : computes the outcome; takes nothing, changes nothing.
    """

    name: str
    section: str
    quotation: str
    statement: str
    check: Callable[[], Outcome]


def outcome(finding: Finding, evidence: Sequence[str] = (), right: str = "", witness: str = "") -> Outcome:
    """The outcome of a check that computed whether the printed statement holds.

    Parameters
    ----------
    evidence, right, witness : what the claim's text says, with names of computed values in braces.
    """
    values = {**finding.facts, **finding.said}
    told: list[str] = []
    for sentence in () if finding.missing and not values else evidence:
        several = values.get(sentence.strip("{}"))
        told += several if isinstance(several, tuple) else [sentence.format_map(values)]
    if finding.missing:
        return unchecked(finding.missing, *told)()
    right, witness = right.format_map(values), witness.format_map(values)
    return judge(finding.printed, tuple(told), finding.facts, corrected=finding.corrected, right=right, witness=witness)


def judge(
    printed: bool,
    evidence: tuple[str, ...],
    facts: Mapping[str, Fact],
    *,
    corrected: bool = False,
    right: str = "",
    witness: str = "",
) -> Outcome:
    """The outcome of a check that computed whether the printed statement holds.

    Parameters
    ----------
    printed : whether the statement holds as it is printed.
    corrected : whether the statement ``right`` was shown to hold in its place.
    witness : where the printed statement fails, in words with exact numbers.

    Guarantee
    ---------
    CONFIRMED if ``printed``; else CORRECTED if ``corrected``; else REFUTED if there is a witness; else UNDECIDED.
    """
    if printed:
        return Outcome(Verdict.CONFIRMED, evidence, facts)
    if corrected and right:
        return Outcome(Verdict.CORRECTED, evidence, facts, right=right, witness=witness)
    if witness:
        return Outcome(Verdict.REFUTED, evidence, facts, witness=witness)
    reason = "neither the printed statement nor a corrected one was shown to hold"
    return Outcome(Verdict.UNDECIDED, evidence, facts, reason=reason)


def unchecked(reason: str, *evidence: str) -> Callable[[], Outcome]:
    """The check of a statement that no computation can decide; ``reason`` says why."""
    return lambda: Outcome(Verdict.NOT_CHECKED, evidence, {}, reason=reason)
