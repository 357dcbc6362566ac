"""``python -m ptmcad.studies.bench STUDY``: measure, print the table, write STUDY.json."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from ptmcad.errors import PtmcadError
from ptmcad.process.output import check_writable, text_writer, write_files
from ptmcad.studies.bench import records, scaling
from ptmcad.studies.bench.harness import made_with, table

STUDIES: dict[str, tuple[str, Callable[[argparse.Namespace], pd.DataFrame], str]] = {
    "times": ("bench", records.timed, "time and memory of whole processes, and forecasts"),
    "ablation": ("ablation", records.ablation, "what each saving is worth"),
    "scaling": ("scaling", scaling.measure, f"how cost grows, along the families {', '.join(scaling.FAMILIES)}"),
}
"""The name of the file, the measurement, and what it is."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a study; the exit status is 0, 1 where an answer differs, or 2 for bad input."""
    parser = argparse.ArgumentParser("python -m ptmcad.studies.bench", description="Measure whole processes.")
    chosen = parser.add_subparsers(dest="study", required=True)
    for name, (_, _, words) in STUDIES.items():
        command = chosen.add_parser(name, help=words, description=words)
        what = "families" if name == "scaling" else "records"
        command.add_argument(what, nargs="*", type=str if what == "families" else Path, help="default: all")
        command.add_argument("--out", type=Path, help="folder for the JSON file and what goes with it")
        command.add_argument("--rounds", type=int, default=3, help="runs of each job (default 3)")
        command.add_argument("--seed", type=int, default=1, help="of all that is drawn (default 1)")
        command.add_argument("--timeout", type=float, default=300, help="seconds for a run (default %(default)g)")
    options = parser.parse_args(arguments)
    for name in ("rounds", "timeout"):
        if not getattr(options, name) > 0:
            parser.error(f"--{name} must be positive")
    name, measure, _ = STUDIES[options.study]
    found = {"format": f"ptmcad-{name}/2", **made_with(), "seed": options.seed, "rounds": options.rounds}
    try:
        if options.out is not None:
            check_writable(options.out, (f"{name}.json",))
        rows = measure(options)
        if options.out is not None:
            found["rows"] = [row.dropna().to_dict() for _, row in rows.iterrows()]
            text = json.dumps(found, indent=1, ensure_ascii=False) + "\n"
            write_files(options.out, {f"{name}.json": text_writer(text)})
            if options.study == "scaling":
                scaling.save_picture(rows, options.out)
    except (PtmcadError, OSError) as error:
        print(f"{options.study}: {error}", file=sys.stderr)
        return 2
    print(table(rows))
    return int("differs" in rows and any(rows["differs"].dropna()))


if __name__ == "__main__":
    sys.exit(main())
