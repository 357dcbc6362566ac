"""Closed loops on springs with free lengths: maps and poses against a search along the loop's own
angle.

The hypotheses of Theorem 5 of docs/soundness.md are dropped one by one; each time a map or a count
is wrong then.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from support.loop_search import Energy, Numbers, counts_along

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.ask.lines.along import certified_intervals
from ptmcad.ask.lines.rangerows import operation_widths
from ptmcad.certified import engine
from ptmcad.certified.engine import certified_map
from ptmcad.certified.plain import criticalcurves as plain_curves
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.refinement import CriticalCurve
from ptmcad.errors import ConfigError
from ptmcad.formulas.graph import Formula
from ptmcad.options import Options
from ptmcad.question.slice import Count
from ptmcad.show.report.scripttape import tape
from ptmcad.workbench.fields.quantityfield import field_of, request_of

pytest.importorskip("numba")

RECORD = yaml.safe_load(
    (Path(__file__).parents[2] / "configs" / "mechanisms" / "four-bar-free.yaml").read_text(
        encoding="utf-8"
    )
)
FOUR_BAR: dict[str, Any] = {key: value for key, value in RECORD.items() if key != "reference"}
ANCHORED: dict[str, Any] = {
    "name": "anchored",
    "mechanism": FOUR_BAR["mechanism"]
    | {
        "parameters": {
            name: p for name, p in FOUR_BAR["mechanism"]["parameters"].items() if name != "k2"
        }
        | {"x": {"default": 0}, "y": {"default": 0}},
        "points": FOUR_BAR["mechanism"]["points"] | {"C": ["x", "y"]},
        "springs": [{"between": ["C", "Q"], "k": "k1", "free": "l0"}],
    },
    "parameters": {"F": "1/5", "G": "1/3"},
    "axes": {"x": [0, 4], "y": [-2, 2]},
}
"""One spring, whose anchor meets the second crank's end on a circle of the window."""
FLAT = FOUR_BAR | {"parameters": {"F": "1/2", "G": 1}, "axes": {"b": [1, 4], "l0": [0, 1]}}
"""The loop folds flat on lines of the window."""
SLICES = {"four-bar-free": FOUR_BAR, "anchored": ANCHORED, "flat": FLAT}
POINTS = 200


def slice_of(name: str, **changes: Any) -> ptmcad.Slice:
    return ptmcad.slice_from_mapping(SLICES[name] | changes)


def values_at(slice: ptmcad.Slice, x: Fraction, y: Fraction) -> dict[str, float]:
    return {name: float(value.evaluate(x, y)) for name, value in slice.parameters.items()}


def energy_of(p: Mapping[str, float]) -> Energy:
    def stretched(k: float, dx: Numbers, dy: Numbers) -> Numbers:
        return k / 2 * (np.hypot(dx, dy) - p["l0"]) ** 2

    def energy(px: Numbers, py: Numbers, qx: Numbers, qy: Numbers) -> Numbers:
        loads = -p["F"] * py - p["G"] * qy
        if "x" in p:
            return loads + stretched(p["k1"], qx - p["x"], qy - p["y"])
        return loads + stretched(p["k1"], qx, qy) + stretched(p["k2"], px - p["b"], py)

    return energy


def random_points(slice: ptmcad.Slice, seed: int) -> list[tuple[Fraction, Fraction]]:
    rng = random.Random(seed)
    shares = [
        (Fraction(rng.randrange(1, 10**6), 10**6), Fraction(rng.randrange(1, 10**6), 10**6))
        for _ in range(400)
    ]
    (one, two) = slice.axes
    return [
        (one.low + u * (one.high - one.low), two.low + v * (two.high - two.low)) for u, v in shares
    ]


