"""The verification of certified maps accepts true ones and rejects false ones; its parts agree with
other methods.
"""

from __future__ import annotations

import random
from collections import Counter
from fractions import Fraction
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from support.counting import MIDDLE, counted_at
from support.covers import covers
from support.examples import examples
from support.maps import shipped
from support.paper_energy import NAMES
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Solution, Status
from ptmcad.cover import components
from ptmcad.cover.rectangles import Cover
from ptmcad.options import Options
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Count, Point
from ptmcad.verification import kinds
from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.certified.coversweep import sweep
from ptmcad.verification.certified.sampling import _beside, _by_area
from ptmcad.verification.normalform.boxes import Unproved, halves

pytest.importorskip("numba")

BOXES = 4


def made(count: str) -> RegionMap:
    slice = slice_from_mapping({
        "name": "small", "mechanism": "ptm",
        "parameters": {"L1": "1", "k": "100", "F3": "-10", "F4": "-10", "l0": "1/5"},
        "axes": {"rho": ["1", "3/2"], "L2": ["3/4", "5/4"]}, "count": count,
    })  # fmt: skip
    from ptmcad.certified.engine import certified_map

    return certified_map(slice, Options(tolerance=Fraction(1, 50), jobs=1))


@pytest.fixture(scope="module")
def stable() -> RegionMap:
    return made("stable")


@pytest.fixture(scope="module")
def total() -> RegionMap:
    return made("total")


def test_a_map_of_stable_counts_is_accepted(stable: RegionMap) -> None:
    report = ptmcad.verify(stable, boxes=BOXES)
    assert report.ok, report.violation
    assert f"{BOXES} boxes" in report.table()
    assert "% of the free area is proved free of critical curves" in " ".join(
        report.table().split()
    )


def test_a_map_of_all_counts_is_accepted(total: RegionMap) -> None:
    report = ptmcad.verify(total, boxes=2, effort=0)  # neither of them depends on the count
    assert report.ok, report.violation


def test_a_partial_map_is_checked_like_a_whole_one(stable: RegionMap) -> None:
    assert ptmcad.verify(replace(stable, status=Status.PARTIAL), boxes=1).ok


def with_cell(r: RegionMap, n: int, **changes: object) -> RegionMap:
    cells = list(r.cells)
    cells[n] = replace(cells[n], **changes)  # type: ignore[arg-type]
    return replace(r, cells=tuple(cells))


def with_region(r: RegionMap, n: int, **changes: object) -> RegionMap:
    regions = list(r.regions)
    regions[n] = replace(regions[n], **changes)  # type: ignore[arg-type]
    return replace(r, regions=tuple(regions))


def recount(r: RegionMap, n: int, stable: int) -> RegionMap:
    return with_region(with_cell(r, n, stable=stable), n, stable=stable)


def at(x: str, y: str) -> Point:
    return Point(("rho", "L2"), Fraction(x), Fraction(y))


def certified(
    count: str, axes: dict[str, list[str]], tolerance: Fraction, **parameters: str
) -> RegionMap:
    from ptmcad.certified.engine import certified_map

    record = {
        "name": "small",
        "mechanism": "ptm",
        "parameters": parameters,
        "axes": axes,
        "count": count,
    }
    return certified_map(slice_from_mapping(record), Options(tolerance=tolerance, jobs=1))


DATA = Path(__file__).resolve().parents[1] / "data" / "samples"
CREASED = {"L1": "3/2", "L2": "1", "rho": "1", "k1": "100", "k2": "100", "l0_1": "1/5"}


@pytest.fixture(scope="module")
def creased() -> RegionMap:
    """rho = L2 in the whole window, with two minima that mirror each other across the crease
    th2 = 0.
    """
    return certified(
        "stable", {"k3": ["5", "15"], "F3": ["-1/100", "1/100"]}, Fraction(1, 3), **CREASED
    )


@pytest.mark.parametrize("steps", [1, 2, 16, 2**24])
@pytest.mark.fast_cases("16")
def test_a_map_on_a_crease(steps: int, creased: RegionMap) -> None:
    """Neither of two minima beside a crease is lost; and a lattice of one step, with no rectangles,
    is one.
    """
    true = replace(creased, cover=Cover(steps, ()))
    report = ptmcad.verify(true, boxes=2)
    assert report.ok, report.violation
    assert "2 boxes" in report.table()
    cell = creased.cells[0]
    assert cell.stable == 2
    for solution in cell.solutions:
        false = with_region(with_cell(true, 0, stable=1, solutions=(solution,)), 0, stable=1)
        violation = ptmcad.verify(false, boxes=2).violation
        assert violation is not None
        assert "said to have stable 1; there are stable 2" in violation


