"""How the inner loops are compiled: by numba, kept on disk, without any licence to change floating-point arithmetic.

Guarantee: each operation is rounded once, to nearest, as IEEE 754 says; no fused or reordered operations, and division
by zero gives an infinity. Nothing that depends on a slice is compiled in, so a new slice compiles nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from ptmcad.errors import ConfigError

F = TypeVar("F", bound=Callable[..., Any])

try:
    from numba import njit
except ImportError as missing:
    raise ConfigError(
        "springs with a free length need the package numba, which is not installed: pip install 'ptmcad[certified]'"
    ) from missing


def compiled(function: F) -> F:
    """Compile for the machine; the global interpreter lock is released while the function runs."""
    return cast("F", njit(cache=True, nogil=True, error_model="numpy", fastmath=False)(function))


def inlined(function: F) -> F:
    """The same for a function of a few operations, which is written out where it is used."""
    return cast("F", njit(nogil=True, error_model="numpy", fastmath=False, inline="always")(function))
