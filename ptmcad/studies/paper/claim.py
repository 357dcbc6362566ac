"""Claims of the paper and what computation says of them, with the rule that turns what was computed into a verdict.

Guarantee: a verdict is reached only through `outcome`; a printed statement that fails is called corrected only when the
right one was shown to hold, and refuted only with a witness. What no computation can decide says why.

``claims.yaml`` has for each claim a few words of the paper (quotation) and the claim in other words (statement). What
is computed of it are statements of `ptmcad.studies.paper.statements` that hold if the claim does (printed), or if what
is called right does (shown), and a check, a function of `ptmcad.studies.paper.maps` or `ptmcad.studies.paper.free` with
what it is called with; ``needs`` names the optional group of packages that it takes. The rest is what is said of it:
evidence, the right statement, a witness, with names of computed values in braces. A claim that says the same as
another is ``like`` it; one that no computation decides has a reason.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cache, partial
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import yaml

from ptmcad.process.extras import Extra
from ptmcad.studies.paper.statements import holds

TEXTS = Path(__file__).with_name("claims.yaml")
_HERE = "ptmcad.studies.paper"

Values = Mapping[str, Any]
"""What a check computed, by name: facts, and under ``printed`` and ``corrected`` whether the statement holds as it is
printed and whether the right one does in its place; under ``missing`` why the check cannot be made here."""


class Verdict(Enum):
    """What computation says of a claim."""

    CONFIRMED = "confirmed"
    CORRECTED = "corrected"
    REFUTED = "refuted"
    NOT_CHECKED = "not checked"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True)
class Claim:
    """One statement of the paper.

    Attributes
    ----------
    name : unique, such as ``3.1-parallelogram``; it begins with the section.
    text : of ``claims.yaml``.
    """

    name: str
    text: Mapping[str, Any]

    @property
    def section(self) -> str:
        """Of the paper; ``abstract`` and ``conclusions`` are sections too."""
        section = self.name.partition("-")[0]
        return {"a": "abstract", "c": "conclusions"}.get(section, section)

    @property
    def quotation(self) -> str:
        """A few words by which a reader finds the place."""
        return str(self.text["quotation"])

    @property
    def statement(self) -> str:
        """The claim in other words."""
        return str(self.text["statement"])


@dataclass(frozen=True, slots=True)
class Outcome:
    """What was computed of a claim.

    Attributes
    ----------
    evidence : sentences, each stating something that was computed.
    facts : the computed values behind them.
    right : the right formula or statement where the verdict is CORRECTED.
    witness : where the statement fails.
    reason : why it was NOT_CHECKED or stayed UNDECIDED.
    """

    verdict: Verdict
    evidence: tuple[str, ...] = ()
    facts: Values | None = None
    right: str = ""
    witness: str = ""
    reason: str = ""


Judged = tuple[Claim, Outcome]


@cache
def all_claims() -> tuple[Claim, ...]:
    """Every claim, in the order of the paper's sections."""
    texts: dict[str, dict[str, Any]] = yaml.safe_load(TEXTS.read_text(encoding="utf-8"))
    return tuple(Claim(name, {**texts.get(text.get("like", ""), {}), **text}) for name, text in texts.items())


def outcome(claim: Claim) -> Outcome:
    """Compute what is to be computed of a claim, and judge it."""
    text = claim.text
    values: dict[str, Any] = dict(_check(text) if "check" in text else {})
    for key, name in (("printed", "printed"), ("shown", "corrected")):
        if key in text:
            facts = {statement: holds(statement) for statement in text[key]}
            values |= facts
            values[name] = bool(values.get(name, True)) and all(facts.values())
    told = partial(_named, text, values)
    if reason := values.get("missing") or text.get("reason", ""):
        evidence = told("evidence") if values.get("corrected") else ()
        return Outcome(Verdict.NOT_CHECKED, tuple(evidence), {}, reason=reason)
    # a witness proves nothing while what is said of it was not shown
    witness = "" if "shown" in text and not values["corrected"] else "".join(told("witness"))
    return judge(values, told("evidence"), "".join(told("right")), witness)


def _check(text: Mapping[str, Any]) -> Values:
    if "needs" in text and find_spec((extra := Extra[text["needs"]]).package) is None:
        return {"missing": f"it cannot be computed here: {extra.message}"}
    module, function = text["check"].split(".")
    found: Values = getattr(import_module(f"{_HERE}.{module}"), function)(**text.get("with", {}))
    return found


def _named(text: Mapping[str, Any], values: Values, key: str) -> Iterable[str]:
    """The sentences under a key; one that is nothing but the name of several sentences is these."""
    told = text.get(key, ())
    for sentence in (told,) if isinstance(told, str) else told:
        several = values.get(sentence.strip("{}"))
        yield from several if isinstance(several, tuple) else (sentence.format_map(values),)


def judge(values: Values, evidence: Iterable[str] = (), right: str = "", witness: str = "") -> Outcome:
    """The outcome of a claim of which something was computed.

    Guarantee
    ---------
    CONFIRMED if it holds as it is printed; else CORRECTED if the statement ``right`` was shown to hold in its place;
    else REFUTED if there is a witness; else UNDECIDED.
    """
    if values.get("printed"):
        return Outcome(Verdict.CONFIRMED, tuple(evidence), values)
    if values.get("corrected") and right:
        return Outcome(Verdict.CORRECTED, tuple(evidence), values, right, witness)
    if witness:
        return Outcome(Verdict.REFUTED, tuple(evidence), values, witness=witness)
    reason = "neither the printed statement nor a corrected one was shown to hold"
    return Outcome(Verdict.UNDECIDED, (), values, reason=reason)


def judged(claims: Sequence[Claim]) -> Iterable[Judged]:
    """The claims with their outcomes, one after the other; what one claim shares with another is computed once."""
    known: dict[str, Outcome] = {}
    for claim in claims:
        shared = claim.text.get("like", claim.name)
        if shared not in known:
            known[shared] = outcome(claim)
        yield claim, known[shared]
