"""How the loops of the exclusion are compiled, without any licence to change floating-point
arithmetic.

Guarantee: each operation is rounded once, to nearest; none is fused or reordered. Compiled code is
kept on disk under a name that follows from the text of this package, as it may call what stands in
another of its files, and of the module that has the operations' numbers.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import config, njit

F = TypeVar("F", bound=Callable[..., Any])
_CONFIG: Any = config


def _kept_at() -> str:
    here = Path(__file__).parent
    sources = [*sorted(here.glob("*.py")), here.parent / "certified" / "formulas.py"]
    text = b"\0".join(source.name.encode() + b"\0" + source.read_bytes() for source in sources)
    beside = here / "__pycache__"
    if not os.access(beside if beside.exists() else here, os.W_OK):
        beside = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "ptmcad"
    return str(Path(_CONFIG.CACHE_DIR or beside) / f"exclusion-{sha256(text).hexdigest()[:16]}")


_FOLDER = _kept_at()


def _made(function: F, **options: Any) -> F:
    usual = _CONFIG.CACHE_DIR
    _CONFIG.CACHE_DIR = _FOLDER  # numba asks for the folder when it decorates
    try:
        return cast("F", njit(nogil=True, error_model="numpy", fastmath=False, **options)(function))
    finally:
        _CONFIG.CACHE_DIR = usual


def compiled(function: F) -> F:
    """Compile for the machine, and keep it."""
    return _made(function, cache=True)


def inlined(function: F) -> F:
    """The same for a function of a few operations."""
    return _made(function, inline="always")