def test_a_crease_in_the_middle_of_a_window_of_both_lengths() -> None:
    """The sample, which an earlier version took, has rho = L2, other places have not."""
    true = ptmcad.RegionMap.from_json((DATA / "crease.json").read_text(encoding="utf-8"))
    assert (true.cells[0].sample[0], true.cells[0].stable) == (true.cells[0].sample[1], 2)
    report = ptmcad.verify(true, boxes=2)
    assert report.ok, report.violation


def creased_values(**changes: str) -> dict[str, Fraction]:
    given = {**CREASED, "k3": "9", **changes}
    return {name: Fraction(given.get(name, "0")) for name in NAMES}


MIRRORED = {"L1": "1", "L2": "3/2", "l0_1": "0", "l0_2": "1/5"}


@pytest.mark.parametrize("changes", [{}, MIRRORED], ids=["rho = L2", "rho = L1"])
def test_minima_on_both_sides_of_a_crease(changes: dict[str, str]) -> None:
    """Places from a root finder in mpmath, with the energy from the nodes' coordinates."""
    *_, there = counted_at(creased_values(**changes), Count.STABLE)
    places = sorted(
        (round(e.center[0], 4), round(e.center[1], 4)) for e in there.found if e.signs == "++"
    )
    near = (0.0189, 0.2124) if not changes else (0.2124, 0.0189)
    assert places == [(-near[0], -near[1]), near]


def test_no_proof_of_existence_crosses_a_crease() -> None:
    """The square in which a minimum beside a crease is proved to be alone ends before it."""
    *_, there = counted_at(creased_values(), Count.STABLE)
    assert all(e.alone[1] < abs(e.center[1]) for e in there.found)


@pytest.mark.slow
@pytest.mark.parametrize("count", ["stable", "admissible"])
def test_bars_of_one_length_on_one_point(count: str) -> None:
    """REFERENCE (mpmath): rho = 0 and L1 = L2, where spring 3 has no length on a circle; det H is
    930 and 628.
    """
    axes = {"F3": ["5", "6"], "F3x": ["5", "6"]}
    true = certified(count, axes, Fraction(1, 3), rho="0", L1="1", L2="1", l0="1/5", F4="-10")
    report = ptmcad.verify(true, boxes=2)
    assert report.ok, report.violation
    assert "2 boxes" in report.table()
    assert report.violation is None
    false = ptmcad.verify(recount(true, 0, 1), boxes=0)
    assert false.violation is not None
    assert "there are stable 2" in false.violation


def test_rho_next_to_a_bar_of_one_length() -> None:
    """REFERENCE (mpmath): 8 equilibria where rho - L1 is 6e-13; spring 2 of one of them is hardly
    longer.
    """
    rho = Fraction(1597743721975, 1597743721974)
    point = {
        n: Fraction(1, 5) if n[0] == "l" else Fraction(100) if n[0] == "k" else Fraction(0)
        for n in NAMES
    }
    point |= {"rho": rho, "L1": Fraction(1), "L2": Fraction(208000000004, 160000000003)}
    point |= {"F3": Fraction(-10), "F4": Fraction(-10)}
    _, counting, there = counted_at(point, Count.TOTAL)
    assert there.counts.index == (2, 4, 2)
    (peak,) = (e for e in there.found if abs(e.center[0]) < 1e-9)
    assert (peak.signs, round(peak.center[0] * 1e14, 2), round(peak.center[1], 6)) == (
        "--",
        -6.22,
        3.032489,
    )
    box = Solution(
        (Fraction(-6.219379885031517e-14), Fraction(3.03248855256242)), Fraction(1, 2**46), "--"
    )
    assert counting.in_box(*MIDDLE, box, 0).signs == "--"


def test_no_equilibrium_is_lost_where_doubles_are_coarse() -> None:
    """REFERENCE (mpmath): rho - L1 is 8e-15; there is a maximum at (-5.6195574e-16, 3.0322134879)."""
    point = {
        n: Fraction(1, 5) if n[0] == "l" else Fraction(100) if n[0] == "k" else Fraction(0)
        for n in NAMES
    }
    point |= {"rho": Fraction(107374182400000886471, 107374182400000000000), "L1": Fraction(1)}
    point |= {"L2": Fraction(665987249, 536870912), "F3": Fraction(-10), "F4": Fraction(-10)}
    _, _, there = counted_at(point, Count.TOTAL)
    assert there.counts.index == (2, 4, 2)
    assert any(
        abs(e.center[0] + 5.6195574e-16) < e.radii[0] + 1e-22 < 1e-16 and e.signs == "--"
        for e in there.found
    )


