"""Judgement of altered maps: rejected by some check, or accepted by all."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import ptmcad
from forger import cells, curves, frame, rearrangements
from forger.consistency import Alteration, Kind
from ptmcad.answer.regionmap import RegionMap
from ptmcad.verification.checks import checks_of
from ptmcad.verification.claims import Claims
from ptmcad.verification.report import Violation


@dataclass(slots=True)
class Tally:
    """Numbers of alterations of each kind: places that there are, tried ones, and the wrongly
    judged ones.
    """

    places: dict[str, int] = field(default_factory=dict)
    tried: dict[str, int] = field(default_factory=dict)
    wrong: list[str] = field(default_factory=list)
    by: dict[str, int] = field(default_factory=dict)
    likely: dict[str, str] = field(default_factory=dict)
    """The check that rejected the last alteration of a kind."""


MALFORMED = (IndexError, KeyError, ValueError, TypeError, AttributeError, ArithmeticError)
"""What a check may stumble over when those before it were left out."""


BEFORE = {"variety complete": ("irreducible components",), "areas": ("walls and samples",)}
"""Checks that another one rests on: without them it need not end. Where a wall is not there, its
panels are halved for hours."""


def violation(r: RegionMap, likely: str = "") -> tuple[str, str] | None:
    """The check that rejects a map and its words; None when every check accepts.

    As `ptmcad.verify` stops at the first violated claim, a map is rejected by it exactly when it is
    by some check. So the check that is likely to reject it is tried first.
    """
    claims = Claims(r)
    checks = {name: check for name, _, check in checks_of(None)}
    for name in (*BEFORE.get(likely, ()), *([likely] if likely else [])):
        try:
            checks[name](claims)
        except Violation as found:
            return name, str(found)
        except MALFORMED:
            claims = Claims(r)
    for name, check in checks.items():
        if name != likely or likely == "":
            try:
                check(claims)
            except Violation as found:
                return name, str(found)
    return None


def places_of(
    kind: Kind, r: RegionMap, number: int | None, seed: str
) -> tuple[int, list[tuple[int, Alteration]]]:
    """How many places there are for a kind, and so many of them at random, or all."""
    places = list(enumerate(kind(r)))
    chosen = (
        places
        if number is None or number >= len(places)
        else random.Random(seed).sample(places, number)
    )
    return len(places), chosen


def judge(
    name: str, r: RegionMap, kinds: Sequence[Kind], false: bool, number: int | None, tally: Tally,
    told: Callable[[str], None] = lambda _: None,
) -> None:  # fmt: skip
    """Try alterations of a map; those that are judged wrongly are noted."""
    for kind in kinds:
        label = kind.__name__
        there, chosen = places_of(kind, r, number, f"{name} {label}")
        tally.places[label] = tally.places.get(label, 0) + there
        for place, make in chosen:
            altered = make()
            tally.tried[label] = tally.tried.get(label, 0) + 1
            if false:
                found = violation(altered, tally.likely.get(label, ""))
                if found is None:
                    tally.wrong.append(f"{name}: {label} {place} accepted")
                    told(tally.wrong[-1])
                else:
                    tally.likely[label] = found[0]
                    key = f"{label}: {found[0]}"
                    tally.by[key] = tally.by.get(key, 0) + 1
            else:
                report = ptmcad.verify(altered)
                if not report.ok:
                    tally.wrong.append(f"{name}: {label} {place} rejected: {report.violation}")
                    told(tally.wrong[-1])


FALSE = (*cells.KINDS, *curves.KINDS, *frame.KINDS)
LIKELY = {
    "adjacency": "adjacencies", "all_adjacencies": "no adjacency missing", "box": "solutions", "counts": "counts",
    "component": "variety complete", "critical": "critical values", "sample": "walls and samples",
    "wall": "walls and samples", "plan": "plan", "non_adjacency": "non-adjacencies", "area": "areas",
    "region": "regions", "equations": "equations", "text": "parameters as written",
    "continuum": "boundary components",
}  # fmt: skip
"""The check that is tried first, by how a kind's name begins: it makes tests faster, and no weaker.
"""


def judged(name: str, r: RegionMap, number: int | None, true: int | None = None) -> Tally:
    """Judge so many places of each kind, and of so many true kinds."""
    tally = Tally(likely={k.__name__: check for k in FALSE for begin, check in LIKELY.items()
                          if k.__name__.startswith(begin)})  # fmt: skip
    judge(name, r, FALSE, True, number, tally)
    judge(name, r, rearrangements.KINDS[:true], False, number, tally)
    return tally
