"""What all measurements have in common: jobs take turns, times are summed up, a command writes a record and its page.

Guarantee: in each round every job that is due runs once, in an order drawn from the seed, so that a slow minute of the
machine hits all alike, and that the i-th figures of two jobs belong together.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import random
import statistics
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from ptmcad.errors import PtmcadError
from ptmcad.process.output import text_writer, write_files
from ptmcad.question.config import load
from ptmcad.question.slice import Slice
from ptmcad.studies.bench import qepcad
from ptmcad.studies.bench.process import run
from ptmcad.studies.tables import installed

PACKAGES = ("ptmcad", "python-flint", "numpy", "click", "PyYAML", "matplotlib", "sympy", "numba", "scipy", "gcad")
T = TypeVar("T")
Record = dict[str, Any]
"""What a command measured, as JSON data."""


@dataclass(frozen=True, slots=True)
class Times:
    """Seconds of repeated runs."""

    runs: int
    median: float
    minimum: float
    maximum: float


def times(seconds: Sequence[float]) -> Times:
    """Median and spread, rounded to 0.1 ms."""
    return Times(len(seconds), *(round(x, 4) for x in (statistics.median(seconds), min(seconds), max(seconds))))


def ratio(numerators: Sequence[float], denominators: Sequence[float]) -> float:
    """The median of the ratios of the same rounds; the longer sequence's last ones have no partner."""
    return statistics.median(a / b for a, b in zip(numerators, denominators, strict=False))


def rounds(number: int, due: Callable[[int], Sequence[T]], order: random.Random) -> Iterator[list[T]]:
    """For each round the jobs that are due then, shuffled; `due` is asked when the round begins."""
    for index in range(number):
        yield order.sample(list(due(index)), len(due(index)))


def made_with() -> dict[str, dict[str, str]]:
    """What figures depend on: the machine, without anything that identifies it, and versions."""
    processor = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        models = [line.partition(":")[2].strip() for line in cpuinfo.read_text().splitlines() if "model name" in line]
        processor = models[0] if models else processor
    machine = {
        "processor": processor,
        "cores": str(os.cpu_count()),
        "system": f"{platform.system()} {platform.machine()}",
        "load before": " ".join(f"{load:.2f}" for load in os.getloadavg()),
    }
    where = qepcad.program()
    told = [] if where is None else run((where, "-v"), timeout=10).output.strip().splitlines() or ["unknown"]
    versions = {"python": platform.python_version(), **installed(PACKAGES)}
    return {"machine": machine, "versions": versions | {"qepcad": told[0] if told else "not installed"}}


def progress(message: str) -> None:
    """What is being done, on standard error."""
    print(message, file=sys.stderr, flush=True)


class Command(argparse.ArgumentParser):
    """``python -m ptmcad.studies.NAME``: measures, writes RECORD.json and RECORD.md, and prints the page.

    Parameters
    ----------
    record : the name of the files.
    rounds : the default of --rounds; with 0 nothing takes turns.
    """

    def __init__(self, name: str, description: str, record: str, *, rounds: int = 0, epilog: str | None = None) -> None:
        super().__init__(prog=f"python -m ptmcad.studies.{name}", description=description, epilog=epilog)
        self.record = record
        self.add_argument("--out", type=Path, help=f"folder for {record}.json and what goes with it")
        if rounds:
            self.add_argument("--rounds", type=int, default=rounds, help=f"runs of each job (default {rounds})")
            self.add_argument("--seed", type=int, default=1, help="of all that is drawn (default 1)")

    def chosen(self, arguments: Sequence[str] | None) -> argparse.Namespace:
        """The options, --rounds being positive."""
        found = self.parse_args(arguments)
        if getattr(found, "rounds", 1) < 1:
            self.error("--rounds must be at least 1")
        return found

    def records(self, given: Sequence[Path], wanted: Callable[[Slice], bool]) -> Sequence[Path]:
        """The problem records that are given, else those in configs/ that are wanted, at least one."""
        try:
            found = given or [path for path in sorted(Path("configs").glob("*.yaml")) if wanted(load(path))]
        except PtmcadError as error:
            self.error(str(error))
        if not found:
            self.error("no configs/*.yaml here: name the problem records, or change to the project's folder")
        return found

    def status(
        self,
        out: Path | None,
        measure: Callable[[], Record],
        page: Callable[[Record], str] = lambda _: "",
        more: Callable[[Record, Path], object] = lambda found, folder: None,
        wrong: Callable[[Record], bool] = lambda _: False,
    ) -> int:
        """Measure and write; the exit status: 0, 1 where the record is wrong, or 2, with a message, for bad input.

        Parameters
        ----------
        out : the folder, which is made before anything is measured.
        more : writes what goes with record and page.
        """
        try:
            if out is not None:
                out.mkdir(parents=True, exist_ok=True)
            found = measure()
            text = page(found)
            if out is not None:
                record = json.dumps(found, indent=1, ensure_ascii=False) + "\n"
                pages = {f"{self.record}.md": text_writer(text)} if text else {}
                write_files(out, {**pages, f"{self.record}.json": text_writer(record)})
                more(found, out)
        except (PtmcadError, OSError) as error:
            print(f"{self.prog}: {error}", file=sys.stderr)
            return 2
        print(text, end="")
        return int(wrong(found))
