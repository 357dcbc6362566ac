"""Springs on one line each (Lemma S6): counts against every side solved by itself, maps against
known areas.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from itertools import product
from math import sqrt
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import assume, given, settings
from hypothesis import strategies as st

pytest.importorskip("numba")

from support.examples import examples
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.certified.engine import certified_map
from ptmcad.certified.plain import criticalcurves as plain_curves
from ptmcad.certified.plain import pointcounts as plain_points
from ptmcad.certified.plain.certifiedposes import point_slice
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.plain.straight import branches
from ptmcad.options import Options
from ptmcad.question.slice import Count, Slice

GUIDES = {"1, 0": 1.0, "3/5, 4/5": 1.0, "1, 1": sqrt(2)}
"""A slider's place over its unknown, and how long that vector is."""


def sliding(guide: str, count: str = "index", **axes: list[Any]) -> dict[str, Any]:
    """A slider with two springs to points of its guide."""
    ex, ey = guide.split(", ")
    return {
        "name": "sliding",
        "mechanism": {
            "name": "sliding",
            "parameters": {
                "l": {"kind": "free length", "default": 1},
                "m": {"kind": "free length", "default": 0},
                "K": {"kind": "stiffness", "default": 2},
                "a": {"kind": "number", "default": "1/2"},
                "F": {"kind": "force", "default": 0},
            },
            "unknowns": {"x": "length"},
            "points": {"O": [0, 0], "S": [f"{ex}*x", f"{ey}*x"], "A": [f"{ex}*a", f"{ey}*a"]},
            "springs": [
                {"between": ["O", "S"], "k": 1, "free": "l"},
                {"between": ["A", "S"], "k": "K", "free": "m"},
            ],
            "loads": {"S": [f"{ex}*F", f"{ey}*F"]},
        },
        "axes": axes or {"F": [-1, 1], "a": [0, 1]},
        "count": count,
    }


YOKE: dict[str, Any] = yaml.safe_load("""
name: yoke
mechanism:
  name: yoke
  parameters:
    a: {kind: number, default: 1/4}
    l: {kind: free length, default: 1/2}
    F: {kind: force}
    G: {kind: force, default: 1/10}
  unknowns: {th: angle}
  points: {O: [0, 0], P: [cos(th), sin(th)], A: [a, 0], S: [cos(th), 0]}
  bars: [[O, P]]
  springs: [{between: [A, S], k: 1, free: l}]
  loads: {P: [F, G]}
axes: {F: [-1, 1], a: [-1, 1]}
count: index
""")
"""The crank of a Scotch yoke: a pin in an upright slot, whose slider a spring pulls along its
guide.
"""


def counted(record: dict[str, Any], **values: Fraction) -> Any:
    model = ptmcad.slice_from_mapping(record).model
    defaults = {
        name: Fraction(p.default) for name, p in model.parameters.items() if p.default is not None
    }
    return plain_counter(point_slice(model, defaults | values)).at(
        Fraction(0), Fraction(0), Count.INDEX
    )


small = st.fractions(min_value=-2, max_value=2, max_denominator=8)
lengths = st.fractions(min_value=Fraction(1, 8), max_value=2, max_denominator=8)


@settings(max_examples=examples(40), deadline=None)
@given(st.sampled_from(sorted(GUIDES)), lengths, lengths, lengths, small, small)
def test_a_slider_has_the_equilibria_of_every_side(
    guide: str, free: Fraction, other: Fraction, stiff: Fraction, a: Fraction, force: Fraction
) -> None:
    """On each side of both kinks forces are linear, k (s - l) + K (s - a - m) = F, and s has to be
    on these sides.
    """
    norm, found = GUIDES[guide], 0
    assume(a)
    for one, two in product((1, -1), repeat=2):
        s = (
            float(force)
            + one * float(free) / norm
            + float(stiff) * (float(a) + two * float(other) / norm)
        ) / (1 + float(stiff))
        sides = one * s, two * (s - float(a))
        assume(all(abs(side) > 1e-6 for side in sides))
        found += min(sides) > 0
    count = counted(sliding(guide), l=free, m=other, K=stiff, a=a, F=force)
    assert count.decided
    assert count.index == (found, 0)
    boxes = [(s.center[0] - s.radius, s.center[0] + s.radius) for s in count.solutions]
    assert all(high < 0 or low > 0 for low, high in boxes)
    assert all(high < a or low > a for low, high in boxes)


