"""Springs between two points of a circle, and along lines that turn (Lemma S10): counts and maps
against known ones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise, product
from math import cos, hypot, pi, sin
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

pytest.importorskip("numba")

from support.examples import examples

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.certified.engine import certified_map
from ptmcad.certified.plain import criticalcurves as plain_curves
from ptmcad.certified.plain import pointcounts as plain_points
from ptmcad.certified.plain import straight
from ptmcad.certified.plain.certifiedposes import point_slice
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.plain.straight import branches, located
from ptmcad.options import Options
from ptmcad.question.slice import Count
from ptmcad.text.balls import ball_of

Index = tuple[int, ...]


def record(mechanism: dict[str, Any], count: str = "index", **axes: list[Any]) -> dict[str, Any]:
    """A slice of a mechanism with a free length l and forces F, G."""
    parameters = {
        "l": {"kind": "free length", "default": 1},
        "F": {"kind": "force", "default": 0},
        "G": {"kind": "force", "default": 0},
    }
    given = {
        "name": "creased",
        **mechanism,
        "parameters": parameters | mechanism.get("parameters", {}),
    }
    return {
        "name": "creased",
        "mechanism": given,
        "axes": axes or {"F": [-2, 2], "l": [0, 2]},
        "count": count,
    }


CRANK: dict[str, Any] = {
    "unknowns": {"th": "angle"},
    "points": {"O": [0, 0], "A": [1, 0], "P": ["cos(th)", "sin(th)"]},
    "bars": [["O", "P"]],
    "springs": [{"between": ["A", "P"], "k": 1, "free": "l"}],
    "loads": {"P": ["F", "G"]},
}
"""With t = th/2 and s = sin t the energy is 2 s^2 - 2 l s - F (1 - 2 s^2) - G sin 2t, up to a
constant.
"""
PAIR: dict[str, Any] = {
    "unknowns": {"a": "angle", "b": "angle"},
    "points": {"O": [0, 0], "P": ["cos(a)", "sin(a)"], "Q": ["cos(b)", "sin(b)"]},
    "springs": [{"between": ["P", "Q"], "k": 1, "free": "l"}],
    "loads": {"P": ["F", "G"], "Q": ["F", "G"]},
}
"""Two cranks on one shaft, with a spring between their pins, both pulled by the same force."""


def counted(mechanism: dict[str, Any], **values: Fraction) -> Any:
    model = ptmcad.slice_from_mapping(record(mechanism)).model
    defaults = {
        name: Fraction(p.default) for name, p in model.parameters.items() if p.default is not None
    }
    return plain_counter(point_slice(model, defaults | values)).at(
        Fraction(0), Fraction(0), Count.INDEX
    )


small = st.fractions(min_value=-2, max_value=2, max_denominator=8)
lengths = st.fractions(min_value=Fraction(1, 8), max_value=2, max_denominator=8)


def crank_by_hand(force: Fraction, free: Fraction) -> Index:
    """Without G: at th = pi, and where s = l/(2 (1 + F)) is less than 1, on both sides of it."""
    if 0 < free < 2 * (1 + force):
        return 2, 1
    return 1, 0


@settings(max_examples=examples(40), deadline=None)
@given(small, lengths)
def test_a_crank_has_the_equilibria_of_half_its_angle(force: Fraction, free: Fraction) -> None:
    assume(free != 2 * (1 + force))
    count = counted(CRANK, F=force, l=free)
    assert count.decided
    assert count.index == crank_by_hand(force, free)
    assert all(abs(c) + s.radius < 4 for s in count.solutions for c in s.center)


@settings(max_examples=examples(40), deadline=None)
@given(small, small, lengths)
def test_the_crease_is_a_peak_in_eulers_sum(force: Fraction, up: Fraction, free: Fraction) -> None:
    """On the circle there are as many minima as maxima, one of which is the crease where it
    outweighs the load.
    """
    assume(abs(up) != free)
    count = counted(CRANK, F=force, G=up, l=free)
    assume(count.decided)  # near a fold nothing is
    minima, maxima = count.index
    assert minima == maxima + (abs(up) < free)


def pair_by_hand(force: float, free: float) -> Index:
    """With a = s + f, b = s - f the energy is 2 sin^2 f - 2 l |sin f| - 2 F cos f cos s; sin s or
    cos f is 0.
    """
    found = [0, 2, 0]  # cos f = 0 = cos s
    f = (np.arange(200000) + 0.5) * pi / 200000
    for c in (1, -1):
        slope = 2 * np.sin(2 * f) - 2 * free * np.cos(f) + 2 * c * force * np.sin(f)
        for k in np.flatnonzero(np.sign(slope[1:]) != np.sign(slope[:-1])):
            bent = 4 * cos(2 * f[k]) + 2 * free * sin(f[k]) + 2 * c * force * cos(f[k])
            turned = 2 * c * force * cos(f[k])
            if min(abs(bent), abs(turned)) < 1e-3:
                return ()  # nearly degenerate
            found[(bent < 0) + (turned < 0)] += 1
    return tuple(found)


@settings(max_examples=examples(40), deadline=None)
@given(st.sampled_from([("1", "0"), ("3/5", "4/5"), ("-5/13", "12/13")]), lengths, lengths)
@pytest.mark.slow
def test_two_cranks_have_the_equilibria_of_their_angles_difference(
    way: tuple[str, str], force: Fraction, free: Fraction
) -> None:
    true = pair_by_hand(float(force), float(free))
    assume(true)
    across, up = (force * Fraction(part) for part in way)
    count = counted(PAIR, F=across, G=up, l=free)
    assert count.decided
    assert count.index == true
    assert all(abs(c) + s.radius < 4 for s in count.solutions for c in s.center)


def turning(*frequencies: int) -> dict[str, Any]:
    """A shaft with pins that gears turn so many times as fast, a spring between each and the next,
    and from a point of their circle to the last."""
    pins = {f"P{k}": [f"cos({n}*a)", f"sin({n}*a)"] for k, n in enumerate(frequencies)}
    ends = [*pins, "A"]
    return {
        "unknowns": {"a": "angle"},
        "points": {"O": [0, 0], "A": ["3/5", "4/5"], **pins},
        "springs": [
            {"between": list(ends), "k": 1, "free": f"l/{2 + k}"}
            for k, ends in enumerate(pairwise(ends))
        ],
        "loads": {ends[0]: ["F", "G"]},
    }


def by_samples(
    frequencies: tuple[int, ...], force: float, up: float, free: float
) -> tuple[Index, float]:
    """Minima and smooth maxima of the energy on a fine grid, and how far from every crease its
    extremes are.
    """
    a = (np.arange(400000) + 0.37) * (2 * pi / 400000)
    pins = [np.exp(1j * n * a) for n in frequencies] + [np.full_like(a, 0.6 + 0.8j, dtype=complex)]
    energy = -force * pins[0].real - up * pins[0].imag
    short = np.full_like(a, 9.0)
    for k, (p, q) in enumerate(pairwise(pins)):
        energy = energy + (abs(p - q) - free / (2 + k)) ** 2 / 2
        short = np.minimum(short, abs(p - q))
    low = (energy < np.roll(energy, 1)) & (energy < np.roll(energy, -1))
    high = (energy > np.roll(energy, 1)) & (energy > np.roll(energy, -1))
    creases = high & (short < 1e-4)
    nearest = short[low | (high & ~creases)].min()
    return (int(low.sum()), int(high.sum() - creases.sum())), float(nearest)


@pytest.mark.slow
@settings(max_examples=examples(40), deadline=None)
@given(st.sampled_from([(1, 2), (1, 3), (2, 3), (1, -1), (1, -2), (3, 1)]), small, small, lengths)
def test_gears_have_the_equilibria_of_all_their_halves(
    frequencies: tuple[int, int], force: Fraction, up: Fraction, free: Fraction
) -> None:
    """Each spring alone has creases at other angles, some in half angles and some in whole ones."""
    count = counted(turning(*frequencies), F=force, G=up, l=free)
    assume(count.decided)
    true, nearest = by_samples(frequencies, float(force), float(up), float(free))
    assume(nearest > 1e-3)
    assert count.index == true


SPUN = {
    "unknowns": {"a": "angle", "b": "angle"},
    "points": {
        "O": [0, 0],
        "A": [1, 0],
        "P": ["cos(a)", "sin(a)"],
        "Q": ["cos(b)", "sin(b)"],
    },
    "springs": [
        {"between": ["P", "Q"], "k": 1, "free": "l"},
        {"between": ["A", "P"], "k": 1, "free": "1/3"},
        {"between": ["A", "Q"], "k": 2, "free": "1/4"},
    ],
    "loads": {"P": ["F", "G"], "Q": ["1/3", "-1/7"]},
}
"""Three springs of which each two fix the side of the third one."""


def test_creases_of_sums_of_one_another_have_two_branches() -> None:
    slice = ptmcad.slice_from_mapping(record(SPUN))
    found = branches(problem_of(slice), slice.axes)
    assert [len(b.inequalities) for b in found] == [3, 3]
    assert abs(np.linalg.det(np.array(found[0].covering))) == pytest.approx(4)
    assert found[0].where == (
        " with spring PQ forwards along its line and spring AP forwards along its line"
        " and spring AQ forwards along its line"
    )


def spun_by_newton(force: float, up: float, free: float) -> Index:
    """From many starts, with derivatives written out; of every equilibrium with springs that are
    long.
    """
    generator = np.random.default_rng(7)
    q = generator.uniform(-pi, pi, (2, 20000))
    ways = ((1, -1, 1.0, free), (1, None, 1.0, 1 / 3), (None, 1, 2.0, 0.25))

    def derivatives(a: Any, b: Any) -> tuple[Any, ...]:
        ga = force * np.sin(a) - up * np.cos(a)
        gb = np.sin(b) / 3 + np.cos(b) / 7
        haa, hab, hbb = force * np.cos(a) + up * np.sin(a), 0 * a, np.cos(b) / 3 - np.sin(b) / 7
        for first, second, k, rest in ways:
            x = (a if first else 0) - (b if second and first else 0) + (b if not first else 0)
            # of k (d - rest)^2/2 with d = 2 |sin(x/2)|
            slope = k * (np.sin(x) - rest * np.sign(np.sin(x / 2)) * np.cos(x / 2))
            bent = k * (np.cos(x) + rest / 2 * np.abs(np.sin(x / 2)))
            u, v = int(bool(first)), (-1 if first else 1) if second else 0
            ga, gb = ga + u * slope, gb + v * slope
            haa, hab, hbb = haa + u * u * bent, hab + u * v * bent, hbb + v * v * bent
        return ga, gb, haa, hab, hbb

    for _ in range(80):
        ga, gb, haa, hab, hbb = derivatives(*q)
        det = haa * hbb - hab * hab
        step = np.array([hbb * ga - hab * gb, haa * gb - hab * ga]) / np.where(det == 0, 1, det)
        q = q - step * np.minimum(1, 0.3 / np.maximum(np.hypot(*step), 1e-300))
    ga, gb, *_ = derivatives(*q)
    found: list[tuple[float, float]] = []
    index = [0, 0, 0]
    for a, b in q[:, np.hypot(ga, gb) < 1e-9].T:
        if all(hypot(sin((a - c) / 2), sin((b - d) / 2)) > 1e-4 for c, d in found):
            found.append((a, b))
            _, _, haa, hab, hbb = derivatives(a, b)
            index[int((np.linalg.eigvalsh([[haa, hab], [hab, hbb]]) < 0).sum())] += 1
    return tuple(index)


@pytest.mark.parametrize(
    "at", [("1/2", "1/5", "1"), ("-1/3", "3/4", "1/2"), ("3/2", "-1/4", "7/4"), ("1/9", "1/7", "2")]
)
@pytest.mark.slow_cases("at1", "at2", "at3")
def test_three_creases_agree_with_a_dense_search(at: tuple[str, str, str]) -> None:
    force, up, free = map(Fraction, at)
    count = counted(SPUN, F=force, G=up, l=free)
    assert count.decided
    assert count.index == spun_by_newton(*map(float, (force, up, free)))


ARM: dict[str, Any] = {
    "unknowns": {"a": "angle", "x": "length"},
    "points": {"O": [0, 0], "S": ["x*cos(a)", "x*sin(a)"]},
    "springs": [{"between": ["O", "S"], "k": 1, "free": "l"}],
    "loads": {"S": ["F", "G"]},
}
"""A slider with a spring along an arm that turns: as a point of the plane it has two places, half a
turn apart.
"""


@settings(max_examples=examples(40), deadline=None)
@given(st.sampled_from([("1", "0"), ("3/5", "4/5"), ("-5/13", "12/13")]), lengths, lengths)
def test_a_slider_on_a_turning_arm_has_the_equilibria_of_either_side(
    way: tuple[str, str], force: Fraction, free: Fraction
) -> None:
    """At l + F ahead of the force there is a minimum, and at l - F behind it, where that is
    positive, a saddle.

    Beyond, the energy's continuation has solutions at x = 0 itself, of which no ball tells that
    they are none.
    """
    assume(free > force)
    across, up = (force * Fraction(part) for part in way)
    count = counted(ARM, F=across, G=up, l=free)
    assert count.decided
    assert count.index == (2, 2, 0)


LOOP: dict[str, Any] = {
    "parameters": {"l": {"kind": "free length", "default": "1/2"}},
    "unknowns": {"th": "angle", "x": "length"},
    "points": {"O": [0, 0], "A": [0, 1], "P": ["cos(th)", "sin(th)"], "S": ["x", 0]},
    "bars": [["O", "P"]],
    "closing": [{"between": ["P", "S"], "length": 2}],
    "springs": [{"between": ["A", "P"], "k": 1, "free": "l"}],
    "loads": {"S": ["F", "G"]},
}
"""A slider-crank with a spring from its pin to a point of the pin's circle."""


