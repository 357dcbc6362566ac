"""A campaign as text: a table for the terminal, a page, JSON and CSV.

Guarantee: JSON and CSV hold every figure; a number that does not exist is null or empty, never 0.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from itertools import groupby
from math import isfinite

from ptmcad.studies.stress.campaign import MAX_COST
from ptmcad.studies.stress.case import Case
from ptmcad.studies.stress.judgement import Row
from ptmcad.studies.tables import columns, page
from ptmcad.studies.tables import markdown as table_of

HEADINGS = ("case", "known", "ptmcad", "double", "double's error", "condition", "bits")


def cells(row: Row) -> tuple[str, ...]:
    """A row of the table, in the order of `HEADINGS`."""
    numbers = ("-" if row[name] is None else f"{row[name]:.2g}" for name in ("double_error", "condition"))
    found = row["found"] + (" WRONG" if not row["right"] else "")
    double = row["double"] + (" wrong" if not row["double_right"] else "")
    return row["name"], row["expected"], found, double, *numbers, str(row["bits"] or "-")


def table(campaign: Row, wanted: int) -> str:
    """The campaign as a table for a terminal, with a summary below."""
    rows = [(*cells(row), f"{1000 * row['seconds']:.3g}", f"{row['ratio']:.2g}") for row in campaign["cases"]]
    return "\n".join([*columns([(*HEADINGS, "ms", "x tame"), *rows]), "", *summary(campaign, wanted)])


def markdown(campaign: Row) -> str:
    """The campaign as a Markdown page, one table for each family.

    Times are left out, so that the same versions write the same page; the work beside its sibling's stands for them.
    """
    order = list(dict.fromkeys(row["family"] for row in campaign["cases"]))
    rows = sorted(campaign["cases"], key=lambda row: order.index(row["family"]))
    blocks: list[str | list[str]] = []
    for family, members in groupby(rows, lambda row: row["family"]):
        shown = [(*cells(row), f"{row['calls'] / max(row['sibling_calls'], 1):.2g}") for row in members]
        blocks += [f"## {family[0].upper()}{family[1:]}", table_of([*HEADINGS, "work x tame"], shown)]
    right, double, *_ = summary(campaign, len(rows), remarks=False)
    written = f"Written by `ptmcad stress` with seed {campaign['seed']}. {right}; {double}."
    return page("# The stress cases, one by one", written, *blocks)


def summary(campaign: Row, wanted: int, remarks: bool = True) -> list[str]:
    """What the campaign says, line by line.

    Parameters
    ----------
    wanted : how many cases were to be run.
    remarks : whether what is wrong is said of each case.
    """
    rows = campaign["cases"]
    wrong = [row for row in rows if not row["right"]]
    lines = [f"ptmcad is right in {len(rows) - len(wrong)} of {len(rows)} cases"]
    lines += [f"  {row['name']}: {'; '.join(row['remarks'])}" for row in wrong if remarks]
    lines.append(f"double precision is wrong in {sum(not row['double_right'] for row in rows)} of {len(rows)}")
    if rows:
        worst = max(rows, key=lambda row: float(row["ratio"]))
        lines.append(
            f"an extreme case costs at most {worst['ratio']:.2g} times its tame sibling ({worst['name']}); "
            f"more than {MAX_COST:g} times: {sum(row['ratio'] > MAX_COST for row in rows)}"
        )
    return lines + ([f"stopped: {wanted - len(rows)} cases were not run"] if wanted > len(rows) else [])


def listing(cases: Sequence[Case]) -> str:
    """Name, family, question and source of each case."""
    return "\n".join(columns([(c.name, c.family, c.question.kind, c.source) for c in cases]))


def to_json(campaign: Row) -> str:
    """Everything about a campaign."""
    return json.dumps({**campaign, "cases": _plain(campaign)}, indent=1, allow_nan=False) + "\n"


def to_csv(campaign: Row) -> str:
    """The same, one row for each case."""
    text, rows = io.StringIO(), _plain(campaign)
    writer = csv.DictWriter(text, list(rows[0]) if rows else [], lineterminator="\n")
    if rows:
        writer.writeheader()
    writer.writerows({**row, "remarks": "; ".join(row["remarks"])} for row in rows)
    return text.getvalue()


def _plain(campaign: Row) -> list[Row]:
    """The rows with None for a number that JSON does not have."""
    return [
        {name: None if isinstance(value, float) and not isfinite(value) else value for name, value in row.items()}
        for row in campaign["cases"]
    ]
