"""All claims of the paper, in the order of its sections: what they say is data, and what is computed of them is here.

Guarantee: names are unique; each check is independent of the others, so they may run in any order.

``claims.yaml`` has for each claim a few words of the paper (quotation), the claim in other words (statement), the check
(a function of this package, and what it is called with) and what is said of its finding: evidence, the right statement,
a witness. A claim that says the same as another is ``like`` it; one that no computation decides has a reason instead.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import yaml

from ptmcad.studies.paper.claim import Claim, Finding, Outcome, outcome, unchecked

TEXTS = Path(__file__).parents[1] / "claims.yaml"


def all_claims() -> tuple[Claim, ...]:
    """Every claim, sorted by section."""
    found: dict[str, Claim] = {}
    for name, text in yaml.safe_load(TEXTS.read_text(encoding="utf-8")).items():
        section = name.partition("-")[0]
        section = {"a": "abstract", "c": "conclusions"}.get(section, section)
        check = found[text["like"]].check if "like" in text else _check(text)
        found[name] = Claim(name, section, text["quotation"], text["statement"], check)
    return tuple(found.values())


def _check(text: Mapping[str, Any]) -> Callable[[], Outcome]:
    if "check" not in text:
        return unchecked(text["reason"])
    module, function = text["check"].split(".")
    compute: Callable[..., Finding] = getattr(import_module(f"{__name__}.{module}"), function)
    said = {key: text[key] for key in ("evidence", "right", "witness") if key in text}
    return lambda: outcome(compute(**text.get("with", {})), **said)
