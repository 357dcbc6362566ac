"""The unloaded mechanism's mirror: formulas next to flat configurations, their pitchforks, and all
other folds.
"""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from flint import arb
from numpy.typing import NDArray
from support.dense_search import dense_search
from support.paper_energy import PaperEnergy, energy_at

pytest.importorskip("numba")

import ptmcad
from ptmcad.certified.branchandprune import search_curve
from ptmcad.certified.plain import criticalcurves as plain_curves
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.mirrors import mirrors
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.refinement import CriticalCurve
from ptmcad.certified.statement import beforehand
from ptmcad.model.involutions import Involution
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Count, Slice

Floats = NDArray[np.float64]
REFLECTION = Involution((0, 1), (-1, -1), (0, 0))
FLAT = ((1, 1), (1, -1), (-1, 1), (-1, -1))
"""Cosines of th1 and th2, in the order of the curves."""
UNLOADED = {
    "L1": "4/5",
    "k1": "90",
    "k2": "110",
    "k3": "70",
    "l0_1": "1/4",
    "l0_2": "1/5",
    "l0_3": "3/10",
}


NEAR_FLAT = [
    (Fraction(789, 1000), np.array([0.675, -0.195, 0.145])),
    (Fraction(764, 1000), np.array([0.855, -0.192, 0.140])),
    (Fraction(874, 1000), np.array([0.970, 0.116, -0.168])),
]
"""rho, and about L2, th1 and th2, of folds that are not flat. Newton's method finds a flat one
nearly always.
"""


def slice_of(**changes: str) -> Slice:
    given = {name: value for name, value in (UNLOADED | changes).items() if value}
    return slice_from_mapping(
        {"name": "s", "parameters": given, "axes": {"rho": ["1/20", "2"], "L2": ["1/10", "2"]}}
    )


def energy(slice: Slice, x: Fraction, y: Fraction) -> PaperEnergy:
    return energy_at(
        lambda n: slice.parameters[n].evaluate(x, y) if n in slice.parameters else Fraction(0)
    )


def has_flat_mirror(slice: Slice) -> bool:
    return REFLECTION in mirrors(slice, problem_of(slice))


def test_which_slices_have_the_mirror() -> None:
    assert has_flat_mirror(slice_of())
    assert has_flat_mirror(slice_of(l0_1="0", l0_3="0"))
    assert has_flat_mirror(slice_of(l0_2="rho"))
    assert has_flat_mirror(slice_of(F3="0"))
    assert has_flat_mirror(slice_of(l0_3="L2 + rho"))
    for name, value in (("F3", "1"), ("F4", "rho")):
        assert not has_flat_mirror(slice_of(**{name: value})), name


def folds(slice: Slice, number: int, *, flat: bool) -> list[Floats]:
    """Points (x, y, th1, th2) with a Hessian that is singular and positive semidefinite."""
    rng, found = np.random.default_rng(4), list[Floats]()
    while len(found) < number:
        x = Fraction(float(rng.uniform(0.3, 1.9)))
        start = np.array([rng.uniform(0.2, 1.9), *rng.uniform(-3, 3, 2)])
        if flat:
            start[1:] = rng.choice([0.0, np.pi], 2)
        point = newton(slice, x, start, flat=flat)
        if (
            point is None
            or not 0.11 < point[1] < 1.99
            or flat != (float(np.abs(np.sin(point[2:])).max()) < 1e-6)
        ):
            continue
        d = energy(slice, x, Fraction(float(point[1])))(*(arb(float(v)) for v in point[2:]))
        if d.e11 > 1e-3 and d.e22 > 1e-3:
            found.append(point)
    return found


def newton(slice: Slice, x: Fraction, z: Floats, *, flat: bool) -> Floats | None:
    """A zero (y, th1, th2) of E1, E2 and det H; of det H alone at a flat configuration."""

    def equations(z: Floats) -> Floats:
        d = energy(slice, x, Fraction(float(z[0])))(*(arb(float(angle)) for angle in z[1:]))
        singular = d.e11 * d.e22 - d.e12 * d.e21
        return np.array([float(v.mid()) for v in ((singular,) if flat else (d.e1, d.e2, singular))])

    moving = 1 if flat else 3
    for _ in range(60):
        if not 0.1 < z[0] < 2:
            return None
        value = equations(z)
        jacobian = np.array(
            [(equations(z + h) - equations(z - h)) / 2e-7 for h in 1e-7 * np.eye(3)[:moving]]
        ).T
        if abs(np.linalg.det(jacobian)) < 1e-12:
            return None
        move = np.zeros(3)
        move[:moving] = np.clip(np.linalg.solve(jacobian, value), -0.3, 0.3)
        z = z - move
        if np.abs(move).max() < 1e-12:
            return np.array([float(x), *z])
    return None


