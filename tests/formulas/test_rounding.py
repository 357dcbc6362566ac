"""Every function of the interval arithmetic encloses what it should: against Arb, and against exact
fractions.
"""

from __future__ import annotations

import importlib
import math
import shutil
from collections.abc import Iterator
from fractions import Fraction
from math import inf, nan
from pathlib import Path
from types import FunctionType

import numpy as np
import pytest
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from support.examples import examples

pytest.importorskip("numba")

from numba.core.registry import CPUDispatcher

from ptmcad.formulas import compilation
from ptmcad.formulas import rounding as arithmetic
from ptmcad.formulas.compilation import compiled

PACKAGE = Path(compilation.__file__).parents[1]
Floats = NDArray[np.float64]
LARGEST, SMALLEST, SUBNORMAL = 1.7976931348623157e308, 2.0**-1022, 5e-324
CORNERS = [
    0.0, -0.0, 1.0, -1.0, 0.1, 1 / 3, 1 + 2.0**-52, 1 - 2.0**-53, 2.0, 3.0, math.pi, SUBNORMAL, 3 * SUBNORMAL, SMALLEST,
    2.0**-1021, 1e-300, 1e-200, 1e-160, 1e-140, 1.1e-140, 9e-141, 1e-100, 1e100, 9e139, 1e140, 1.1e140, 1e154, 1e160,
    1e200, 1e300, LARGEST,
]  # fmt: skip
FINITE = (
    st.sampled_from(CORNERS) | st.floats(allow_nan=False, allow_infinity=False) | st.floats(-2, 2)
)
END = FINITE | st.sampled_from([inf, -inf, nan])


@st.composite
def intervals(draw: st.DrawFn, end: st.SearchStrategy[float] = END) -> tuple[float, float]:
    """A lower and an upper end; an end that says nothing may be infinite or NaN, whatever the other
    one is.
    """
    a, b = draw(end) * draw(st.sampled_from([1, -1])), draw(end) * draw(st.sampled_from([1, -1]))
    if a > b:
        a, b = b, a
    if draw(st.integers(0, 4)) == 0 and math.isfinite(a):
        b = draw(st.sampled_from([a, math.nextafter(a, inf), b]))
    return (nan if a == inf else a), (nan if b == -inf else b)


def points(interval: tuple[float, float]) -> Iterator[Fraction]:
    """Exact members of an interval: its ends, zero, some between; large ones where an end is no
    bound.
    """
    a, b = interval
    low = Fraction(a) if math.isfinite(a) else None
    high = Fraction(b) if math.isfinite(b) else None
    big = Fraction(10) ** 400
    low = (
        low
        if low is not None
        else (min(high, Fraction(0)) if high is not None else Fraction(0)) - big
    )
    high = high if high is not None else max(low, Fraction(0)) + big
    yield low
    yield high
    yield (low + high) / 2
    yield (3 * low + high) / 4
    if low <= 0 <= high:
        yield Fraction(0)
        yield min(high, Fraction(1, 10**350))
        yield max(low, -Fraction(1, 10**350))


def encloses(interval: tuple[float, float], value: Fraction) -> bool:
    """Whether neither end excludes the value; a NaN excludes nothing."""
    low, high = interval
    return not (math.isfinite(low) and value < Fraction(low)) and not (
        math.isfinite(high) and value > Fraction(high)
    ) and low != inf and high != -inf  # fmt: skip


@given(intervals(), intervals())
@settings(max_examples=examples(400), deadline=None)
def test_product(x: tuple[float, float], y: tuple[float, float]) -> None:
    product = arithmetic.multiply(*x, *y)
    for p in points(x):
        for q in points(y):
            assert encloses(product, p * q)


@given(intervals())
@settings(max_examples=examples(300), deadline=None)
def test_reciprocal(x: tuple[float, float]) -> None:
    result = arithmetic.reciprocal(*x)
    for p in points(x):
        assert p == 0 or encloses(result, 1 / p)


@compiled
def _sum(a: float, b: float) -> tuple[float, float]:
    return arithmetic.down(a + b), arithmetic.up(a + b)


@compiled
def _quotient(a: float, b: float) -> tuple[float, float]:
    return arithmetic.down(a / b), arithmetic.up(a / b)


@compiled
def _product(a: float, b: float) -> tuple[float, float]:
    return arithmetic.down(a * b), arithmetic.up(a * b)


