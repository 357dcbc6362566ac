"""Hypothesis repeats the same examples in every run, and the processes of a run have a folder in common."""

from __future__ import annotations

import gc
import os
import shutil
import signal
import tempfile
from collections.abc import Generator, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from _pytest.doctest import DoctestModule
from hypothesis import HealthCheck, settings
from support.browser import Browser, browser
from support.examples import ALL, FAST, FEW, THOROUGH
from support.maps import FOLDER, shipped

for _profile, _number in ((FAST, FEW), (THOROUGH, ALL)):
    settings.register_profile(
        _profile,
        max_examples=_number,
        derandomize=True,
        deadline=None,
        database=None,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large],
    )
settings.load_profile(FAST)  # where no other one is asked for on the command line

# a shell makes what it starts in the background ignore Ctrl-C, nohup makes it ignore SIGHUP, and every process that a
# test starts would inherit that
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if hasattr(signal, "SIGHUP"):
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def pytest_configure(config: pytest.Config) -> None:
    gc.disable()  # until all is collected: nearly all that is made until then stays
    # the first process of a run; those that it starts find the folder in their environment
    if FOLDER not in os.environ and os.name == "posix":
        folder = tempfile.mkdtemp(prefix="ptmcad-maps-")
        os.environ[FOLDER] = folder
        config.add_cleanup(lambda: shutil.rmtree(folder, ignore_errors=True))
        config.add_cleanup(lambda: os.environ.pop(FOLDER, None))


def pytest_collection_finish() -> None:
    # the modules and tests of the whole suite stay to its end: the collector need not go through them again and again,
    # nor forked children copy them for it; and of what tests make, maps and figures, it need not look for cycles often
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 50)
    gc.enable()


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Curves of pictures to a fiftieth of the window, and branches at a third of the values: for tests of what else the
    pictures show. How near curves are, and that branches are joined right, have tests of their own."""
    from ptmcad.ask import boundaries, branches

    fine = boundaries.chains
    monkeypatch.setattr(boundaries, "chains", lambda found, wanted: fine(found, max(wanted, Fraction(1, 50))))
    monkeypatch.setattr(branches, "SAMPLES", 8)


@pytest.hookimpl(wrapper=True)
def pytest_collect_file(file_path: Path) -> Generator[None, Any, Any]:
    """Of the modules, doctests are looked for in those that have an example."""
    found = yield
    if file_path.suffix == ".py" and b">>>" not in file_path.read_bytes():
        found = [node for node in found if not isinstance(node, DoctestModule)]
    return found


@pytest.fixture(scope="session", name="one")
def one_browser() -> Iterator[Browser]:
    """One Chromium for all tests of pages that a process runs."""
    with browser() as found:
        yield found


@pytest.fixture(name="shipped")
def shipped_fixture() -> object:
    return shipped
