"""``python -m ptmcad.studies.bench.systems``: run all programs, write systems.json and systems.md."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from ptmcad.studies.bench.harness import Command, Record
from ptmcad.studies.bench.systems.measuring import Plan, measure
from ptmcad.studies.bench.systems.table import to_markdown

RECORDS = (
    "fig2",
    "fig4",
    "stiffness",
    "systems/cubic",
    "systems/orthogonal-3r",
    "systems/kuramoto",
    "systems/kuramoto-4",
    "mechanisms/x-joint",
    "mechanisms/two-bar-chain",
    "mechanisms/two-dof-tensegrity",
    "mechanisms/four-bar",
    "mechanisms/five-bar",
)
"""Three slices of the paper's mechanism, four systems and five mechanisms: from one that is done by hand to one whose
map is out of reach."""


def differs(found: Record) -> bool:
    """Whether an answer is not what ptmcad says."""
    return any(check["agrees"] is False for row in found["rows"] for check in row["agreement"].values())


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write the page; the exit status is 0, 1 when two programs differ, or 2 for bad input."""
    default = Plan()
    command = Command(
        "bench.systems",
        "The same systems with ptmcad, msolve, Singular, QEPCAD and gcad.",
        "systems",
        rounds=default.rounds,
        epilog="example: python -m ptmcad.studies.bench.systems configs/fig4.yaml --rounds 1 --out out",
    )
    command.add_argument("records", nargs="*", type=Path, help="problem records; default: twelve of those in configs/")
    command.add_argument(
        "--timeout", type=float, default=default.timeout, help=f"seconds for a program (default {default.timeout:g})"
    )
    command.add_argument(
        "--points", type=int, default=default.points, help=f"where solutions are asked for (default {default.points})"
    )
    command.add_argument("--date", default="", help="recorded in the report as it is")
    chosen = command.chosen(arguments)
    if not chosen.timeout > 0:
        command.error("--timeout must be positive")
    if chosen.points < 1:
        command.error("--points must be at least 1")
    records = chosen.records or [Path("configs", f"{name}.yaml") for name in RECORDS]
    if not chosen.records and not all(path.is_file() for path in records):
        command.error("no configs/ here: name the problem records, or change to the project's folder")
    plan = Plan(chosen.rounds, chosen.timeout, chosen.points, chosen.seed)
    return command.status(chosen.out, lambda: measure(records, plan, chosen.date), to_markdown, wrong=differs)


if __name__ == "__main__":
    sys.exit(main())
