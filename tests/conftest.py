"""Hypothesis repeats the same examples in every run, and each region map that many tests read is computed once per run.

The processes of a run share these maps as files: the one that comes first computes a map, any other waits for it.
"""

from __future__ import annotations

import fcntl
import os
import pickle
import shutil
import signal
import tempfile
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

import ptmcad

settings.register_profile(
    "ptmcad",
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large],
)
settings.load_profile("ptmcad")

# a shell makes what it starts in the background ignore Ctrl-C, nohup makes it ignore SIGHUP, and every process that a
# test starts would inherit that
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if hasattr(signal, "SIGHUP"):
    signal.signal(signal.SIGHUP, signal.SIG_DFL)

CONFIGS = Path(__file__).parent.parent / "configs"


_FOLDER = "PTMCAD_TESTS_MAPS"
"""The variable of the environment that names the folder of this run's maps."""


def pytest_configure(config: pytest.Config) -> None:
    # the first process of a run; those that it starts find the folder in their environment
    if _FOLDER not in os.environ:
        folder = tempfile.mkdtemp(prefix="ptmcad-maps-")
        os.environ[_FOLDER] = folder
        config.add_cleanup(lambda: shutil.rmtree(folder, ignore_errors=True))
        config.add_cleanup(lambda: os.environ.pop(_FOLDER, None))


def once_per_run(name: str, compute: Callable[[], ptmcad.RegionMap]) -> ptmcad.RegionMap:
    """What is computed under this name by the first of a run's processes that asks for it."""
    folder = os.environ.get(_FOLDER)
    if folder is None:  # no test run: somebody tries a module of the tests by hand
        return compute()
    path = Path(folder) / f"{name}.pickle"
    with path.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.exists():
            path.write_bytes(pickle.dumps(compute()))
        return pickle.loads(path.read_bytes())


@cache
def shipped(name: str, count: str | None = None, area_tolerance: str = "1e-4") -> ptmcad.RegionMap:
    """The region map of a shipped slice."""

    def compute() -> ptmcad.RegionMap:
        return ptmcad.classify(ptmcad.load(CONFIGS / f"{name}.yaml"), count=count, area_tolerance=area_tolerance)

    return once_per_run(f"{name} {count} {area_tolerance}", compute)


@cache
def shipped_certified(name: str, tolerance: str, count: str | None = None) -> ptmcad.RegionMap:
    """The certified map of a shipped slice at a tolerance like ``"1/100"``, by two threads."""

    def compute() -> ptmcad.RegionMap:
        slice = ptmcad.load(CONFIGS / f"{name}.yaml")
        return ptmcad.classify(slice, engine="certified", tolerance=Fraction(tolerance), count=count, jobs=2)

    return once_per_run(f"certified {name} {count} {tolerance.replace('/', ' of ')}", compute)


@pytest.fixture(name="shipped")
def shipped_fixture() -> object:
    return shipped
