"""Region maps that many tests read: each is computed once per run.

The processes of a run share these maps as files: the one that comes first computes a map, any other
waits for it.
"""

from __future__ import annotations

import os
import pickle
import re
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from pathlib import Path

import yaml

import ptmcad

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
FOLDER = "PTMCAD_TESTS_MAPS"
"""The variable of the environment that names the folder of this run's maps."""


def once_per_run(name: str, compute: Callable[[], ptmcad.RegionMap]) -> ptmcad.RegionMap:
    """What is computed under this name by the first of a run's processes that asks for it."""
    folder = os.environ.get(FOLDER)
    if folder is None:  # no test run, or a system without locks of this kind
        return compute()
    import fcntl

    path = Path(folder) / f"{name.replace('/', ' of ')}.pickle"
    with path.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.exists():
            path.write_bytes(pickle.dumps(compute()))
        return pickle.loads(path.read_bytes())


@cache
def shipped(name: str, count: str | None = None, area_tolerance: str = "1e-4") -> ptmcad.RegionMap:
    """The region map of a shipped slice."""

    def compute() -> ptmcad.RegionMap:
        return ptmcad.classify(
            ptmcad.load(CONFIGS / f"{name}.yaml"), count=count, area_tolerance=area_tolerance
        )

    return once_per_run(f"{name} {count} {area_tolerance}", compute)


@cache
def shipped_certified(name: str, tolerance: str, count: str | None = None) -> ptmcad.RegionMap:
    """The certified map of a shipped slice at a tolerance like ``"1/100"``, by two threads."""

    def compute() -> ptmcad.RegionMap:
        slice = ptmcad.load(CONFIGS / f"{name}.yaml")
        return ptmcad.classify(
            slice, engine="certified", tolerance=Fraction(tolerance), count=count, jobs=2
        )

    return once_per_run(f"certified {name} {count} {tolerance}", compute)


def record_of_part_of_free02() -> str:
    """A window with two regions of each stable count, in a seventh of the time that all of free02
    takes.
    """
    text = (CONFIGS / "free02.yaml").read_text(encoding="utf-8")
    return re.sub("(?m)^axes: .*$", "axes: {rho: [1/4, 1], L2: [1/4, 3/4]}", text)


@cache
def part_of_free02() -> ptmcad.RegionMap:
    """The certified map of that part of free02's window, to 1/50."""

    def compute() -> ptmcad.RegionMap:
        return ptmcad.classify(yaml.safe_load(record_of_part_of_free02()), tolerance="1/50", jobs=2)

    return once_per_run("part of free02", compute)


@cache
def heavier_fig4() -> ptmcad.RegionMap:
    """Fig. 4's window with other loads, with which fig. 4 is compared."""

    def compute() -> ptmcad.RegionMap:
        slice = ptmcad.slice_from_options(
            slice="rho,L2", ranges=["rho=0:2", "L2=0:2"], sets=["F3=-14", "F4=-8"]
        )
        return ptmcad.classify(slice)

    return once_per_run("heavier fig4", compute)
