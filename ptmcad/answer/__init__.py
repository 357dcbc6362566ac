"""The answers, as plain data: nothing here computes or draws.

What is done with an answer (`RegionMap.locate`, `Poses.table`) imports it, never the other way
round. So the classes only declare such methods; `ptmcad.methods`, which `ptmcad` imports before
anything else, enters them here.
"""

from __future__ import annotations

TYPE_CHECKING = False  # type checkers take it for true; the module typing would be half of the way to `__main__.main`
if TYPE_CHECKING:
    from typing import Any, TypeVar

    Answer = TypeVar("Answer")

METHODS: dict[str, dict[str, Any]] = {}
"""The names of classes, with their methods by name."""


def with_methods(answer: type[Answer]) -> type[Answer]:
    """Give a class the methods that were entered for it."""
    for name, method in METHODS[answer.__name__].items():
        function = getattr(method, "__func__", method)
        function.__name__, function.__qualname__ = name, f"{answer.__qualname__}.{name}"
        setattr(answer, name, method)
    return answer
