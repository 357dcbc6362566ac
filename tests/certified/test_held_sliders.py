"""Sliders that springs alone hold, on guides in any direction: bounds and counts against a search
of the test's own.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from math import inf
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from support.examples import examples
from support.held_sliders import PAIR, SLANTED, pairs
from support.multistart import Found, Model, model_of, solutions

pytest.importorskip("numba")

import ptmcad
from ptmcad.certified.plain import unknownranges as bounds
from ptmcad.certified.plain.certifiedposes import point_slice
from ptmcad.certified.plain.harmonics import TrigonometricPolynomial
from ptmcad.certified.plain.problem import Problem, problem_of
from ptmcad.certified.plain.straight import branches
from ptmcad.certified.plain.unknownranges import known_ranges
from ptmcad.errors import ConfigError
from ptmcad.question.slice import Slice

TURNED: dict[str, Any] = yaml.safe_load("""
name: turned
mechanism:
  name: turned
  parameters: {F: {kind: force}, l: {kind: free length}}
  unknowns: {t: angle, x: length, y: length}
  points: {S: [x*cos(t) - sin(t), x*sin(t) + cos(t)], T: [2 + y, y/2], A: [1, -1/2], B: [3, 1]}
  springs:
    - {between: [A, S], k: 1, free: l}
    - {between: [B, T], k: 1, free: 1}
    - {between: [S, T], k: 5, free: 1/2}
  loads: {S: [F, 1/5]}
axes: {F: [-1, 1], l: [1/2, 2]}
count: index
""")
"""One of two guides turns."""
THREE: dict[str, Any] = yaml.safe_load("""
name: three
mechanism:
  name: three
  parameters: {F: {kind: force}, l: {kind: free length}}
  unknowns: {x: length, y: length, z: length}
  points: {P: [x, x/3], Q: [2*y-1, y], R: [z, 1+z/5], A: [1, -1/2]}
  springs:
    - {between: [A, P], k: 1, free: l}
    - {between: [P, Q], k: 20, free: 1}
    - {between: [Q, R], k: 30, free: 1}
    - {between: [R, P], k: 10, free: l}
  loads: {P: [F, 1/5]}
