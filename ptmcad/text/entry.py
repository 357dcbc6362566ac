"""A part of a record: a value with its key, and where all that is wrong with it is noted.

Guarantee: a value that is asked for in a shape or as something has that shape, or is it, or there is a `ConfigError`
with the key; where work goes on without it, the fault is noted.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any, NamedTuple, TypeVar

from ptmcad.errors import ConfigError, Faults, quoted
from ptmcad.text.syntax import did_you_mean

MAX_ENTRIES = 400
"""Of any list or mapping in a description, so that what is read is read, and proved, in a fraction of a second."""
T = TypeVar("T")


class Entry(NamedTuple):
    """A value of plain data: texts, numbers, lists and mappings, as YAML gives it."""

    value: Any
    key: str
    faults: Faults
    name: Any = ""
    """The last step of the key."""

    def error(self, message: str) -> ConfigError:
        """A fault of this entry."""
        return ConfigError(message, key=self.key)

    def below(self, step: str | int, value: Any) -> Entry:
        """An entry of this one."""
        return Entry(value, f"{self.key}.{step}" if self.key else str(step), self.faults, step)

    def entries(self, like: str = "", most: int = MAX_ENTRIES) -> dict[str, Entry]:
        """Those of a mapping of at most so many entries; ``like`` is an example for the message."""
        if not isinstance(self.value, Mapping):
            raise self.error(f"expected a mapping{like and f', such as {like}'}")
        self._check_size(most)
        return {name: self.below(name, value) for name, value in self.value.items()}

    def items(self, like: str = "") -> list[Entry]:
        """Those of a list of at most `MAX_ENTRIES` entries."""
        if not isinstance(self.value, list | tuple):
            raise self.error(f"expected a list{like and f', such as {like}'}")
        self._check_size(MAX_ENTRIES)
        return [self.below(n, value) for n, value in enumerate(self.value, 1)]

    def pair(self, what: str, like: str) -> tuple[Entry, Entry]:
        """The two entries of a list that has two; ``what`` it is, for the message."""
        found = self.items(like)
        if len(found) != 2:
            raise self.error(f"expected {what} such as {like}")
        return found[0], found[1]

    def _check_size(self, most: int) -> None:
        if len(self.value) > most:
            raise self.error(f"{len(self.value)} entries, more than the {most} that can be computed with")

    def fields(self, known: Collection[str], needed: Collection[str] = (), like: str = "") -> Entry:
        """This mapping, once every key of it that is not known, and every one that is missing, is noted."""
        found = self.entries(like)
        for name, entry in found.items():
            with self.faults:
                if name not in known:
                    hint = did_you_mean(str(name), known) or f"; the keys are {', '.join(known)}"
                    raise entry.error(f"unknown key{hint}")
        for name in needed:
            with self.faults:
                if name not in found:
                    raise self.below(name, None).error("is missing")
        return self

    def has(self, *names: str) -> bool:
        """Whether a mapping has all of these keys."""
        return all(name in self.value for name in names)

    def at(self, name: str, default: Any = None) -> Entry:
        """What a mapping has under a key."""
        return self.below(name, self.value.get(name, default))

    def read(self, name: str, read: Callable[[Entry], T], default: T) -> T:
        """What is read under a key of a mapping; the default where the key is missing, or wrong, which is noted."""
        with self.faults:
            return read(self.at(name)) if name in self.value else default
        return default

    def each_item(self, read: Callable[[Entry], T], like: str = "") -> tuple[T, ...]:
        """What is read of the entries of a list, without those that are wrong, which are noted."""
        return self._each(read, lambda: self.items(like))

    def each_entry(self, read: Callable[[Entry], T], like: str = "") -> tuple[T, ...]:
        """The same of a mapping."""
        return self._each(read, lambda: self.entries(like).values())

    def _each(self, read: Callable[[Entry], T], parts: Callable[[], Iterable[Entry]]) -> tuple[T, ...]:
        found = []
        with self.faults:
            for entry in parts():
                with self.faults:
                    found.append(read(entry))
        return tuple(found)


def as_written(value: object) -> str:
    """What a value is, for messages: a text in quotation marks, or the kind of what is none."""
    if value is None:
        return "an empty value"
    if isinstance(value, bool):
        return f"the yes-or-no value '{str(value).lower()}'"
    if isinstance(value, list | tuple):
        return "a list"
    return "a mapping" if isinstance(value, Mapping) else quoted(value) if isinstance(value, str) else f"{value!r:.60}"
