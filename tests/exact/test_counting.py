"""Counts at rational points: isolation, Hermite signatures, and an oracle that shares no code with
the package.
"""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
from flint import arb, arb_mat, fmpq
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from support import oracle
from support.counting import system_of
from support.examples import examples
from support.few import few
from support.maps import CONFIGS, shipped
from support.shipped_records import EXACT
from support.signatures import count_by_isolation, count_by_signature

from ptmcad import load
from ptmcad.ask.stepwise import slice_from
from ptmcad.errors import GeometryError
from ptmcad.exact.counting import negative_eigenvalues
from ptmcad.exact.point_system import DegeneratePoint
from ptmcad.exact.stages import problem_of
from ptmcad.text.flint_numbers import from_fraction

SYSTEM = system_of("ptm")
SHIPPED = [path.stem for path in EXACT]
Values = dict[str, Fraction]


def counts(method: object, values: Values) -> tuple[int, int, int] | None:
    """The index counts, None at a degenerate point."""
    try:
        return method(SYSTEM, {n: from_fraction(v) for n, v in values.items()}).index  # type: ignore
    except DegeneratePoint:
        return None


def oracle_counts(values: Values) -> tuple[int, int, int] | None:
    try:
        return oracle.count(values)
    except oracle.Degenerate:
        return None


def random_values(generator: random.Random) -> Values:
    """Simple numbers of all kinds: unequal springs, horizontal loads, loads that are zero or
    cancel, rho = 0.
    """

    def number() -> Fraction:
        return Fraction(generator.randint(-9, 9), generator.randint(1, 7))

    values = {n: abs(number()) or Fraction(1) for n in ("L1", "L2", "rho", "k1", "k2", "k3")}
    if generator.random() < 0.5:
        values["k1"] = values["k2"] = values["k3"]
    scale = generator.choice([1, 10, 100])
    values |= {n: number() / scale for n in ("F3", "F4")}
    values |= {
        n: number() / scale if generator.random() < 0.5 else Fraction(0) for n in ("F3x", "F4x")
    }
    special = generator.randint(0, 19)
    if special == 0:
        values["rho"] = Fraction(0)
    elif special == 1:
        values["F4"] = -values["F3"]
    elif special == 2:
        values["F3"] = values["F4"] = values["F3x"] = values["F4x"] = Fraction(0)
    elif special == 3:
        values["L2"], values["F4"] = values["L1"], values["F3"]
    return values


def points(number: int, seed: int) -> list[Values]:
    generator = random.Random(seed)
    return [random_values(generator) for _ in range(number)]


def check_agreement(values: Values, with_oracle: bool) -> bool:
    """Whether the point was regular; the methods must agree there, and all refuse it otherwise."""
    by_isolation, by_signature = (
        counts(count_by_isolation, values),
        counts(count_by_signature, values),
    )
    assert by_isolation == by_signature, values
    if by_isolation is not None:
        assert by_isolation[0] - by_isolation[1] + by_isolation[2] == 0
    if with_oracle:
        try:
            assert oracle.count(values) == by_isolation, values
        except oracle.Untreated:
            return False
        except oracle.Degenerate:
            assert by_isolation is None, values
    return by_isolation is not None


def test_two_methods_agree_at_random_points() -> None:
    assert sum(check_agreement(v, with_oracle=False) for v in points(50, seed=1)) > 45


@pytest.mark.slow
def test_two_methods_agree_at_2000_random_points() -> None:
    assert sum(check_agreement(v, with_oracle=False) for v in points(2000, seed=2)) > 1900


def test_oracle_agrees_at_random_points() -> None:
    assert sum(check_agreement(v, with_oracle=True) for v in points(40, seed=3)) > 35


@pytest.mark.slow
def test_oracle_agrees_at_300_random_points() -> None:
    assert sum(check_agreement(v, with_oracle=True) for v in points(300, seed=4)) > 280


@pytest.mark.parametrize("name", few(SHIPPED, "fig2", "fig4", "forces", "rods"))
@pytest.mark.slow_cases("fig4", "rods", "forces")
def test_methods_agree_at_every_sample_of(name: str) -> None:
    slice = load(CONFIGS / f"{name}.yaml")
    for cell in shipped(name).cells:
        values = {n: slice.parameters[n].evaluate(*cell.sample) for n in SYSTEM.ring.parameters}
        assert (
            cell.index == counts(count_by_isolation, values) == counts(count_by_signature, values)
        )
        assert cell.index == oracle.count(values)


# ------------------------------------------------------------------------------------------------- extreme parameters

corner = st.sampled_from(
    [Fraction(1), Fraction(2), Fraction(1, 2), Fraction(3, 2), Fraction(1, 10**6), Fraction(10**6)]
)
length = st.one_of(
    corner, st.fractions(min_value=Fraction(1, 100), max_value=100, max_denominator=100)
)
force = st.one_of(
    st.sampled_from([Fraction(c) for c in ("0", "0", "-10", "10", "1e-9", "-1e9", "1/3")]),
    st.fractions(min_value=-50, max_value=50, max_denominator=20),
)
extreme = st.fixed_dictionaries(
    {**{n: length for n in ("L1", "L2", "k1", "k2", "k3")}, "rho": st.one_of(st.just(Fraction(0)), length),
     **{n: force for n in ("F3", "F4", "F3x", "F4x")}}
)  # fmt: skip


