"""``python -m ptmcad.studies.bench.scaling``: measure, write scaling.json, scaling.md and a picture of each family."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ptmcad.studies.bench.command import Command, progress, save
from ptmcad.studies.bench.scaling.families import FAMILIES, families_named
from ptmcad.studies.bench.scaling.run import MAX_SECONDS, ROUNDS, scaling
from ptmcad.studies.bench.scaling.table import grouped, to_markdown

PICTURES = ("svg", "png")
MIN_PICTURE_SIZES = 3
"""Places along a family from which on a picture shows more than the table."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure; the exit status is 0, or 2 for bad input."""
    names = ", ".join(f.name for f in FAMILIES)
    command = Command(
        "bench.scaling",
        "How processor time and memory grow with degree, height, regions, solutions, tolerance.",
        files="JSON, page and pictures",
        rounds=ROUNDS,
        epilog=f"Families: {names}. Example: python -m ptmcad.studies.bench.scaling fold grid --rounds 1 --out out",
    )
    command.add_argument("families", nargs="*", help="families by name; default: all")
    command.add_argument(
        "--limit", type=float, default=MAX_SECONDS, help=f"seconds for one run (default {MAX_SECONDS:g})"
    )
    chosen = command.chosen(arguments)
    if not chosen.limit > 0:
        command.error("--limit must be positive")

    def work() -> int:
        if chosen.out is not None:
            chosen.out.mkdir(parents=True, exist_ok=True)
        wanted = families_named(chosen.families)
        report = scaling(wanted, chosen.rounds, chosen.seed, limit=chosen.limit, progress=progress)
        save(chosen.out, "scaling", report, to_markdown(report))
        if chosen.out is not None:
            _draw(report, chosen.out)
        print(to_markdown(report), end="")
        return 0

    return command.status(work)


def _draw(report: dict[str, Any], folder: Path) -> None:
    # loaded after the measurement, whose children would inherit its pages
    from ptmcad.show.render.printing import save
    from ptmcad.studies.bench.scaling.picture import draw_scaling

    for family in report["families"]:
        if len(grouped(family)) >= MIN_PICTURE_SIZES:
            figure = draw_scaling(family)
            for suffix in PICTURES:
                save(figure, folder / f"scaling-{family['name']}.{suffix}")


if __name__ == "__main__":
    sys.exit(main())
