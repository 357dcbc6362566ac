"""Every false alteration of a map is rejected, every true one is accepted.

The fast tests take one place of each kind on one map; the slow ones `PLACES` places of each kind on
every shipped slice, and `RANDOM_PLACES` on a hundred random ones.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction

import pytest
from support.random_slices import NUMBERS
from support.replacing import replace
from support.shipped_records import EXACT

import ptmcad
from forger import cells, certified, rearrangements
from forger.consistency import drop, put, settled, with_plan
from forger.judge import FALSE, Tally, judged, places_of, violation
from forger.maps import CONFIGS, named
from ptmcad.answer.regionmap import NO_POINT, Component, Kind, RegionMap
from ptmcad.options import Options
from ptmcad.question.slice import Count
from ptmcad.text.plane import PlanePolynomial

PLACES, RANDOM_PLACES = 12, 2
KEPT = ("fig5-text+no-areas",)
RANDOM = tuple(sorted(random.Random("forger").sample(list(NUMBERS), 100)))


def assert_judged(name: str, r: RegionMap, number: int | None, true: int | None = None) -> Tally:
    """Judge so many places of each kind, and of so many true kinds."""
    tally = judged(name, r, number, true)
    assert not tally.wrong, "\n".join(tally.wrong)
    return tally


def test_there_are_enough_kinds() -> None:
    assert len({kind.__name__ for kind in FALSE}) >= 40
    assert len(RANDOM) == 100


def test_one_place_of_each_kind(shipped: Callable[..., RegionMap]) -> None:
    tally = assert_judged("fig2", shipped("fig2"), 1, 3)
    assert sum(number > 0 for number in tally.tried.values()) >= 70


@pytest.mark.parametrize("name", ["fig3", pytest.param("fig4", marks=pytest.mark.slow)])
def test_no_adjacency_can_be_dropped(name: str, shipped: Callable[..., RegionMap]) -> None:
    """Nor all of a critical value: regions, areas and records follow, so that nothing else is
    false.
    """
    r = shipped(name)
    for kind in (cells.adjacency_across_dropped, cells.all_adjacencies_across_dropped):
        for place, make in places_of(kind, r, None, "")[1]:
            found = violation(make(), "no adjacency missing")
            assert found is not None, (kind.__name__, place)
            assert found[0] == "no adjacency missing"


@pytest.mark.slow
def test_areas_next_to_one_of_their_bounds_are_confirmed(shipped: Callable[..., RegionMap]) -> None:
    for make in rearrangements.lopsided_areas(shipped("fig3")):
        assert violation(make(), "areas") is None


@pytest.mark.slow
def test_areas_within_rounding_of_one_of_their_bounds_are_confirmed() -> None:
    """The bounds are 4e-17 apart, and one of each region's is taken away."""
    r = ptmcad.classify(CONFIGS / "fig3.yaml", area_tolerance="1e-17")
    assert min(g.area[1] - g.area[0] for g in r.regions) < Fraction(1, 10**15)
    for make in rearrangements.lopsided_areas(r):
        assert violation(make(), "areas") is None


def test_stacks_without_walls_need_a_pair(shipped: Callable[..., RegionMap]) -> None:
    """Where no half-branch runs to the line over a critical value there is one pair, whatever
    parity says.
    """
    r = shipped("fig3")
    bare = [
        s for s in range(len(r.stacks) - 1) if not r.stacks[s].walls and not r.stacks[s + 1].walls
    ]
    assert bare
    for s in bare[:1]:
        k = next(
            k for k, a in enumerate(r.adjacencies) if a.segment and r.cells[a.first].stack == s
        )
        forged = settled(replace(r, adjacencies=drop(r.adjacencies, k)))
        assert len(forged.regions) > len(r.regions)
        report = ptmcad.verify(forged)
        assert report.violation is not None
        assert report.violation.startswith("no adjacency missing: the adjacency of cells")


def test_areas_are_not_tried_over_walls_that_are_not_there(
    shipped: Callable[..., RegionMap], monkeypatch: pytest.MonkeyPatch
) -> None:
    """`ptmcad.verify` never does, and what comes first here must not: in a window above all walls
    it would not end.
    """

    def endless(*_: object) -> None:
        raise AssertionError("integrated a wall that is not in the window")

    monkeypatch.setattr("ptmcad.verification.areaclaims.integrals_over", endless)
    r = shipped("fig2")
    axis = r.slice.axes[1 - r.base]
    width = axis.high - axis.low
    axes = put(r.slice.axes, 1 - r.base, low=axis.low + width, high=axis.high + width)
    found = violation(replace(r, slice=replace(r.slice, axes=axes)), "areas")
    assert found is not None
    assert found[0] == "walls and samples"


def test_no_curve_is_auxiliary(shipped: Callable[..., RegionMap]) -> None:
    """Though its step of the plan says so: only an ablation has such curves."""
    r = shipped("fig2")
    line = Component(PlanePolynomial.of([(1, 0, 1), (0, 0, -1000)]), Kind.AUXILIARY, NO_POINT)
    found = violation(with_plan(replace(r, components=(*r.components, line))), "plan")
    assert found is not None
    assert "auxiliary, but no saving was switched off" in found[1]


def test_an_exact_map_has_no_admissible_counts(shipped: Callable[..., RegionMap]) -> None:
    r = shipped("fig2")
    report = ptmcad.verify(replace(r, slice=replace(r.slice, count=Count.ADMISSIBLE)))
    assert (
        report.violation
        == "shape: an exact map has no admissible counts by which its regions could be distinguished"
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", [*(path.stem for path in EXACT), *KEPT])
def test_places_on_shipped_slices(name: str) -> None:
    assert_judged(name, named(name), PLACES)


@pytest.mark.slow
@pytest.mark.parametrize("number", RANDOM)
def test_places_on_random_slices(number: int) -> None:
    assert_judged(str(number), named(str(number)), RANDOM_PLACES)


def certified_map_of(count: str) -> RegionMap:
    pytest.importorskip("numba")
    from fractions import Fraction

    from ptmcad.certified.engine import certified_map

    record = {
        "name": "small", "mechanism": "ptm", "count": count,
        "parameters": {"L1": "1", "k": "100", "F3": "-10", "F4": "-10", "l0": "1/5"},
        "axes": {"rho": ["1", "3/2"], "L2": ["3/4", "5/4"]},
    }  # fmt: skip
    return certified_map(
        ptmcad.slice_from_mapping(record), Options(tolerance=Fraction(1, 50), jobs=1)
    )


BOXES = 40
"""Random places where a missing curve has to be found."""
CERTIFIED_PLACES = 24
"""Of each kind: there are nine for each box of a solution, and to reject one takes about a second.
"""


@pytest.mark.slow
@pytest.mark.parametrize("count", ["stable", "admissible", "total"])
def test_places_on_certified_maps(count: str) -> None:
    r = certified_map_of(count)
    assert ptmcad.verify(r, boxes=4).ok
    wrong: list[tuple[str, int, str | None]] = []
    for kind in certified.FALSE:
        boxes = BOXES if kind is certified.cover_left_out else 0
        _, chosen = places_of(kind, r, CERTIFIED_PLACES, f"{count} {kind.__name__}")
        wrong += [
            (kind.__name__, k, None) for k, make in chosen if ptmcad.verify(make(), boxes=boxes).ok
        ]
    for kind in certified.TRUE:
        for k, make in enumerate(kind(r)):
            report = ptmcad.verify(make(), boxes=2)
            wrong += [(kind.__name__, k, report.violation)] if not report.ok else []
    assert not wrong
