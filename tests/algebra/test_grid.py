"""Polynomials from values modulo primes on a grid: against elimination and bounds; what a planted fault does."""

from __future__ import annotations

import random
from collections.abc import Sequence
from itertools import chain, permutations

import pytest
from flint import fmpz_mpoly
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples

from ptmcad.algebra import determinants, grid, pencils
from ptmcad.algebra.assignment import least_assignment
from ptmcad.algebra.pencils import Pencil
from ptmcad.algebra.polynomials import PLANE, multiplicity
from ptmcad.algebra.residues import FaultyValue
from ptmcad.algebra.resultants import nothing

X, Y = PLANE.gens()
Matrix = list[list[fmpz_mpoly]]

COEFFICIENT = st.integers(-9, 9) | st.integers(-(10**20), 10**20)
POLYNOMIAL = st.dictionaries(st.tuples(st.integers(0, 3), st.integers(0, 3)), COEFFICIENT, max_size=3).map(
    lambda terms: PLANE.from_dict({m: c for m, c in terms.items() if c})
)


@st.composite
def matrices(draw: st.DrawFn) -> Matrix:
    size = draw(st.integers(1, 4))
    return [[draw(POLYNOMIAL) for _ in range(size)] for _ in range(size)]


def by_permutations(matrix: Sequence[Sequence[fmpz_mpoly]]) -> fmpz_mpoly:
    total = PLANE.constant(0)
    for order in permutations(range(len(matrix))):
        product = PLANE.constant((-1) ** sum(a > b for k, b in enumerate(order) for a in order[:k]))
        for row, j in zip(matrix, order, strict=True):
            product = product * row[j]
        total = total + product
    return total


def whole(cofactor: fmpz_mpoly, factors: grid.Factors) -> fmpz_mpoly:
    for f, e in factors:
        cofactor = cofactor * f**e
    return cofactor


def sample(size: int = 5) -> Matrix:
    """Rows that share factors in many ways: the determinant has (x + y)^3 and y^2 at least."""
    source = random.Random(3)

    def entry(i: int, j: int) -> fmpz_mpoly:
        terms = (source.randint(-(10**18), 10**18) * X**a * Y**b for a in range(3) for b in range(3 - a))
        return sum(terms, PLANE.constant(1)) * (X + Y) ** (i < 3) * Y ** (j < 2)

    return [[entry(i, j) for j in range(size)] for i in range(size)]


PLACES = (X, Y, X + Y, X - 7)


@given(st.integers(1, 5).flatmap(lambda n: st.lists(
    st.lists(st.none() | st.integers(-5, 9), min_size=n, max_size=n), min_size=n, max_size=n)))  # fmt: skip
@settings(max_examples=examples(200))
def test_assignments_are_the_least(costs: list[list[int | None]]) -> None:
    sums = []
    for order in permutations(range(len(costs))):
        taken = [row[j] for row, j in zip(costs, order, strict=True)]
        if None not in taken:
            sums.append(sum(c for c in taken if c is not None))
    assert least_assignment(costs) == min(sums, default=None)


def test_assignments_of_many_rows_are_those_of_scipy() -> None:
    from scipy.optimize import linear_sum_assignment

    source = random.Random(7)
    for size in range(2, 40):
        costs = [[source.randint(-9, 40) for _ in range(size)] for _ in range(size)]
        rows, columns = linear_sum_assignment(costs)
        assert least_assignment(costs) == sum(costs[i][j] for i, j in zip(rows, columns, strict=True))


@given(matrices())
@settings(max_examples=examples(60))
def test_determinants_are_those_by_permutations(matrix: Matrix) -> None:
    expected = by_permutations(matrix)
    asked = pencils.bounds(Pencil(matrix), PLACES)
    if asked is None:
        assert expected.is_zero()
        return
    cofactor, factors = pencils.determinant(matrix, asked, nothing)
    assert whole(cofactor, factors) == expected


@given(matrices(), st.integers(-3, 3))
@settings(max_examples=examples(40))
def test_characteristic_polynomials_are_determinants(matrix: Matrix, t: int) -> None:
    scales = [X**2 + Y + 5 + k for k in range(len(matrix))]
    coefficients, factors = pencils.characteristic(matrix, scales, PLACES, nothing)
    product = PLANE.constant(t ** len(matrix))
    for s in scales:
        product = product * s
    value = product + sum((whole(c, factors) * t**k for k, c in enumerate(coefficients)), PLANE.constant(0))
    shifted = [[(t * scales[i] if i == j else 0) - p for j, p in enumerate(row)] for i, row in enumerate(matrix)]
    assert value == by_permutations(shifted)


