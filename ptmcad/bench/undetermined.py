"""Undetermined area against run time of the certified engine: ``python -m ptmcad.bench.undetermined RECORD...``.

Guarantee: each point is one level of one run in this process, after a run that has loaded the compiled code: wall and
processor seconds since the run began, and the exact share of the window that was still open, rounded.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

from ptmcad.bench.suite import machine, versions
from ptmcad.config import load
from ptmcad.errors import LimitReached, PtmcadError

FORMAT = "ptmcad-undetermined/1"


def measure(record: Path, tolerance: Fraction, timeout: float, jobs: int) -> dict[str, Any]:
    """One record's levels as JSON data.

    Raises
    ------
    PtmcadError
        When the record is wrong.
    """
    from ptmcad.interval.engine import certified_map

    slice = load(record)
    points: list[list[float]] = []
    wall, processor = perf_counter(), process_time()

    def reached(share: Fraction) -> None:
        points.append(
            [round(perf_counter() - wall, 2), round(process_time() - processor, 2), float(f"{float(share):.3g}")]
        )

    try:
        result = certified_map(slice, tolerance=tolerance, deadline=wall + timeout, jobs=jobs, reached=reached)
    except LimitReached as stopped:
        assert stopped.partial is not None
        result = stopped.partial  # type: ignore[assignment]
    return {
        "record": slice.name,
        "status": result.status.value,
        "undetermined": float(f"{float(result.undetermined):.3g}"),
        "seconds": round(perf_counter() - wall, 2),
        "processor": round(process_time() - processor, 2),
        "cells": len(result.cells),
        "levels": points,
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and write undetermined.json; the exit status is 0, or 2 for bad input."""
    parser = argparse.ArgumentParser(
        prog="python -m ptmcad.bench.undetermined", description="Undetermined area against run time."
    )
    parser.add_argument("records", nargs="*", type=Path, help="problem records; default: configs/ with free lengths")
    parser.add_argument("--out", type=Path, help="folder for undetermined.json")
    parser.add_argument("--tolerance", type=Fraction, default=Fraction(1, 5000), help="where to stop (default 1/5000)")
    parser.add_argument("--timeout", type=float, default=150.0, help="seconds for each record (default 150)")
    parser.add_argument("--jobs", type=int, default=2, help="threads (default 2)")
    chosen = parser.parse_args(arguments)
    try:
        records = chosen.records or [p for p in sorted(Path("configs").glob("*.yaml")) if load(p).has_free_lengths]
        if records:
            measure(records[0], Fraction(1, 10), 60.0, chosen.jobs)  # loads the compiled code, or compiles it
        rows = []
        for record in records:
            rows.append(measure(record, chosen.tolerance, chosen.timeout, chosen.jobs))
            print(json.dumps(rows[-1]), flush=True)
        if chosen.out is not None:
            data = {
                "format": FORMAT,
                "levels": "wall seconds, processor seconds, undetermined share of the window; one run each",
                "machine": machine(),
                "versions": versions(),
                "jobs": chosen.jobs,
                "rows": rows,
            }
            (chosen.out / "undetermined.json").write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    except (PtmcadError, OSError) as error:
        print(f"python -m ptmcad.bench.undetermined: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