def wrong_counts(
    m: RegionMap, number: int = POINTS, seed: int = 5
) -> list[tuple[Fraction, Fraction]]:
    """Of so many random points outside of the cover those at which the search finds another count."""
    first, second = m.slice.axis_names
    found, tried = [], 0
    for x, y in random_points(m.slice, seed):
        cell = m.locate(**{first: x, second: y}).cell
        if cell is None or tried == number:
            continue
        tried += 1
        p = values_at(m.slice, x, y)
        total, stable = counts_along(p, energy_of(p))
        said = m.cells[cell]
        if said.stable != stable if m.slice.count is Count.STABLE else said.total != total:
            found.append((x, y))
    assert tried == number
    return found


@cache
def map_of(name: str, count: str, tolerance: str) -> RegionMap:
    return ptmcad.classify(slice_of(name, count=count), tolerance=tolerance)


@pytest.mark.parametrize(
    ("name", "count", "tolerance"),
    [
        ("four-bar-free", "stable", "1/500"),
        ("flat", "total", "1/200"),
        pytest.param("four-bar-free", "total", "1/500", marks=pytest.mark.slow),
        pytest.param("flat", "stable", "1/500", marks=pytest.mark.slow),
        pytest.param("anchored", "total", "1/500", marks=pytest.mark.slow),
        pytest.param("anchored", "stable", "1/500", marks=pytest.mark.slow),
    ],
)
@pytest.mark.slow_cases("flat-total-1/200")
def test_counts_are_those_of_a_search_along_the_loop(name: str, count: str, tolerance: str) -> None:
    m = map_of(name, count, tolerance)
    assert m.undetermined < Fraction(tolerance)
    assert not wrong_counts(m)


@pytest.mark.slow
def test_as_free_lengths_vanish_counts_are_the_exact_engine_s() -> None:
    slice = slice_of("four-bar-free")
    for x, y in random_points(slice, 11)[:6]:
        at = {"F": x, "G": y}
        exact, near = (ptmcad.solve(replaced(l0), **at) for l0 in ("0", "1/1000000000"))
        assert (exact.status, near.status) == (Status.EXACT, Status.CERTIFIED)
        assert len(exact.equilibria) == len(near.equilibria)
        assert exact.stable == near.stable


def replaced(l0: str) -> dict[str, Any]:
    return FOUR_BAR | {"parameters": {"l0": l0}}


@pytest.mark.slow
def test_poses_are_the_critical_points_along_the_loop() -> None:
    slice = slice_of("anchored")
    for x, y in random_points(slice, 3)[:6]:
        p = values_at(slice, x, y)
        poses = ptmcad.solve(ANCHORED, x=x, y=y)
        assert (len(poses.equilibria), poses.stable) == counts_along(p, energy_of(p))
        assert len({pose.energy.text(8) for pose in poses.equilibria if pose.energy}) == len(
            poses.equilibria
        )


def test_a_relaxed_spring_is_told() -> None:
    """Of an unloaded loop on one spring: its force and the energy are zero, to 100 digits, and the
    pose is stable.
    """
    poses = ptmcad.solve(ANCHORED | {"parameters": {}}, x="3/2", y=1)
    relaxed = [
        pose for pose in poses.equilibria if abs(pose.springs[0].force.high) < Fraction(1, 10**100)
    ]
    assert len(relaxed) == poses.stable == 4
    assert all(
        pose.energy is not None and abs(pose.energy.high) < Fraction(1, 10**100) for pose in relaxed
    )
    assert all(pose.stable and pose.admissible is None for pose in relaxed)
    assert len(poses.equilibria) == 8


LOOSE: dict[str, tuple[str, float, float]] = {
    "L1": ("length", 0.5, 1.5), "L2": ("length", 0.5, 1.5), "L3": ("length", 0.5, 2), "b": ("length", 1, 3),
    "k1": ("stiffness", 0.5, 2), "k2": ("stiffness", 0.2, 2), "F": ("force", -2, 2), "G": ("force", -2, 2),
    "x": ("number", -1, 3), "y": ("number", -2, 2), "l1": ("free length", 0, 1.5), "l2": ("free length", 0, 1.5),
}  # fmt: skip
"""Kinds and ranges of what a random four-bar is made of: C = (x, y) holds the second crank's end.
"""