def test_places_are_spread_over_the_window(stable: RegionMap) -> None:
    """One in each square of a grid, whatever the rectangles; and those beside rectangles are not
    where most are.
    """
    assert stable.cover is not None
    steps = stable.cover.steps
    decoys = {
        (u, u + 1, steps // 2, steps // 2 + 1) for u in range(steps // 2, steps // 2 + 4000, 2)
    }
    cover = Cover(steps, tuple(sorted({*decoys, (steps // 8, steps // 8 + 1, 0, steps)})))
    claims = CertifiedClaims(replace(stable, cover=cover, cells=stable.cells[:1]))
    by_area, without = _by_area(claims, random.Random(1), 40)
    component = claims.sweep.areas[next(iter(claims.cell_of))]
    free = Fraction(component, steps**2)
    assert 256 * free - 33 <= len(by_area) == 256 - without
    for side in (0, 1):
        columns = Counter(int(16 * (p.u, p.v)[side] / steps) for p in by_area)
        assert all(columns[k] >= (13 if side else 16) for k in range(4, 16))
    beside = _beside(claims, random.Random(1), 40)
    assert len(beside) == 40
    near = [
        p
        for p in beside
        if abs(p.u - steps // 2) < steps // 16 and abs(p.v - steps // 2) < steps // 16
    ]
    assert len(near) <= 8


@given(covers())
@settings(max_examples=examples(60), deadline=None)
def test_sweep_and_subdivision_agree(cover: Cover) -> None:
    """Components, clusters, areas, who touches whom, and where points lie, by two methods without
    common code.
    """
    one, two = sweep(cover), components(cover)
    assert sorted(one.areas.values()) == sorted(two.areas)
    assert sorted(one.cluster_areas.values()) == sorted(two.cluster_areas)
    assert len(one.touching) == len(two.touching)
    names: dict[int | None, int | None] = {}
    for i in range(1, 2 * cover.steps):
        for j in range(1, 2 * cover.steps):
            u, v = Fraction(i, 2), Fraction(j, 2)
            assert names.setdefault(one.locate(u, v), two.locate(u, v)) == two.locate(u, v)
    assert len(set(names.values())) == len(names)


@given(covers(), st.integers(1, 15), st.integers(1, 15), st.integers(0, 5))
@settings(max_examples=examples(100), deadline=None)
def test_a_free_square_meets_no_rectangle(cover: Cover, u: int, v: int, half: int) -> None:
    if not (u < cover.steps and v < cover.steps):
        return
    meets = any(
        left <= u + half and u - half <= right and bottom <= v + half and v - half <= top
        for left, right, bottom, top in cover.rectangles
    )
    # one that only touches the window's edge may be refused
    inside = half < u < cover.steps - half and half < v < cover.steps - half
    free = sweep(cover).free_around(Fraction(u), Fraction(v), Fraction(half))
    assert not (free and (meets or u < half or v < half or max(u, v) + half > cover.steps))
    if inside and not meets:
        assert free


KNOWN = {
    "REFERENCE, reproduction: 6, 2 stable": (
        "7/10",
        "1",
        "3/2",
        "1/5",
        "-1/10",
        "-1/10",
        (2, 3, 1),
    ),
    "REFERENCE: 12": ("96859/100000", "1", "100609/100000", "1/5", "-1/10", "-1/10", (2, 6, 4)),
    "REFERENCE: 26, 8 stable": (
        "120609/100000",
        "1",
        "1",
        "101487/100000",
        "-1/10",
        "-1/10",
        (8, 14, 4),
    ),
}


def values(rho: str, l1: str, l2: str, l0: str, f3: str, f4: str) -> dict[str, Fraction]:
    given = {"rho": rho, "L1": l1, "L2": l2, "F3": f3, "F4": f4, "l0_1": l0, "l0_2": l0, "l0_3": l0}
    return {name: Fraction(given.get(name, "1" if name[0] == "k" else "0")) for name in NAMES}


@pytest.mark.parametrize("name", KNOWN)
@pytest.mark.slow_cases("REFERENCE: 26, 8 stable", "REFERENCE, reproduction: 6, 2 stable")
def test_known_counts(name: str) -> None:
    *text, index = KNOWN[name]
    point = values(*text)
    *_, there = counted_at(point, Count.TOTAL)
    assert there.counts.index == index
    *_, there = counted_at(point, Count.STABLE)
    assert there.counts.stable == index[0]


@pytest.mark.slow
def test_thirty_equilibria() -> None:
    """REFERENCE: (.75609, 1, 1, 1.43487, 0, 0) has 30, 10 of them stable."""
    point = values("75609/100000", "1", "1", "143487/100000", "0", "0")
    *_, there = counted_at(point, Count.TOTAL)
    assert there.counts.index == (10, 16, 4)


@pytest.mark.parametrize("rho", ["1", "3/2"])
@pytest.mark.slow_cases("1")
def test_minima_where_a_spring_has_length_zero_on_a_circle(rho: str) -> None:
    """rho = L1 and rho = L2: as many as on both sides nearby."""
    given = (Fraction(rho) + Fraction(n, 500) for n in (-1, 0, 1))
    found = [
        counted_at(values(str(at), "1", "3/2", "1/5", "-1/10", "-1/10"), Count.STABLE)[2]
        for at in given
    ]
    assert len({there.counts.stable for there in found}) == 1


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.slow_cases("1", "2")
def test_a_box_of_parameters_has_the_count_of_its_points(seed: int, stable: RegionMap) -> None:
    rng = random.Random(seed)
    x, y = Fraction(rng.randint(1050, 1450), 1000), Fraction(rng.randint(800, 1200), 1000)
    half = Fraction(1, 4000)
    claims = CertifiedClaims(stable)
    counting = claims.counting
    box = tuple(zip(*(claims.lattice.on(x + d, y + d) for d in (0, half)), strict=True))
    counts = counting.over(*box, counting.at(x + half / 2, y + half / 2))
    for _ in range(4):
        a, b = x + half * Fraction(rng.random()), y + half * Fraction(rng.random())
        assert counting.at(a, b).counts == counts


def test_nothing_is_proved_over_a_fold(stable: RegionMap) -> None:
    claims = CertifiedClaims(stable)
    assert stable.cover is not None
    left, right, bottom, top = stable.cover.rectangles[40]
    counting = claims.counting
    there = counting.at(*claims.lattice.off(Fraction(left), Fraction(bottom)))
    with pytest.raises(Unproved):
        counting.over((Fraction(left), Fraction(right)), (Fraction(bottom), Fraction(top)), there)


def test_a_count_that_the_checker_does_not_know_is_refused(
    stable: RegionMap, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A kind that records, engines and documents have, and that has no row in the checker's table."""
    monkeypatch.delitem(kinds._KINDS, Count.ADMISSIBLE)
    slice = replace(stable.slice, count=Count.ADMISSIBLE)
    report = ptmcad.verify(replace(stable, slice=slice), boxes=0)
    assert report.violation == "form: the checker does not know what admissible counts are"
    exact = ptmcad.verify(
        replace(shipped("fig4"), slice=replace(shipped("fig4").slice, count=Count.ADMISSIBLE))
    )
    assert exact.violation == "shape: the checker does not know what admissible counts are"


def test_conditions_that_are_numbers_all_over_a_slice_are_none() -> None:
    """A map with such ones was said to be false: nothing is stored of them."""
    record = yaml.safe_load("""
        name: settled
        system:
          parameters: {c: {kind: number}}
          unknowns: {x: real}
          equations: [x^2 - a]
          positive: [3*c - 1]
          stable: [c, '2', x - b]
        parameters: {c: 1}
        axes: {a: [-1, 2], b: [-1, 1]}
    """)
    found = ptmcad.classify(
        slice_from_mapping(record), engine="certified", tolerance="1/10", jobs=1
    )
    assert {cell.stable for cell in found.cells} == {0, 1, 2}
    assert ptmcad.verify(found).ok


@pytest.mark.parametrize(("m", "r"), [(0.3, 1e-9), (3.0322134878826974, 2.8e-15)])
def test_halves_cover_the_box(m: float, r: float) -> None:
    found = halves(((0.0, m), (1.0, r)), [1, 0], [0.0, 0.0])
    assert found is not None
    (low, half), (high, other) = (
        (Fraction(middle[1]), Fraction(width[1])) for middle, width in found
    )
    assert low - half <= Fraction(m) - Fraction(r) < Fraction(m) + Fraction(r) <= high + other
    assert high - other <= low + half
    assert halves(((0.0, 3.0), (0.0, 2.0**-51)), [1, 0], [1.0, 0.0]) is None
