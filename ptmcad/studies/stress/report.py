"""A campaign as text: a table for the terminal, a page, JSON and CSV.

Guarantee: JSON and CSV hold every figure; a number that does not exist is null or empty, never 0.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Sequence
from math import isfinite
from typing import Any

from ptmcad.studies.stress.campaign import MAX_COST, Campaign, Outcome
from ptmcad.studies.stress.case import Case
from ptmcad.studies.tables import columns, page
from ptmcad.studies.tables import markdown as table_of
from ptmcad.text.numerals import shortest_text

_OF_VERDICT = (
    "expected", "found", "right", "remarks", "double", "double_right", "error", "double_error", "condition", "bits"
)  # fmt: skip
_OF_COST = ("calls", "sibling_calls", "seconds", "sibling_seconds", "ratio", "ratio_low", "ratio_high")
HEADINGS = ("case", "known", "ptmcad", "double", "double's error", "condition", "bits")
TIMES = ("ms", "x tame")


def cells(outcome: Outcome) -> tuple[str, ...]:
    """A row of the table, in the order of `HEADINGS`."""
    v = outcome.verdict
    numbers = ("-" if value is None else f"{value:.2g}" for value in (v.double_error, v.condition))
    return (
        outcome.case.name,
        v.expected,
        v.found if v.right else f"{v.found} WRONG",
        v.double if v.double_right else f"{v.double} wrong",
        *numbers,
        str(v.bits or "-"),
    )


def table(campaign: Campaign) -> str:
    """The campaign as a table for a terminal, with a summary below."""
    rows = [(*cells(o), f"{1000 * o.seconds:.3g}", f"{o.ratio:.2g}") for o in campaign.outcomes]
    return "\n".join([*columns([(*HEADINGS, *TIMES), *rows]), "", *summary(campaign)])


def markdown(campaign: Campaign) -> str:
    """The campaign as a Markdown page, one table for each family.

    Times are left out, so that the same versions write the same page; the work beside its sibling's stands for them.
    """
    names = [*HEADINGS, "work x tame"]
    wrong, total = len(campaign.double_wrong), len(campaign.outcomes)
    blocks: list[str | list[str]] = []
    for family in dict.fromkeys(o.case.family for o in campaign.outcomes):
        rows = [[*cells(o), f"{o.work_ratio:.2g}"] for o in campaign.outcomes if o.case.family == family]
        blocks += [f"## {family[0].upper()}{family[1:]}", table_of(names, rows)]
    written = (
        f"Written by `ptmcad stress` with seed {campaign.seed}. ptmcad is right in {total - len(campaign.wrong)} of "
        f"{total} cases; double precision is wrong in {wrong}."
    )
    return page("# The stress cases, one by one", written, *blocks)


def summary(campaign: Campaign) -> Iterable[str]:
    """What the campaign says, line by line."""
    total = len(campaign.outcomes)
    yield f"ptmcad is right in {total - len(campaign.wrong)} of {total} cases"
    for outcome in campaign.wrong:
        yield f"  {outcome.case.name}: {'; '.join(outcome.verdict.remarks)}"
    yield f"double precision is wrong in {len(campaign.double_wrong)} of {total}"
    if campaign.outcomes:
        worst = max(campaign.outcomes, key=lambda o: o.ratio)
        yield (
            f"an extreme case costs at most {worst.ratio:.2g} times its tame sibling ({worst.case.name}); "
            f"more than {MAX_COST:g} times: {len(campaign.expensive)}"
        )
    if not campaign.complete:
        yield f"stopped: {campaign.wanted - total} cases were not run"


def listing(cases: Sequence[Case]) -> str:
    """Name, family, question and source of each case."""
    return "\n".join(columns([(c.name, c.family, c.question.kind, c.source) for c in cases]))


def to_json(campaign: Campaign) -> str:
    """Everything about a campaign."""
    document = {
        "kind": "ptmcad stress",
        **{name: getattr(campaign, name) for name in ("complete", "seed", "repeats", "machine", "versions")},
        "cases": [record(outcome) for outcome in campaign.outcomes],
    }
    return json.dumps(document, indent=1, allow_nan=False) + "\n"


def to_csv(campaign: Campaign) -> str:
    """The same, one row for each case."""
    text = io.StringIO()
    rows = [record(outcome) for outcome in campaign.outcomes]
    if rows:
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows({**row, "remarks": "; ".join(row["remarks"])} for row in rows)
    return text.getvalue()


def record(outcome: Outcome) -> dict[str, Any]:
    """A case and what came out, as plain data; None for a number that JSON does not have."""
    case = outcome.case
    values = {
        "name": case.name,
        "family": case.family,
        "asked": case.question.kind,
        "stiffness": shortest_text(case.stiffness),
        "source": case.source,
        **{name: getattr(outcome.verdict, name) for name in _OF_VERDICT},
        **{name: getattr(outcome, name) for name in _OF_COST},
    }
    return {n: None if isinstance(value, float) and not isfinite(value) else value for n, value in values.items()}