def test_smoothing_has_the_peak_at_the_kink_as_one_more() -> None:
    """With sqrt(s^2 + eps) for |s| equilibria are those that are counted and, where the kink
    outweighs, its peak.
    """
    x = np.linspace(-4, 4, 800001)
    for force, free in product((-1.3, -0.7, 0.2, 0.9), (0.5, 1.0)):
        slope = x - free * x / np.sqrt(x * x + 1e-8) - force
        smooth = int(np.count_nonzero(np.sign(slope[1:]) != np.sign(slope[:-1])))
        values = {
            "l": Fraction(free),
            "F": Fraction(force),
            "K": Fraction(1, 10**9),
            "m": Fraction(0),
        }
        assert counted(sliding("1, 0"), **values).total + (abs(force) < free) == smooth


@cache
def map_of(guide: str, count: str) -> RegionMap:
    slice = ptmcad.slice_from_mapping(sliding(guide, count, F=["-3/2", "3/2"], l=[0, 1]))
    alone = replace(
        slice, parameters={**slice.parameters, "K": slice.parameters["K"] * 0 + Fraction(1, 10**6)}
    )
    return certified_map(alone, Options(tolerance=Fraction(1, 50), jobs=1))


@pytest.mark.parametrize("count", ["total", "index", "stable"])
@pytest.mark.parametrize("guide", list(GUIDES))
@pytest.mark.fast_cases("1, 0-index", "3/5, 4/5-total", "3/5, 4/5-stable", "1, 1-total")
def test_a_map_has_the_area_between_two_lines(guide: str, count: str) -> None:
    """There are two equilibria where |F| |e| < l, up to what a spring of 1e-6 does."""
    areas = map_of(guide, count).regions
    two = [r for r in areas if 2 in (r.total, r.stable)]
    true = 1 / GUIDES[guide]
    assert (
        sum(float(r.area[0]) for r in two) - 1e-4
        <= true
        <= sum(float(r.area[1]) for r in two) + 1e-4
    )
    assert map_of(guide, count).undetermined < Fraction(1, 50)


def test_without_sides_nothing_is_decided(monkeypatch: pytest.MonkeyPatch) -> None:
    """If a spring on a line may have any direction, as others may, its solutions are not told
    apart.
    """
    assert counted(YOKE, F=Fraction(1, 5)).decided
    monkeypatch.setattr(plain_points, "branches", lambda problem, _: (problem,))
    assert not counted(YOKE, F=Fraction(1, 5)).decided


def test_without_the_kinks_a_map_is_false(monkeypatch: pytest.MonkeyPatch) -> None:
    """The lemma's boundaries s = 0 are needed: without them one cell has points with one and with
    two equilibria.
    """
    monkeypatch.setattr(plain_curves, "_boundaries", lambda *_: iter(()))
    slice = ptmcad.slice_from_mapping(sliding("1, 0", "total", F=["-3/2", "3/2"], l=[0, 1]))
    assert len(certified_map(slice, Options(tolerance=Fraction(1, 50), jobs=1)).regions) == 1


def test_without_the_sides_as_conditions_counts_are_false(monkeypatch: pytest.MonkeyPatch) -> None:
    """An equilibrium of the energy continued across the kink is none of the mechanism."""

    def unconditional(problem: Any, axes: Any) -> Any:
        return tuple(
            replace(branch, inequalities=(), where="") for branch in branches(problem, axes)
        )

    values = {"F": Fraction(3), "a": Fraction(1, 3), "m": Fraction(1, 4)}
    assert counted(sliding("1, 0"), **values).total == 1
    monkeypatch.setattr(plain_points, "branches", unconditional)
    assert counted(sliding("1, 0"), **values).total == 4


def lines(slice: Slice) -> int:
    return len(branches(problem_of(slice), slice.axes))


