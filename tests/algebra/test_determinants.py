"""Determinants from values modulo primes, against elimination and permutations, and least
assignments.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from itertools import permutations

import pytest
from flint import fmpz_mat, fmpz_mpoly
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples

from ptmcad.algebra import plane_determinants
from ptmcad.algebra.plane_determinants import least_assignment
from ptmcad.algebra.polynomials import PLANE

X, Y = PLANE.gens()
Matrix = list[list[fmpz_mpoly]]

COEFFICIENT = st.integers(-9, 9) | st.integers(-(10**20), 10**20)
POLYNOMIAL = st.dictionaries(
    st.tuples(st.integers(0, 3), st.integers(0, 3)), COEFFICIENT, max_size=3
).map(lambda terms: PLANE.from_dict({m: c for m, c in terms.items() if c}))


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
        assert least_assignment(costs) == sum(
            costs[i][j] for i, j in zip(rows, columns, strict=True)
        )


@given(matrices())
@settings(max_examples=examples(60))
def test_determinants_are_those_by_permutations(matrix: Matrix) -> None:
    expected = by_permutations(matrix)
    assert plane_determinants.characteristic(matrix) == [expected]
    assert plane_determinants._bareiss([list(row) for row in matrix], math.inf) == expected


def test_long_eliminations_are_given_up_for_values(monkeypatch: pytest.MonkeyPatch) -> None:
    source = random.Random(5)
    size = 12
    few = [
        [
            PLANE.constant(source.randint(-9, 9)) * (X + i) + (Y if i == j else 0)
            for j in range(size)
        ]
        for i in range(size)
    ]
    expected = plane_determinants._bareiss([list(row) for row in few], math.inf)
    assert plane_determinants._bareiss([list(row) for row in few], 1000) is None
    monkeypatch.setattr(plane_determinants, "SHARE", 0)
    assert plane_determinants._primitive_determinant(few) == expected
    values = fmpz_mat([[int(p(3, 5)) for p in row] for row in few])
    assert expected is not None
    assert expected(3, 5) == values.det()


def test_sparse_determinants_take_an_elimination(monkeypatch: pytest.MonkeyPatch) -> None:
    """ring-of-three: 28 rows of about one term each took 11 s by values, and take 0.06 s."""
    monkeypatch.setattr(plane_determinants, "characteristic", None)
    size = 28
    terms = {0: X**3 + 2, 1: Y**2 - X}
    sparse = [[terms.get(j - i, PLANE.constant(0)) for j in range(size)] for i in range(size - 1)]
    sparse.append([X + j * Y for j in range(size)])
    values = fmpz_mat([[int(p(3, 5)) for p in row] for row in sparse])
    assert plane_determinants._primitive_determinant(sparse)(3, 5) == values.det()


def test_a_matrix_without_rank_has_determinant_zero() -> None:
    rows = [[X + i * Y + j for j in range(4)] for i in range(3)]
    assert plane_determinants.characteristic(
        [*rows, [a + b for a, b in zip(rows[0], rows[1], strict=True)]]
    )[0].is_zero()
