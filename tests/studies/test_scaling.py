"""The scaling benchmark: its families give what they claim, its fits find planted laws, its runs can be repeated."""

from __future__ import annotations

import json
import math
import random
import re
import time
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.structure import check_structure

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.question.slice import Slice
from ptmcad.show.render.printing import save
from ptmcad.studies.bench.scaling import __main__ as command
from ptmcad.studies.bench.scaling import families, folds, measurement, run, slices
from ptmcad.studies.bench.scaling.fit import Verdict, fit, medians
from ptmcad.studies.bench.scaling.measurement import Run, Stages, in_child
from ptmcad.studies.bench.scaling.picture import draw_scaling
from ptmcad.studies.bench.scaling.table import grouped, to_markdown
from ptmcad.text.expressions import axis

ROOT = Path(__file__).resolve().parents[2]


# --------------------------------------------------------------------------------------------- what is known of folds


@given(st.integers(0, 32), st.fractions(-3, 3, max_denominator=9).filter(bool))
def test_chebyshev_polynomials_by_their_definition(n: int, z: Fraction) -> None:
    """T_n((z + 1/z)/2) = (z^n + z^-n)/2."""
    assert folds.chebyshev(n, axis(0)).evaluate((z + 1 / z) / 2, Fraction(0)) == (z**n + z**-n) / 2


CORNERS = {(-1, 1): "left top", (1, -1): "right bottom", (-1, -1): "left bottom"}
"""Where the lines cut off a triangle of the square -1 < a, b < 1 with L2 = 1 + a/2, rho = 1/2 + b/3."""


def test_the_square_of_the_grid_has_three_triangles() -> None:
    """By the unloaded answer: the stable count at the corners of the square, and in its middle."""

    def two(a: Fraction, b: Fraction) -> bool:
        bar, rho = 1 + a / 2, Fraction(1, 2) + b / 3
        return abs(bar - 1) < 2 * rho < bar + 1

    near = Fraction(99, 100)
    assert {(i, j) for i in (-1, 1) for j in (-1, 1) if not two(i * near, j * near)} == set(CORNERS)
    assert two(Fraction(0), Fraction(0))


def glued(n: int) -> int:
    """Regions of the n by n grid, by gluing copies of the square along their sides."""
    parts = {(i, j, part) for i in range(n) for j in range(n) for part in ("middle", *CORNERS.values())}
    parent = {part: part for part in parts}

    def root(part: tuple[int, int, str]) -> tuple[int, int, str]:
        while parent[part] != part:
            part = parent[part]
        return part

    # copies are mirrored in turn: copy i has its left side at its left for even n - i, say, and at its right for others
    for i in range(n):
        for j in range(n):
            for di, dj in ((1, 0), (0, 1)):
                if i + di < n and j + dj < n:
                    k = i if di else j
                    high = (n - k) % 2 == 1  # T_n is (-1)^m at the m-th point from the right
                    side = (("left", "right") if di else ("bottom", "top"))[high]
                    for part in ("middle", *CORNERS.values()):
                        if part == "middle" or side in part.split():
                            parent[root((i, j, part))] = root((i + di, j + dj, part))
    return len({root(part) for part in parts})


def test_regions_of_the_grid_by_gluing() -> None:
    for n in range(1, 13):
        assert glued(n) == folds.regions_of_grid(n)


FOLDED = {
    **{f"fold {n}": (folds.fold(n), folds.regions_of_fold(n)) for n in (1, 2, 3, 5)},
    **{f"grid {n}": (folds.grid(n), folds.regions_of_grid(n)) for n in (1, 2, 3)},
    "window 2": (folds.window_of_fold(2), folds.regions_of_fold(2)),
}
_maps: dict[str, RegionMap] = {}


def folded(name: str) -> RegionMap:
    if name not in _maps:
        _maps[name] = ptmcad.classify(FOLDED[name][0])
    return _maps[name]