@pytest.mark.parametrize("at", [("1/10", "1/2"), ("-2/5", "1/3"), ("1/7", "3/2"), ("2/5", "1/5")])
@pytest.mark.slow_cases("at1", "at2")
def test_a_loop_has_the_equilibria_of_the_half_angle(at: tuple[str, str]) -> None:
    force, free = map(Fraction, at)
    slice = ptmcad.slice_from_mapping(record(LOOP, "total", F=["-1/2", "1/2"], l=[0, 2]))
    counter = plain_counter(slice)
    found = counter.at(force, free, Count.TOTAL), counter.at(force, free, Count.STABLE)
    th = (np.arange(400000) + 0.37) * (2 * pi / 400000)
    total = stable = 0
    for sign in (1, -1):
        place = np.cos(th) + sign * np.sqrt(4 - np.sin(th) ** 2)
        extent = 2 * np.abs(np.sin(th / 2 - pi / 4))
        energy = (extent - float(free)) ** 2 / 2 - float(force) * place
        low = (energy < np.roll(energy, 1)) & (energy < np.roll(energy, -1))
        high = (energy > np.roll(energy, 1)) & (energy > np.roll(energy, -1)) & (extent > 1e-4)
        total += int(low.sum() + high.sum())
        stable += int(low.sum())
    assert (found[0].total, found[1].stable) == (total, stable)
    # each solution closes the loop: the angle is that of the mechanism, not its half
    for solution in found[0].solutions:
        angle, x = map(float, solution.center)
        assert hypot(cos(angle) - x, sin(angle)) == pytest.approx(2, abs=float(8 * solution.radius))


