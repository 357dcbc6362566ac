"""``python -m ptmcad.studies.bench.scaling``: measure, write scaling.json, scaling.md and a picture of each family."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ptmcad.errors import PtmcadError
from ptmcad.studies.bench.scaling.families import FAMILIES, families_named
from ptmcad.studies.bench.scaling.run import MAX_SECONDS, ROUNDS, abscissa, scaling
from ptmcad.studies.bench.scaling.table import to_markdown

PICTURES = ("svg", "png")
MIN_PICTURE_SIZES = 3
"""Places along a family from which on a picture shows more than the table."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure; the exit status is 0, or 2 for bad input."""
    names = ", ".join(f.name for f in FAMILIES)
    parser = argparse.ArgumentParser(
        prog="python -m ptmcad.studies.bench.scaling",
        description="How processor time and memory grow with degree, height, regions, solutions, tolerance.",
        epilog=f"Families: {names}. Example: python -m ptmcad.studies.bench.scaling fold grid --rounds 1 --out out",
    )
    parser.add_argument("families", nargs="*", help="families by name; default: all")
    parser.add_argument("--out", type=Path, help="folder for JSON, page and pictures; default: print only")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help=f"runs of each size (default {ROUNDS})")
    parser.add_argument("--seed", type=int, default=1, help="of slices, order and resampling (default 1)")
    parser.add_argument(
        "--limit", type=float, default=MAX_SECONDS, help=f"seconds for one run (default {MAX_SECONDS:g})"
    )
    chosen = parser.parse_args(arguments)
    if chosen.rounds < 1:
        parser.error("--rounds must be at least 1")
    if not chosen.limit > 0:
        parser.error("--limit must be positive")
    try:
        if chosen.out is not None:
            chosen.out.mkdir(parents=True, exist_ok=True)
        report = scaling(
            families_named(chosen.families),
            chosen.rounds,
            chosen.seed,
            limit=chosen.limit,
            progress=lambda message: print(message, file=sys.stderr),
        )
        if chosen.out is not None:
            (chosen.out / "scaling.json").write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
            (chosen.out / "scaling.md").write_text(to_markdown(report), encoding="utf-8")
            _draw(report, chosen.out)
    except (PtmcadError, OSError) as error:
        print(f"python -m ptmcad.studies.bench.scaling: {error}", file=sys.stderr)
        return 2
    print(to_markdown(report), end="")
    return 0


def _draw(report: dict[str, Any], folder: Path) -> None:
    # loaded after the measurement, whose children would inherit its pages
    from ptmcad.show.render.printing import save
    from ptmcad.studies.bench.scaling.picture import draw_scaling

    for family in report["families"]:
        if len({abscissa(family["against"], run) for run in family["runs"]}) >= MIN_PICTURE_SIZES:
            figure = draw_scaling(family)
            for suffix in PICTURES:
                save(figure, folder / f"scaling-{family['name']}.{suffix}")


if __name__ == "__main__":
    sys.exit(main())