def random_slice(seed: int) -> ptmcad.Slice:
    rng = random.Random(seed)

    def between(low: float, high: float) -> str:
        return str(Fraction(rng.uniform(low, high)).limit_denominator(30))

    axes: dict[str, list[str]] = {}
    for name in rng.sample(sorted(LOOSE), 2):
        _, low, high = LOOSE[name]
        middle = rng.uniform(low, high)
        axes[name] = [between(low, middle), between(middle + 0.1, high + 0.2)]
    mechanism = FOUR_BAR["mechanism"] | {
        "parameters": {n: {"default": 1} | ({} if k == "number" else {"kind": k}) for n, (k, *_) in LOOSE.items()},
        "points": FOUR_BAR["mechanism"]["points"] | {"C": ["x", "y"]},
        "springs": [
            {"between": ["C", "Q"], "k": "k1", "free": "l1"}, {"between": ["B0", "P"], "k": "k2", "free": "l2"},
        ],
    }  # fmt: skip
    values = {
        name: between(low, high) for name, (_, low, high) in LOOSE.items() if name not in axes
    }
    record = {"name": "loose", "mechanism": mechanism, "parameters": values, "axes": axes}
    return ptmcad.slice_from_mapping(record | {"count": rng.choice(["total", "stable"])})


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(16))
def test_random_four_bars(seed: int) -> None:
    slice = random_slice(seed)
    m = ptmcad.classify(slice, tolerance="1/50", timeout=120)
    decided = 0
    for x, y in random_points(slice, seed)[:POINTS]:
        cell = m.locate(**dict(zip(slice.axis_names, (x, y), strict=True))).cell
        if cell is None:
            continue
        decided += 1
        p = values_at(slice, x, y)

        def energy(
            px: Numbers, py: Numbers, qx: Numbers, qy: Numbers, p: dict[str, float] = p
        ) -> Numbers:
            first = np.hypot(qx - p["x"], qy - p["y"]) - p["l1"]
            second = np.hypot(px - p["b"], py) - p["l2"]
            work: Numbers = (
                (p["k1"] * first**2 + p["k2"] * second**2) / 2 - p["F"] * py - p["G"] * qy
            )
            return work

        total, stable = counts_along(p, energy, 20001)
        said = m.cells[cell]
        assert (said.total, said.stable) == (
            (None, stable) if slice.count is Count.STABLE else (total, None)
        ), (x, y)
    assert decided > 0.9 * POINTS


@pytest.mark.slow
def test_intervals_along_a_line() -> None:
    """With stable counts; and an operation range is where most poses are stable, as without free
    lengths.
    """
    slice = slice_of("four-bar-free")
    found = certified_intervals(slice, "F", {"G": "18/5"}, 10)
    assert len(found.intervals) == 3
    for interval in found.intervals:
        p = values_at(slice, interval.sample, Fraction(18, 5))
        assert (interval.total, interval.stable) == counts_along(p, energy_of(p))
    widths = operation_widths(slice, "F", 3, 6)
    assert widths.working == 3
    with pytest.raises(ConfigError, match="not followed where springs have free lengths"):
        ptmcad.pose_paths(slice, "F", {"G": "18/5"}, "1")


def test_a_map_of_an_angle_is_that_of_the_poses() -> None:
    """Followed in floating point with the springs' roots, and compared with proved poses."""
    result = map_of("four-bar-free", "stable", "1/500")
    field = field_of(result, request_of(result.slice, "th1", "stable:1"), 6, checks=12)
    assert field.checked == 12
    assert field.difference < 1e-9
    assert tape(result) is None, "the report's page has no roots of loops, and follows nothing"


CRANK: dict[str, Any] = yaml.safe_load(
    (Path(__file__).parents[2] / "configs" / "mechanisms" / "slider-crank.yaml").read_text(
        encoding="utf-8"
    )
)


