"""Undetermined area against run time of the certified engine: ``python -m ptmcad.studies.bench.undetermined
RECORD...``.

Guarantee: each point is one run in this process, with a tolerance of half that of the run before, after a run that has
loaded the compiled code: wall and processor seconds, and the exact share of the window that was left, rounded.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

from ptmcad.answer.regionmap import RegionMap
from ptmcad.errors import LimitReached
from ptmcad.options import Options
from ptmcad.question.config import load
from ptmcad.studies.bench.harness import Command, Record, made_with

FORMAT = "ptmcad-undetermined/2"
COARSEST = Fraction(1, 100)


def measure(record: Path, finest: Fraction, timeout: float, jobs: int) -> dict[str, Any]:
    """One record's runs as JSON data: tolerances from `COARSEST`, halved until the finest, or until one takes too long.

    Parameters
    ----------
    timeout : seconds for a run; what was left undetermined then is a point, too.

    Raises
    ------
    PtmcadError
        When the record is wrong.
    """
    from ptmcad.certified.engine import certified_map

    slice = load(record)
    runs: list[dict[str, Any]] = []
    tolerance = COARSEST
    while tolerance >= finest and all(run["status"] == "certified" for run in runs):
        wall, processor = perf_counter(), process_time()
        try:
            result = certified_map(slice, Options(tolerance=tolerance, deadline=wall + timeout, jobs=jobs))
        except LimitReached as stopped:
            if not isinstance(stopped.partial, RegionMap):
                raise
            result = stopped.partial
        runs.append({
            "tolerance": str(tolerance),
            "status": result.status.value,
            "undetermined": float(f"{float(result.undetermined):.3g}"),
            "seconds": round(perf_counter() - wall, 2),
            "processor": round(process_time() - processor, 2),
            "cells": len(result.cells),
            "rectangles": len(result.cover.rectangles) if result.cover else 0,
        })  # fmt: skip
        tolerance /= 2
    return {"record": slice.name, "runs": runs}


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and write undetermined.json; the exit status is 0, or 2 for bad input."""
    command = Command("bench.undetermined", "Undetermined area against run time.", "undetermined")
    command.add_argument("records", nargs="*", type=Path, help="problem records; default: configs/ with free lengths")
    command.add_argument("--finest", type=Fraction, default=Fraction(1, 25600), help="tolerance (default 1/25600)")
    command.add_argument("--timeout", type=float, default=150.0, help="seconds for each run (default 150)")
    command.add_argument("--jobs", type=int, default=2, help="threads (default 2)")
    chosen = command.chosen(arguments)
    records = command.records(chosen.records, lambda slice: slice.has_free_lengths)

    def work() -> Record:
        found: Record = {"format": FORMAT, **made_with(), "jobs": chosen.jobs, "rows": []}
        measure(records[0], COARSEST, 60.0, chosen.jobs)  # loads the compiled code, or compiles it
        for record in records:
            found["rows"].append(measure(record, chosen.finest, chosen.timeout, chosen.jobs))
            print(json.dumps(found["rows"][-1]), flush=True)
        return found

    return command.status(chosen.out, work)


if __name__ == "__main__":
    sys.exit(main())
