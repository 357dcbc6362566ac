"""Intervals of doubles, rounded outward, in code that numba compiles; without numba it runs as it is,
some hundred times slower.

Guarantee: intervals hold the exact values. An operation on doubles is rounded once, to nearest, and
none is fused or reordered, so that its error is at most 2^-53 of the result or 2^-1075; each end is
moved outward by 2^-52 of it and 1e-300. What is not finite, or beyond 1e150, becomes the whole
line, which nothing is ever concluded from. The sine and the cosine of a double are taken from the C
library, with an error of at most 2^-50.

Compiled code is kept on disk under a name that follows from the text of this package, as it may
call what stands in another of its files, and of the module that has the operations' numbers.
"""

# ruff: noqa: PLW3301
from __future__ import annotations

import os
from collections.abc import Callable
from hashlib import sha256
from importlib.util import find_spec
from math import cos, hypot, inf, sin
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np

from ptmcad.verification.normalform.operations import (
    ADD,
    COSINE,
    DIRECTION,
    DIVIDE,
    LENGTH,
    MULTIPLY,
    SINE,
    SQUARE,
    SUBTRACT,
)

F = TypeVar("F", bound=Callable[..., Any])


def _kept_at(usual: str) -> str:
    here = Path(__file__).parent
    sources = [*sorted(here.glob("*.py")), here.parent / "normalform" / "operations.py"]
    text = b"\0".join(source.name.encode() + b"\0" + source.read_bytes() for source in sources)
    beside = here / "__pycache__"
    if not os.access(beside if beside.exists() else here, os.W_OK):
        beside = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "ptmcad"
    return str(Path(usual or beside) / f"exclusion-{sha256(text).hexdigest()[:16]}")


def _compiler() -> Callable[..., Callable[[F], F]]:
    """What makes decorators of numba's options."""
    if find_spec("numba") is None:
        return lambda **_: lambda function: function
    from numba import config, njit

    settings: Any = config
    folder = _kept_at(settings.CACHE_DIR)

    def decorator(**options: Any) -> Callable[[F], F]:
        def made(function: F) -> F:
            usual = settings.CACHE_DIR
            settings.CACHE_DIR = folder  # numba asks for the folder when it decorates
            try:
                wrap = njit(nogil=True, error_model="numpy", fastmath=False, **options)
                return cast("F", wrap(function))
            finally:
                settings.CACHE_DIR = usual

        return made

    return decorator


_DECORATOR = _compiler()


def compiled(function: F) -> F:
    """Compile for the machine, and keep it."""
    return _DECORATOR(cache=True)(function)


def inlined(function: F) -> F:
    """The same for a function of a few operations."""
    return _DECORATOR(inline="always")(function)


_LARGE = 1e150
_PART, _MIN_ERROR = 2.0**-52, 1e-300
_TURN = 6.283185307179586
_SINE_ERROR = 2.0**-50


@inlined
def outward(a: float, b: float) -> Any:
    """The interval from a to b, a little wider; the whole line where it is not finite."""
    low, high = a - (abs(a) * _PART + _MIN_ERROR), b + (abs(b) * _PART + _MIN_ERROR)
    if not (low > -_LARGE and high < _LARGE):
        low, high = -inf, inf
    return low, high


@inlined
def _hull(p: float, q: float, r: float, s: float) -> Any:
    return outward(min(min(p, q), min(r, s)), max(max(p, q), max(r, s)))


@inlined
def _nearest(a: float, b: float) -> float:
    """The least absolute value in [a, b]."""
    return 0.0 if a <= 0.0 <= b else min(abs(a), abs(b))


@compiled
def times(a: float, b: float, c: float, d: float) -> Any:
    """[a, b] [c, d]"""
    if a == -inf or c == -inf:
        return -inf, inf
    return _hull(a * c, a * d, b * c, b * d)


@compiled
def square(a: float, b: float) -> Any:
    """The squares of what is in [a, b]."""
    if a == -inf:
        return -inf, inf
    p, q = a * a, b * b
    low, high = outward(0.0 if a <= 0.0 <= b else min(p, q), max(p, q))
    return max(low, 0.0) if low > -inf else low, high


@compiled
def over(a: float, b: float, c: float, d: float) -> Any:
    """[a, b]/[c, d]; the whole line where the divisor may be zero."""
    if a == -inf or c == -inf or c <= 0.0 <= d:
        return -inf, inf
    return _hull(a / c, a / d, b / c, b / d)


@compiled
def wave(a: float, b: float, top: float) -> Any:
    """The cosine's values on [a, b] (top 0) or the sine's (top pi/2): the function is 1 at top and
    at whole turns.
    """
    if not (b - a < _TURN and abs(a) < 1e3):
        return -1.0, 1.0
    p, q = (cos(a), cos(b)) if top == 0.0 else (sin(a), sin(b))
    low, high = min(p, q) - _SINE_ERROR, max(p, q) + _SINE_ERROR
    # a multiple of a turn, plus top or plus top and a half turn, that may be in the interval
    if np.floor((b + 1e-9 - top) / _TURN) >= np.ceil((a - 1e-9 - top) / _TURN):
        high = 1.0
    if np.floor((b + 1e-9 - top) / _TURN - 0.5) >= np.ceil((a - 1e-9 - top) / _TURN - 0.5):
        low = -1.0
    return max(low, -1.0), min(high, 1.0)


@compiled
def reach(a: float, b: float, c: float, d: float) -> Any:
    """The least and the largest length of a vector in [a, b] x [c, d]."""
    low, high = (
        hypot(_nearest(a, b), _nearest(c, d)),
        hypot(max(abs(a), abs(b)), max(abs(c), abs(d))),
    )
    # the C library's hypot is wrong by one unit in the last place at most
    return low * (1 - 2.0**-50), high * (1 + 2.0**-50) + _MIN_ERROR


@compiled
def direction(a: float, b: float, c: float, d: float) -> Any:
    """The first coordinate of the unit vectors along what is in [a, b] x [c, d]."""
    if a == -inf or c == -inf or (a <= 0.0 <= b and c <= 0.0 <= d):
        return -1.0, 1.0
    least, most = _nearest(c, d), max(abs(c), abs(d))
    # x/|(x, y)| grows with x; it grows with |y| where x is negative, and falls where it is positive
    low, high = a / hypot(a, most if a >= 0.0 else least), b / hypot(b, least if b >= 0.0 else most)
    if not (low >= -2.0 and high <= 2.0):
        return -1.0, 1.0
    return max(low - 2.0**-49, -1.0), min(high + 2.0**-49, 1.0)


@compiled
def operation(code: int, a: float, b: float, c: float, d: float) -> Any:
    """One operation on [a, b], or on [a, b] and [c, d]."""
    if code == ADD:
        return outward(a + c, b + d)
    if code == SUBTRACT:
        return outward(a - d, b - c)
    if code == MULTIPLY:
        return times(a, b, c, d)
    if code == SQUARE:
        return square(a, b)
    if code == DIVIDE:
        return over(a, b, c, d)
    if code == COSINE:
        return wave(a, b, 0.0)
    if code == SINE:
        return wave(a, b, _TURN / 4)
    if code == DIRECTION:
        return direction(a, b, c, d)
    if a == -inf or c == -inf:
        return -inf, inf
    low, high = reach(a, b, c, d)
    if code == LENGTH:
        return outward(low, high)
    return over(1.0, 1.0, low, high)
