"""Hypothesis repeats the same examples in every run, and the region maps of the shipped slices are computed once."""

from __future__ import annotations

import signal
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


@cache
def shipped(name: str, count: str | None = None, area_tolerance: str = "1e-4") -> ptmcad.RegionMap:
    """The region map of a shipped slice."""
    return ptmcad.classify(ptmcad.load(CONFIGS / f"{name}.yaml"), count=count, area_tolerance=area_tolerance)


@pytest.fixture(name="shipped")
def shipped_fixture() -> object:
    return shipped
