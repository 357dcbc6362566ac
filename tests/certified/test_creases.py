"""Springs between two points of a circle, and along lines that turn (Lemma S10): counts and maps
against known ones.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from itertools import product
from math import cos, hypot, sin
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import assume, given, settings
from hypothesis import strategies as st

pytest.importorskip("numba")

from support.examples import examples
from support.places import random_points
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.certified.engine import certified_map
from ptmcad.certified.plain import criticalcurves as plain_curves
from ptmcad.certified.plain import pointcounts as plain_points
from ptmcad.certified.plain import straight
from ptmcad.certified.plain.certifiedposes import point_slice
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.plain.straight import branches
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


CRANK: dict[str, Any] = yaml.safe_load("""
unknowns: {th: angle}
points: {O: [0, 0], A: [1, 0], P: [cos(th), sin(th)]}
bars: [[O, P]]
springs: [{between: [A, P], k: 1, free: l}]
loads: {P: [F, G]}
""")
"""With t = th/2 and s = sin t the energy is 2 s^2 - 2 l s - F (1 - 2 s^2) - G sin 2t, up to a
constant.
"""
PAIR: dict[str, Any] = yaml.safe_load("""
unknowns: {a: angle, b: angle}
points: {O: [0, 0], P: [cos(a), sin(a)], Q: [cos(b), sin(b)]}
springs: [{between: [P, Q], k: 1, free: l}]
loads: {P: [F, G], Q: [F, G]}
""")
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


SPUN = yaml.safe_load("""
unknowns: {a: angle, b: angle}
points: {O: [0, 0], A: [1, 0], P: [cos(a), sin(a)], Q: [cos(b), sin(b)]}
springs:
  - {between: [P, Q], k: 1, free: l}
  - {between: [A, P], k: 1, free: 1/3}
  - {between: [A, Q], k: 2, free: 1/4}
loads: {P: [F, G], Q: [1/3, -1/7]}
""")
"""Three springs of which each two fix the side of the third one."""


def test_creases_of_sums_of_one_another_have_two_branches() -> None:
    slice = ptmcad.slice_from_mapping(record(SPUN))
    found = branches(problem_of(slice), slice.axes)
    assert [len(b.inequalities) for b in found] == [3, 3]
    assert abs(np.linalg.det(np.array(found[0].rows))) == pytest.approx(4)
    assert found[0].where == (
        " with spring PQ forwards along its line and spring AP forwards along its line"
        " and spring AQ forwards along its line"
    )


def test_three_creases_have_the_equilibria_of_a_dense_search() -> None:
    """REFERENCE: Newton's method from 20000 starts, with derivatives written out."""
    count = counted(SPUN, F=Fraction(1, 2), G=Fraction(1, 5), l=Fraction(1))
    assert count.decided
    assert count.index == (3, 4, 0)


ARM: dict[str, Any] = yaml.safe_load("""
unknowns: {a: angle, x: length}
points: {O: [0, 0], S: [x*cos(a), x*sin(a)]}
springs: [{between: [O, S], k: 1, free: l}]
loads: {S: [F, G]}
""")
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


LOOP: dict[str, Any] = yaml.safe_load("""
parameters: {l: {kind: free length, default: 1/2}}
unknowns: {th: angle, x: length}
points: {O: [0, 0], A: [0, 1], P: [cos(th), sin(th)], S: [x, 0]}
bars: [[O, P]]
closing: [{between: [P, S], length: 2}]
springs: [{between: [A, P], k: 1, free: l}]
loads: {S: [F, G]}
""")
"""A slider-crank with a spring from its pin to a point of the pin's circle."""


@pytest.mark.parametrize(
    ("force", "free", "known"), [("1/10", "1/2", (6, 4)), ("2/5", "1/5", (4, 2))]
)
def test_a_loop_has_the_equilibria_of_the_half_angle(
    force: str, free: str, known: tuple[int, int]
) -> None:
    """REFERENCE: the energy at 400000 crank angles, on both ways of assembling the loop; all and
    stable ones.
    """
    at = Fraction(force), Fraction(free)
    slice = ptmcad.slice_from_mapping(record(LOOP, "total", F=["-1/2", "1/2"], l=[0, 2]))
    counter = plain_counter(slice)
    found = counter.at(*at, Count.TOTAL), counter.at(*at, Count.STABLE)
    assert (found[0].total, found[1].stable) == known
    # each solution closes the loop: the angle is that of the mechanism, not its half
    for solution in found[0].solutions:
        angle, x = map(float, solution.center)
        assert hypot(cos(angle) - x, sin(angle)) == pytest.approx(2, abs=float(8 * solution.radius))


GEARED = {"G": ["cos(2*a + b)", "3 + sin(2*a + b)"], "C": [1, 3]}
"""A pin that a differential turns, and a point of its circle."""


def test_a_solution_is_alone_in_the_cube_of_the_descriptions_angles() -> None:
    """Whatever is in it has unknowns of the problem in the cube in which those are the only ones."""
    points, spring = {**PAIR["points"], **GEARED}, {"between": ["G", "C"], "k": 1, "free": "l"}
    model = ptmcad.slice_from_mapping(record({**PAIR, "points": points, "springs": [spring]})).model
    values = {"l": Fraction(1), "F": Fraction(1, 2), "G": Fraction(0)}
    (counter,) = plain_counter(point_slice(model, values)).branches
    assert counter.problem.rows == ((1, 0), (-2, 2))
    origin = Fraction(0), Fraction(0)
    found = counter.at(*origin, Count.INDEX).solutions
    assert found
    for solution in found:
        cube, narrow = counter.search.located(*origin, solution, 128)
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


def wrong(found: RegionMap, true: Callable[[Fraction, Fraction], Index]) -> int:
    """Of 200 random points out of the cover those of which the map says another count."""
    cells = [
        (found.locate(F=x, l=y).cell, true(x, y)) for x, y in random_points(found.slice, 200, 11)
    ]
    assert sum(cell is not None for cell, _ in cells) > 150
    return sum(found.cells[cell].index != index for cell, index in cells if cell is not None)


def test_a_map_of_a_crank_is_true_at_random_points() -> None:
    assert wrong(map_of("index"), crank_by_hand) == 0


def test_solve_has_the_angles_themselves() -> None:
    """At l = 1 the sine of the half angle is 1/2, or the angle is half a turn."""
    poses = ptmcad.solve(record(CRANK), F=0, l=1)
    assert poses.status is Status.CERTIFIED
    said = {(p.index, p.degrees[0].text(8)) for p in poses.equilibria}
    assert said == {(0, "60.000000"), (0, "-60.000000"), (1, "180")}
    pair = ptmcad.solve(record(PAIR), F="1/2", l=1)
    assert pair.status is Status.CERTIFIED
    # with a = s + f, b = s - f the energy is 2 sin^2 f - 2 |sin f| - cos f cos s: sin s or cos f is 0
    assert [sum(p.index == k for p in pair.equilibria) for k in range(3)] == [2, 2, 0]


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
