"""Hypothesis repeats the same examples in every run, and the processes of a run have a folder in
common.
"""

from __future__ import annotations

import gc
import importlib
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Generator, Iterator
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from _pytest.doctest import DoctestModule
from hypothesis import HealthCheck, settings
from support.browser import Browser, browser
from support.examples import ALL, FAST, FEW, THOROUGH
from support.maps import FOLDER, shipped

ROOT = Path(__file__).resolve().parents[1]

for _profile, _number in ((FAST, FEW), (THOROUGH, ALL)):
    settings.register_profile(
        _profile,
        max_examples=_number,
        derandomize=True,
        deadline=None,
        database=None,
        suppress_health_check=[
            HealthCheck.too_slow,
            HealthCheck.filter_too_much,
            HealthCheck.data_too_large,
        ],
    )
settings.load_profile(FAST)  # where no other one is asked for on the command line

# a shell makes what it starts in the background ignore Ctrl-C, nohup makes it ignore SIGHUP, and
# every process that a test starts would inherit that
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if hasattr(signal, "SIGHUP"):
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


class ModulesWithExamples:
    """Of the modules, doctests are looked for in those that have an example: no other one is even
    imported for them.
    """

    @pytest.hookimpl(wrapper=True)
    def pytest_collect_file(self, file_path: Path) -> Generator[None, Any, Any]:
        found = yield
        if file_path.suffix == ".py" and b">>>" not in file_path.read_bytes():
            found = [node for node in found if not isinstance(node, DoctestModule)]
        return found


def pytest_configure(config: pytest.Config) -> None:
    gc.disable()  # until all is collected: nearly all that is made until then stays
    # a conftest's own hooks see what lies below its folder, and most examples are in the package
    config.pluginmanager.register(ModulesWithExamples(), "modules-with-examples")
    # the first process of a run; those that it starts find the folder in their environment
    if FOLDER not in os.environ and os.name == "posix":
        folder = tempfile.mkdtemp(prefix="ptmcad-maps-")
        os.environ[FOLDER] = folder
        config.add_cleanup(lambda: shutil.rmtree(folder, ignore_errors=True))
        config.add_cleanup(lambda: os.environ.pop(FOLDER, None))
    whole = config.args_source is pytest.Config.ArgsSource.TESTPATHS
    if whole and not hasattr(config, "workerinput") and config.getoption("numprocesses", None):
        compile_beside(config)


def pytest_sessionstart(session: pytest.Session) -> None:
    worker = getattr(session.config, "workerinput", None)
    if worker is not None and session.config.args_source is pytest.Config.ArgsSource.TESTPATHS:
        import_in_turn(int(worker["workerid"].removeprefix("gw")), worker["workercount"])


def import_in_turn(number: int, count: int) -> None:
    """Import the test modules before they are collected, each process of a whole run from another
    one on.

    All collect in one order, and in a fresh clone each would compile every module for itself, which
    takes longer than the rest of the collection: like this each finds in the others' share what
    these have written.
    """
    files = sorted((ROOT / "tests").glob("*/**/test_*.py"))
    first = len(files) * number // count
    for file in files[first:] + files[:first]:
        if (file.parent / "__init__.py").exists():
            continue  # part of a package, with another name
        if str(file.parent) not in sys.path:
            sys.path.insert(0, str(file.parent))
        with suppress(
            Exception, pytest.skip.Exception
        ):  # the collection comes upon it again, and reports it
            importlib.import_module(file.stem)


_COMPILE = """
from ptmcad.certified.loading import load
load()
import ptmcad
from support.records import TRUSS
ptmcad.verify(ptmcad.classify(TRUSS, engine="certified", tolerance="1/10"), boxes=0)
"""


def compile_beside(config: pytest.Config) -> None:
    """Compile the certified engine while tests are collected: processes that come to it wait, and
    compile nothing. Then what searches the free area of its maps, which is wanted later.

    For runs of the whole suite by several processes, each of which would otherwise compile at about
    the same time.
    """
    compiling = subprocess.Popen(
        [sys.executable, "-c", _COMPILE],
        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=ROOT / "tests",
    )  # fmt: skip

    def end() -> None:
        compiling.kill()
        compiling.wait()

    config.add_cleanup(end)


@pytest.hookimpl(tryfirst=True)  # before those are left out that are not asked for
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Of a test with many cases, those that its marker names are the slow ones, or the only ones
    that are not.
    """
    named: dict[str, set[str]] = {}
    seen: dict[str, set[str]] = {}
    for item in items:
        for name in ("fast_cases", "slow_cases"):
            marker = item.get_closest_marker(name)
            if marker is not None and isinstance(item, pytest.Function):
                function, case = item.nodeid.partition("[")[0], item.callspec.id
                named[function] = set(marker.args)
                seen.setdefault(function, set()).add(case)
                if (case in marker.args) == (name == "slow_cases"):
                    item.add_marker(pytest.mark.slow)
    if not any("::" in argument for argument in config.args) and not config.getoption(
        "lf", False
    ):  # all are here
        gone = {
            function: cases - seen[function]
            for function, cases in named.items()
            if cases - seen[function]
        }
        if gone:
            raise pytest.UsageError(f"a marker names cases that the test does not have: {gone}")


def pytest_collection_finish() -> None:
    # the modules and tests of the whole suite stay to its end: the collector need not go through
    # them again and again, nor forked children copy them for it; and of what tests make, maps and
    # figures, it need not look for cycles often
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 50)
    gc.enable()


@pytest.fixture(scope="module", autouse=True)
def compiled(request: pytest.FixtureRequest) -> None:
    """Before tests that call compiled functions by themselves all are made ready, as the engine
    does it: in turn with other processes, where a single function would be compiled beside them. To
    read them takes a fifth of a second."""
    if request.path.parent.name == "certified":
        from ptmcad.certified.loading import load

        load()


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Curves of pictures to a fiftieth of the window, and branches at a third of the values: for
    tests of what else the pictures show. How near curves are, and that branches are joined right,
    have tests of their own."""
    from ptmcad.ask import boundaries
    from ptmcad.ask.lines import diagram

    fine = boundaries.chains
    monkeypatch.setattr(
        boundaries, "chains", lambda found, wanted: fine(found, max(wanted, Fraction(1, 50)))
    )
    monkeypatch.setattr(diagram, "SAMPLES", 8)


@pytest.fixture(autouse=True)
def quick_pictures(request: pytest.FixtureRequest) -> None:
    """Most of a quick picture's time went to the nearness of its curves, so they are coarse where a
    test does not say that it is of that: in the rooms of pictures and of commands. Slow tests draw
    as the program does."""
    rooms = {"behaviour", "cli", "show", "tests", "workbench"}
    marked = request.node.get_closest_marker
    if request.path.parent.name in rooms and not marked("slow") and not marked("fine"):
        request.getfixturevalue("coarse")


@pytest.fixture(scope="session", name="one")
def one_browser() -> Iterator[Browser]:
    """One Chromium for all tests of pages that a process runs."""
    with browser() as found:
        yield found


@pytest.fixture(name="shipped")
def shipped_fixture() -> object:
    return shipped