GEARED = {"G": ["cos(2*a + b)", "3 + sin(2*a + b)"], "C": [1, 3]}
"""A pin that a differential turns, and a point of its circle."""
FOUR_BARS: dict[str, Any] = {
    "unknowns": {"a": "angle", "b": "angle"},
    "points": {
        "O": [0, 0],
        "B": [2, 0],
        "P": ["cos(a)", "sin(a)"],
        "Q": ["cos(a) + cos(a + b)", "sin(a) + sin(a + b)"],
        **GEARED,
    },
    "closing": [{"between": ["Q", "B"], "length": "3/2"}],
    "springs": [{"between": ["G", "C"], "k": 1, "free": "l"}],
    "loads": {"P": ["F", "G"]},
}


def test_in_half_angles_a_loop_is_closed_by_equations_without_springs() -> None:
    slice = ptmcad.slice_from_mapping(record(FOUR_BARS, "total"))
    (branch,) = branches(problem_of(slice), slice.axes)
    assert branch.covering == ((1, 0), (-2, 2))
    closed, slope = branch.equations
    assert all(a.is_constant and b.is_constant for a, b in closed.terms.values())
    assert not all(a.is_constant and b.is_constant for a, b in slope.terms.values())


def test_a_solution_is_alone_in_the_cube_of_the_descriptions_angles() -> None:
    """Whatever is in it has unknowns of the problem in the cube in which those are the only ones."""
    points, spring = {**PAIR["points"], **GEARED}, {"between": ["G", "C"], "k": 1, "free": "l"}
    model = ptmcad.slice_from_mapping(record({**PAIR, "points": points, "springs": [spring]})).model
    values = {"l": Fraction(1), "F": Fraction(1, 2), "G": Fraction(0)}
    (counter,) = plain_counter(point_slice(model, values)).branches
    assert counter.problem.covering == ((1, 0), (-2, 2))
    origin = Fraction(0), Fraction(0)
    found = counter.at(*origin, Count.INDEX).solutions
    assert found
    for solution in found:
        cube, narrow = located(counter.problem, counter.equations, origin, solution, 128)
        for corner in product((-1, 1), repeat=2):
            a, b = (c + side * cube.radius for c, side in zip(cube.center, corner, strict=True))
            own = a, a + b / 2
            assert all(
                abs(u - c) <= solution.radius for u, c in zip(own, solution.center, strict=True)
            )
        assert all(
            abs(x - ball_of(c)) < ball_of(cube.radius)
            for x, c in zip(narrow[2:], cube.center, strict=True)
        )