@given(matrices())
@settings(max_examples=examples(60))
def test_bounds_hold(matrix: Matrix) -> None:
    expected = by_permutations(matrix)
    asked = pencils.bounds(Pencil(matrix), PLACES)
    if asked is None or expected.is_zero():
        assert expected.is_zero()
        return
    for f, e in asked.factors:
        assert multiplicity(expected, f) >= e
        expected = expected / f**e
    assert all(i < len(asked.support) and j < asked.support[i] for i, j in expected.monoms())
    assert max(int(c).bit_length() for c in expected.coeffs()) <= asked.bits


def test_high_orders_are_known_and_divided_out() -> None:
    asked = pencils.bounds(Pencil(sample()), PLACES)
    assert asked is not None
    assert {str(f): e for f, e in asked.factors} == {"y": 2, "x + y": 3}
    # degree 2 in each of five rows, in total
    assert asked.points == 11 * 12 // 2


@pytest.mark.parametrize("fault", ["prime", "degree", "bits", "factor", "measure"])
def test_a_planted_fault_is_caught(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    matrix = sample()
    asked = pencils.bounds(Pencil(matrix), PLACES)
    assert asked is not None
    if fault == "prime":
        plain, wrong = pencils._values, [1]

        def faulty(pencil: Pencil) -> grid.Values:
            at = plain(pencil)
            return lambda x: lambda y: lambda p: [v + wrong.pop() if wrong else v for v in at(x)(y)(p)]

        monkeypatch.setattr(pencils, "_values", faulty)
    elif fault == "degree":
        asked = asked._replace(support=asked.support[:-1])
    elif fault == "bits":
        asked = asked._replace(bits=3)
    elif fault == "measure":
        monkeypatch.setattr(pencils, "_measure", lambda _: -20.0)
        asked = pencils.bounds(Pencil(matrix), PLACES)
        assert asked is not None
    else:
        asked = asked._replace(factors=((X + 2 * Y + 1, 2),))
    with pytest.raises(FaultyValue):
        pencils.determinant(matrix, asked, nothing)


def test_primes_that_divide_a_value_are_passed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    primes = grid.primes()
    # y and x + y take the values 2 to 11 at the points
    monkeypatch.setattr(grid, "primes", lambda: chain([5, 7, 11], primes))
    matrix = sample()
    asked = pencils.bounds(Pencil(matrix), PLACES)
    assert asked is not None
    assert whole(*pencils.determinant(matrix, asked, nothing)) == by_permutations(matrix)


def test_points_keep_off_curves_on_which_a_factor_vanishes() -> None:
    asked = grid.Asked(1, (4, 3, 2, 1), 5, ((X - Y, 1), (X + Y + 1, 2)), (X * Y - 2,))
    found = grid._grid(asked)
    points = [(found.x + i, found.y + j) for i, height in enumerate(asked.support) for j in range(height)]
    assert len(points) == len(found.divisors) == 10
    assert 0 not in found.divisors
    assert all((x * y - 2) % p for x, y in points for p in found.primes)


def test_large_determinants_go_modulo_primes_and_small_ones_do_not(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []
    plain = pencils.determinant

    def spied(matrix: pencils.Matrix, bounds: grid.Asked, check: grid.Check) -> tuple[fmpz_mpoly, grid.Factors]:
        asked.append(len(matrix))
        return plain(matrix, bounds, check)

    monkeypatch.setattr(pencils, "determinant", spied)
    monkeypatch.setattr(determinants, "_MANY_TERMS", 4000)
    monkeypatch.setattr(pencils, "seconds", lambda *_: 0.0)
    rows = [[(p, PLANE.constant(1)) for p in row] for row in sample(9)]
    large = determinants.determinant(rows)
    assert asked == [9]
    monkeypatch.setattr(determinants, "MIN_MODULAR", 10)
    assert determinants.determinant(rows) == large
    determinants.determinant([row[:5] for row in rows[:5]])
    assert asked == [9]


def test_a_matrix_without_rank_has_determinant_zero() -> None:
    matrix = sample()
    matrix[4] = [a + X * b for a, b in zip(matrix[0], matrix[1], strict=True)]
    asked = pencils.bounds(Pencil(matrix), PLACES)
    assert asked is not None
    assert pencils.determinant(matrix, asked, nothing)[0].is_zero()
