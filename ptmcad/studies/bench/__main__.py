"""``python -m ptmcad.studies.bench STUDY``: measure, print the table, write STUDY.json."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from ptmcad.studies.bench import records, scaling
from ptmcad.studies.bench.harness import study

STUDIES: dict[str, tuple[Callable[..., int], str, float]] = {
    "times": (lambda o: study("bench", o, records.timed), "time and memory of whole processes, and forecasts", 120),
    "ablation": (lambda o: study("ablation", o, records.ablation), "what each saving is worth", 120),
    "scaling": (
        lambda o: study("scaling", o, scaling.measure, scaling.save_picture),
        f"how cost grows, along the families {', '.join(scaling.FAMILIES)}",
        300,
    ),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a study; the exit status is 0, 1 where an answer differs, or 2 for bad input."""
    parser = argparse.ArgumentParser("python -m ptmcad.studies.bench", description="Measure whole processes.")
    chosen = parser.add_subparsers(dest="study", required=True)
    for name, (_, words, timeout) in STUDIES.items():
        command = chosen.add_parser(name, help=words, description=words)
        what = "families" if name == "scaling" else "records"
        command.add_argument(what, nargs="*", type=str if what == "families" else Path, help="default: all")
        command.add_argument("--out", type=Path, help="folder for the JSON file and what goes with it")
        command.add_argument("--rounds", type=int, default=3, help="runs of each job (default 3)")
        command.add_argument("--seed", type=int, default=1, help="of all that is drawn (default 1)")
        command.add_argument("--timeout", type=float, default=timeout, help="seconds for a run (default %(default)g)")
    options = parser.parse_args(arguments)
    for name in ("rounds", "timeout"):
        if not getattr(options, name) > 0:
            parser.error(f"--{name} must be positive")
    return STUDIES[options.study][0](options)


if __name__ == "__main__":
    sys.exit(main())