def test_a_length_that_no_unknown_changes_has_no_sides() -> None:
    """From the middle of the circle, where a parameter puts it: the spring's line turns, but it is
    never short.
    """
    points = {**CRANK["points"], "B": ["r", 0]}
    springs = [*CRANK["springs"], {"between": ["P", "B"], "k": 1, "free": "l"}]
    middle = {
        **CRANK,
        "parameters": {"r": {"kind": "number", "default": 0}},
        "points": points,
        "springs": springs,
    }
    slice = ptmcad.slice_from_mapping(record(middle))
    assert [len(b.cones) for b in branches(problem_of(slice), slice.axes)] == [1]
    values = {"F": Fraction(1, 3), "l": Fraction(1)}
    assert counted(middle, **values).index == crank_by_hand(values["F"], values["l"])


@cache
def map_of(count: str) -> RegionMap:
    return certified_map(
        ptmcad.slice_from_mapping(record(CRANK, count)), Options(tolerance=Fraction(1, 100), jobs=1)
    )


@pytest.mark.parametrize("count", ["total", "index", "stable"])
@pytest.mark.slow_cases("total", "stable")
def test_a_map_has_the_area_below_a_line(count: str) -> None:
    """There are two minima where l < 2 (1 + F): 5 of the window's 8, and one in the rest."""
    found = map_of(count)
    assert found.undetermined < Fraction(1, 100)
    two = [r for r in found.regions if r.stable == 2]
    assert {(r.stable, r.total) for r in found.regions} == {
        "total": {(2, 3), (1, 1)},
        "index": {(2, 3), (1, 1)},
        "stable": {(2, None), (1, None)},
    }[count]
    assert sum(float(r.area[0]) for r in two) <= 5 <= sum(float(r.area[1]) for r in two)


