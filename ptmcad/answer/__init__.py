"""The answers, as plain data: nothing here computes or draws.

What is done with an answer (`RegionMap.locate`, `Poses.table`) imports it, never the other way
round. So the classes only declare such methods; `ptmcad.methods`, which `ptmcad` imports before
anything else, enters them here.
"""

from __future__ import annotations

from importlib import import_module
from types import MethodType

TYPE_CHECKING = False  # type checkers take it for true; the module typing would be half of the way to `__main__.main`
if TYPE_CHECKING:
    from typing import Any, TypeVar

    Answer = TypeVar("Answer")

METHODS: dict[str, dict[str, Any]] = {}
"""The names of classes, with their methods by name: a function, the home of one, or a `Method`."""


class Method:
    """A function of another module as a method, imported when it is asked for.

    Parameters
    ----------
    home : module and function, as ``show.table:table``.
    bound : whether its first argument is the answer.
    """

    def __init__(self, home: str, bound: bool = True) -> None:
        self.home, self.bound = home, bound

    @property
    def function(self) -> Any:
        """The function itself."""
        module, _, name = self.home.partition(":")
        return getattr(import_module(f"ptmcad.{module}"), name)

    def __get__(self, answer: Any, kind: type | None = None) -> Any:
        return (
            MethodType(self.function, answer)
            if self.bound and answer is not None
            else self.function
        )


def with_methods(answer: type[Answer]) -> type[Answer]:
    """Give a class the methods that were entered for it."""
    for name, method in METHODS[answer.__name__].items():
        if callable(method):
            method.__name__, method.__qualname__ = name, f"{answer.__qualname__}.{name}"
        setattr(answer, name, Method(method) if isinstance(method, str) else method)
    return answer
