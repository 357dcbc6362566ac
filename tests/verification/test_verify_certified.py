"""The verification of certified maps accepts true ones and rejects false ones; its parts agree with
other methods.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from math import pi
from pathlib import Path

import pytest
from click.testing import CliRunner
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st
from support.counting import MIDDLE, claims_of, counted_at
from support.examples import examples
from support.maps import shipped
from support.paper_energy import NAMES, PaperEnergy

import ptmcad
from ptmcad.answer.regionmap import Cell, RegionMap, Solution, Status, System
from ptmcad.cli.verify import command
from ptmcad.cover import components
from ptmcad.cover.rectangles import Cover, Rectangle
from ptmcad.options import Options
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Count, Point
from ptmcad.text.balls import ball_of
from ptmcad.verification import kinds
from ptmcad.verification.certified.ballequations import BallEquations
from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.certified.coversweep import sweep
from ptmcad.verification.certified.sampling import _beside, _by_area
from ptmcad.verification.normalform.boxes import Unproved, halves
from ptmcad.verification.normalform.waves import form_of

pytest.importorskip("numba")

Change = Callable[[RegionMap], RegionMap]
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


@pytest.mark.slow
def test_the_command_checks_a_stored_map(stable: RegionMap, tmp_path: Path) -> None:
    """Exit status 0, and 1 for a false one, whose violated claim is named."""
    good, bad = tmp_path / "good.json", tmp_path / "bad.json"
    good.write_text(stable.to_json(), encoding="utf-8")
    bad.write_text(recount(stable, 0, 2).to_json(), encoding="utf-8")
    runner = CliRunner()
    one = runner.invoke(command, [str(good), "--boxes", "2", "--seed", "7"], standalone_mode=False)
    assert (one.exception, one.return_value) == (None, 0)
    assert "2 boxes" in one.output
    assert "seed 7" in one.output
    two = runner.invoke(command, [str(bad), "--boxes", "0"], standalone_mode=False)
    assert (two.exception, two.return_value) == (None, 1)
    assert "violated: counts and solutions: cell 0, at rho=" in two.output


def with_cell(r: RegionMap, n: int, **changes: object) -> RegionMap:
    cells = list(r.cells)
    cells[n] = replace(cells[n], **changes)  # type: ignore[arg-type]
    return replace(r, cells=tuple(cells))


def with_region(r: RegionMap, n: int, **changes: object) -> RegionMap:
    regions = list(r.regions)
    regions[n] = replace(regions[n], **changes)  # type: ignore[arg-type]
    return replace(r, regions=tuple(regions))


def with_solution(r: RegionMap, **changes: object) -> RegionMap:
    solutions = list(r.cells[1].solutions)
    solutions[0] = replace(solutions[0], **changes)  # type: ignore[arg-type]
    return with_cell(r, 1, solutions=tuple(solutions))


def with_cover(r: RegionMap, rectangles: list[Rectangle], steps: int | None = None) -> RegionMap:
    assert r.cover is not None
    return replace(r, cover=Cover(steps or r.cover.steps, tuple(rectangles)))


def rectangles(r: RegionMap) -> list[Rectangle]:
    assert r.cover is not None
    return list(r.cover.rectangles)


def without_one(items: list[Rectangle], n: int) -> list[Rectangle]:
    return [*items[:n], *items[n + 1 :]]


def recount(r: RegionMap, n: int, stable: int) -> RegionMap:
    return with_region(with_cell(r, n, stable=stable), n, stable=stable)


def moved(r: RegionMap) -> Point:
    """A sample in a rectangle."""
    assert r.cover is not None
    left, right, bottom, top = r.cover.rectangles[0]
    x, y = CertifiedClaims(r).lattice.off(Fraction(left + right, 2), Fraction(bottom + top, 2))
    return Point(("rho", "L2"), x, y)


def at(x: str, y: str) -> Point:
    return Point(("rho", "L2"), Fraction(x), Fraction(y))


FALSE: dict[str, tuple[Change, str]] = {
    "one stable equilibrium more": (lambda r: recount(r, 0, 2), "counts and solutions"),
    "one stable equilibrium less": (lambda r: recount(r, 1, 1), "counts and solutions"),
    "no count": (lambda r: with_cell(r, 0, stable=None), "form"),
    "a count that was not asked for": (lambda r: with_cell(r, 0, total=4), "form"),
    "counts of a region": (lambda r: with_region(r, 0, stable=2), "regions and areas"),
    "a rectangle removed": (lambda r: with_cover(r, rectangles(r)[1:]), "components"),
    "a rectangle in the middle removed": (
        lambda r: with_cover(r, without_one(rectangles(r), len(rectangles(r)) // 2)), "components",
    ),
    "a rectangle shifted": (
        lambda r: with_cover(r, sorted([*rectangles(r)[1:], tuple(x + 4096 for x in rectangles(r)[0])])),  # type: ignore[list-item]
        "components",
    ),
    "a rectangle twice": (lambda r: with_cover(r, [rectangles(r)[0], *rectangles(r)]), "form"),
    "rectangles not sorted": (lambda r: with_cover(r, rectangles(r)[::-1]), "form"),
    "a rectangle outside": (lambda r: with_cover(r, [*rectangles(r), (2**24 - 1, 2**24 + 1, 0, 1)]), "form"),
    "steps no power of two": (lambda r: with_cover(r, rectangles(r), 2**24 + 1), "form"),
    "a finer lattice": (lambda r: with_cover(r, rectangles(r), 2**25), "components"),
    "a sample in a rectangle": (lambda r: with_cell(r, 0, sample=moved(r)), "components"),
    "a sample in another cell": (lambda r: with_cell(r, 0, sample=r.cells[1].sample), "components"),
    "a sample outside": (lambda r: with_cell(r, 0, sample=at("1/2", "1")), "components"),
    "a sample elsewhere in the cell": (lambda r: with_cell(r, 0, sample=at("7/5", "1")), "regions and areas"),
    "a region's sample": (lambda r: with_region(r, 0, sample=r.cells[1].sample), "regions and areas"),
    "level": (lambda r: with_cell(r, 0, level=1), "components"),
    "undetermined": (lambda r: replace(r, undetermined=r.undetermined * Fraction(999, 1000)), "components"),
    "nothing undetermined": (lambda r: replace(r, undetermined=Fraction(0)), "components"),
    "too large a lower bound": (
        lambda r: with_region(r, 0, area=(r.regions[0].area[0] + Fraction(1, 2**60), r.regions[0].area[1])),
        "regions and areas",
    ),
    "too small an upper bound": (
        lambda r: with_region(r, 1, area=(r.regions[1].area[0], r.regions[1].area[1] - Fraction(1, 2**60))),
        "regions and areas",
    ),
    "cells of a region": (lambda r: with_region(r, 0, cells=(0, 1)), "regions and areas"),
    "a cell removed": (lambda r: replace(r, cells=r.cells[:1], regions=r.regions[:1]), "components"),
    "a solution removed": (lambda r: with_cell(r, 1, solutions=r.cells[1].solutions[1:]), "counts and solutions"),
    "a solution twice": (
        lambda r: with_cell(r, 1, solutions=(r.cells[1].solutions[0],) * 2), "counts and solutions",
    ),
    "a solution's signs": (lambda r: with_solution(r, signs="+-"), "counts and solutions"),
    "a solution's center": (lambda r: with_solution(r, center=(Fraction(3), Fraction(3))), "counts and solutions"),
    "a solution's box too small": (lambda r: with_solution(r, radius=Fraction(1, 2**60)), "counts and solutions"),
    "a solution's box too large": (lambda r: with_solution(r, radius=Fraction(1)), "counts and solutions"),
    "a solution's radius zero": (lambda r: with_solution(r, radius=Fraction(0)), "counts and solutions"),
    "potential": (lambda r: with_potential(r, "1/2*k1*", "1/2*k2*"), "equations"),
    "sign of a load": (lambda r: with_potential(r, "- F3*", "+ F3*"), "equations"),
    "a potential that is a program": (lambda r: with_potential(r, "1/2*k1*", "exit()*k1*"), "equations"),
    "the absolute value of a load": (lambda r: with_potential(r, " - F3*", " - sqrt(F3^2)*"), "equations"),
    "a load's 45th digit": (lambda r: with_potential(r, " - F3*", f" - (1 + 1/{10**45})*F3*"), "equations"),
    "unknowns": (lambda r: replace(r, system=replace(r.system, unknowns=("th2", "th1"))), "equations"),
    "another load": (lambda r: with_text(r, "F3", "-11"), "parameters as written"),
    "status": (lambda r: replace(r, status=Status.EXACT), "form"),
    "no cover": (lambda r: replace(r, cover=None), "form"),
    "complex solutions": (lambda r: replace(r, complex_solutions=6), "form"),
}  # fmt: skip


def with_potential(r: RegionMap, old: str, new: str) -> RegionMap:
    assert old in r.system.potential
    system: System = replace(r.system, potential=r.system.potential.replace(old, new))
    return replace(r, system=system)


def with_text(r: RegionMap, name: str, text: str) -> RegionMap:
    return replace(r, slice=replace(r.slice, text={**r.slice.text, name: text}))


@pytest.mark.parametrize("name", FALSE)
@pytest.mark.slow_cases(
    "one stable equilibrium less",
    "a solution removed",
    "a solution twice",
    "a solution's signs",
    "a solution's center",
    "a solution's box too small",
    "a solution's box too large",
    "a solution's radius zero",
)
def test_a_false_map_is_rejected(name: str, stable: RegionMap) -> None:
    change, by = FALSE[name]
    report = ptmcad.verify(change(stable), boxes=0)
    assert not report.ok
    assert report.violation is not None
    assert report.violation.startswith(by + ":"), report.violation


@pytest.mark.parametrize(
    "change",
    [
        lambda c: {"total": c.total + 2, "index": (c.index[0], c.index[1] + 1, c.index[2] + 1)},
        lambda c: {"index": (c.index[0] - 1, c.index[1], c.index[2] + 1)},
        lambda c: {"solutions": c.solutions[:-1]},
        lambda c: {"stable": c.stable + 1},
    ],
    ids=["two more", "a maximum for a minimum", "a solution removed", "stable"],
)
@pytest.mark.slow_cases("two more", "a solution removed")
def test_a_false_index_is_rejected(
    change: Callable[[Cell], dict[str, object]], total: RegionMap
) -> None:
    changes = change(total.cells[1])
    false = with_cell(total, 1, **changes)
    counts = {k: v for k, v in changes.items() if k != "solutions"}
    report = ptmcad.verify(with_region(false, 1, **counts), boxes=0)
    assert report.violation is not None
    assert report.violation.startswith("counts and solutions:")


def consistent(r: RegionMap, cover: Cover, cells: tuple[Cell, ...]) -> RegionMap:
    """A map with another cover, false but with areas and samples that agree with it."""
    changed = replace(
        r, cover=cover, cells=cells, regions=tuple(r.regions[c.region] for c in cells)
    )
    claims = CertifiedClaims(changed)
    component = {n: k for k, n in claims.cell_of.items()}
    areas = [claims.sweep.areas[component[n]] for n in range(len(cells))]
    levels = [sum(a > area for a in claims.sweep.areas.values()) for area in areas]
    window = claims.square * cover.steps**2
    return replace(
        changed,
        cells=tuple(
            replace(c, level=level, region=n)
            for n, (c, level) in enumerate(zip(cells, levels, strict=True))
        ),
        regions=tuple(
            replace(g, area=(area * claims.square, window), cells=(n,))
            for n, (g, area) in enumerate(zip(changed.regions, areas, strict=True))
        ),
        undetermined=1 - Fraction(sum(areas), cover.steps**2),
    )


@pytest.mark.parametrize("steps", [1, 2, 2**24])
@pytest.mark.fast_cases("16777216")
def test_random_points_find_that_a_curve_was_left_out(steps: int, stable: RegionMap) -> None:
    """All else agrees: only what looks at the free area can tell, however coarse the lattice is."""
    false = consistent(stable, Cover(steps, ()), stable.cells[:1])
    assert ptmcad.verify(false, boxes=0, effort=0).ok
    for found_by, report in (
        ("random boxes:", ptmcad.verify(false, seed=1, boxes=20, effort=0)),
        ("the whole free area:", ptmcad.verify(false, seed=1, boxes=0)),
    ):
        assert report.violation is not None
        assert report.violation.startswith(found_by)


@pytest.mark.slow
def test_random_points_beside_rectangles_find_a_shifted_cover(stable: RegionMap) -> None:
    assert stable.cover is not None
    steps, by = stable.cover.steps, stable.cover.steps // 64
    shifted = [
        (left, right, bottom + by, min(top + by, steps))
        for left, right, bottom, top in stable.cover.rectangles
    ]
    kept = sorted(r for r in shifted if r[2] < r[3])
    # the curve's end at the window's edge has moved away from it
    kept = sorted({*kept, *((a, b, 0, by + 1) for a, b, c, _ in stable.cover.rectangles if c == 0)})
    false = consistent(stable, Cover(steps, tuple(kept)), stable.cells)
    assert ptmcad.verify(false, boxes=0, effort=0).ok
    report = ptmcad.verify(false, seed=3, boxes=24, effort=0)
    assert report.violation is not None
    assert report.violation.startswith("random boxes:")


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


@pytest.mark.slow
def test_rectangles_that_tell_nothing_do_not_draw_places() -> None:
    """A fifth of the window is false, and behind 1500 squares of no size; with this seed 40 places
    used to miss it.
    """
    true = certified(
        "stable", {"rho": ["6/5", "13/10"], "L2": ["9/10", "1"]}, Fraction(1, 50),
        L1="3/2", k="100", F3="-10", F4="0", l0="1/5",
    )  # fmt: skip
    assert true.cover is not None
    assert [c.stable for c in true.cells] == [2, 1]
    steps, rng = true.cover.steps, random.Random(0)
    corners = [
        (rng.randrange(steps // 4, steps // 2), rng.randrange(steps // 4, steps // 2))
        for _ in range(1500)
    ]
    wall = steps * 4 // 5
    cover = Cover(
        steps,
        tuple(sorted({*((u, u + 1, v, v + 1) for u, v in corners), (wall, wall + 1, 0, steps)})),
    )
    report = ptmcad.verify(consistent(true, cover, true.cells), seed=167, effort=0)
    assert report.violation is not None
    assert report.violation.startswith("random boxes:")


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


@pytest.mark.parametrize("turns", [0, 1])
def test_a_box_next_to_a_crease_holds_one_equilibrium(turns: int) -> None:
    """A turn away, too."""
    claims, _, there = counted_at(creased_values(), Count.STABLE)
    for zero in there.found:
        center = zero.center[0], zero.center[1] + turns * 2 * pi
        box = Solution((Fraction(center[0]), Fraction(center[1])), Fraction(1, 2**15), "++")
        assert claims.counting.in_box(*MIDDLE, box, 0).signs == zero.signs


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


@pytest.mark.slow
def test_a_window_as_narrow_as_rounding_beside_a_bar() -> None:
    """Boxes of parameters in it are proved: an angle has a unit of its own where a spring is that
    short.
    """
    side = [str(1 + k * Fraction(1, 10**13)) for k in (3, 4)]
    true = certified(
        "total",
        {"rho": side, "L2": ["6/5", "13/10"]},
        Fraction(1, 3),
        L1="1",
        l0="1/5",
        F3="-10",
        F4="-10",
    )
    report = ptmcad.verify(true, boxes=2)
    assert report.ok, report.violation
    assert "2 boxes" in report.table()


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


@st.composite
def covers(draw: st.DrawFn) -> Cover:
    """Rectangles on a small lattice, so that they touch, overlap and enclose; corners and the
    window's edges.
    """
    steps = draw(st.sampled_from([4, 8, 16]))
    side = st.integers(0, steps)
    found = set()
    for _ in range(draw(st.integers(0, 14))):
        a, b, c, d = draw(side), draw(side), draw(side), draw(side)
        if a != b and c != d:
            found.add((min(a, b), max(a, b), min(c, d), max(c, d)))
    return Cover(steps, tuple(sorted(found)))


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


@pytest.mark.slow
def test_sweep_and_subdivision_agree_where_strips_change_in_parts() -> None:
    """Many small rectangles that touch, so that most of a strip goes on while parts of it begin and
    end.
    """
    rng = random.Random(11)
    for _ in range(300):
        found = set()
        for _ in range(rng.randint(1, 24)):
            u, v = rng.randrange(8), rng.randrange(8)
            wide = rng.choice((1, 1, 2, 3, 8))
            found.add((u * (wide < 8), min(u + wide, 8), v, min(v + rng.randint(1, 3), 8)))
        cover = Cover(8, tuple(sorted(found)))
        one, two = sweep(cover), components(cover)
        assert sorted(one.areas.values()) == sorted(two.areas)
        assert sorted(one.cluster_areas.values()) == sorted(two.cluster_areas)
        assert Counter((one.areas[a], one.cluster_areas[b]) for a, b in one.touching) == Counter(
            (two.areas[a], two.cluster_areas[b]) for a, b in two.touching
        )


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


def random_values(rng: random.Random) -> dict[str, Fraction]:
    def positive() -> Fraction:
        return Fraction(rng.randint(1, 300), 100)

    found = {name: positive() for name in NAMES}
    return found | {
        name: Fraction(rng.randint(-300, 300), 100) for name in ("F3", "F4", "F3x", "F4x")
    }


def potential(v: dict[str, arb]) -> arb:
    """The energy from the coordinates of the four nodes."""
    nodes = (
        (arb(0), arb(0)), (v["rho"], arb(0)),
        (v["L1"] * v["th1"].cos(), v["L1"] * v["th1"].sin()),
        (v["rho"] - v["L2"] * v["th2"].cos(), v["L2"] * v["th2"].sin()),
    )  # fmt: skip
    energy = (
        -v["F3x"] * nodes[2][0]
        - v["F3"] * nodes[2][1]
        - v["F4x"] * nodes[3][0]
        - v["F4"] * nodes[3][1]
    )
    for number, (one, two) in enumerate(((0, 3), (1, 2), (2, 3)), 1):
        across, up = nodes[two][0] - nodes[one][0], nodes[two][1] - nodes[one][1]
        stretch = (across * across + up * up).sqrt() - v[f"l0_{number}"]
        energy += v[f"k{number}"] * stretch * stretch / 2
    return energy


@pytest.mark.parametrize("seed", range(5))
def test_derivatives_are_those_of_the_potential(seed: int) -> None:
    """Divided differences of the potential from the nodes' coordinates, with 400 bits and a step of
    2^-60.
    """
    rng = random.Random(seed)
    v = random_values(rng)
    th1, th2 = Fraction(rng.randint(-300, 300), 100), Fraction(rng.randint(-300, 300), 100)
    with ctx.workprec(400):
        h = arb(2) ** -60
        point = {name: ball_of(value) for name, value in v.items()}

        def u(i: int, j: int) -> arb:
            return potential({**point, "th1": ball_of(th1) + i * h, "th2": ball_of(th2) + j * h})

        at, (l1, l2) = (ball_of(th1), ball_of(th2)), (point["L1"], point["L2"])
        jet = BallEquations(form_of(claims_of(v, Count.TOTAL).result.slice), point)(at)
        ((u11, u12), (u21, u22)), d = jet.jacobian, PaperEnergy(point)(*at)
        mixed = (u(1, 1) - u(1, -1) - u(-1, 1) + u(-1, -1)) / (4 * h**2)
        pairs = [
            (jet.values[0], (u(1, 0) - u(-1, 0)) / (2 * h)), (jet.values[0], l1 * d.e1),
            (jet.values[1], (u(0, 1) - u(0, -1)) / (2 * h)), (jet.values[1], l2 * d.e2),
            (u11, (u(1, 0) - 2 * u(0, 0) + u(-1, 0)) / h**2), (u11, l1 * d.e11),
            (u22, (u(0, 1) - 2 * u(0, 0) + u(0, -1)) / h**2), (u22, l2 * d.e22),
            (u12, mixed), (u12, l1 * d.e12), (u21, l2 * d.e21),
        ]  # fmt: skip
        for formula, difference in pairs:
            assert abs(formula - difference) < 1e-25


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


@pytest.mark.slow
def test_solutions_of_a_cell_are_where_the_check_finds_them(total: RegionMap) -> None:
    """Center by center: the engine's boxes and the check's."""
    for cell in total.cells:
        point = {n: e.evaluate(*cell.sample) for n, e in total.slice.parameters.items()}
        found = counted_at(point, Count.TOTAL)[2].found
        assert len(found) == len(cell.solutions)
        for solution in cell.solutions:
            assert isinstance(solution, Solution)
            assert any(
                all(
                    min(abs(float(c) - a + k * 6.283185307179586) for k in (-1, 0, 1)) < 1e-9
                    for c, a in zip(solution.center, e.center, strict=True)
                )
                for e in found
            )


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
    record = {
        "name": "settled",
        "system": {
            "parameters": {"c": {"kind": "number"}},
            "unknowns": {"x": "real"},
            "equations": ["x^2 - a"],
            "positive": ["3*c - 1"],
            "stable": ["c", "2", "x - b"],
        },
        "parameters": {"c": 1},
        "axes": {"a": [-1, 2], "b": [-1, 1]},
    }
    found = ptmcad.classify(
        slice_from_mapping(record), engine="certified", tolerance="1/10", jobs=1
    )
    assert {cell.stable for cell in found.cells} == {0, 1, 2}
    assert ptmcad.verify(found).ok
