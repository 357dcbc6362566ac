"""Slices that are their own mirror image: the folds on and off the mirror, and limits of minima on
it.
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
from support.few import few
from support.paper_energy import PaperEnergy, energy_at

pytest.importorskip("numba")

import ptmcad
from ptmcad.certified.branchandprune import search_curve
from ptmcad.certified.plain import criticalcurves as plain_curves
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.mirrors import mirrors
from ptmcad.certified.plain.opening import QUARTER
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


def energy(slice: Slice, x: Fraction, y: Fraction) -> PaperEnergy:
    return energy_at(
        lambda n: slice.parameters[n].evaluate(x, y) if n in slice.parameters else Fraction(0)
    )


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


def newton(slice: Slice, x: float, z: Floats, on_the_mirror: bool) -> Floats | None:
    """A zero (y, th1, th2) of E1, E2 and det H; or (y, s, s) of E1 and H11 - H12."""

    def equations(z: Floats) -> Floats:
        angles = (z[1], z[1]) if on_the_mirror else (z[1], z[2])
        d = energy(slice, Fraction(x), Fraction(float(z[0])))(
            *(arb(float(angle)) for angle in angles)
        )
        found = (
            (d.e1, d.e11 - d.e12) if on_the_mirror else (d.e1, d.e2, d.e11 * d.e22 - d.e12 * d.e21)
        )
        return np.array([float(v.mid()) for v in found])

    z = z[:2] if on_the_mirror else z
    for _ in range(40):
        if not -29 < z[0] < -0.1:
            return None
        value = equations(z)
        jacobian = np.array(
            [(equations(z + h) - equations(z - h)) / 2e-7 for h in 1e-7 * np.eye(len(z))]
        ).T
        if abs(np.linalg.det(jacobian)) < 1e-12:
            return None
        move = np.linalg.solve(jacobian, value)
        z = z - np.clip(move, -1, 1)
        if np.abs(move).max() < 1e-12:
            return np.array([x, z[0], z[1], z[-1]])
    return None


def folds(slice: Slice, number: int, kind: str) -> list[Floats]:
    """Points (x, y, th1, th2) with a Hessian that is singular and positive semidefinite:
    pitchforks, or other folds.
    """
    rng, found = np.random.default_rng(6), list[Floats]()
    while len(found) < number:
        start = np.array([rng.uniform(-25, -1), *rng.uniform(-3, 3, 2)])
        point = newton(slice, float(rng.uniform(0.2, 1.9)), start, kind == "pitchfork")
        if point is not None and (kind == "off the mirror") == (halves(point)[1] > 0.01):
            d = energy(slice, *(Fraction(float(v)) for v in point[:2]))(
                *(arb(float(v)) for v in point[2:])
            )
            if d.e11 > 1e-3 and d.e22 > 1e-3:
                found.append(point)
    return found


def halves(point: Floats) -> tuple[float, float]:
    """s in its turn and d in [0, pi/2], of the configuration or its mirror image."""
    s, d = (point[2] + point[3]) / 2, (point[2] - point[3]) / 2
    turns = np.round(d / np.pi)
    return float((s - turns * np.pi + 3) % (2 * np.pi) - 3), float(abs(d - turns * np.pi))


def left_around(curve: CriticalCurve, x: float, y: float) -> Floats:
    window = np.array([[x - 0.02, y - 0.2, x + 0.011, y + 0.3]])
    return search_curve(
        curve.system.arguments(), curve.start(window), 1e-5, 50_000, curve.importance()
    ).left()


def is_kept(found: tuple[CriticalCurve, ...], point: Floats) -> bool:
    """Whether one of the curves' searches leaves a box that has it."""
    s, d = halves(point)
    here = np.array([*point[:2], s, d])
    for curve in found:
        boxes = left_around(curve, *map(float, point[:2]))
        known = here[: boxes.shape[1] // 2]
        if len(known) == 3 and d > 1e-9:
            continue  # it is not on the mirror
        if (
            ((boxes[:, : len(known)] <= known + 1e-9) & (boxes[:, len(known) :] >= known - 1e-9))
            .all(axis=1)
            .any()
        ):
            return True
    return False


@pytest.mark.parametrize(
    "kind", few(["pitchfork", "on the mirror", "off the mirror"], "pitchfork", "on the mirror")
)
@pytest.mark.slow_cases("pitchfork")
def test_the_search_keeps_known_folds(kind: str) -> None:
    slice = slice_of()
    found = curves(slice, Count.STABLE)[:3]
    assert [len(c.system.unknowns) for c in found] == [3, 3, 4]
    assert QUARTER[0] <= 0
    assert QUARTER[1] > np.pi / 2
    assert all(is_kept(found, point) for point in folds(slice, 2, kind))


@pytest.mark.slow
def test_on_a_slice_that_is_not_its_own_image_folds_would_be_lost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What the hypothesis is for."""
    slice = slice_of(F4="9*F/10")
    points = folds(slice, 3, "off the mirror")
    monkeypatch.setattr(plain_curves, "mirrors", lambda *_: [EXCHANGE])
    assert not all(is_kept(curves(slice, Count.STABLE)[:3], point) for point in points)


def test_a_minimum_that_two_springs_without_length_absorb_is_kept() -> None:
    """At rho = L the ends of springs 1 and 2 are at their pivots for th = 0, and both push as hard
    as the loads do.
    """
    slice = ptmcad.slice_from_mapping(
        {
            "parameters": {"L1": 1, "L2": 1, "k": 100, "F3": "F", "F4": "F", "l0": "1/5"},
            "axes": {"rho": ["1/2", "3/2"], "F": ["-30", "-10"]},
        }
    )
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
    rng = random.Random(7)
    for _ in range(points):
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
    """There u is linear in w, and the third equation off the mirror would be a square."""
    parameters = {"L1": "1", "L2": "1", "k": "100", "F3": "F", "F4": "F"}
    slice = slice_from_mapping(
        {"name": "s", "parameters": parameters, "axes": {"rho": ["1/20", "2"], "F": ["-40", "0"]}}
    )
    assert is_own_image(slice)
    proved = ptmcad.classify(slice, engine="certified", tolerance="1/200", jobs=1)
    true = ptmcad.classify(slice)
    window = Fraction(39, 20) * 40
    for count in {region.stable for region in true.regions}:
        low = sum((r.area[0] for r in proved.regions if r.stable == count), Fraction(0))
        known = [
            sum((r.area[k] for r in true.regions if r.stable == count), Fraction(0)) for k in (0, 1)
        ]
        assert low <= known[1]
        assert known[0] <= low + proved.undetermined * window


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
