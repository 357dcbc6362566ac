"""The exceptions of ptmcad, as one tree.

* PtmcadError
  * ConfigError            -- the input is wrong: exit status 2, one message with file, line, key
    and remedy
  * ExpressionError        -- a text is not arithmetic, or too large to be meant; `config` reports
    it as a ConfigError
    * PoleError            -- a denominator vanishes at the point where a value was asked for
  * HypothesisError        -- the input is well formed but a hypothesis of the method fails
    * DegenerateSliceError -- the whole slice lies inside the discriminant variety: exit status 2
      * NothingToCountError -- off some curves there is no solution, or none that counts: exit
        status 2
    * InfiniteSolutionsError -- infinitely many equilibria at every point of the slice: exit status
      2
    * GeometryError        -- a length or a stiffness is not positive somewhere in the window: exit
      status 2
  * OutputError            -- a result could not be written: exit status 2
    * PictureError         -- a picture could not be drawn; the result itself is saved: exit status
      2
  * LimitReached           -- a time limit stopped the computation: exit status 3 (so does the
                              memory limit, which the operating system enforces: a MemoryError, or
                              an abort that `supervisor` sees)

"Undecided" is not in this tree: it is a value (`ptmcad.answer.regionmap.Status.UNDECIDED`), never
an exception.

Guarantee: the text of every exception of the tree is one line of at most `MAX_MESSAGE` characters
that a terminal shows as they are, whatever the input that it quotes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import NamedTuple, TypeVar

MAX_MESSAGE = 1000
"""Characters of a message."""
MAX_FAULTS = 50
"""Of one record: whoever wrote it has enough to mend, and a hostile one costs a bounded time."""
_MAX_PLACE = 300
T = TypeVar("T")


def shown(text: str, most: int = MAX_MESSAGE) -> str:
    """A text of someone else's as it can be shown: what is not printable is escaped, what is too long is cut out.

    >>> print(shown("a\x1b[31m" + "b" * 100, most=30))
    a\\x1b[31mbbb ... bbbbbbbbbbbb
    """
    if len(text) > 2 * most:  # so that the work is bounded too
        text = text[:most] + text[-most:]
        cut = True
    else:
        cut = False
    if not text.isprintable():
        text = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
    if len(text) > most or cut:
        half = (most - 5) // 2
        text = f"{text[:half]} ... {text[len(text) - half :]}"
    return text


def quoted(text: object, most: int = 60) -> str:
    """A text of someone else's in quotation marks; the middle of a long one is left out, as by
    `shown`.

    >>> print(quoted("L*sin(th)"), quoted("a" * 100, most=20))
    'L*sin(th)' 'aaaaaaa ... aaaaaaa'
    """
    return repr(shown(str(text), most))


def excerpt(text: str, position: int, most: int = 60) -> str:
    """The part of a text around a position in quotation marks, with dots where something is left
    out.

    >>> print(excerpt("a + b + c + d + e", 8, most=9))
    '...b + c + d...'
    """
    start = min(max(position - most // 2, 0), max(len(text) - most, 0))
    part = shown(text[start : start + most], 5 * most)
    return repr(f"{'...' if start else ''}{part}{'...' if start + most < len(text) else ''}")


def shown_path(path: object) -> str:
    """A path as a terminal can show it; whole, because the next command may be given it."""
    return shown(str(path), 5 * MAX_MESSAGE)


class PtmcadError(Exception):
    """Base of every exception that ptmcad raises on purpose."""

    def __str__(self) -> str:
        return shown(super().__str__())


class PtmcadWarning(UserWarning):
    """Something went wrong that the answer does not suffer from; the command line prints it as a
    line.
    """


class Place(NamedTuple):
    """Where something stands: file, line (from 1) and dotted key path, or an option; each may be
    unknown.

    Guarantee: every message about a record, an option or an argument names its place by this class
    alone.

    >>> print(Place("axes", "a.yaml").below("rho", 3))
    a.yaml:3: axes.rho
    """

    key: str | None = None
    file: str | None = None
    line: int | None = None

    def __str__(self) -> str:
        file = "" if self.file is None else shown(self.file, _MAX_PLACE)
        if self.file is not None and self.line is not None:
            file = f"{file}:{self.line}"
        key = "" if self.key is None else shown(self.key, _MAX_PLACE)
        return ": ".join(filter(None, (file, key)))

    def below(self, key: str, line: int | None = None) -> Place:
        """The place of an entry under this one."""
        path = key if self.key is None else f"{self.key}.{key}"
        return Place(path, self.file, self.line if line is None else line)

    def error(self, message: str) -> ConfigError:
        """A `ConfigError` that names this place."""
        return ConfigError(message, **self._asdict())

    def read(self, text: str, read: Callable[[str], T]) -> T:
        """What is read of a text that stands here; of what is wrong with it the part that is meant
        is shown.
        """
        try:
            return read(text)
        except ExpressionError as error:
            at = error.position
            where = (
                ""
                if at is None or len(text) < 2
                else f" (character {at + 1} of {excerpt(text, at)})"
            )
            raise self.error(f"{error.message}{where}") from error


class ConfigError(PtmcadError):
    """The input is wrong.

    Parameters
    ----------
    message : what is wrong and, in the same sentence or the next, the remedy.
    key : dotted path of the offending key, such as ``axes.rho``, or the command-line option.
    file, line : where it stands, when it stands in a file.

    Attributes
    ----------
    place : the key, the file and the line.
    faults : this one, and the others that were found with it.
    """

    def __init__(
        self,
        message: str,
        *,
        key: str | None = None,
        file: str | None = None,
        line: int | None = None,
    ):
        self.message = message
        self.key, self.file, self.line = self.place = Place(key, file, line)
        self._others: tuple[ConfigError, ...] = ()
        super().__init__(message)

    @classmethod
    def of(cls, faults: Iterable[ConfigError]) -> ConfigError:
        """The first of some faults, which knows the others; there has to be one."""
        first, *others = (fault for error in faults for fault in error.faults)
        first._others = tuple(others)
        return first

    @property
    def faults(self) -> tuple[ConfigError, ...]:
        return (self, *self._others)

    def __str__(self) -> str:
        place = str(self.place)
        return shown(f"{place}: {self.message}" if place else self.message)


@contextmanager
def blamed(key: str | None = None, file: object = None, line: int | None = None) -> Iterator[None]:
    """Say what is wrong inside of an option, or of a place in a file; the error keeps its own
    option where none is given, and has none where that is empty.
    """
    try:
        yield
    except ConfigError as error:
        place = Place(error.key if key is None else key, None if file is None else str(file), line)
        raise place.error(error.message) from error


def expect(value: object, kinds: type | tuple[type, ...], key: str, expected: str) -> None:
    """Refuse an argument of another kind than is expected.

    Raises
    ------
    ConfigError
        With the argument's name as the key.

    >>> expect(3, str, "along", "an axis of the slice")
    Traceback (most recent call last):
        ...
    ptmcad.errors.ConfigError: along: expected an axis of the slice, not 3
    """
    if not isinstance(value, kinds):
        small = value is None or isinstance(value, str | bytes | int | float)
        given = shown(repr(value), 60) if small else f"an object of type {type(value).__name__}"
        raise ConfigError(f"expected {expected}, not {given}", key=key)


A_SLICE = "a slice, as ptmcad.load(FILE) or ptmcad.slice_from_mapping({...}) returns"
A_RECORD = "the file of a record, or a mapping like a record"
A_MAP = "a map, as ptmcad.classify(...) returns"
A_MODEL = (
    "a mechanism or a system, as ptmcad.Mechanism(...), ptmcad.System(...) or the model of a slice"
)


class Faults:
    """Everything that is wrong with a record: a `ConfigError` in a ``with`` block is noted, and
    work goes on behind it.

    Guarantee: no fault is there twice. After `MAX_FAULTS` nothing more is looked for, and those are
    raised.

    >>> faults = Faults()
    >>> for key in ("a", "b"):
    ...     with faults:
    ...         raise ConfigError("is wrong", key=key)
    >>> [fault.key for fault in faults.found]
    ['a', 'b']
    """

    def __init__(self) -> None:
        self.found: list[ConfigError] = []

    def __enter__(self) -> None: ...

    def __exit__(
        self,
        _kind: type[BaseException] | None,
        error: BaseException | None,
        _trace: TracebackType | None,
    ) -> bool:
        if not isinstance(error, ConfigError) or len(self.found) >= MAX_FAULTS:
            return False
        known = {(fault.place, fault.message) for fault in self.found}
        self.found += [fault for fault in error.faults if (fault.place, fault.message) not in known]
        if len(self.found) >= MAX_FAULTS:
            self.check()
        return True

    @property
    def steps(self) -> list[list[str]]:
        """The keys of what is wrong, each as its steps."""
        return [(fault.key or "").split(".") for fault in self.found]

    @property
    def parts(self) -> frozenset[str]:
        """The first steps of these: the parts of a record, or of a description, in which something
        is wrong.
        """
        return frozenset(step for step, *_ in self.steps)

    def concern(self, key: str) -> bool:
        """Whether something is wrong at a key, or below it."""
        sought = key.split(".")
        return any(steps[: len(sought)] == sought for steps in self.steps)

    def check(self) -> None:
        """Raise what was found, if anything was.

        Raises
        ------
        ConfigError
            The first fault, in the order of the files' lines; it knows the others.
        """
        if self.found:
            files = [fault.file for fault in self.found]
            found = sorted(self.found, key=lambda fault: (files.index(fault.file), fault.line or 0))
            raise ConfigError.of([fault.place.error(fault.message) for fault in found])


class ExpressionError(PtmcadError):
    """A text is not an arithmetic expression in the known names, or exceeds a limit.

    Parameters
    ----------
    message : what is wrong, with the remedy.
    position : index of the offending character in the text, where there is one.
    """

    def __init__(self, message: str, position: int | None = None):
        self.message = message
        self.position = position
        super().__init__(message)

    def __str__(self) -> str:
        return shown(
            self.message
            if self.position is None
            else f"{self.message} (at column {self.position + 1})"
        )


class PoleError(ExpressionError):
    """The denominator of an expression vanishes at the point where its value was asked for."""


class HypothesisError(PtmcadError):
    """A hypothesis of the method is violated; the message names a witness.

    Attributes
    ----------
    parameter : which one it is; empty where it is none.
    part : the key of what it is else in the model's description, such as ``springs.2``; empty where
        it is nothing.
    """

    def __init__(self, message: str, parameter: str = "", part: str = ""):
        self.parameter = parameter
        self.part = part
        super().__init__(message)


class DegenerateSliceError(HypothesisError):
    """Every point of the slice lies on the discriminant variety."""


class NothingToCountError(DegenerateSliceError):
    """Off some curves of the slice there is no solution, real or complex, or inequalities exclude
    all.
    """


class InfiniteSolutionsError(HypothesisError):
    """Every point of the slice has infinitely many equilibria."""


class GeometryError(HypothesisError):
    """A length or stiffness is not positive at some point of the window, or it could not be proved
    to be.
    """


class OutputError(PtmcadError):
    """A result could not be written."""


class PictureError(OutputError):
    """A picture could not be drawn."""


class LimitReached(PtmcadError):
    """A limit that the caller set stopped the computation.

    Parameters
    ----------
    message : which limit, and how far the computation got.
    partial : the result so far, marked as partial (a `RegionMap`), or None when there is nothing to
        save.
    """

    def __init__(self, message: str, partial: object | None = None):
        self.partial = partial
        super().__init__(message)
