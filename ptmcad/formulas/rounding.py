"""Interval arithmetic on pairs of floats, with outward rounding and no function of the C library
but sqrt.

Guarantee: the result of each function encloses every value that its exact counterpart takes on the
arguments. An infinite end, or a NaN, means that nothing is known on that side; no test that is
written as a comparison succeeds on it. Proofs are in docs/soundness-arithmetic.md, in the order of
the functions here.
"""

from __future__ import annotations

from math import floor, inf, sqrt

from ptmcad.formulas.compilation import compiled, inlined

UNIT = 1.5 * 2.0**-52
"""An operation rounded to nearest, and the step that makes up for it, err by less than this part of
the result ...
"""
TINY = 2.0**-1022
"""... or by less than this where results are subnormal."""
SINE_ERROR = 2.0**-50
"""`sine_cosine` errs by less."""
MAX_ANGLE = 60.0
"""Beyond it nothing is claimed of sine and cosine."""
_HALF_PI_1 = float.fromhex(
    "0x1.921fb54400000p+0"
)  # the first 33 bits of pi/2: products with small integers are exact
_HALF_PI_2 = float.fromhex("0x1.0b4611a600000p-34")  # the next 33
_HALF_PI_3 = float.fromhex("0x1.3198a2e037073p-69")  # and the rest, rounded
_HALF_PI = float.fromhex("0x1.921fb54442d18p+0")
_INVERSE = 1 / _HALF_PI
_SMALL, _LARGE = (
    1e-140,
    1e140,
)  # squares of numbers between them neither overflow nor lose digits that matter


@inlined
def down(x: float) -> float:
    """A number not above the exact result whose rounding is x."""
    return x - (abs(x) * UNIT + TINY)


@inlined
def up(x: float) -> float:
    """A number not below the exact result whose rounding is x."""
    return x + (abs(x) * UNIT + TINY)


@inlined
def mignitude(low: float, high: float) -> float:
    """The least absolute value in an interval."""
    return low if low > 0 else (-high if high < 0 else 0.0)


@inlined
def magnitude(low: float, high: float) -> float:
    """The largest absolute value in an interval; NaN or infinite when nothing is known on a side."""
    # max() alone would pass over a NaN in its second argument
    return max(abs(low), abs(high)) + 0.0 * (low + high)


@compiled
def multiply(a: float, b: float, c: float, d: float) -> tuple[float, float]:
    """[a, b] [c, d]"""
    p, q, r, s = a * c, a * d, b * c, b * d
    total = p + q + r + s
    if total != total:
        return _multiply_unbounded(a, b, c, d)
    return down(min(min(p, q), min(r, s))), up(max(max(p, q), max(r, s)))


@compiled
def _multiply_unbounded(a: float, b: float, c: float, d: float) -> tuple[float, float]:
    """The product when an end is infinite: zero times anything is zero."""
    if a != a or b != b or c != c or d != d:
        return -inf, inf
    low, high = inf, -inf
    for u in (a, b):
        for v in (c, d):
            product = u * v
            if product != product:
                product = 0.0
            low, high = min(low, product), max(high, product)
    return low if low == -inf else down(low), high if high == inf else up(high)


@compiled
def reciprocal(c: float, d: float) -> tuple[float, float]:
    """1/[c, d]; everything when the interval contains zero."""
    if c > 0 or d < 0:
        return down(1 / d), up(1 / c)
    return -inf, inf


@compiled
def sine_cosine(x: float) -> tuple[float, float]:
    """sin x and cos x for |x| <= MAX_ANGLE, within SINE_ERROR: less quarter turns, then Taylor's
    polynomials.
    """
    turns = floor(x * _INVERSE + 0.5)
    r = ((x - turns * _HALF_PI_1) - turns * _HALF_PI_2) - turns * _HALF_PI_3
    z = r * r
    sine = r + r * z * (
        -1 / 6 + z * (1 / 120 + z * (-1 / 5040 + z * (1 / 362880 + z * (-1 / 39916800 + z * (
            1 / 6227020800 + z * (-1 / 1307674368000 + z / 355687428096000))))))
    )  # fmt: skip
    cosine = 1 - z * (0.5 - z * (1 / 24 - z * (1 / 720 - z * (1 / 40320 - z * (1 / 3628800 - z * (
        1 / 479001600 - z * (1 / 87178291200 - z / 20922789888000)))))))  # fmt: skip
    quarter = int(turns) & 3
    if quarter == 0:
        return sine, cosine
    if quarter == 1:
        return cosine, -sine
    if quarter == 2:
        return -sine, -cosine
    return -cosine, sine


@compiled
def sine(a: float, b: float, quarter: int) -> tuple[float, float]:
    """sin [a, b] when ``quarter`` is 0, cos [a, b] when it is 1."""
    if not (b - a < 6.28 and a > -MAX_ANGLE and b < MAX_ANGLE):
        return -1.0, 1.0
    sine_a, cosine_a = sine_cosine(a)
    sine_b, cosine_b = sine_cosine(b)
    u, v = (sine_a, sine_b) if quarter == 0 else (cosine_a, cosine_b)
    low, high = min(u, v) - SINE_ERROR, max(u, v) + SINE_ERROR
    # an extremum that may lie inside is taken to be inside
    top = (1 - quarter) * _HALF_PI
    if top + floor((b - top) / (4 * _HALF_PI) + 1e-13) * (4 * _HALF_PI) >= a - 1e-12:
        high = 1.0
    bottom = top + 2 * _HALF_PI
    if bottom + floor((b - bottom) / (4 * _HALF_PI) + 1e-13) * (4 * _HALF_PI) >= a - 1e-12:
        low = -1.0
    return max(low, -1.0), min(high, 1.0)


@compiled
def _slope(x: float, y: float) -> float:
    """x/|(x, y)|, rounded; relative error under 9 units of rounding."""
    return x / sqrt(x * x + y * y)


@compiled
def direction(a: float, b: float, c: float, d: float) -> tuple[float, float]:
    """x/|(x, y)| for x in [a, b], y in [c, d]: increasing in x, and nearer to zero for larger |y|."""
    near, far = mignitude(c, d), magnitude(c, d)
    if not (magnitude(a, b) < _LARGE and far < _LARGE):
        return -1.0, 1.0
    low, high = -1.0, 1.0
    if b < 0:
        high = up(up(up(_slope(b, far)))) if -b > _SMALL or far > _SMALL else 0.0
    elif b == 0:
        high = 0.0 if near > 0 else 1.0
    elif b > _SMALL or near > _SMALL:
        high = up(up(up(_slope(b, near))))
    if a > 0:
        low = down(down(down(_slope(a, far)))) if a > _SMALL or far > _SMALL else 0.0
    elif a == 0:
        low = 0.0 if near > 0 else -1.0
    elif -a > _SMALL or near > _SMALL:
        low = down(down(down(_slope(a, near))))
    return max(low, -1.0), min(high, 1.0)


@compiled
def length(a: float, b: float, c: float, d: float) -> tuple[float, float]:
    """|(x, y)| for x in [a, b], y in [c, d]."""
    x, y = mignitude(a, b), mignitude(c, d)
    near = max(0.0, down(down(sqrt(x * x + y * y)))) if x > _SMALL or y > _SMALL else 0.0
    x, y = magnitude(a, b), magnitude(c, d)
    if not (x < _LARGE and y < _LARGE):
        return (near, inf) if near < inf else (0.0, inf)
    if x > _SMALL or y > _SMALL:
        return near, up(up(sqrt(x * x + y * y)))
    return near, up(x + y)
