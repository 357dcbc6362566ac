"""Solutions that an inequality excludes, and conditions that are zero at every solution: map,
points, checker.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest
import yaml
from flint import fmpq
from support.signatures import signature

import ptmcad
from ptmcad.algebra.fibre_algebra import evaluate, hermite_matrix
from ptmcad.answer.regionmap import Status
from ptmcad.ask.checking import check
from ptmcad.errors import ConfigError, NothingToCountError
from ptmcad.exact.point_system import point_system, solutions_at
from ptmcad.exact.stages import problem_of
from ptmcad.question.config import slice_from
from ptmcad.question.slice import Slice
from ptmcad.verification import verify

LINE = {"unknowns": {"x": "real", "y": "real"}}
WINDOW = {"a": [-3, 3], "b": [-2, 2]}
# on x = 0 there are infinitely many solutions
CONTINUUM = {
    "system": {**LINE, "equations": ["x*(x + y - a)", "x*(x*y - b)"], "positive": ["x"]},
    "axes": WINDOW,
}
# x = 0 is a double root everywhere
DOUBLE = {
    "system": {**LINE, "equations": ["x^2*(x^2 - a*x + b)", "y^2 - x - 1"], "positive": ["x"]},
    "axes": WINDOW,
}


def roots(a: Fraction, b: Fraction) -> int:
    """The number of positive roots of x^2 - a x + b."""
    if a * a < 4 * b:
        return 0
    return 1 if b < 0 else 2 if a > 0 else 0


POINTS = [(Fraction(1392, 625), Fraction(1003, 1250)), (Fraction(459, 2500), Fraction(-632, 625)),
          (Fraction(2), Fraction(1, 3)), (Fraction(-2), Fraction(1, 3)), (Fraction(1), Fraction(1))]  # fmt: skip


@pytest.mark.parametrize(
    ("record", "each"), [(CONTINUUM, 1), (DOUBLE, 2)], ids=["a continuum", "a double root"]
)
@pytest.mark.parametrize(("a", "b"), POINTS, ids=str)
def test_solve_counts_what_the_map_counts(
    record: dict[str, Any], each: int, a: Fraction, b: Fraction
) -> None:
    found = ptmcad.solve(model=slice_from(record).model, a=a, b=b)
    assert found.status is Status.EXACT
    assert len(found.equilibria) == each * roots(a, b)
    assert not found.remark
    assert ptmcad.counts_at(slice_from(record).model, a=a, b=b).total == each * roots(a, b)


def test_solve_says_that_excluded_solutions_coincide() -> None:
    record = yaml.safe_load("""
        system: {unknowns: {x: real}, equations: [(x + 1)^2*(x - a)*(x - b)], positive: [x]}
        axes: {a: [1, 2], b: [3, 4]}
    """)
    found = ptmcad.solve(model=slice_from(record).model, a="3/2", b="7/2")
    assert (len(found.equilibria), found.status) == (2, Status.EXACT)
    assert found.remark == "two solutions that an inequality excludes coincide"


STABLE_NOWHERE = [
    {"unknowns": {"x": "real"}, "equations": ["x^3 - a*x + b"], "stable": ["x^3 - a*x + b"]},
    {**LINE, "equations": ["x*(1 - x)", "y - a*x + b"], "stable": ["x - x^2"]},
    {"unknowns": {"x": "real"}, "equations": ["x^3 - a*x + b"], "stable": ["x^3 - a*x + b", "x"]},
]


@pytest.mark.parametrize(
    "system", STABLE_NOWHERE, ids=["the equation", "a multiple of it", "and another one"]
)
@pytest.mark.parametrize("ask", [ptmcad.classify, check])
@pytest.mark.slow_cases("check-a multiple of it", "check-and another one")
def test_a_condition_that_is_zero_at_every_solution_is_refused(
    ask: Callable[[Slice], object], system: dict[str, Any]
) -> None:
    slice = slice_from({"system": system, "axes": {"a": [-1, 1], "b": [-1, 1]}, "count": "stable"})
    with pytest.raises(
        NothingToCountError, match="zero at each solution, real or complex: none is stable"
    ) as caught:
        ask(slice)
    assert caught.value.part == "stable.1"


def test_a_condition_that_is_zero_at_some_solutions_is_none_that_is_refused() -> None:
    system = {"unknowns": {"x": "real"}, "equations": ["x*(x - 2 + a)"], "stable": ["x"]}
    found = ptmcad.classify(
        {"system": system, "axes": {"a": [-1, 1], "b": [-1, 1]}, "count": "stable"}
    )
    assert {region.stable for region in found.regions} == {1}
    assert check(found.slice).complex_solutions == 2
    assert verify(found).ok


def test_an_inequality_that_is_zero_at_every_solution_leaves_nothing_to_count() -> None:
    system = {"unknowns": {"x": "real"}, "equations": ["x^2 - a + b"], "positive": ["x^2 - a + b"]}
    with pytest.raises(
        NothingToCountError,
        match=r"left side of an inequality zero: there is nothing to count; for example at a = 10/21",
    ):
        ptmcad.classify({"system": system, "axes": {"a": [0, 1], "b": [0, 1]}})


def test_check_refuses_what_the_certified_engine_refuses() -> None:
    mechanism = {
        "parameters": {"c": {"kind": "stiffness"}, "F": {"kind": "force"}},
        "unknowns": dict.fromkeys(("th", "s", "t", "u", "v", "w"), "angle"),
        "points": {"A": [2, 0], "P": ["cos(th)", "sin(th)"]},
        "springs": [{"between": ["A", "P"], "k": "c", "free": "1/2"}],
        "torsion": [{"angle": angle, "k": 1} for angle in ("s", "t", "u", "v", "w")],
        "loads": {"P": [0, "F"]},
    }
    slice = slice_from({"mechanism": mechanism, "axes": {"c": [1, 3], "F": [-3, 3]}})
    with pytest.raises(ConfigError, match="takes up to 3 unknowns") as checked:
        check(slice)
    with pytest.raises(ConfigError) as classified:
        ptmcad.classify(slice)
    assert str(checked.value) == str(classified.value)


MANY = {"unknowns": {"x": "real", "y": "real", "z": "real"},
        "equations": ["(x + y + z + a)^12 - 1", "(x - 2*y + z*b)^11 - 1", "(x + y*z)^9 - x"]}  # fmt: skip


@pytest.mark.parametrize(
    ("system", "bound"),
    [
        (MANY, 12 * 11 * 18),
        ({"unknowns": {"x": "angle"}, "equations": ["cos(40*x) - b*a*sin(x)"]}, 80),
    ],
    ids=["three polynomials", "a high harmonic"],
)
def test_check_does_not_count_more_than_it_can_at_once(system: dict[str, Any], bound: int) -> None:
    found = check(slice_from({"system": system, "axes": {"a": [0, 1], "b": [0, 1]}}))
    assert (found.complex_solutions, found.bound) == (None, bound)


MANY_SIDES = [
    (yaml.safe_load("""