def crank(unknowns: Mapping[str, str]) -> dict[str, Any]:
    spring = {"between": ["A", "S"], "k": "k", "free": "1/3"}
    mechanism = CRANK["mechanism"] | {"unknowns": dict(unknowns), "springs": [spring]}
    return {"mechanism": mechanism, "axes": {"W": [-2, 2], "M": [-2, 2]}}


def crank_counts(weight: float, moment: float) -> tuple[int, int]:
    """Along the crank's angle, for either way of assembling; the moment's work grows with the
    turns.
    """
    th = np.linspace(-np.pi, np.pi, 20001)
    total = minima = 0
    for side in (1, -1):
        x = np.cos(th) + side * np.sqrt(4 - np.sin(th) ** 2)
        energy = (np.hypot(x - 1, 1) - 1 / 3) ** 2 / 2 + weight * np.sin(th) - moment * th
        rising = np.diff(energy) > 0  # the same after a turn
        before = np.roll(rising, 1)
        total, minima = (
            total + int((rising != before).sum()),
            minima + int((rising & ~before).sum()),
        )
    return total, minima


@pytest.mark.parametrize(
    "unknowns", [{"th": "angle", "x": "length"}, {"x": "length", "th": "angle"}], ids=str
)
@pytest.mark.slow_cases("{'th': 'angle', 'x': 'length'}")
def test_a_slider_in_any_order_of_the_unknowns(unknowns: dict[str, str]) -> None:
    """Bounds of the slider follow from the loop; the determinant's sign from the order."""
    record = crank(unknowns)
    slice = ptmcad.slice_from_mapping(record)
    for x, y in random_points(slice, 2)[:4]:
        poses = ptmcad.solve(record, W=x, M=y)
        assert (len(poses.equilibria), poses.stable) == crank_counts(float(x), float(y))
    # as many minima as maxima are along a closed curve: which pose is stable is told by energies
    ordered = sorted(
        ptmcad.solve(record, W="1/3", M=0).equilibria, key=lambda pose: pose.known_energy.center
    )
    assert ordered[0].stable is True
    assert ordered[-1].stable is False
    stable = ptmcad.classify(slice, tolerance="1/50")
    assert stable.undetermined < Fraction(1, 50)
    for x, y in random_points(slice, 4)[:40]:
        cell = stable.locate(W=x, M=y).cell
        assert cell is None or stable.cells[cell].stable == crank_counts(float(x), float(y))[1]


LADDER: dict[str, Any] = {
    "name": "ladder",
    "mechanism": {
        "name": "ladder",
        "parameters": {"F": {"kind": "force"}, "G": {"kind": "force"}},
        "unknowns": {"x": "length", "y": "length"},
        "points": {"A": [2, 0], "P": ["x", 0], "Q": ["4/5*y", "3/5*y"]},
        "closing": [{"between": ["P", "Q"], "length": 1}],
        "springs": [{"between": ["A", "Q"], "k": 1, "free": "3/2"}],
        "loads": {"P": ["F", 0], "Q": [0, "G"]},
    },
    "axes": {"F": [-2, 2], "G": [-2, 2]},
    "count": "total",
}
"""A bar between two sliders on oblique guides; no unknown is an angle."""


@pytest.mark.slow
def test_sliders_that_bound_one_another() -> None:
    """Only the loop does: x^2 + y^2 - 8/5 x y = 1; in the checker, too."""
    m = ptmcad.classify(ptmcad.slice_from_mapping(LADDER), tolerance="1/50")
    turn = np.linspace(-np.pi, np.pi, 20001)
    y = np.sin(turn) / 0.6
    x = np.cos(turn) + 0.8 * y
    tried = 0
    for f, g in random_points(m.slice, 8)[:60]:
        energy = (np.hypot(0.8 * y - 2, 0.6 * y) - 1.5) ** 2 / 2 - float(f) * x - float(g) * 0.6 * y
        rising = np.diff(energy) > 0
        cell = m.locate(F=f, G=g).cell
        if cell is not None:
            tried += 1
            assert m.cells[cell].total == int((rising != np.roll(rising, 1)).sum())
    assert tried > 40
    report = ptmcad.verify(m, boxes=2)
    assert report.ok, report.table()
    told = {check.name: check for check in report.checks}
    assert told["counts and solutions"].passed, told["counts and solutions"].detail