axes: {F: [-1, 1], l: [1/2, 2]}
count: index
""")
"""Three sliders, of which only one is held by a spring from the base."""


@cache
def searched(name: str) -> Model:
    return model_of({"pair": PAIR, "turned": TURNED, "three": THREE, "slanted": SLANTED}[name])


def slice_at(record: dict[str, Any], values: dict[str, Fraction]) -> Slice:
    return point_slice(ptmcad.slice_from_mapping(record).model, values)


def problems(slice: Slice) -> tuple[Problem, ...]:
    return branches(problem_of(slice), slice.axes)


def hull(slice: Slice) -> list[tuple[float, float]]:
    """The ranges of all branches in one."""
    found = [known_ranges(problem, slice.axes) for problem in problems(slice)]
    return [
        (min(low for low, _ in ends), max(high for _, high in ends))
        for ends in zip(*found, strict=True)
    ]


def within(found: Found, ranges: list[tuple[float, float]], reals: list[int]) -> bool:
    return all(ranges[k][0] <= found.at[k] <= ranges[k][1] for k in reals)


def index(found: list[Found], unknowns: int) -> tuple[int, ...]:
    return tuple(sum(f.negative == k for f in found) for k in range(unknowns + 1))


def agrees(values: dict[str, Fraction], counted: Sequence[int]) -> bool:
    """Whether counts are those of the search, which goes on while it knows of fewer: peaks are
    reached from nearby.
    """
    found: list[Found] = []
    for starts, span in ((400, inf), (4_000, 3.0), (40_000, 3.0), (400_000, 1.0)):
        found = solutions(searched("pair"), values, starts, starts, span)
        if len(found) >= sum(counted):
            break
    return index(found, 2) == tuple(counted)


@settings(max_examples=examples(12), deadline=None)
@given(pairs())
def test_no_equilibrium_is_beyond_the_bounds(values: dict[str, Fraction]) -> None:
    ranges = hull(slice_at(PAIR, values))
    assert all(-1e4 < low <= high < 1e4 for low, high in ranges)
    for found in solutions(searched("pair"), values, 100, seed=1):
        assert within(found, ranges, [0, 1])


@pytest.mark.slow
def test_a_map_at_irrational_guides_has_the_counts_of_a_search() -> None:
    """Guides along (1, 2) and (3, 1): neither vector has a rational length."""
    result = ptmcad.classify(PAIR, tolerance="1/20", jobs=1)
    assert result.undetermined < 0.05
    fixed = {name: Fraction(value) for name, value in PAIR["parameters"].items()}
    seen = set()
    for force, free in (
        (Fraction(u, 9), Fraction(v, 11)) for u in (-17, -4, 5, 16) for v in (2, 9, 15, 21)
    ):
        there = result.locate(F=force, l=free)
        if there.index is not None:
            assert agrees(fixed | {"F": force, "l": free}, there.index)
            seen.add(there.index)
    assert len(seen) > 2


@pytest.mark.parametrize(
    ("record", "reals"), [(TURNED, [1, 2]), (THREE, [0, 1, 2])], ids=["turned", "three"]
)
@pytest.mark.slow
def test_bounds_with_a_guide_that_turns_and_of_three_sliders(
    record: dict[str, Any], reals: list[int]
) -> None:
    ranges = hull(ptmcad.slice_from_mapping(record))
    assert all(-100 < low <= high < 100 for low, high in ranges)
    for force, free in (
        (Fraction(1), Fraction(2)),
        (Fraction(-1), Fraction(1, 2)),
        (Fraction(0), Fraction(7, 5)),
    ):
        found = solutions(searched(record["name"]), {"F": force, "l": free}, 30, seed=2)
        assert found
        assert all(within(f, ranges, reals) for f in found)


FAR = {"a": Fraction(1, 1000), "F": Fraction(3, 2)}
"""Where the guides of two sliders without a hold are nearly parallel."""


def test_a_window_over_parallel_guides_has_no_bound() -> None:
    """The guides are parallel at a = 0, where no equilibrium is, and as near as one likes to it
    they are far away.
    """
    whole = ptmcad.slice_from_mapping(SLANTED)
    assert not all(abs(end) < 1e30 for ends in hull(whole) for end in ends)
    with pytest.raises(ConfigError, match="no bound of the unknowns x, y"):
        ptmcad.classify(SLANTED, tolerance="1/10", jobs=1)
    (found,) = solutions(searched("slanted"), FAR, 4000, seed=3)
    assert abs(found.at[0]) > 500
    assert within(found, hull(slice_at(SLANTED, FAR)), [0, 1])


def test_without_regularity_all_over_the_window_a_bound_is_false(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With the determinant at one point in the place of the whole window equilibria are beyond."""
    empty = bounds.is_empty

    def at_the_middle(tape: Any, box: Any, *more: Any) -> bool:
        narrow = box.copy()
        narrow[:2] = narrow[:2].mean(axis=1)[:, None]
        return empty(tape, narrow, *more)

    monkeypatch.setattr(bounds, "is_empty", at_the_middle)
    (found,) = solutions(searched("slanted"), FAR, 4000, seed=3)
    assert not within(found, hull(ptmcad.slice_from_mapping(SLANTED)), [0, 1])


@pytest.mark.parametrize("way", ["without the springs", "without the loads"])
@pytest.mark.slow_cases("without the springs")
def test_without_what_pulls_a_bound_is_false(way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The reach of springs with free lengths, and forces, count."""
    fixed = {name: Fraction(value) for name, value in PAIR["parameters"].items()} | {
        "l": Fraction(1)
    }
    free = Fraction(50) if way == "without the springs" else Fraction(1)
    force = Fraction(90) if way == "without the loads" else Fraction(0)
    slice = slice_at(PAIR, fixed | {"l": free, "r": free, "F": force})
    found = solutions(searched("pair"), fixed | {"l": free, "r": free, "F": force}, 800, seed=4)
    assert all(within(f, hull(slice), [0, 1]) for f in found)
    if way == "without the springs":
        monkeypatch.setattr(bounds, "length", lambda x, _: x.graph.constant(0))
    else:
        whole = bounds.scaled_together

        def less(polynomials: Any, weights: Any) -> Any:
            rest, *others = whole(polynomials, weights)
            return [
                TrigonometricPolynomial({k: c for k, c in rest.terms.items() if not k[1][-1]}),
                *others,
            ]

        monkeypatch.setattr(bounds, "scaled_together", less)
    assert not all(within(f, hull(slice), [0, 1]) for f in found)
