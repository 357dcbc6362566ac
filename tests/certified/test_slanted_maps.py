"""Maps with slanted pieces: against the exact engine, as files, checked, and shifted so that they
are wrong.
"""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest

pytest.importorskip("numba")

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.cover.rectangles import Patch, Tube
from ptmcad.verification import verify

CONFIGS = Path(__file__).parents[2] / "configs"
TOLERANCE = Fraction(1, 10**9)


@cache
def fine() -> RegionMap:
    return ptmcad.classify(
        ptmcad.load(CONFIGS / "fig4.yaml"), engine="certified", tolerance=TOLERANCE
    )


@cache
def true() -> RegionMap:
    return ptmcad.classify(ptmcad.load(CONFIGS / "fig4.yaml"))


@pytest.mark.slow
def test_error_costs_almost_nothing_where_curves_are_smooth() -> None:
    result = fine()
    assert result.status is Status.CERTIFIED
    assert result.undetermined <= TOLERANCE
    assert result.cover is not None
    assert len(result.cover.patches) < 1000
    assert len(result.to_json()) < 200_000


def test_areas_and_counts_are_those_of_the_exact_engine() -> None:
    for count in (1, 2):
        known = [[r.area for r in m.regions if r.stable == count] for m in (fine(), true())]
        (low, high), (exact_low, exact_high) = (
            (sum(a for a, _ in k), sum(b for _, b in k)) for k in known
        )
        assert low <= exact_high
        assert exact_low <= high
        assert high - low < Fraction(1, 10**7)
    rng = random.Random(4)
    for _ in range(20):
        at = {
            name: Fraction(rng.randrange(1, 2 * 10**6), 10**6) for name in true().slice.axis_names
        }
        assert fine().locate(at).stable == true().locate(at).stable


def test_points_next_to_tubes_have_the_exact_engines_counts() -> None:
    cover = fine().cover
    assert cover is not None
    rng = random.Random(8)
    decided = 0
    for patch in rng.sample(cover.patches, 30):
        left, right, bottom, top = patch.frame
        for _ in range(4):
            u, v = (
                Fraction(rng.randrange(64 * a + 1, 64 * b), 64)
                for a, b in ((left, right), (bottom, top))
            )
            at = {
                axis.name: axis.low + (axis.high - axis.low) * w / cover.steps
                for axis, w in zip(fine().slice.axes, (u, v), strict=True)
            }
            found = fine().locate(at)
            if found.status is Status.CERTIFIED:
                decided += 1
                assert found.stable == true().locate(at).stable
    assert decided > 100


def test_a_file_gives_the_same_map_and_a_damaged_one_is_refused() -> None:
    text = fine().to_json()
    again = RegionMap.from_json(text)
    assert again == fine()
    for damage, what in (
        (text.replace('"patches": [\n[', '"patches": [\n["a",'), "five integers"),
        (text.replace('"patches": [\n[', '"patches": [\n[[],'), "five integers"),
    ):
        with pytest.raises((ValueError, ptmcad.errors.ConfigError), match=what):
            RegionMap.from_json(damage)


def test_the_map_is_verified_and_tubes_beside_the_curves_are_not() -> None:
    report = verify(fine(), boxes=5)
    assert report.ok, str(report)
    cover = fine().cover
    assert cover is not None
    by = cover.steps // 50  # all tubes moved, as far as they stay what they are
    moved = tuple(
        Patch(
            p.frame,
            p.along,
            tuple(Tube(t.half, tuple(c + by for c in t.controls)) for t in p.tubes),
        )
        for p in cover.patches
    )
    false = replace(fine(), cover=replace(cover, patches=moved))
    assert not verify(false, boxes=5).ok


@pytest.mark.slow
def test_it_is_drawn_and_gone_on_from() -> None:
    assert len(fine().boundaries()) >= 2
    grid = fine().grid(24)
    exact = true().grid(24)
    same = (grid.stable == exact.stable).mean()
    assert same > 0.99
    again = ptmcad.classify(
        fine().slice, engine="certified", tolerance=Fraction(1, 10), resume=fine()
    )
    assert again.cover == fine().cover