def test_what_is_not_computed_is_refused() -> None:
    mechanism = FOUR_BAR["mechanism"]
    two_free = mechanism | {
        "unknowns": mechanism["unknowns"] | {"th3": "angle"},
        "points": mechanism["points"] | {"R": ["b + 2*L2*cos(th3)", "sin(th3)"]},
        "loads": mechanism["loads"] | {"R": [0, "F"]},
    }
    with pytest.raises(
        ConfigError, match=r"free lengths in closed loops .* one degree of freedom, not 2"
    ):
        ptmcad.slice_from_mapping(FOUR_BAR | {"mechanism": two_free})
    with pytest.raises(ConfigError, match="choose certified or auto"):
        ptmcad.classify(slice_of("four-bar-free"), engine="exact")


def without_curves(monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    """Leave out the curves whose names begin with one of these."""
    complete = engine.curves

    def some(*given: Any, **options: Any) -> tuple[CriticalCurve, ...]:
        return tuple(
            curve for curve in complete(*given, **options) if not curve.name.startswith(names)
        )

    monkeypatch.setattr(engine, "curves", some)


@pytest.mark.slow
def test_without_flat_loops_counts_are_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fold at which the tangent is not zero is not all: at b = L1 + L2 + L3 = 37/10 the whole
    loop comes to be.
    """
    original = plain_curves.system

    def bent(
        equations: list[Formula],
        unknowns: Any,
        vanishing: Any,
        nonnegative: Sequence[Formula] = (),
        **more: Any,
    ) -> Any:
        closed = equations[-3]  # the loop's equation, the slope and the determinant
        slopes = [closed.graph.derivative(closed, k) for k in unknowns[2:4]]
        far = slopes[0].squared() + slopes[1].squared() - Fraction(1, 10**4)
        return original(equations, unknowns, vanishing, [*nonnegative, far], **more)

    monkeypatch.setattr(plain_curves, "system", bent)
    wrong = ptmcad.classify(
        slice_of("flat", count="total", axes={"b": ["7/2", 4], "l0": [0, 1]}), tolerance="1/20"
    )
    assert wrong_counts(wrong, 40)
    monkeypatch.undo()
    right = ptmcad.classify(
        slice_of("flat", count="total", axes={"b": ["7/2", 4], "l0": [0, 1]}), tolerance="1/20"
    )
    assert not wrong_counts(right, 40)
    assert {0, 2} <= {cell.total for cell in right.cells}


SMALL = {"axes": {"x": ["9/5", "11/5"], "y": [1, "7/5"]}, "count": "total"}
"""Around a place at which the second crank's end may be, upright over its pivot."""
MET = {"x": Fraction(2), "y": Fraction(6, 5)}


@pytest.mark.slow
def test_where_a_spring_has_no_length_there_is_an_equilibrium_less(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """On the circle itself, which a map has to leave out: beside it the peak is a smooth one, and
    counts.
    """
    slice = slice_of("anchored", **SMALL)
    complete = ptmcad.classify(slice, tolerance="1/20")
    assert complete.locate(**MET).cell is None
    counter = plain_counter(slice)
    beside = counter.at(MET["x"] + Fraction(1, 1000), MET["y"], Count.TOTAL)
    p = values_at(slice, MET["x"], MET["y"])
    total, _ = counts_along(p, energy_of(p))  # with the peak
    assert beside.decided and beside.total == total
    assert not counter.at(MET["x"], MET["y"], Count.TOTAL).decided
    without_curves(monkeypatch, "point where")
    assert ptmcad.classify(slice, tolerance="1/20").locate(**MET).cell is not None


@pytest.mark.slow
def test_without_short_springs_counts_are_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    """Folds at which a spring is shorter than an eighth of what is usual have a search of their
    own.
    """
    slice = slice_of("anchored", **SMALL)
    assert not wrong_counts(ptmcad.classify(slice, tolerance="1/50"))
    without_curves(monkeypatch, "fold with spring")
    assert wrong_counts(ptmcad.classify(slice, tolerance="1/50"))


def test_the_equations_are_the_energy_s_slope_along_the_loop() -> None:
    """By differences: along the loop's tangent, with the pulls."""
    problem = problem_of(slice_of("four-bar-free"))
    assert problem.closing == 1 and not problem.is_gradient
    assert all(not f.terms for cone in problem.cones for pair in cone.weights[:1] for f in pair)
    p = {
        "L1": 1.0,
        "L2": 1.2,
        "L3": 1.5,
        "b": 2.0,
        "k1": 1.0,
        "k2": 1.0,
        "F": 1.0,
        "G": 1.5,
        "l0": 0.5,
    }
    energy, step = energy_of(p), 1e-5

    def place(t: Numbers) -> tuple[Numbers, Numbers, Numbers, Numbers]:
        return np.cos(t[0]), np.sin(t[0]), 2 + 1.2 * np.cos(t[1]), 1.2 * np.sin(t[1])

    def closed(t: Numbers) -> Numbers:
        px, py, qx, qy = place(t)
        return (qx - px) ** 2 + (qy - py) ** 2 - 1.5**2

    def slopes(f: Any, t: Numbers) -> Numbers:
        return np.array([(f(t + step * e) - f(t - step * e)) / (2 * step) for e in np.eye(2)])

    counter = plain_counter(slice_of("four-bar-free")).branches[0]
    for t in (np.array([0.3, 1.7]), np.array([-2.0, 0.9])):
        first, second = slopes(closed, t)
        along = np.array([-second, first]) @ slopes(lambda at: energy(*place(at)), t)
        assert float(closed(t)) == pytest.approx(value_of(counter, 0, t), abs=1e-12)
        assert along == pytest.approx(value_of(counter, 1, t), abs=1e-7)


def value_of(counter: Any, equation: int, t: Numbers) -> float:
    from ptmcad.formulas.ballarithmetic import ball, run_arb

    box = [ball(Fraction(x), Fraction(x)) for x in (1.0, 1.5, *t)]
    values = run_arb(counter.equations.tape, box, 90)
    return float(values[int(counter.equations.equations[equation])].mid())


@pytest.mark.slow
def test_springs_side_by_side_in_a_loop_are_the_one_spring_that_they_are() -> None:
    """From C to Q with k1, and to a point 3/2 as far with k1: k1 (1 + 9/4), and of the free lengths
    l0 (1 + 3/2).
    """
    mechanism: dict[str, Any] = ANCHORED["mechanism"]
    beyond = ["x + a*(b + L2*cos(th2) - x)", "y + a*(L2*sin(th2) - y)"]
    several = mechanism | {
        "points": mechanism["points"] | {"T": beyond},
        "parameters": mechanism["parameters"] | {"a": {"default": "3/2"}},
        "springs": [{"between": ["C", "T"], "k": "k1", "free": "l0"}, *mechanism["springs"]],
    }
    alone = mechanism | {"springs": [{"between": ["C", "Q"], "k": "13/4*k1", "free": "10/13*l0"}]}
    window = {"axes": {"x": [1, 3], "y": [-1, 1]}, "count": "stable"}
    one, two = (
        ptmcad.slice_from_mapping(ANCHORED | window | {"mechanism": m}) for m in (alone, several)
    )
    many = certified_map(two, Options(tolerance=Fraction(1, 10), jobs=1))
    found = plain_counter(one)
    assert len({cell.stable for cell in many.cells}) > 2
    for cell in many.cells:
        assert found.at(*cell.sample, Count.STABLE).stable == cell.stable
    told = {check.name for check in ptmcad.verify(many, boxes=2).checks if check.passed}
    assert told >= {"counts and solutions", "random boxes"}
