"""Samples at which spring 3 has no length with the bars in line, and the forces balance any
direction of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path

import pytest

pytest.importorskip("numba")

from forger.consistency import put
from support.maps import once_per_run
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Solution
from ptmcad.cover.rectangles import Cover
from ptmcad.question.slice import Point
from ptmcad.verification.certified.cellsamples import _near
from ptmcad.verification.certified.counted import CountedPoint
from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.certified.models import ModelCounting
from ptmcad.verification.normalform.boxes import Unproved

UNLOADED = {"L1": "1", "k": "1", "l0": "1/2"}
PI = Fraction(math.pi)
DATA = Path(__file__).resolve().parents[1] / "data" / "samples"


def map_of(axes: dict[str, list[str]], **parameters: str) -> RegionMap:
    def compute() -> RegionMap:
        given = {
            name: value for name, value in {**UNLOADED, **parameters}.items() if name not in axes
        }
        record = {"name": "flat", "parameters": given, "axes": axes, "count": "stable"}
        return ptmcad.classify(record, tolerance="1/4", jobs=1)

    return ptmcad.RegionMap.from_json(once_per_run(f"flat {axes} {parameters}", compute).to_json())


@pytest.fixture(scope="module", autouse=True)
def counted_once() -> Iterator[None]:
    """What the checker finds at a point does not depend on what is claimed there."""
    own, found = ModelCounting.at, dict[tuple[str, Fraction, Fraction], CountedPoint | Unproved]()

    def at(
        counting: ModelCounting,
        x: Fraction,
        y: Fraction,
    ) -> CountedPoint:
        slice = counting.lattice.slice
        key = (f"{slice.parameters} {slice.count}", x, y)
        if key not in found:
            try:
                found[key] = own(counting, x, y)
            except Unproved as reason:
                found[key] = reason
        if isinstance(there := found[key], Unproved):
            raise there
        return there

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ModelCounting, "at", at)
        yield


def counted(r: RegionMap) -> bool | None:
    report = ptmcad.verify(r, boxes=0)
    assert report.ok is (report.violation is None)
    return next(check.passed for check in report.checks if check.name == "counts and solutions")


@pytest.fixture(scope="module", name="flat")
def flat_map() -> RegionMap:
    """One cell, whose sample has rho = L1 + L2, which an earlier version took."""
    true = ptmcad.RegionMap.from_json((DATA / "flat.json").read_text(encoding="utf-8"))
    (cell,) = true.cells
    assert tuple(cell.sample) == (Fraction(6, 5), Fraction(1, 5))
    assert cell.stable == len(cell.solutions) == 2
    return true


def test_a_true_map_without_loads_is_accepted(flat: RegionMap) -> None:
    assert len(_near(CertifiedClaims(flat), flat.cells[0])) == 4
    assert counted(flat) is True


def one_less(r: RegionMap) -> RegionMap:
    (cell,) = r.cells
    cells = put(r.cells, 0, stable=1, solutions=cell.solutions[:1])
    return replace(r, cells=cells, regions=put(r.regions, 0, stable=1))


def with_boxes(
    change: Callable[[tuple[Solution, ...]], tuple[Solution, ...]],
) -> Callable[[RegionMap], RegionMap]:
    return lambda r: replace(r, cells=put(r.cells, 0, solutions=change(r.cells[0].solutions)))


FALSE = {
    "a count": one_less,
    "a box twice": with_boxes(lambda s: (s[0], s[0])),
    "a box less": with_boxes(lambda s: s[:1]),
    "a box elsewhere": with_boxes(
        lambda s: (s[0], replace(s[1], center=(s[1].center[0] + 1, s[1].center[1])))
    ),
    "signs": with_boxes(lambda s: (s[0], replace(s[1], signs="+-"))),
}


@pytest.mark.parametrize("kind", FALSE)
def test_a_false_map_is_rejected(kind: str, flat: RegionMap) -> None:
    assert counted(FALSE[kind](flat)) is False


@pytest.mark.slow
def test_a_slice_that_is_flat_everywhere_is_not_decided() -> None:
    true = map_of(
        {"F": ["15", "19"], "l0": ["11/50", "6/25"]}, L2="1", rho="2", k="100", F3="F", F4="-F"
    )
    assert counted(true) is None


def test_a_sample_too_near_to_a_rectangle_is_not_decided(flat: RegionMap) -> None:
    """So near that everything beside it would be as good as flat."""
    steps = 2**40
    middle = steps // 2
    near = replace(flat, cover=Cover(steps, ((0, middle - 1, 0, steps),)))
    assert len(_near(CertifiedClaims(near), near.cells[0])) == 4
    (first, second), width = (axis.low for axis in flat.slice.axes), Fraction(1, 5)
    off = width * (Fraction(middle - 1, steps) + Fraction(1, 2**64))
    cells = put(near.cells, 0, sample=Point(("rho", "L2"), first + off, second + off))
    assert not _near(CertifiedClaims(replace(near, cells=cells)), cells[0])


def test_a_solution_that_is_stored_twice_a_turn_apart(flat: RegionMap) -> None:
    solutions = flat.cells[0].solutions
    again = replace(solutions[0], center=(solutions[0].center[0] - 2 * PI, solutions[0].center[1]))
    assert (
        counted(replace(flat, cells=put(flat.cells, 0, solutions=(solutions[0], again)))) is False
    )