@given(FINITE, FINITE)
@settings(max_examples=examples(500), deadline=None)
def test_one_step_makes_up_for_one_rounding(a: float, b: float) -> None:
    assert encloses(_sum(a, b), Fraction(a) + Fraction(b))
    assert encloses(_product(a, b), Fraction(a) * Fraction(b))
    if b != 0:
        assert encloses(_quotient(a, b), Fraction(a) / Fraction(b))


@compiled
def _size(a: float, b: float) -> tuple[float, float]:
    return arithmetic.mignitude(a, b), arithmetic.magnitude(a, b)


@given(intervals())
@settings(max_examples=examples(300), deadline=None)
def test_least_and_largest_absolute_value(x: tuple[float, float]) -> None:
    near, far = _size(*x)
    for p in points(x):
        assert abs(p) >= Fraction(near)
        assert not math.isfinite(far) or abs(p) <= Fraction(far)


def sign(x: Fraction) -> int:
    return (x > 0) - (x < 0)


def at_most(bound: float, x: Fraction, y: Fraction) -> bool:
    """Whether bound <= x/|(x, y)|, exactly."""
    b = Fraction(bound)
    # compare b |(x, y)| with x by signs and squares
    left, right = sign(b) * b * b * (x * x + y * y), sign(x) * x * x
    return left <= right


@given(intervals(), intervals())
@settings(max_examples=examples(500), deadline=None)
def test_direction_and_length(x: tuple[float, float], y: tuple[float, float]) -> None:
    low, high = arithmetic.direction(*x, *y)
    near, far = arithmetic.length(*x, *y)
    assert -1 <= low <= high <= 1
    for p in points(x):
        for q in points(y):
            square = p * p + q * q
            assert near == -inf or Fraction(max(near, 0.0)) ** 2 <= square
            assert not math.isfinite(far) or square <= Fraction(far) ** 2
            if square:
                assert at_most(low, p, q)
                assert at_most(-high, -p, q)
            else:
                assert (low, high) == (-1, 1), "at the origin the direction may be any"


@compiled
def _sines(low: Floats, high: Floats, out: Floats) -> None:
    for i in range(low.shape[0]):
        out[i, 0], out[i, 1] = arithmetic.sine(low[i], high[i], 0)
        out[i, 2], out[i, 3] = arithmetic.sine(low[i], high[i], 1)


def random_angles(count: int, seed: int) -> tuple[Floats, Floats]:
    """Intervals of angles, many of them near quarter turns, narrow, wide, tiny, or beyond what is
    claimed.
    """
    rng = np.random.default_rng(seed)
    low = rng.uniform(-7, 7, count)
    kind = rng.integers(0, 8, count)
    quarters = rng.integers(-44, 45, count) * (math.pi / 2)
    low = np.where(kind == 1, quarters + rng.integers(-40, 41, count) * 2.0**-50, low)
    low = np.where(
        kind == 2, quarters + 10.0 ** rng.uniform(-16, 0, count) * rng.choice([-1, 1], count), low
    )
    low = np.where(kind == 3, rng.uniform(-61, 61, count), low)
    low = np.where(kind == 4, 10.0 ** rng.uniform(-320, 0, count) * rng.choice([-1, 1], count), low)
    width = 10.0 ** rng.uniform(-17, 1, count)
    width = np.where(rng.integers(0, 6, count) == 0, 0.0, width)
    # ends that lie at an extremum
    high = np.where(
        kind == 5, np.maximum(low, np.ceil(low / (math.pi / 2)) * (math.pi / 2)), low + width
    )
    high = np.where(kind == 6, np.nextafter(low, inf), high)
    return low, high


def whole(x: arb) -> int:
    """The only whole number in a ball."""
    number = x.unique_fmpz()
    assert number is not None
    return int(number)


