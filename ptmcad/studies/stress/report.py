"""A campaign as text: a table for the terminal, a page, JSON and CSV.

Guarantee: JSON and CSV hold every figure; a number that does not exist is null or empty, never 0.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Sequence
from math import isfinite

from ptmcad.studies.stress.campaign import MAX_COST
from ptmcad.studies.stress.case import Case
from ptmcad.studies.stress.judgement import Row
from ptmcad.studies.tables import columns, page
from ptmcad.studies.tables import markdown as table_of

HEADINGS = ("case", "known", "ptmcad", "double", "double's error", "condition", "bits")
TIMES = ("ms", "x tame")


def cells(row: Row) -> tuple[str, ...]:
    """A row of the table, in the order of `HEADINGS`."""
    numbers = ("-" if row[name] is None else f"{row[name]:.2g}" for name in ("double_error", "condition"))
    return (
        row["name"],
        row["expected"],
        row["found"] if row["right"] else f"{row['found']} WRONG",
        row["double"] if row["double_right"] else f"{row['double']} wrong",
        *numbers,
        str(row["bits"] or "-"),
    )


def table(campaign: Row, wanted: int) -> str:
    """The campaign as a table for a terminal, with a summary below."""
    rows = [(*cells(row), f"{1000 * row['seconds']:.3g}", f"{row['ratio']:.2g}") for row in campaign["cases"]]
    return "\n".join([*columns([(*HEADINGS, *TIMES), *rows]), "", *summary(campaign, wanted)])


def markdown(campaign: Row) -> str:
    """The campaign as a Markdown page, one table for each family.

    Times are left out, so that the same versions write the same page; the work beside its sibling's stands for them.
    """
    names, rows = [*HEADINGS, "work x tame"], campaign["cases"]
    blocks: list[str | list[str]] = []
    for family in dict.fromkeys(row["family"] for row in rows):
        shown = [
            [*cells(row), f"{row['calls'] / max(row['sibling_calls'], 1):.2g}"]
            for row in rows
            if row["family"] == family
        ]
        blocks += [f"## {family[0].upper()}{family[1:]}", table_of(names, shown)]
    written = (
        f"Written by `ptmcad stress` with seed {campaign['seed']}. ptmcad is right in "
        f"{sum(row['right'] for row in rows)} of {len(rows)} cases; double precision is wrong in "
        f"{sum(not row['double_right'] for row in rows)}."
    )
    return page("# The stress cases, one by one", written, *blocks)


def summary(campaign: Row, wanted: int) -> Iterable[str]:
    """What the campaign says, line by line.

    Parameters
    ----------
    wanted : how many cases were to be run.
    """
    rows = campaign["cases"]
    yield f"ptmcad is right in {sum(row['right'] for row in rows)} of {len(rows)} cases"
    for row in rows:
        if not row["right"]:
            yield f"  {row['name']}: {'; '.join(row['remarks'])}"
    yield f"double precision is wrong in {sum(not row['double_right'] for row in rows)} of {len(rows)}"
    if rows:
        worst = max(rows, key=lambda row: float(row["ratio"]))
        yield (
            f"an extreme case costs at most {worst['ratio']:.2g} times its tame sibling ({worst['name']}); "
            f"more than {MAX_COST:g} times: {sum(row['ratio'] > MAX_COST for row in rows)}"
        )
    if wanted > len(rows):
        yield f"stopped: {wanted - len(rows)} cases were not run"


def listing(cases: Sequence[Case]) -> str:
    """Name, family, question and source of each case."""
    return "\n".join(columns([(c.name, c.family, c.question.kind, c.source) for c in cases]))


def to_json(campaign: Row) -> str:
    """Everything about a campaign."""
    document = {**campaign, "cases": [_plain(row) for row in campaign["cases"]]}
    return json.dumps(document, indent=1, allow_nan=False) + "\n"


def to_csv(campaign: Row) -> str:
    """The same, one row for each case."""
    text = io.StringIO()
    rows = [_plain(row) for row in campaign["cases"]]
    if rows:
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows({**row, "remarks": "; ".join(row["remarks"])} for row in rows)
    return text.getvalue()


def _plain(row: Row) -> Row:
    """A row with None for a number that JSON does not have."""
    return {n: None if isinstance(value, float) and not isfinite(value) else value for n, value in row.items()}