def agree_at_extremes(values: Values) -> None:
    by_isolation = counts(count_by_isolation, values)
    assert by_isolation == counts(count_by_signature, values)
    try:
        expected = oracle.count(values)
    except oracle.Degenerate:
        expected = None
    except oracle.Untreated:
        assume(False)
    # a singular solution that is not real stops isolation, but not the oracle
    assert by_isolation in (expected, None)


@given(extreme)
@settings(max_examples=examples(40))
def test_extreme_ratios(values: Values) -> None:
    agree_at_extremes(values)


@pytest.mark.slow
@given(extreme)
@settings(max_examples=1500)
def test_many_extreme_ratios(values: Values) -> None:
    agree_at_extremes(values)


# -------------------------------------------------------------------------------------------------------- known points

PLAIN = {n: Fraction(v) for n, v in {"L1": 1, "L2": 1, "rho": 1, "k1": 100, "k2": 100, "k3": 100, "F3": 0, "F4": 0,
                                     "F3x": 0, "F4x": 0}.items()}  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "index"),
    [({"L2": "3/2"}, (2, 3, 1)), ({"L2": "3/2", "rho": "1/5"}, (1, 2, 1)), ({"L2": "3/2", "rho": "3/2"}, (1, 2, 1)),
     ({"F3": "-10", "F4": "-10", "rho": "1/400"}, (1, 3, 2)), ({"F3": "-10", "F4": "-10", "rho": "1/10"}, (1, 2, 1)),
     ({"F3": "-10", "F4": "-10", "rho": "3/4"}, (2, 3, 1))],
    ids=lambda v: ",".join(f"{n}={x}" for n, x in v.items()) if isinstance(v, dict) else None,
)  # fmt: skip
@pytest.mark.parametrize(
    "method",
    [count_by_isolation, count_by_signature, None],
    ids=["isolation", "signature", "oracle"],
)
def test_reference_points(
    method: object, changed: dict[str, str], index: tuple[int, int, int]
) -> None:
    """Unloaded: |L2 - 1| < 2 rho < L2 + 1 has two minima. Symmetric: sliver, rose, beyond the rose
    (REFERENCE).
    """
    values = PLAIN | {n: Fraction(v) for n, v in changed.items()}
    assert (counts(method, values) if method else oracle_counts(values)) == index


@pytest.mark.parametrize(
    "changed", [{"L2": "3/2", "rho": "1/4"}, {"L2": "3/2", "rho": "5/4"}, {"rho": "0"}]
)
def test_degenerate_points_have_no_count(changed: dict[str, str]) -> None:
    """On the lines 2 rho = |L2 - 1| and 2 rho = L2 + 1; and unloaded with rho = 0, where a motion
    is free.
    """
    values = PLAIN | {n: Fraction(v) for n, v in changed.items()}
    assert counts(count_by_isolation, values) is None
    assert counts(count_by_signature, values) is None
    assert oracle_counts(values) is None


@pytest.mark.parametrize("rho", ["81/65", "1/3", "1", "5/4", "13/10", "2"])
@pytest.mark.parametrize("length", ["3/2", "1", "2/3"])
def test_flat_equilibria(rho: str, length: str) -> None:
    """Sines that are exactly zero: a ball around 0 has no integer power in python-flint 0.9, only
    products.
    """
    values = PLAIN | {"rho": Fraction(rho), "L2": Fraction(length)}
    expected = oracle_counts(values)
    assert counts(count_by_signature, values) == expected
    assert counts(count_by_isolation, values) == expected


def test_oracle_is_independent() -> None:
    """The oracle imports nothing of ptmcad and nothing of FLINT."""
    with open(oracle.__file__, encoding="utf-8") as file:
        lines = [line for line in file if line.startswith(("import", "from"))]
    assert lines
    assert not any("ptmcad" in line or "flint" in line for line in lines)


@pytest.mark.parametrize(
    ("rho", "length", "must"),
    [
        (1, 0, "L2 = 0 at .* must be positive in the whole window"),
        (-1, 1, "rho = -1 at .* must not be negative anywhere in the window"),
    ],
)
def test_a_point_without_geometry_is_refused_with_its_bound(
    rho: int, length: int, must: str
) -> None:
    slice = slice_from({"name": "lengths", "axes": {"rho": [0, 2], "L2": [0, 2]}})
    with pytest.raises(GeometryError, match=must):
        problem_of(slice).solved_at((fmpq(rho), fmpq(length)))


@pytest.mark.parametrize("size", [1, 2, 3, 4, 5])
def test_inertia_of_congruent_matrices(size: int) -> None:
    """P' D P has as many negative eigenvalues as the diagonal D has negative entries (Sylvester)."""
    source = random.Random(size)
    for _ in range(50):
        diagonal = [source.choice((-3, -1, 1, 2)) for _ in range(size)]
        d = arb_mat([[x * (i == j) for j in range(size)] for i, x in enumerate(diagonal)])
        upper = arb_mat(
            [
                [source.randint(-3, 3) if j > i else int(i == j) for j in range(size)]
                for i in range(size)
            ]
        )
        assert negative_eigenvalues(upper.transpose() * d * upper) == sum(x < 0 for x in diagonal)


def test_inertia_is_open_where_balls_hold_a_singular_matrix() -> None:
    assert negative_eigenvalues(arb_mat([[0, 1], [1, 0]])) == 1
    assert negative_eigenvalues(arb_mat([[1, 0], [0, arb(0, 1)]])) is None
    with pytest.raises(ArithmeticError, match="not finite"):
        negative_eigenvalues(arb_mat([[arb.nan()]]))
