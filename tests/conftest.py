"""Hypothesis repeats the same examples in every run, and the processes of a run have a folder in common."""

from __future__ import annotations

import gc
import os
import shutil
import signal
import tempfile
from collections.abc import Iterator

import pytest
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
    # the first process of a run; those that it starts find the folder in their environment
    if FOLDER not in os.environ and os.name == "posix":
        folder = tempfile.mkdtemp(prefix="ptmcad-maps-")
        os.environ[FOLDER] = folder
        config.add_cleanup(lambda: shutil.rmtree(folder, ignore_errors=True))
        config.add_cleanup(lambda: os.environ.pop(FOLDER, None))


def pytest_collection_finish() -> None:
    # the modules and tests of the whole suite stay to its end: the collector need not go through them again and again,
    # nor forked children copy them for it
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session", name="one")
def one_browser() -> Iterator[Browser]:
    """One Chromium for all tests of pages that a process runs."""
    with browser() as found:
        yield found


@pytest.fixture(name="shipped")
def shipped_fixture() -> object:
    return shipped
