"""Several options of a command handed on as one object, so that no list of them is typed out on
every floor.

Guarantee: click sees each option as it was declared: order, help and messages are the same.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

import click

F = TypeVar("F", bound=Callable[..., Any])


def reading(
    read: Callable[[str, Any], Any], absent: Any = None
) -> Callable[[Any, click.Parameter, Any], Any]:
    """What click calls with an option's value: a function of the option's name and its value, where
    one is given.
    """
    return lambda _context, parameter, value: (
        absent if value is None else read(parameter.opts[0], value)
    )


def gathered(**kinds: Callable[..., Any]) -> Callable[[F], F]:
    """A decorator of a command that takes, for each name, what ``kinds`` makes of the options of
    its parameters' names.

    It stands below the options that it gathers.
    """

    def decorate(command: F) -> F:
        @wraps(command)
        def with_fewer(**given: Any) -> Any:
            made = {
                name: kind(
                    **{option: given.pop(option) for option in inspect.signature(kind).parameters}
                )
                for name, kind in kinds.items()
            }
            return command(**given, **made)

        return with_fewer  # type: ignore[return-value]

    return decorate
