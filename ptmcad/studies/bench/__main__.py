"""``python -m ptmcad.studies.bench``: run the benchmark, write JSON and Markdown."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from ptmcad.errors import PtmcadError
from ptmcad.question.config import load
from ptmcad.studies.bench.report import to_json, to_markdown
from ptmcad.studies.bench.suite import measure


def _exact_records(folder: Path) -> list[Path]:
    """The records that the exact engine answers; a map with free lengths takes as long as it is given."""
    return [path for path in sorted(folder.glob("*.yaml")) if not load(path).has_free_lengths]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmark; the exit status is 0, or 2 for bad input."""
    parser = argparse.ArgumentParser(
        prog="python -m ptmcad.studies.bench",
        description="Time and memory of whole `ptmcad classify` processes, against the machine's floor.",
        epilog="example: python -m ptmcad.studies.bench configs/fig4.yaml --rounds 3 --out /tmp",
    )
    parser.add_argument("records", nargs="*", type=Path, help="problem records; default: configs/ without free lengths")
    parser.add_argument("--out", type=Path, help="folder for bench.json and bench.md; default: print the table only")
    parser.add_argument("--rounds", type=int, default=5, help="runs of each job (default 5)")
    parser.add_argument("--picture-rounds", type=int, default=2, help="runs with PNG and SVG too (default 2)")
    parser.add_argument("--timeout", type=float, default=120.0, help="seconds for each run (default 120)")
    parser.add_argument("--seed", type=int, default=1, help="of the order within a round (default 1)")
    parser.add_argument("--date", default="", help="recorded in the report as it is")
    chosen = parser.parse_args(arguments)
    try:
        records = chosen.records or _exact_records(Path("configs"))
    except PtmcadError as error:
        parser.error(str(error))
    if not records:
        parser.error("no configs/*.yaml here: name the problem records, or change to the project's folder")
    if chosen.rounds < 1 or chosen.picture_rounds < 0:
        parser.error("--rounds must be at least 1 and --picture-rounds at least 0")
    try:
        report = measure(
            records,
            rounds=chosen.rounds,
            picture_rounds=chosen.picture_rounds,
            timeout=chosen.timeout,
            seed=chosen.seed,
            date=chosen.date,
            progress=lambda message: print(message, file=sys.stderr),
        )
        if chosen.out is not None:
            chosen.out.mkdir(parents=True, exist_ok=True)
            (chosen.out / "bench.json").write_text(to_json(report), encoding="utf-8")
            (chosen.out / "bench.md").write_text(to_markdown(report), encoding="utf-8")
    except (PtmcadError, OSError) as error:
        print(f"python -m ptmcad.studies.bench: {error}", file=sys.stderr)
        return 2
    print(to_markdown(report), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
