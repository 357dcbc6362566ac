"""``python -m ptmcad.studies.bench``: run the benchmark, write JSON and Markdown."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from ptmcad.errors import PtmcadError
from ptmcad.question.config import load
from ptmcad.studies.bench.command import NO_RECORDS, Command, progress, save
from ptmcad.studies.bench.report import to_json, to_markdown
from ptmcad.studies.bench.suite import Plan, measure


def _exact_records(folder: Path) -> list[Path]:
    """The records that the exact engine answers; a map with free lengths takes as long as it is given."""
    return [path for path in sorted(folder.glob("*.yaml")) if not load(path).has_free_lengths]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmark; the exit status is 0, or 2 for bad input."""
    command = Command(
        "bench",
        "Time and memory of whole `ptmcad classify` processes, against the machine's floor.",
        files="bench.json and bench.md",
        rounds=5,
        epilog="example: python -m ptmcad.studies.bench configs/fig4.yaml --rounds 3 --out /tmp",
    )
    command.add_argument("records", nargs="*", type=Path, help="problem records; default: configs/, no free lengths")
    command.add_argument("--picture-rounds", type=int, default=2, help="runs with PNG and SVG too (default 2)")
    command.add_argument("--timeout", type=float, default=120.0, help="seconds for each run (default 120)")
    command.add_argument("--date", default="", help="recorded in the report as it is")
    chosen = command.chosen(arguments)
    try:
        records = chosen.records or _exact_records(Path("configs"))
    except PtmcadError as error:
        command.error(str(error))
    if not records:
        command.error(NO_RECORDS)
    if chosen.picture_rounds < 0:
        command.error("--picture-rounds must be at least 0")

    def work() -> int:
        plan = Plan(chosen.rounds, chosen.picture_rounds, chosen.timeout, chosen.seed)
        report = measure(records, plan, date=chosen.date, progress=progress)
        save(chosen.out, "bench", to_json(report), to_markdown(report))
        print(to_markdown(report), end="")
        return 0

    return command.status(work)


if __name__ == "__main__":
    sys.exit(main())