def test_a_map_tells_whether_the_spring_pulls() -> None:
    """At the two minima it does where F < 0; beyond the line there is one, at th = pi, where it
    does, as l < 2.
    """
    found = map_of("admissible")
    assert found.undetermined < Fraction(1, 100)
    areas = {(2, 2): 1, (2, 0): 4, (1, 1): 3}
    assert {(r.stable, r.admissible) for r in found.regions} == areas.keys()
    for (stable, admissible), area in areas.items():
        (region,) = (r for r in found.regions if (r.stable, r.admissible) == (stable, admissible))
        assert region.area[0] <= area <= region.area[1]


def random_points(number: int) -> Iterator[tuple[Fraction, Fraction]]:
    generator = np.random.default_rng(11)
    for u, v in generator.integers(1, 10**4, (number, 2)):
        yield Fraction(4 * int(u), 10**4) - 2, Fraction(2 * int(v), 10**4)


def wrong(found: RegionMap, true: Callable[[Fraction, Fraction], Index]) -> int:
    """Of 200 random points out of the cover those of which the map says another count."""
    cells = [(found.locate(F=x, l=y).cell, true(x, y)) for x, y in random_points(200)]
    assert sum(cell is not None for cell, _ in cells) > 150
    return sum(found.cells[cell].index != index for cell, index in cells if cell is not None)