unknowns: {x: real, y: real, t: angle}
equations: [x^2*cos(t) + y - a*sin(t), y^2*sin(t) - x*b, x*y - cos(t)/5 + x^2]
positive: [x + 2, y + 2, sin(t) + 1/2, 3 - x^2 - y^2]
"""), 22),
    (yaml.safe_load("""
unknowns: {t: angle, s: angle, x: real, y: real}
equations:
  - cos(t) + x*sin(s) - a
  - sin(t) + y - b/2
  - x^2 + y^2 - 2 + cos(s)/3
  - cos(s - t) - y/3 - x/5
positive: [x + y + 1, cos(t) + 3/4]
"""), 16),
]  # fmt: skip


@pytest.mark.parametrize(("system", "solutions"), MANY_SIDES)
@pytest.mark.slow_cases("system1-16")
def test_check_answers_at_once_whatever_the_inequalities(
    system: dict[str, Any], solutions: int
) -> None:
    """A basis with the inverse of the inequalities' product takes minutes of each."""
    assert (
        check(slice_from({"system": system, "axes": {"a": [1, 3], "b": [1, 3]}})).complex_solutions
        == solutions
    )


@pytest.mark.parametrize("record", [CONTINUUM, DOUBLE], ids=["a continuum", "a double root"])
def test_solutions_off_a_condition_are_as_many_as_the_saturated_ideal_has(
    record: dict[str, Any],
) -> None:
    problem = problem_of(slice_from(record))
    values = problem.on.values((fmpq(1, 3), fmpq(2, 5)))
    algebra = point_system(problem.system, values, saturated=True).algebra
    one = evaluate(algebra, {(0,) * len(algebra.multiplication): fmpq(1)})
    expected = sum(signature(hermite_matrix(algebra, one))), algebra.dimension
    assert solutions_at(problem.system, values, saturated=True) == expected


def test_what_counts_is_taken_with_its_multiplicity() -> None:
    system = {
        "unknowns": {"x": "real"},
        "equations": ["x^3*(x - 1)^2*(x - a)*(x - b)"],
        "positive": ["x^2"],
    }
    problem = problem_of(slice_from({"system": system, "axes": {"a": [2, 3], "b": [4, 5]}}))
    values = problem.on.values((fmpq(5, 2), fmpq(9, 2)))
    assert solutions_at(problem.system, values) == (4, 7)
    assert solutions_at(problem.system, values, saturated=True) == (3, 4)
