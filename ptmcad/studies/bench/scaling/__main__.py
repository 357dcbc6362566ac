"""``python -m ptmcad.studies.bench.scaling``: measure, write scaling.json, scaling.md and a picture of each family."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from ptmcad.studies.bench.harness import Command, Record
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
        "scaling",
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
    return command.status(
        chosen.out,
        lambda: scaling(families_named(chosen.families), chosen.rounds, chosen.seed, chosen.limit),
        to_markdown,
        _draw,
    )


def _draw(report: Record, folder: Path) -> None:
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