def test_a_line_needs_a_direction_everywhere() -> None:
    """Where e is zero the spring has no length in any configuration, and there are no equilibria by
    definition.
    """
    record = sliding("c, s", F=[-1, 1], t=[-1, 1])
    mechanism = record["mechanism"]
    mechanism["parameters"] |= {"c": {"kind": "number"}, "s": {"kind": "number"}}
    turned = {**record, "parameters": {"c": "(1 - t^2)/(1 + t^2)", "s": "2*t/(1 + t^2)", "m": 1}}
    assert lines(ptmcad.slice_from_mapping(turned)) == 4
    vanishing = {
        **record,
        "axes": {"t": [-1, 1], "F": [-1, 1]},
        "parameters": {"c": "t", "s": "F", "m": 1},
    }
    assert lines(ptmcad.slice_from_mapping(vanishing)) == 1
    away = {**vanishing, "axes": {"t": ["1/2", 1], "F": [-1, 1]}}
    assert lines(ptmcad.slice_from_mapping(away)) == 4


def test_equal_maps_whatever_the_guide() -> None:
    """A slanted guide is the mechanism turned, whether its direction is a number or a parameter."""
    at = {
        "l": Fraction(1),
        "m": Fraction(1, 2),
        "K": Fraction(2),
        "a": Fraction(1, 2),
        "F": Fraction(1, 4),
    }
    straight, slanted = (counted(sliding(guide), **at) for guide in ("1, 0", "3/5, 4/5"))
    assert straight.index == slanted.index


LOOP: dict[str, Any] = yaml.safe_load("""
name: crank
mechanism:
  name: crank
  parameters: {l: {kind: free length, default: 1/2}, F: {kind: force}, G: {kind: force}}
  unknowns: {th: angle, x: length}
  points: {O: [0, 0], P: [cos(th), sin(th)], S: [x, 0], A: [2, 0]}
  bars: [[O, P]]
  closing: [{between: [P, S], length: 2}]
  springs: [{between: [A, S], k: 1, free: l}]
  loads: {P: [F, G]}
axes: {F: [-1/2, 1/2], G: [-1/2, 1/2]}
count: total
""")
"""A slider-crank whose slider has a spring along its guide that can get short."""


@pytest.mark.parametrize(("force", "up", "known"), [("1/10", "1/5", (8, 5)), ("0", "9/20", (4, 3))])
def test_a_loop_has_the_equilibria_of_every_side(
    force: str, up: str, known: tuple[int, int]
) -> None:
    """REFERENCE: the energy at 400000 crank angles, on both ways of assembling the loop; all and
    stable ones.
    """
    counter = plain_counter(ptmcad.slice_from_mapping(LOOP))
    at = Fraction(force), Fraction(up)
    total, stable = (counter.at(*at, count) for count in (Count.TOTAL, Count.STABLE))
    assert (total.total, stable.stable) == known


PAIR: dict[str, Any] = yaml.safe_load("""
name: pair
mechanism:
  name: pair
  parameters:
    m: {kind: free length, default: 1/2}
    F: {kind: force}
    G: {kind: force, default: 1/3}
  unknowns: {x: length, y: length}
  points: {O: [0, 0], S: [x, 0], T: [y, 0]}
  springs: [{between: [O, S], k: 1, free: 1}, {between: [S, T], k: 2, free: m}]
  loads: {S: [F, 0], T: [G, 0]}
axes: {F: [-1, 1], m: [0, 1]}
count: index
""")
"""Two sliders on one guide: a spring holds the first one, and another spring the second one by the
first.
"""


@pytest.mark.parametrize(
    ("force", "free"), [("1/10", "1/2"), ("-5/4", "1/2"), ("1/10", "1/7"), ("3/2", "1/10")]
)
@pytest.mark.slow_cases("1/10-1/2", "-5/4-1/2")
def test_two_sliders_have_the_equilibria_of_every_side(force: str, free: str) -> None:
    """x = F + G + p and y - x = G/2 + q m on the sides p, q, exactly."""
    f, m, g = Fraction(force), Fraction(free), Fraction(1, 3)
    true = sum(
        p * (f + g + p) > 0 and q * (g / 2 + q * m) > 0 for p, q in product((1, -1), repeat=2)
    )
    assert counted(PAIR, F=f, m=m, G=g).index == (true, 0, 0)
