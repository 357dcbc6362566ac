"""Claims of the paper and what computation says of them, with the rule that turns what was computed
into a verdict.

Guarantee: a verdict is reached only through `judge`; a printed statement that fails is called
corrected only when the right one was shown to hold, and refuted only with a witness. What no
computation can decide says why. The claims are data, ``claims.yaml``, whose head says how they are
written.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cache, partial
from importlib import import_module
from pathlib import Path
from typing import Any

import yaml

from ptmcad.extras import missing
from ptmcad.studies.paper.statements import holds

TEXTS = Path(__file__).with_name("claims.yaml")

Text = Mapping[str, Any]
"""A claim as it is written."""
Facts = Mapping[str, Any]
"""What a check computed, by name."""


class Verdict(Enum):
    """What computation says of a claim."""

    CONFIRMED = "confirmed"
    CORRECTED = "corrected"
    REFUTED = "refuted"
    NOT_CHECKED = "not checked"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True)
class Claim:
    """One statement of the paper, and what was computed of it.

    Attributes
    ----------
    name : unique, such as ``3.1-parallelogram``; it begins with the section.
    section : of the paper; ``abstract`` and ``conclusions`` are sections too.
    quotation : a few words by which a reader finds the place.
    statement : the claim in other words.
    right : the right formula or statement where the verdict is CORRECTED.
    witness : where the statement fails.
    reason : why it was NOT_CHECKED or stayed UNDECIDED.
    evidence : sentences, each stating something that was computed.
    facts : the computed values behind them.
    """

    name: str
    section: str
    quotation: str
    statement: str
    verdict: Verdict
    right: str = ""
    witness: str = ""
    reason: str = ""
    evidence: tuple[str, ...] = ()
    facts: Facts | None = None


@cache
def texts() -> Mapping[str, Text]:
    """Every claim as it is written, in the order of the paper's sections."""
    found = yaml.safe_load(TEXTS.read_text(encoding="utf-8"))
    return {name: {**found.get(text.get("like", ""), {}), **text} for name, text in found.items()}


def judge(name: str, text: Text) -> Claim:
    """Compute what is to be computed of a claim, and judge it.

    Guarantee
    ---------
    CONFIRMED if it holds as it is printed; else CORRECTED if the statement ``right`` was shown to
    hold in its place; else REFUTED if there is a witness; else UNDECIDED.
    """
    section = name.partition("-")[0]
    section = {"a": "abstract", "c": "conclusions"}.get(section, section)
    claim = partial(Claim, name, section, text["quotation"], text["statement"])
    if "needs" in text and (why := missing(text["needs"])):
        return claim(verdict=Verdict.NOT_CHECKED, reason=f"it cannot be computed here: {why}")
    facts = dict(_facts(text))
    printed, shown = (_hold(text, key, facts) for key in ("printed", "shown"))
    evidence, right = _sentences(text, "evidence", facts), "".join(_sentences(text, "right", facts))
    # a witness proves nothing while what is said of it was not shown
    witness = "".join(_sentences(text, "witness", facts)) if shown or "shown" not in text else ""
    if reason := text.get("reason"):
        return claim(verdict=Verdict.NOT_CHECKED, reason=reason, evidence=evidence if shown else ())
    computed = partial(claim, evidence=evidence, facts=facts)
    if printed:
        return computed(verdict=Verdict.CONFIRMED)
    if shown and right:
        return computed(verdict=Verdict.CORRECTED, right=right, witness=witness)
    if witness:
        return computed(verdict=Verdict.REFUTED, witness=witness)
    return claim(
        verdict=Verdict.UNDECIDED,
        reason="neither the printed statement nor a corrected one was shown to hold",
        facts=facts,
    )


def _facts(text: Text) -> Facts:
    """What the claim's check computes."""
    if "check" not in text:
        return {}
    module, function = text["check"].split(".")
    found: Facts = getattr(import_module(f"ptmcad.studies.paper.{module}"), function)(
        **text.get("with", {})
    )
    return found


def _hold(text: Text, key: str, facts: dict[str, Any]) -> bool:
    """Whether there are statements under a key and all of them hold; what they say becomes facts."""
    for statement in text.get(key, ()):
        if isinstance(statement, str):
            facts[statement] = holds(statement)
    return key in text and all(
        facts[s] if isinstance(s, str) else _plain({name: facts[name] for name in s}) == s
        for s in text[key]
    )


def _plain(value: Any) -> Any:
    """As it would be read from a file."""
    return json.loads(json.dumps(value, default=str))


def _sentences(text: Text, key: str, facts: Facts) -> tuple[str, ...]:
    """The sentences under a key; one that is nothing but the name of several sentences is these."""
    said = text.get(key, ())
    found: list[str] = []
    for sentence in (said,) if isinstance(said, str) else said:
        several = facts.get(sentence.strip("{}"))
        found += several if isinstance(several, list) else (sentence.format_map(facts),)
    return tuple(found)