@pytest.mark.parametrize("name", FOLDED, ids=lambda name: f"{name} [known by construction]")
@pytest.mark.fast_cases(
    "fold 1 [known by construction]", "fold 2 [known by construction]", "grid 1 [known by construction]"
)
def test_the_engine_finds_the_regions_of_folds(name: str) -> None:
    result = folded(name)
    check_structure(result)
    assert len(result.regions) == FOLDED[name][1]
    assert sorted({region.stable for region in result.regions}) == [1, 2]
    assert sum(region.stable == 2 for region in result.regions) == 1


@pytest.mark.slow
@pytest.mark.parametrize(("slice", "regions"), [
    *(pytest.param(folds.fold(n), folds.regions_of_fold(n), id=f"fold {n}") for n in (8, 16, 32)),
    *(pytest.param(folds.grid(n), folds.regions_of_grid(n), id=f"grid {n}") for n in (4, 5, 6)),
    pytest.param(folds.window_of_fold(6), folds.regions_of_fold(6), id="window 6"),
])  # fmt: skip
def test_the_engine_finds_the_regions_of_many_folds(slice: Slice, regions: int) -> None:
    assert len(ptmcad.classify(slice).regions) == regions


@settings(max_examples=40)
@given(
    st.sampled_from(sorted(FOLDED)), st.fractions(0, 1, max_denominator=997), st.fractions(0, 1, max_denominator=991)
)
def test_folds_have_the_known_count_everywhere(name: str, s: Fraction, t: Fraction) -> None:
    """2 stable poses where |L2 - L1| < 2 rho < L2 + L1 (REFERENCE: unloaded), at any point off these lines."""
    slice = FOLDED[name][0]
    at = tuple(a.low + (a.high - a.low) * u for a, u in zip(slice.axes, (s, t), strict=True))
    rho, bar = (slice.parameters[p].evaluate(*at) for p in ("rho", "L2"))
    if 0 < s < 1 and 0 < t < 1 and 2 * rho not in (abs(bar - 1), bar + 1):
        found = folded(name).locate(**dict(zip(slice.axis_names, at, strict=True)))
        if found.stable is not None:  # on a wall of the decomposition that is none of the variety, none is asked
            assert found.stable == (2 if abs(bar - 1) < 2 * rho < bar + 1 else 1)


# ------------------------------------------------------------------------------------------------ degrees and heights


@given(st.integers(0, 20), st.integers(0, 10**6))
def test_bends_are_dense_and_small(n: int, seed: int) -> None:
    terms = slices.bend(n, seed).numerator
    assert len(terms) == (n + 1) * (n + 2) // 2
    assert max(i + j for i, j, _ in terms) == n
    assert sum(abs(c) for _, _, c in terms) <= slices.SHIFT


@pytest.mark.parametrize(("n", "seed"), [(1, 1), (2, 2), (5, 1)])
def test_the_curves_of_bent_slices_have_the_degree_asked_for(n: int, seed: int) -> None:
    result = ptmcad.classify(slices.unloaded(n, seed))
    assert [c.polynomial.total_degree for c in result.components if not c.left_out] == [n] * 3
    assert len(result.regions) == 4