def check_sines(low: Floats, high: Floats) -> None:
    """Against Arb with 110 bits, and to within 2^-109: ends, extrema, and how much is given away."""
    out = np.empty((len(low), 4))
    _sines(low, high, out)
    with ctx.workprec(110):
        pi = arb.pi()
        slack = arb(arithmetic.SINE_ERROR) * 2
        for a, b, row in zip(low.tolist(), high.tolist(), out.tolist(), strict=True):
            x, y = arb(a), arb(b)
            at = (*x.sin_cos(), *y.sin_cos())
            for quarter in (0, 1):
                u, v = row[2 * quarter], row[2 * quarter + 1]
                p, q = at[quarter], at[2 + quarter]
                # the numbers of the last extrema below the ends show how many lie between
                first = ((x / pi) - (arb(1) - quarter) / 2).floor()
                last = ((y / pi) - (arb(1) - quarter) / 2).floor()
                n, m = whole(first), whole(last)
                inside = range(n + 1, m + 1)
                top = any(k % 2 == 0 for k in inside) or (a == 0 and quarter == 1)
                bottom = any(k % 2 == 1 for k in inside)
                assert -1 <= u <= v <= 1
                assert (v == 1) if top else not (p > v or q > v), (a, b, quarter)
                assert (u == -1) if bottom else not (p < u or q < u), (a, b, quarter)
                if b - a < 6.28 and a > -60 and b < 60:
                    assert top or v == 1 or v - p < slack or v - q < slack, (
                        "the upper bound gives too much away"
                    )
                    assert bottom or u == -1 or p - u < slack or q - u < slack, (
                        "the lower bound gives too much away"
                    )


def test_sine_and_cosine_against_arb() -> None:
    check_sines(*random_angles(5_000, 1))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_sine_and_cosine_against_arb_at_a_million_intervals(seed: int) -> None:
    check_sines(*random_angles(100_000, 100 + seed))


@pytest.mark.parametrize(
    ("a", "b"),
    [(nan, nan), (nan, 1.0), (0.0, nan), (-inf, inf), (0.0, inf), (-inf, 0.0), (1e300, 1e301), (60.0, 60.5), (-61, -60),
     (0.0, 6.284), (-LARGEST, LARGEST)],
)  # fmt: skip
@pytest.mark.slow_cases("-61--60")
def test_nothing_is_claimed_of_angles_that_are_unknown_or_large(a: float, b: float) -> None:
    assert arithmetic.sine(a, b, 0) == arithmetic.sine(a, b, 1) == (-1, 1)


def copied(into: Path) -> Path:
    """The modules of the package as far as the digest is of them, and one that it is not of."""
    for room in (*compilation.ROOMS, "cover"):
        shutil.copytree(
            PACKAGE / room,
            into / room,
            ignore=lambda _, names: [n for n in names if n[-3:] != ".py"],
        )
    return into


@pytest.mark.parametrize("module", ["certified/branchandprune.py", "formulas/rounding.py"])
def test_compiled_code_belongs_to_the_sources(module: str, tmp_path: Path) -> None:
    """Another text of one module of the rooms is another folder: callers do not keep what they
    called before.
    """
    package = copied(tmp_path)
    before = compilation.digest_of(package)
    assert before == compilation.digest_of(PACKAGE)
    (package / module).write_text((package / module).read_text() + "UNIT = 1\n")
    assert compilation.digest_of(package) != before


def test_compiled_code_is_kept_where_the_digest_says() -> None:
    assert compilation._FOLDER.is_dir()
    assert compilation._FOLDER.name.endswith(compilation.digest_of(PACKAGE)[:16])


def test_the_digest_is_of_no_more_than_compiled_code_needs(tmp_path: Path) -> None:
    package = copied(tmp_path)
    before = compilation.digest_of(package)
    (package / "cover" / "samples.py").write_text("")
    assert compilation.digest_of(package) == before


def called_by(function: object) -> Iterator[str]:
    """The module of a compiled function, and those of functions among the globals that its code
    names.
    """
    python = function.py_func  # type: ignore[attr-defined]
    yield python.__module__
    for name in python.__code__.co_names:
        value = python.__globals__.get(name)
        if isinstance(value, CPUDispatcher):
            yield value.py_func.__module__
        elif isinstance(value, FunctionType):
            yield value.__module__


def test_the_digest_is_of_all_that_is_compiled() -> None:
    """A function of another room that compiled code calls could be edited, and old code would go
    on.
    """
    modules = [importlib.import_module(f"ptmcad.{room}.{path.stem}")
               for room in compilation.ROOMS for path in sorted((PACKAGE / room).glob("*.py"))]  # fmt: skip
    functions = [f for m in modules for f in vars(m).values() if isinstance(f, CPUDispatcher)]
    assert len({f.py_func for f in functions}) >= len(compilation.FUNCTIONS) > 40
    rooms = {module.rpartition(".")[0] for function in functions for module in called_by(function)}
    assert rooms == {f"ptmcad.{room}" for room in compilation.ROOMS}