def test_a_map_of_a_crank_is_true_at_random_points() -> None:
    assert wrong(map_of("index"), crank_by_hand) == 0


@pytest.mark.slow
def test_a_map_of_two_cranks_is_true_at_random_points() -> None:
    slice = ptmcad.slice_from_mapping(record(PAIR, F=["1/4", 2], l=[0, 2]))
    found = certified_map(slice, Options(tolerance=Fraction(1, 100), jobs=1))
    assert found.undetermined < Fraction(1, 100)
    for x, y in random_points(200):
        force = (x + 2) * Fraction(7, 16) + Fraction(1, 4)
        cell = found.locate(F=force, l=y).cell
        if cell is not None:
            assert pair_by_hand(float(force), float(y)) in ((), found.cells[cell].index)


def test_solve_has_the_angles_themselves() -> None:
    """At l = 1 the sine of the half angle is 1/2, or the angle is half a turn."""
    poses = ptmcad.solve(record(CRANK), F=0, l=1)
    assert poses.status is Status.CERTIFIED
    said = {(p.index, p.degrees[0].text(8)) for p in poses.equilibria}
    assert said == {(0, "60.000000"), (0, "-60.000000"), (1, "180")}
    pair = ptmcad.solve(record(PAIR), F="1/2", l=1)
    assert pair.status is Status.CERTIFIED
    assert tuple(sum(p.index == k for p in pair.equilibria) for k in range(3)) == pair_by_hand(
        0.5, 1.0
    )


