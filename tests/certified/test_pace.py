"""When maps are handed over, and when a search ends, by a clock that the test sets."""

from __future__ import annotations

import pytest

pytest.importorskip("numba")

import gc
import re
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from numba import njit
from numba.core.event import install_listener

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.certified import engine, loading, refinement
from ptmcad.certified.pace import (
    MIN_RESERVE,
    PARTS,
    SAFETY,
    Pace,
    parts_done,
)
from ptmcad.errors import LimitReached
from ptmcad.formulas.compilation import FUNCTIONS
from ptmcad.options import Options


class Clock:
    """A clock that moves when it is made to, and a millisecond at each look, as time does."""

    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self) -> float:
        self.now += 1e-3
        return self.now

    def slowed(self, function: Callable[..., Any], seconds: float) -> Callable[..., Any]:
        """The function, which takes so long by this clock."""

        def slow(*arguments: Any, **named: Any) -> Any:
            self.now += seconds
            return function(*arguments, **named)

        return slow


def test_the_last_map_is_foreseen_from_those_before() -> None:
    clock = Clock()
    pace = Pace(clock() + 100, clock, clock)
    assert pace.last(1000) == pytest.approx(2, abs=0.1)  # a fiftieth of the time
    pace.record("map", 10_000, 3.0)
    assert pace.last(10_000) == pytest.approx(SAFETY * 3, rel=0.1)
    assert pace.last(40_000) >= SAFETY * 12
    assert pace.last(100) >= SAFETY * 3
    assert not pace.late(10_000)
    clock.now += 95
    assert pace.late(10_000)


def test_on_a_busy_machine_more_time_is_kept() -> None:
    """By the clock all takes ten times what it does by the processor's; but a third of the time is
    enough.
    """
    clock, work = Clock(), Clock()
    long, short = Pace(clock() + 100, clock, work), Pace(clock() + 12, clock, work)
    clock.now += 5
    work.now += 0.5
    assert long.last(10) == pytest.approx(10, rel=0.1)
    assert short.last(10) == pytest.approx(4, rel=0.1)


def window() -> ptmcad.Slice:
    """A small part of free02 with a fold in it."""
    return ptmcad.slice_from_options(
        slice="rho,L2", ranges=["rho=1/2:1", "L2=5/4:7/4"], sets=["l0=1/5", "F3=-10", "F4=-10"]
    )


def stopped(
    monkeypatch: pytest.MonkeyPatch, seconds: float, phase: str, length: float
) -> tuple[float, RegionMap | None, list[RegionMap]]:
    """Run until so many seconds by a clock by which one phase takes long: what is left, the map,
    those on the way.
    """
    clock = Clock()
    deadline = clock() + seconds
    handed: list[RegionMap] = []
    with monkeypatch.context() as patch:
        patch.setattr(engine, "Pace", lambda until: Pace(until, clock, clock))
        patch.setattr(refinement, "BUDGET", 500)
        patch.setattr(refinement, "search_curve", clock.slowed(refinement.search_curve, 0.1))
        if phase == "handing":
            hand = clock.slowed(handed.append, length)
        else:
            hand = handed.append
            patch.setattr(engine, phase, clock.slowed(getattr(engine, phase), length))
        with pytest.raises(LimitReached) as limit:
            engine.certified_map(
                window(),
                Options(tolerance=Fraction(1, 10**14), deadline=deadline, jobs=1, partial=hand),
            )
    found = limit.value.partial
    assert found is None or isinstance(found, RegionMap)
    return deadline - clock.now, found, handed


@pytest.mark.parametrize(
    "phase",
    [
        pytest.param("thinning", marks=pytest.mark.slow),
        pytest.param("combined", marks=pytest.mark.slow),
        "components",
        pytest.param("union_area", marks=pytest.mark.slow),
        pytest.param("handing", marks=pytest.mark.slow),
    ],
)
def test_the_time_limit_is_kept_in_every_phase(monkeypatch: pytest.MonkeyPatch, phase: str) -> None:
    """Whatever part of a map takes three seconds, the last map is made before the limit, and is the
    best.
    """
    loading.load()
    left, found, handed = stopped(monkeypatch, 40, phase, 3.0)
    assert left > 0
    assert found is not None
    assert found.status is Status.PARTIAL
    assert handed
    assert found.undetermined == min(m.undetermined for m in [found, *handed])
    shares = [m.undetermined for m in handed]
    assert shares == sorted(shares, reverse=True)


