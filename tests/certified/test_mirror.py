"""Slices that are their own mirror image: the folds on and off the mirror, and limits of minima on
it.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray
from support.dense_search import dense_search

pytest.importorskip("numba")

from support.places import assert_same_areas, random_points
from support.replacing import replace

import ptmcad
from ptmcad.certified.branchandprune import search_curve
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.mirrors import mirrors
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.refinement import CriticalCurve
from ptmcad.model.involutions import Involution
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Count, Slice

Floats = NDArray[np.float64]
OWN_IMAGE = {
    "L1": "4/5", "L2": "4/5", "k1": "90", "k2": "90", "k3": "70", "F3": "F", "F4": "F", "F3x": "3", "F4x": "-3",
    "l0_1": "1/4", "l0_2": "1/4", "l0_3": "rho/4",
}  # fmt: skip


def slice_of(**changes: str) -> Slice:
    parameters = OWN_IMAGE | changes
    axes = {"rho": ["1/20", "2"], "F": ["-30", "0"]}
    if "F" not in parameters["F3"]:
        axes["G"] = axes.pop("F")
        parameters["l0_3"] = "rho/4 - G/100"
    return slice_from_mapping({"name": "s", "parameters": parameters, "axes": axes})


EXCHANGE = Involution((1, 0), (1, 1), (0, 0))


def is_own_image(slice: Slice) -> bool:
    return EXCHANGE in mirrors(slice, problem_of(slice))


def test_what_is_its_own_image() -> None:
    assert is_own_image(slice_of())
    assert is_own_image(slice_of(F3x="F*rho", F4x="-rho*F"))
    for name, value in (
        ("L2", "4/5 + rho/1000"), ("k2", "91"), ("l0_2", "1/5"), ("F4", "9*F/10"), ("F4x", "3"), ("F3x", "2"),
    ):  # fmt: skip
        assert not is_own_image(slice_of(**{name: value})), name
    unloaded = slice_of(F3="0", F4="0", F3x="0", F4x="0")
    assert mirrors(unloaded, problem_of(unloaded))[0].odd == 2  # a better one comes first
    assert is_own_image(slice_of(F3="-1", F4="-1"))


def left_around(curve: CriticalCurve, x: float, y: float) -> Floats:
    window = np.array([[x - 0.02, y - 0.2, x + 0.011, y + 0.3]])
    return search_curve(
        curve.system.arguments, curve.start(window), 1e-5, 50_000, curve.weights
    ).left()


def test_a_minimum_that_two_springs_without_length_absorb_is_kept() -> None:
    """At rho = L the ends of springs 1 and 2 are at their pivots for th = 0, and both push as hard
    as the loads do.
    """
    record = yaml.safe_load("""
        parameters: {L1: 1, L2: 1, k: 100, F3: F, F4: F, l0: 1/5}
        axes: {rho: [1/2, 3/2], F: ['-30', '-10']}
    """)
    slice = ptmcad.slice_from_mapping(record)
    counter = plain_counter(slice)
    inside, beyond = (
        counter.at(Fraction(1), y, Count.STABLE).stable for y in (Fraction(-19), Fraction(-21))
    )
    assert inside is not None
    assert beyond is not None
    assert inside != beyond
    on_the_mirror = curves(slice, Count.STABLE)[0]
    boxes = left_around(on_the_mirror, 1.0, -20.0)
    limit = np.array([1.0, -20.0, 0.0])
    assert ((boxes[:, :3] <= limit) & (boxes[:, 3:] >= limit)).all(axis=1).any()


@pytest.mark.parametrize(
    ("axes", "points"),
    [
        ({"rho": ["1/2", "3/2"], "F": ["-20", "-5"]}, 6),
        pytest.param({"rho": ["1/2", "3/2"], "F": ["-20", "-5"]}, 60, marks=pytest.mark.slow),
        pytest.param({"rho": ["1/2", "3/2"], "l0": ["0", "1/2"]}, 60, marks=pytest.mark.slow),
    ],
)
def test_maps_with_and_without_mirror_images_do_not_contradict(
    axes: dict[str, list[str]], points: int
) -> None:
    load = "F" if "F" in axes else "-10"
    parameters = {"L1": "1", "L2": "1", "k": "100", "F3": load, "F4": load} | (
        {"l0": "1/5"} if "F" in axes else {}
    )
    slice = slice_from_mapping({"name": "s", "parameters": parameters, "axes": axes})
    given = {"engine": "certified", "tolerance": "1/40", "jobs": 1}
    quick = ptmcad.classify(slice, **given)  # type: ignore[arg-type]
    slow = ptmcad.classify(slice, without=["mirror-images"], **given)  # type: ignore[arg-type]
    for one, other in ((quick, slow), (slow, quick)):
        at = [dict(zip(slice.axis_names, cell.sample, strict=True)) for cell in one.cells]
        told = [
            (other.locate(**p).stable, cell.stable) for p, cell in zip(at, one.cells, strict=True)
        ]
        assert sum(a is not None for a, _ in told) > len(told) // 2
        assert all(a in (None, b) for a, b in told)
    for x, y in random_points(slice, points, 7):
        count = quick.locate(**dict(zip(slice.axis_names, (x, y), strict=True))).stable
        values = {
            name: float(expression.evaluate(x, y)) for name, expression in slice.parameters.items()
        }
        assert count is None or any(
            dense_search(values, grid)["stable"] == count for grid in (12, 48)
        )


@pytest.mark.parametrize(
    ("loads", "axes", "tolerance"),
    [
        ({}, {"rho": ["1/20", "2"], "L2": ["1/20", "2"]}, "1/100"),
        ({"L2": "1", "F3": "F", "F4": "F"}, {"rho": ["1/20", "2"], "F": ["-40", "0"]}, "1/200"),
    ],
    ids=["flat poses", "equal bars"],
)
def test_without_free_lengths_the_map_is_the_exact_engines(
    loads: dict[str, str], axes: dict[str, list[str]], tolerance: str
) -> None:
    """With equal bars u is linear in w, and the third equation off the mirror would be a square."""
    slice = slice_from_mapping(
        {"name": "s", "parameters": {"L1": "1", "k": "100", **loads}, "axes": axes}
    )
    assert mirrors(slice, problem_of(slice))
    proved = ptmcad.classify(slice, engine="certified", tolerance=tolerance, jobs=1)
    assert_same_areas(proved, ptmcad.classify(slice))


def test_admissible_counts_have_the_same_curves() -> None:
    names = [
        curve.name
        for curve in curves(replace(slice_of(), count=Count.ADMISSIBLE), Count.ADMISSIBLE)
    ]
    assert [name.split()[0] for name in names[:3]] == ["fold", "pitchfork", "fold"]
    assert len(names) == 9
    assert [c.name for c in curves(slice_of(), Count.STABLE, frozenset({"mirror-images"}))] == [
        "fold of a stable equilibrium", "fold of a stable equilibrium with spring A3A4 short",
    ]  # fmt: skip