@pytest.mark.parametrize("n", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_the_curves_of_loaded_slices_have_six_times_the_degree(n: int) -> None:
    (found,) = families.exact(n, slices.loaded(n, 1), 2)
    assert found.found["degree"] == 6 * n


def test_numbers_grow_in_height_and_nothing_else() -> None:
    maps = {n: ptmcad.classify(slices.digits(n, 1)) for n in (5, 20)}
    for n, result in maps.items():
        assert len(str(result.slice.parameters["L1"].constant().numerator)) == n + 3
        assert len(result.regions) == 3
    assert len(maps[5].cells) == len(maps[20].cells)
    length = [m.slice.parameters["L1"].constant() for m in maps.values()]
    assert abs(length[0] - length[1]) < Fraction(1, 10**6)


def test_another_seed_draws_other_slices() -> None:
    assert slices.unloaded(3, 1) == slices.unloaded(3, 1) != slices.unloaded(3, 2)
    assert slices.digits(9, 1) == slices.digits(9, 1) != slices.digits(9, 2)
    assert families.designs(1) == families.designs(1) != families.designs(2)


def test_a_family_with_the_wrong_number_of_regions_is_a_fault() -> None:
    with pytest.raises(ptmcad.errors.PtmcadError, match="fold-2 has 5 regions, not 4"):
        families.exact(2, folds.fold(2), 4)


def test_the_known_designs_have_their_equilibria(monkeypatch: pytest.MonkeyPatch) -> None:
    """12 of REFERENCE.md first among the designs that are solved; 26 and 30 follow."""
    pytest.importorskip("numba")
    assert families.designs(1)[:3] == families.KNOWN_DESIGNS
    monkeypatch.setattr(families, "DESIGNS", 0)
    monkeypatch.setattr(families, "KNOWN_DESIGNS", families.KNOWN_DESIGNS[:1])
    assert [r.found["equilibria"] for r in families.equilibria(1, 1)] == [12]


def test_algebra_has_four_or_six_equilibria(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(families, "DESIGNS", 8)
    found = families.fibres(1, 1)
    assert len(found) == 11
    assert {r.found["equilibria"] for r in found} == {4, 6}


def test_certified_maps_within_a_tolerance(monkeypatch: pytest.MonkeyPatch) -> None:
    """The boxes are those that the search treated; a smaller tolerance takes more of them."""
    pytest.importorskip("numba")
    from ptmcad.certified import refinement

    used: list[int] = []
    search_curve = refinement.search_curve

    def counting(*arguments: Any) -> Any:
        result = search_curve(*arguments)
        used.append(result.used)
        return result

    monkeypatch.setattr(refinement, "search_curve", counting)
    boxes = []
    for size in (5, 50):
        used.clear()
        (found,) = families.tolerances(size, 1)
        assert found.found["boxes"] == sum(used)
        boxes.append(sum(used))
    assert boxes[0] < boxes[1]


# ---------------------------------------------------------------------------------------------------------------- fits


@settings(max_examples=40)
@given(st.floats(-3, 6), st.floats(1e-6, 1e3), st.sets(st.integers(1, 500), min_size=4, max_size=9), st.integers(0, 99))
def test_an_exact_power_law_gives_its_exponent(p: float, c: float, sizes: set[int], seed: int) -> None:
    found = fit([(x, c * x**p) for x in sizes], seed)
    assert found is not None
    assert math.isclose(found.exponent, p, rel_tol=1e-9, abs_tol=1e-9)
    assert math.isclose(found.growth, p, rel_tol=1e-9, abs_tol=1e-9)
    assert math.isclose(found.factor, c, rel_tol=1e-6)
    assert found.low <= found.exponent <= found.high
    assert found.verdict in (Verdict.POWER_LAW, Verdict.FLAT)


@settings(max_examples=30)
@given(st.floats(0.7, 5), st.integers(0, 10**6))
def test_noise_is_within_the_bounds_of_the_exponent(p: float, seed: int) -> None:
    """Noise of 5 %, as on a shared machine: the exponent is right to 0.1 and does not become another law."""
    source = random.Random(seed)
    points = [(x, x**p * math.exp(source.gauss(0, 0.05))) for x in (2, 4, 8, 16, 32, 64) for _ in range(3)]
    found = fit(points)
    assert found is not None
    assert abs(found.exponent - p) < 0.1
    assert found.low - 0.1 < p < found.high + 0.1
    assert found.verdict is Verdict.POWER_LAW


@settings(max_examples=15)
@given(st.floats(0.8, 4), st.floats(0.1, 20))
def test_a_fixed_cost_is_told_from_growth(p: float, share: float) -> None:
    """y = a + x^p, a being a share of what the smallest size costs beyond it."""
    sizes = [2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0]
    a = share * sizes[0] ** p
    found = fit([(x, a + x**p) for x in sizes])
    assert found is not None
    if found.verdict is Verdict.FIXED_COST:
        assert abs(found.growth - p) < 0.05 * p
        assert abs(found.fixed - a) < 0.05 * (a + sizes[0] ** p)
        assert found.growth_low <= found.growth <= found.growth_high
        assert abs(found.growth_high - p) < 0.2 * p
        assert abs(found.growth_low - p) < 0.2 * p
    if share > 1.5:
        assert found.verdict is Verdict.FIXED_COST


@pytest.mark.parametrize(
    ("law", "verdict"),
    [
        pytest.param(lambda x: math.exp(x / 20), Verdict.RISES, id="exponential"),
        pytest.param(lambda x: math.log(x) ** 2, Verdict.FALLS, id="logarithm squared"),
        pytest.param(lambda x: 5 + 0.01 * math.sin(x), Verdict.FLAT, id="constant"),
        pytest.param(lambda x: 2 + math.cos(3 * math.log(x)) if x != 8 else 30, Verdict.SCATTERED, id="no order"),
    ],
)
def test_what_is_no_power_law_is_not_called_one(law: Any, verdict: Verdict) -> None:
    found = fit([(x, law(x)) for x in (2, 4, 8, 16, 32, 64, 128)])
    assert found is not None
    assert found.verdict is verdict or (verdict is Verdict.SCATTERED and found.verdict is not Verdict.POWER_LAW)


def test_three_sizes_are_too_few() -> None:
    found = fit([(1, 1), (2, 4), (4, 16)])
    assert found is not None
    assert found.verdict is Verdict.TOO_FEW
    assert math.isclose(found.exponent, 2)


@pytest.mark.parametrize("points", [[], [(1, 2)], [(1, 2), (1, 3)], [(1, 2), (2, 0)], [(0, 1), (1, 2)]])
def test_without_two_positive_points_there_is_no_fit(points: list[tuple[float, float]]) -> None:
    assert fit(points) is None


def test_one_slow_run_is_outvoted() -> None:
    assert medians([(2, 1.0), (2, 9.0), (2, 1.2), (1, 0.5)]) == ((1, 0.5), (2, 1.2))


# --------------------------------------------------------------------------------------------------------- measurement


@pytest.mark.slow
def test_a_child_brings_its_figures_back() -> None:
    def task() -> list[Run]:
        watch = Stages()
        watch.begin("first")
        sum(range(10**5))
        watch.begin("second")
        return [watch.run(7, {"cells": 3})]

    found = in_child(task, 60.0)
    assert not isinstance(found, str)
    ((size, stages, what),) = [(r.size, r.stages, r.found) for r in found]
    assert (size, list(stages), what) == (7, ["first", "second"], {"cells": 3})
    assert found[0].seconds >= sum(stages.values()) > 0


@pytest.mark.slow
@pytest.mark.skipif(not measurement._HIGH_WATER.exists(), reason="only Linux shows the peak of a forked child alone")
def test_memory_is_what_the_task_takes_and_not_what_its_parent_has() -> None:
    ballast = bytes(80 << 20) + bytes(1)  # the sum is written, which makes its pages resident

    def task() -> list[Run]:
        watch = Stages()
        watch.begin("small")
        watch.begin("large")
        len(bytes(40 << 20) + bytes(1))
        return [watch.run(1, {})]

    found = in_child(task, 60.0, before=lambda: len(bytes(60 << 20) + bytes(1)))
    assert not isinstance(found, str)
    assert len(ballast) > 80 << 20
    assert found[0].memory["small"] < 20
    assert 38 < found[0].memory["large"] < 120


@pytest.mark.slow
def test_what_fails_in_a_child_has_a_reason() -> None:
    def task() -> list[Run]:
        raise ptmcad.errors.PtmcadError("no such thing")

    found = in_child(task, 60.0)
    assert isinstance(found, str)
    assert "no such thing" in found


def test_a_child_that_takes_too_long_is_ended() -> None:
    def task() -> list[Run]:
        time.sleep(600)
        return []

    assert in_child(task, 0.2) == "no answer within 0.2 s"


# ---------------------------------------------------------------------------------------------------- the whole report


def small(name: str = "small", sizes: tuple[int, ...] = (1, 2, 3)) -> families.Family:
    def slice_of(n: int, seed: int) -> Slice:
        return folds.fold(n)

    return families.Family(
        name, "Small folds", "regions", "regions", sizes, families._exact(slice_of, folds.regions_of_fold), "nothing",
        heavy=sizes[-1:],
    )  # fmt: skip


def without_clock(report: dict[str, Any]) -> Any:
    """What has to be the same in the next run."""
    kept = [
        {**family, "fits": sorted(family["fits"].keys() - {"areas", "stacks", "projection", "adjacency", "memory"}),
         "runs": [(r["size"], r["found"], sorted(r["stages"])) for r in family["runs"]]}
        for family in report["families"]
    ]  # fmt: skip
    return {**report, "families": kept, "machine": None}


@pytest.fixture(scope="module")
def report() -> dict[str, Any]:
    """Of children that are not warmed up: nothing here asks how long they took."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run, "touch", lambda certified: None)
        return run.scaling([small()], 2, 5)


@pytest.mark.slow
def test_all_but_time_is_the_same_in_the_next_run(report: dict[str, Any]) -> None:
    first, again = (run.scaling([small(sizes=(1, 2))], 1, 5) for _ in range(2))
    assert without_clock(first) == without_clock(again)
    assert json.loads(json.dumps(report)) == report


@pytest.mark.slow
def test_a_report_says_what_it_was_made_with(report: dict[str, Any]) -> None:
    assert report["format"] == run.FORMAT
    assert (report["seed"], report["rounds"]) == (5, 2)
    assert report["machine"]["cores"]
    assert report["versions"]["python-flint"]
    (family,) = report["families"]
    assert [r["size"] for r in family["runs"]] == [1, 1, 2, 2, 3]  # the heavy one only once
    assert [r["found"]["regions"] for r in family["runs"]] == [4, 4, 5, 5, 6]
    assert list(family["runs"][0]["stages"]) == ["variety", "projection", "stacks", "counts", "adjacency", "areas"]
    assert {"seconds", "counts"} <= family["fits"].keys()


def test_a_size_that_fails_is_given_up_with_its_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "touch", lambda certified: None)
    wrong = replace(small(), measure=families._exact(lambda n, seed: folds.fold(n), lambda n: 4 if n > 2 else n + 3))
    (family,) = run.scaling([wrong], 1)["families"]
    assert {r["size"] for r in family["runs"]} == {1, 2}
    assert all("regions, not 4" in reason for reason in family["reasons"].values())
    assert family["reasons"]
    assert "has no figures" in to_markdown({**run.scaling([], 1), "families": [family]})


@pytest.mark.slow
def test_the_page_shows_every_place_and_every_fit(report: dict[str, Any]) -> None:
    page = to_markdown(report)
    (family,) = report["families"]
    for regions in (4, 5, 6):
        assert f"\n| {regions} | " in page
    assert f"{family['fits']['seconds']['exponent']:.2f} (" in page
    widths = [line.count("|") for line in page.splitlines() if line.startswith("|")]
    assert len(set(widths)) == 2  # of the table of fits and of the table of runs


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(families, "FAMILIES", (small(),))
    assert command.main(["small", "--rounds", "1", "--out", str(tmp_path / "out")]) == 0
    assert {p.name for p in (tmp_path / "out").iterdir()} == {
        "scaling.json", "scaling.md", "scaling-small.svg", "scaling-small.png",
    }  # fmt: skip
    assert (tmp_path / "out" / "scaling.md").read_text(encoding="utf-8") == capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["folds"], "no family 'folds'; there are degree"),
        (["fold", "--rounds", "0"], "--rounds must be at least 1"),
        (["fold", "--limit", "-1"], "--limit must be positive"),
        (["fold", "--limit", "nan"], "--limit must be positive"),
    ],
)
def test_bad_input(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    try:
        status: Any = command.main(arguments)
    except SystemExit as end:
        status = end.code
    assert status == 2
    assert message in capsys.readouterr().err


def test_a_folder_that_can_not_be_made_is_refused_before_anything_is_measured(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    assert command.main(["fold", "--out", str(tmp_path / "file")]) == 2
    errors = capsys.readouterr().err
    assert "file" in errors
    assert "round 1" not in errors


# ------------------------------------------------------------------------------------------------------------ pictures


@pytest.mark.parametrize("memory", [0.0, 40.0])
def test_pictures(report: dict[str, Any], tmp_path: Path, memory: float) -> None:
    """Every stage is named, the title says what grows, the description says the exponent."""
    family = json.loads(json.dumps(report["families"][0]))
    for r in family["runs"]:
        r["memory"] = {"variety": memory * r["size"]}
    figure = draw_scaling(family)
    assert len(figure.axes) == (2 if memory else 1)
    assert {"variety", "counts", "adjacency", "in all"} <= {
        t.get_text() for t in figure.axes[0].get_legend().get_texts()
    }
    save(figure, tmp_path / "a.svg")
    save(draw_scaling(family), tmp_path / "b.svg")
    text = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert text == (tmp_path / "b.svg").read_text(encoding="utf-8")
    assert "<title>Small folds</title>" in text
    assert f"exponent {family['fits']['seconds']['exponent']:.2f}" in text


def test_a_family_without_runs_can_not_be_drawn(report: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="no runs"):
        draw_scaling({**report["families"][0], "runs": []})


# ---------------------------------------------------------------------------------------------------- the manual's page


STORED = ROOT / "docs" / "benchmarks" / "scaling.json"
ROW = re.compile(r"^\| `(?P<name>[\w-]+)` \| [^|]* \| (?P<time>[^|]*) \| (?P<memory>[^|]*) \|", re.MULTILINE)


def said(cell: str) -> float | None:
    """The exponent that a cell of the page's table says; None where it says that there is none."""
    found = re.match(r"\d+\.\d+", cell)
    return float(found[0]) if found else None


def test_the_manual_says_what_was_measured() -> None:
    """Each family has its row, and an exponent there is the stored one to within what two runs differ by."""
    stored = {family["name"]: family for family in json.loads(STORED.read_text(encoding="utf-8"))["families"]}
    rows = {found["name"]: found for found in ROW.finditer((ROOT / "docs" / "scaling.md").read_text(encoding="utf-8"))}
    assert rows.keys() | {"threads"} == stored.keys() == {family.name for family in families.FAMILIES}
    for name, row in rows.items():
        for cell, quantity in ((row["time"], "seconds"), (row["memory"], "memory")):
            exponent = said(cell)
            if exponent is not None:
                law = stored[name]["fits"][quantity]
                assert min(abs(exponent - law[k]) for k in ("exponent", "growth")) < 0.4, (name, quantity)


def test_the_page_of_figures_is_made_from_the_stored_runs() -> None:
    report = json.loads(STORED.read_text(encoding="utf-8"))
    for family, stored in zip(families.FAMILIES, report["families"], strict=True):
        assert run._family(family, [Run(**r) for r in stored["runs"]], {}, report["seed"]) == stored
    assert (STORED.with_suffix(".md")).read_text(encoding="utf-8") == to_markdown(report)
    assert report["rounds"] >= 3
    for family in report["families"]:
        assert not family["reasons"]
        seen = grouped(family)
        for suffix in command.PICTURES if len(seen) >= command.MIN_PICTURE_SIZES else ():
            assert STORED.with_name(f"scaling-{family['name']}.{suffix}").exists()
