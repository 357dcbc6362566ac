"""Where exact numbers become arrays of doubles: what does not fit into one is said."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from ptmcad.errors import ConfigError
from ptmcad.question.slice import Slice


@contextmanager
def within_doubles(slice: Slice) -> Iterator[None]:
    """Numbers are small enough inside.

    Raises
    ------
    ConfigError
        When one is not.
    """
    try:
        yield
    except OverflowError as error:
        raise ConfigError(
            f"{slice.name} has numbers beyond doubles, 1.8e308: there are no arrays of it"
        ) from error