def test_a_direction_may_depend_on_the_axes() -> None:
    """The spring's end in the direction of a rational angle, or of one by the tangent of its half:
    the crank turned.
    """
    way = {"c": {"kind": "number", "default": 1}, "s": {"kind": "number", "default": 0}}
    loads = {"P": ["F*c - G*s", "F*s + G*c"]}
    turned = {
        **CRANK,
        "parameters": way,
        "points": {**CRANK["points"], "A": ["c", "s"]},
        "loads": loads,
    }
    values = {"F": Fraction(1, 3), "l": Fraction(3, 4)}
    there = counted(turned, c=Fraction(-7, 25), s=Fraction(24, 25), **values)
    assert there.decided
    assert there.index == crank_by_hand(values["F"], values["l"])
    moved = record(turned, F=[-2, 2], t=[-2, 2])
    slice = ptmcad.slice_from_mapping(
        {**moved, "parameters": {"c": "(1 - t^2)/(1 + t^2)", "s": "2*t/(1 + t^2)"}}
    )
    (branch,) = branches(problem_of(slice), slice.axes)
    assert not branch.cones
    for x, y in (("1/2", "3/2"), ("-4/3", "1/7"), ("-2/3", "-3/2")):
        assert plain_counter(slice).at(
            Fraction(x), Fraction(y), Count.INDEX
        ).index == crank_by_hand(Fraction(x), Fraction(1))


def test_without_lines_that_turn_nothing_is_decided(monkeypatch: pytest.MonkeyPatch) -> None:
    """If such a spring may have any direction where it is short, its crease is as good as a
    solution.
    """
    at = {"F": Fraction(1, 3), "l": Fraction(1, 2)}
    assert counted(CRANK, **at).decided
    monkeypatch.setattr(plain_points, "branches", lambda problem, _: (problem,))
    assert not counted(CRANK, **at).decided


def test_on_both_sides_every_equilibrium_is_there_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    """Over two turns of the angle one side is all: the other one has the same configurations again."""
    in_half_angles = straight._in_half_angles
    monkeypatch.setattr(
        straight, "_in_half_angles", lambda *given: (in_half_angles(*given)[0], set())
    )
    assert counted(CRANK, F=Fraction(1, 3), l=Fraction(1, 2)).total == 6


def test_without_the_side_as_a_condition_counts_are_false(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where s = l/(2 (1 + F)) is greater than 1, but less than -1 or negative, too, is no
    equilibrium of the crank.
    """

    def unconditional(problem: Any, axes: Any) -> Any:
        return tuple(
            replace(branch, inequalities=(), where="") for branch in branches(problem, axes)
        )

    at = {"F": Fraction(1, 3), "l": Fraction(1, 2)}
    monkeypatch.setattr(plain_points, "branches", unconditional)
    assert counted(CRANK, **at).total == 4


def test_without_the_crease_among_the_curves_a_map_is_false(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where |G| = l an equilibrium is swallowed at the crease: without that curve a cell has points
    of both kinds.
    """
    slice = ptmcad.slice_from_mapping(record(CRANK, G=[-1, 1], l=["1/10", 1]))

    def cells() -> int:
        return len(certified_map(slice, Options(tolerance=Fraction(1, 50), jobs=1)).cells)

    counts = [
        plain_counter(slice).at(Fraction(g), Fraction(1, 4), Count.INDEX).index
        for g in ("1/5", "1/3")
    ]
    assert counts == [(2, 1), (1, 1)]
    before = cells()
    monkeypatch.setattr(plain_curves, "_boundaries", lambda *_: iter(()))
    assert cells() < before


def test_half_of_a_direction_that_winds_is_none() -> None:
    """Around the origin half the angle of the square of x + iy turns by half a turn: there the
    spring stays a cone.
    """
    way = {name: {"kind": "number"} for name in ("c", "s", "r")}
    points = {"O": [0, 0], "A": ["c", "s"], "P": ["r*cos(th)", "r*sin(th)"]}
    winding = record({**CRANK, "parameters": way, "points": points}, x=[-1, 1], y=[-1, 1])
    given = {**winding, "parameters": {"c": "x^2 - y^2", "s": "2*x*y", "r": "x^2 + y^2"}}

    def cones(**axes: list[Any]) -> int:
        slice = ptmcad.slice_from_mapping({**given, "axes": axes})
        return sum(len(branch.cones) for branch in branches(problem_of(slice), slice.axes))

    assert cones(x=[-1, 1], y=[-1, 1]) == 1
    assert cones(x=["1/4", 1], y=[-1, 1]) == 0