def is_kept(found: tuple[CriticalCurve, ...], point: Floats) -> bool:
    """Whether one of the curves' searches leaves a box that has the point, or its mirror image."""
    x, y = point[:2]
    window = np.array([[x - 0.02, y - 0.02, x + 0.011, y + 0.03]])
    for number, curve in enumerate(found):
        boxes = search_curve(
            curve.system.arguments(), curve.start(window), 1e-6, 50_000, curve.importance()
        ).left()
        half = boxes.shape[1] // 2
        if number >= 3 * len(FLAT):  # far from the mirror, in both angles
            places = [np.array([x, y, *((point[2:] + 3) % (2 * np.pi) - 3)])]
        elif half == 2:
            places = [point[:2]] if np.abs(np.sin(point[2:])).max() < 1e-6 else []
        else:
            flat, larger = FLAT[number // 3], number % 3 == 2
            shift = np.array([0.0 if c > 0 else np.pi for c in flat])
            # the tangents of half the angles from there, of the larger one first
            pair = np.tan((point[2:][::-1] if larger else point[2:]) / 2 - shift / 2)
            places = (
                [np.array([x, y, abs(pair[0]), pair[1] / pair[0]])] if abs(pair[0]) > 1e-9 else []
            )
        for place in places:
            if (
                ((boxes[:, :half] <= place + 1e-8) & (boxes[:, half:] >= place - 1e-8))
                .all(axis=1)
                .any()
            ):
                return True
    return False


@pytest.mark.parametrize("kind", ["flat", "near flat"])
@pytest.mark.slow_cases("flat")
def test_the_search_keeps_known_folds(kind: str) -> None:
    slice = slice_of()
    found = curves(slice, Count.STABLE)[:13]
    assert [len(c.system.unknowns) for c in found] == [2, 4, 4] * 4 + [4]
    points = (
        folds(slice, 4, flat=True)
        if kind == "flat"
        else [newton(slice, *start, flat=False) for start in NEAR_FLAT]
    )
    assert all(point is not None and is_kept(found, point) for point in points)


def test_on_a_slice_with_a_load_folds_would_be_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the hypothesis is for."""
    slice = slice_of(F3="-5")
    points = folds(slice, 3, flat=False)
    monkeypatch.setattr(plain_curves, "mirrors", lambda *_: [REFLECTION])
    assert not all(is_kept(curves(slice, Count.STABLE)[:12], point) for point in points)


@pytest.mark.slow
def test_maps_with_and_without_the_mirror_do_not_contradict() -> None:
    slice = slice_from_mapping(
        {
            "name": "s",
            "parameters": {"L1": "1", "k": "100", "l0": "1/5"},
            "axes": {"rho": ["3/5", "7/5"], "L2": ["1/2", "3/2"]},
        }
    )
    given = {"engine": "certified", "tolerance": "1/12", "jobs": 1}
    quick = ptmcad.classify(slice, **given)  # type: ignore[arg-type]
    slow = ptmcad.classify(slice, without=["mirror-images"], **given)  # type: ignore[arg-type]
    for one, other in ((quick, slow), (slow, quick)):
        at = [dict(zip(slice.axis_names, cell.sample, strict=True)) for cell in one.cells]
        told = [
            (other.locate(**p).stable, cell.stable) for p, cell in zip(at, one.cells, strict=True)
        ]
        assert sum(a is not None for a, _ in told) >= len(told) // 2
        assert all(a in (None, b) for a, b in told)
    rng = random.Random(7)
    for _ in range(40):
        x, y = (
            a.low + (a.high - a.low) * Fraction(rng.randrange(1, 10**6), 10**6) for a in slice.axes
        )
        count = quick.locate(**dict(zip(slice.axis_names, (x, y), strict=True))).stable
        values = {
            name: float(expression.evaluate(x, y)) for name, expression in slice.parameters.items()
        }
        assert count is None or any(
            dense_search(values, grid)["stable"] == count for grid in (12, 48)
        )


def test_without_free_lengths_the_map_is_the_exact_engines() -> None:
    slice = slice_from_mapping(
        {
            "name": "s",
            "parameters": {"L1": "1", "k": "100"},
            "axes": {"rho": ["1/20", "2"], "L2": ["1/20", "2"]},
        }
    )
    assert has_flat_mirror(slice)
    proved = ptmcad.classify(slice, engine="certified", tolerance="1/100", jobs=1)
    true = ptmcad.classify(slice)
    window = Fraction(39, 20) ** 2
    for count in {region.stable for region in true.regions}:
        low = sum((r.area[0] for r in proved.regions if r.stable == count), Fraction(0))
        known = [
            sum((r.area[k] for r in true.regions if r.stable == count), Fraction(0)) for k in (0, 1)
        ]
        assert low <= known[1]
        assert known[0] <= low + proved.undetermined * window


def test_the_plan_says_what_is_saved() -> None:
    def steps(without: frozenset[str] = frozenset(), count: Count = Count.STABLE) -> list[str]:
        return [step.saving for step in beforehand(replace(slice_of(), count=count), without)]

    assert "mirror-images" in steps()
    assert "mirror-images" in steps(count=Count.TOTAL)
    assert len(curves(slice_of(), Count.STABLE, frozenset({"mirror-images"}))) == 2
