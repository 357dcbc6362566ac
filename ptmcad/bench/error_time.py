"""Error against run time: ``python -m ptmcad.bench.error_time RECORD --out FOLDER``, a file that the report shows.

Guarantee: each point is the median wall time of whole processes of ``ptmcad classify`` with one area tolerance, and the
largest relative width of the areas' bounds in the result that they wrote. Tolerances take turns, so that a busy minute
of the machine does not fall on one of them.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import tempfile
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

from ptmcad.bench.process import Outcome, run
from ptmcad.config import load
from ptmcad.errors import PtmcadError
from ptmcad.regionmap import RegionMap

FORMAT = "ptmcad-error-time/1"
TOLERANCES = tuple(f"1e-{k}" for k in (1, 2, 3, 4, 6, 8, 10, 12))


def measure(record: Path, tolerances: Sequence[str] = TOLERANCES, rounds: int = 3) -> dict[str, object]:
    """The measurement as JSON data.

    Raises
    ------
    PtmcadError
        When the record is wrong or a run fails.
    """
    name = load(record).name
    program = [sys.executable, "-m", "ptmcad", "classify", str(record.resolve()), "--format", "json", "--out"]
    seconds: dict[str, list[float]] = {tolerance: [] for tolerance in tolerances}
    errors: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(rounds):
            for tolerance in tolerances:
                usage = run([*program, folder, "--area-tolerance", tolerance])
                if usage.outcome is not Outcome.DONE:
                    raise PtmcadError(f"the run with tolerance {tolerance} {usage.outcome.value}: {usage.message}")
                seconds[tolerance].append(usage.seconds)
                result = RegionMap.from_json((Path(folder) / f"{name}.json").read_text(encoding="utf-8"))
                errors[tolerance] = float(_error(result))
    points = [[round(statistics.median(seconds[t]), 4), errors[t]] for t in tolerances if errors[t] > 0]
    return {
        "format": FORMAT,
        "error": "Largest relative width of the bounds of a region's area; whole processes, start-up included.",
        "series": [{"name": "exact engine", "points": points}],
    }


def _error(result: RegionMap) -> Fraction:
    return max((high - low) / low if low else Fraction(1) for low, high in (r.area for r in result.regions))


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and write NAME.error-time.json; the exit status is 0, or 2 for bad input."""
    parser = argparse.ArgumentParser(prog="python -m ptmcad.bench.error_time", description="Error against run time.")
    parser.add_argument("record", type=Path, help="a problem record")
    parser.add_argument("--out", type=Path, default=Path(), help="folder for NAME.error-time.json (default .)")
    parser.add_argument("--rounds", type=int, default=3, help="runs for each tolerance (default 3)")
    parser.add_argument("--tolerances", default=",".join(TOLERANCES), help="of areas (default %(default)s)")
    chosen = parser.parse_args(arguments)
    if chosen.rounds < 1:
        parser.error("--rounds must be at least 1")
    try:
        data = measure(chosen.record, chosen.tolerances.split(","), chosen.rounds)
        chosen.out.mkdir(parents=True, exist_ok=True)
        target = chosen.out / f"{load(chosen.record).name}.error-time.json"
        target.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    except (PtmcadError, OSError) as error:
        print(f"python -m ptmcad.bench.error_time: {error}", file=sys.stderr)
        return 2
    print(target)
    return 0


if __name__ == "__main__":
    sys.exit(main())
