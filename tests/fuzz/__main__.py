"""A whole fuzz campaign: ``python -m fuzz`` in the folder tests/. Exit status 1 when it found something.

Records and results are guided by coverage when atheris is installed; without it, and for the other kinds of input, the
cases come from seeds and run under `fuzz.watch`. The numbers of cases are the same either way.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

from fuzz.watch import watched

GUIDED = ("record", "result")
HERE = Path(__file__).resolve().parent


def guided(kind: str, cases: int, seed: int, folder: Path) -> bool:
    """Run a campaign of `fuzz.guided`, print its figures, and return whether it found nothing."""
    start = time.monotonic()
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join((str(HERE.parent), str(HERE.parents[1]))),
    }
    done = subprocess.run(
        [sys.executable, "-m", "fuzz.guided", kind, str(cases), str(seed), str(folder)],
        env=environment, capture_output=True, check=False,
    )  # fmt: skip
    log = done.stderr.decode("utf-8", "replace")
    (folder / f"{kind}.log").write_text(log, encoding="utf-8")
    figures = (
        json.loads((folder / f"{kind}-figures.json").read_text()) if done.returncode == 0 else {}
    )
    covered = re.findall(r"cov: ([0-9]+) ft: ([0-9]+) corp: ([0-9]+)", log)
    edges, features, corpus = covered[-1] if covered else ("?", "?", "?")
    print(f"{kind}: {figures.get('cases', '?')} cases guided by atheris in {time.monotonic() - start:.0f} s, "
          f"{figures.get('outcomes', {})}, slowest {figures.get('slowest', '?')} s; "
          f"{edges} edges, {features} features, {corpus} inputs in the corpus", flush=True)  # fmt: skip
    if done.returncode != 0:
        print(
            f"{kind}: FOUND something (status {done.returncode}), the input is in {folder}:\n{log[-4000:]}"
        )
    return done.returncode == 0


def seeded(kind: str, cases: int, seed: int, folder: Path) -> bool:
    """Run cases made from seeds, print the figures, and return whether nothing was found."""
    start = time.monotonic()
    tally = watched(kind, range(seed * 1_000_000, seed * 1_000_000 + cases), folder)
    slowest, _, number = tally.slowest
    outcomes = {name.partition(" ")[2]: n for name, n in tally.outcomes.items()}
    print(f"{kind}: {tally.cases} cases from seeds in {time.monotonic() - start:.0f} s, {outcomes}, "
          f"slowest {slowest:.3f} s of processor time (number {number})", flush=True)  # fmt: skip
    for finding in tally.findings:
        print(f"FOUND {finding}")
    return not tally.findings


def main() -> int:
    """Run the campaign."""
    parser = argparse.ArgumentParser(
        prog="python -m fuzz", description="Fuzz ptmcad's readers, locate and verify."
    )
    parser.add_argument(
        "--records", type=int, default=100_000, help="problem records [%(default)s]"
    )
    parser.add_argument(
        "--options", type=int, default=20_000, help="options of classify [%(default)s]"
    )
    parser.add_argument("--results", type=int, default=10_000, help="damaged results [%(default)s]")
    parser.add_argument("--points", type=int, default=10_000, help="files of points [%(default)s]")
    parser.add_argument(
        "--small", type=int, default=1_000, help="records that are classified too [%(default)s]"
    )
    parser.add_argument(
        "--seed", type=int, default=1, help="of everything that is drawn [%(default)s]"
    )
    parser.add_argument(
        "--folder", type=Path, default=Path("findings"), help="for findings and logs [%(default)s]"
    )
    parser.add_argument("--no-atheris", action="store_true", help="make every case from a seed")
    asked = parser.parse_args()
    folder = asked.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    by_coverage = not asked.no_atheris and find_spec("atheris") is not None
    if not by_coverage and not asked.no_atheris:
        print(
            "atheris is not installed (it has no wheel for this Python or system): all cases are made from seeds"
        )
    cases = {"record": asked.records, "options": asked.options, "points": asked.points, "small": asked.small,
             "result": asked.results}  # fmt: skip
    clean = True
    for kind, number in cases.items():
        if number > 0:
            campaign = guided if by_coverage and kind in GUIDED else seeded
            clean &= campaign(kind, number, asked.seed, folder)
    print("nothing was found" if clean else f"there are findings, their inputs are in {folder}")
    return 0 if clean else 1


if __name__ == "__main__":
    sys.exit(main())