@pytest.mark.slow
def test_counts_are_left_out_before_the_limit_is_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each count at a point takes ten seconds: what is not counted is undetermined, and the map is
    there in time.
    """
    from ptmcad.certified.plain.pointcounts import BranchCounter

    clock = Clock()
    monkeypatch.setattr(engine, "Pace", lambda until: Pace(until, clock, clock))
    monkeypatch.setattr(BranchCounter, "at", clock.slowed(BranchCounter.at, 10.0))
    deadline = clock() + 16
    result = engine.certified_map(
        window(), Options(tolerance=Fraction(99, 100), deadline=deadline, jobs=1)
    )
    assert clock.now <= deadline + 10
    assert len(result.cells) == 2


def test_before_anything_is_decided_the_message_says_that_there_is_no_map(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = Clock()
    monkeypatch.setattr(engine, "Pace", lambda until: Pace(until, clock, clock))
    with pytest.raises(
        LimitReached, match="before anything was decided: there is no map to save yet"
    ) as limit:
        engine.certified_map(window(), Options(deadline=clock() + MIN_RESERVE / 2, jobs=1))
    assert limit.value.partial is None


@pytest.mark.parametrize(
    ("seconds", "told"), [(1.0, "the time limit was reached"), (4.5, "4.5 s before the time limit")]
)
def test_a_search_that_ends_early_says_so(seconds: float, told: str) -> None:
    run = object.__new__(engine._MapSearch)
    run.pace = Pace(seconds, lambda: 0.0, lambda: 0.0)
    assert told in run._at_limit()


def test_the_bar_of_a_search_only_grows() -> None:
    told: list[tuple[str, int, int]] = []
    ptmcad.classify(window(), tolerance="1/5", jobs=1, progress=lambda *what: told.append(what))
    done = [done for _, done, _ in told]
    assert (
        done == sorted(done) and 0 < done[-1] < PARTS and {total for _, _, total in told} == {PARTS}
    )
    assert all(re.fullmatch(r"undetermined [0-9.]+ %", stage) for stage, _, _ in told)


def test_what_is_compiled_is_counted_and_timed() -> None:
    told: list[tuple[str, int, int]] = []
    compiling = loading._Compiling(lambda *what: told.append(what))
    with install_listener("numba:compile", compiling):
        assert njit(lambda x: x + 1)(1) == 2
    ready = sum(bool(function.overloads) for function in FUNCTIONS)
    assert (
        told
        == [("compiling the certified engine, once on this machine:", ready, len(FUNCTIONS))] * 2
    )
    assert compiling.seconds > 0
    loading.load()
    assert loading.load() == 0


@pytest.mark.parametrize(("before", "during"), [(700, loading.MIN_GARBAGE), (10**6, 10**6), (0, 0)])
def test_garbage_is_looked_for_less_while_compiling(
    before: int, during: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A caller's own threshold comes back, also when compiling ends by an exception; 0 is a
    collector switched off.
    """
    usual = gc.get_threshold()

    def use_each() -> None:
        assert gc.get_threshold()[0] == during
        raise KeyboardInterrupt

    monkeypatch.setattr(loading, "_use_each", use_each)
    monkeypatch.setattr(loading, "_done", [])
    gc.set_threshold(before, 7, 8)
    try:
        with pytest.raises(KeyboardInterrupt):
            loading.load()
        assert gc.get_threshold() == (before, 7, 8)
    finally:
        gc.set_threshold(*usual)


def test_nothing_is_compiled_after_loading() -> None:
    """All that a map needs is compiled by `load`, of which a run is no part."""
    from numba.core.dispatcher import Dispatcher

    loading.load()

    def signatures() -> dict[str, int]:
        import sys

        return {
            f"{name}.{key}": len(value.signatures)
            for name, module in sys.modules.items()
            if name.startswith("ptmcad.certified.")
            for key, value in vars(module).items()
            if isinstance(value, Dispatcher)
        }

    before = signatures()
    assert before["ptmcad.certified.boxstrips.strips"] == 1
    ptmcad.classify(window(), count="total", tolerance="1/5", jobs=1)
    assert signatures() == before


def test_a_tolerance_below_all_floats_has_a_way_to_it() -> None:
    assert [parts_done(share, 0.0, 0.0) for share in (1.0, 1e-300, 0.0)] == [
        0,
        975,
        PARTS,
    ]  # of 307.65 powers of ten
