"""What the readers of descriptions share: shapes, names and expressions, each fault a `ConfigError` with its key.

Guarantee: an expression that leaves here has a value in every ring (`ptmcad.mechanism.evaluate`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import Enum
from fractions import Fraction
from typing import TypeVar

from ptmcad.errors import ConfigError, ExpressionError, Faults, quoted
from ptmcad.mechanism.angles import PI, split_angle, without_quarter_turns
from ptmcad.mechanism.description import Kind, Parameter, UnknownKind
from ptmcad.mechanism.evaluate import evaluate, value_at
from ptmcad.mechanism.sizes import size_of
from ptmcad.text.entry import Entry, as_written
from ptmcad.text.numerals import FINITE
from ptmcad.text.syntax import NAME, NOT_NUMBERS, did_you_mean, parse
from ptmcad.text.tree import FUNCTIONS, Call, Negative, Number, Tree, names_of
from ptmcad.text.tree import to_text as text_of

MAX_NAME = 40
MAX_TITLE = 300
MAX_DEGREE = 64
"""Of a coordinate, stiffness, free length or force in the parameters and the cosines and sines."""
MAX_UNKNOWNS = 12
MAX_BODIES = 100
"""One may be at a point of another, whose coordinates then stand in its own."""
PARAMETER_KEYS = ("kind", "default", "range", "alias")
_EXPRESSIONS = ": what depends on other parameters is written under the record's 'parameters:'"
_UNSET = frozenset({Kind.FREE_LENGTH, Kind.FORCE, Kind.ANGLE})
"""Kinds that are zero where nothing is said."""
_Member = TypeVar("_Member", bound=Enum)
_T = TypeVar("_T")


def faulty_entries(faults: Faults, part: str) -> frozenset[str]:
    """The entries of a part of a description of which something is noted."""
    keys = ((fault.key or "").split(".") for fault in faults.found)
    return frozenset(steps[1] for steps in keys if len(steps) > 1 and steps[0] == part)


def member(kinds: type[_Member], entry: Entry) -> _Member:
    """The member of an enumeration that a word stands for."""
    for kind in kinds:
        if kind.value == entry.value:
            return kind
    words = [str(kind.value) for kind in kinds]
    hint = did_you_mean(str(entry.value), words)
    raise entry.error(f"{as_written(entry.value)} is none of {', '.join(words)}{hint}")


# ------------------------------------------------------------------------------------------------------------- names


def new_name(name: object, key: str, taken: Mapping[str, object]) -> str:
    """A name that nothing else has."""
    if not isinstance(name, str) or not NAME.fullmatch(name) or len(name) > MAX_NAME:
        raise ConfigError(
            f"{as_written(name)} is no name: use ASCII letters, digits and '_', starting with a letter", key=key
        )
    if name in FUNCTIONS or name == PI or name.lower() in NOT_NUMBERS:
        infinite = f"; {FINITE}" if name.lower() in NOT_NUMBERS else ""
        raise ConfigError(f"'{name}' has a meaning of its own: choose another name{infinite}", key=key)
    if name in taken:
        raise ConfigError(f"the name '{name}' is given twice: choose another one", key=key)
    return name


def name_of(entry: Entry) -> str:
    """The name of what is described."""
    return new_name(entry.value, entry.key, {})


def title_of(title: object) -> str:
    """A title as one line: YAML's folded and literal texts end with a line break.

    Raises
    ------
    ConfigError
        For what is no text, or a long one, or one with a character that is not printed.
    """
    if not isinstance(title, str):
        raise ConfigError(f"{as_written(title)} is no text", key="title")
    if len(title) > MAX_TITLE:
        raise ConfigError(f"the text is longer than {MAX_TITLE} characters", key="title")
    line = " ".join(title.split())
    if not line.isprintable():
        hidden = next(c for c in line if not c.isprintable())
        raise ConfigError(
            f"the title has a character that cannot be printed, U+{ord(hidden):04X}: remove it", key="title"
        )
    return line


class Unread(dict[str, tuple[Tree, Tree]]):
    """Points of which nothing is known, because what lists them is missing or faulty: any name may be one's."""

    def __missing__(self, name: str) -> tuple[Tree, Tree]:
        return Number(Fraction(0)), Number(Fraction(0))


def point_name(name: object, key: str, points: Mapping[str, object]) -> str:
    """The name of a point that there is, or of one that there may be."""
    if isinstance(name, str) and isinstance(points, Unread):
        return name
    if not points and not isinstance(points, Unread):
        raise ConfigError(f"{as_written(name)} is no point's name: there are no points", key=key)
    if not isinstance(name, str):
        raise ConfigError(f"{as_written(name)} is no point's name; the points are {', '.join(points)}", key=key)
    if name not in points:
        hint = did_you_mean(str(name), points) or f"; the points are {', '.join(points)}"
        raise ConfigError(f"there is no point {quoted(name)}{hint}", key=key)
    return name


def ends(entry: Entry, points: Mapping[str, object]) -> tuple[str, str]:
    """The names of two different points."""
    start, end = (point_name(part.value, entry.key, points) for part in entry.pair("two points,", "[A1, A3]"))
    if start == end:
        raise entry.error(f"both ends are {start}")
    return start, end


# ------------------------------------------------------------------------------------------- parameters and unknowns


def parameters_of(record: Entry) -> dict[str, Parameter]:
    """The parameters of a record; one that is faulty is there as a number."""
    found: dict[str, Parameter] = {}
    entries = record.at("parameters", {}).entries()
    for name, entry in entries.items():
        with record.faults:
            new_name(name, entry.key, found)
            found[name] = Parameter(name, Kind.NUMBER, "", None)
            entry.entries(like="{kind: length, default: 1}, or {} for a number")
            fields = entry.fields(PARAMETER_KEYS)
            kind = member(Kind, fields.at("kind", Kind.NUMBER.value))
            default = constant(fields.at("default"), _EXPRESSIONS) if fields.has("default") else ""
            if not default and kind in _UNSET:
                default = "0"
            found[name] = Parameter(name, kind, default, _window(fields.at("range")) if fields.has("range") else None)
            for alias in fields.at("alias", ()).items("[k1, k2]"):
                with record.faults:
                    new_name(alias.value, alias.key, {})
                    if alias.value in entries:
                        raise alias.error(f"'{alias.value}' is a parameter of its own: leave one out")
                    new_name(alias.value, alias.key, found)
                    found[alias.value] = Parameter(alias.value, kind, name, found[name].window, name)
    return {name: p for last in (False, True) for name, p in found.items() if (p.kind is Kind.FREE_LENGTH) is last}


def _window(entry: Entry) -> tuple[str, str]:
    low, high = (constant(end) for end in entry.pair("a range", "[0, 2]"))
    if value_at(parse(low), {}) >= value_at(parse(high), {}):
        raise entry.error(f"the range is reversed or empty: {low} to {high}")
    return low, high


def unknowns_of(record: Entry, taken: Mapping[str, object]) -> dict[str, UnknownKind]:
    """The unknowns of a record."""
    found: dict[str, UnknownKind] = {}
    unknowns = record.at("unknowns")
    with record.faults:
        if not record.has("unknowns"):
            raise unknowns.error("is missing")
        entries = unknowns.entries("{th: angle, x: real}", MAX_UNKNOWNS)
        if not entries:
            raise unknowns.error("there is none")
        for name, entry in entries.items():
            with record.faults:
                new_name(name, entry.key, taken)
                found[name] = UnknownKind.ANGLE  # known, whatever is wrong with it
                found[name] = member(UnknownKind, entry)
    return found


# ------------------------------------------------------------------------------------------------------- expressions


class Reader:
    """Reads expressions, and refuses those without a value in every ring.

    Parameters
    ----------
    doubtful : names of unknowns that are faulty themselves: they may stand anywhere.
    second : names of angles that follow from unknown ones.
    """

    def __init__(
        self,
        parameters: Mapping[str, Parameter],
        unknowns: Mapping[str, UnknownKind],
        doubtful: frozenset[str] = frozenset(),
        second: Sequence[str] = (),
    ):
        lengths = [name for name, kind in unknowns.items() if kind is not UnknownKind.ANGLE or name in doubtful]
        angles = [name for name, kind in unknowns.items() if kind is UnknownKind.ANGLE]
        self.second = frozenset(second)
        self.excluded = frozenset((*unknowns, *second))
        self.fixed = _Names(parameters, (), (*unknowns, *second), doubtful)
        self.moving = _Names((*parameters, *lengths), (*angles, *second), (), doubtful)
        self.names = dict.fromkeys((*parameters, *unknowns))

    def tree(self, entry: Entry, *, moving: bool = False) -> Tree:
        """An expression in the parameters, and in the unknowns where it may move."""
        tree = parsed(entry)
        return located(lambda: self._without_offsets(tree, self.moving if moving else self.fixed), entry)

    @staticmethod
    def _without_offsets(tree: Tree, names: _Names) -> Tree:
        """The tree with quarter turns in cosines and sines worked out, once it was found to have a value."""
        turned = without_quarter_turns(tree)
        evaluate(turned, names)
        size_of(turned)
        return turned

    def pair(
        self, entry: Entry, *, moving: bool = False, what: str = "coordinates", like: str = "[rho, 0]"
    ) -> tuple[Tree, Tree]:
        """Two coordinates or components; what they are, and an example, are for messages."""
        first, second = (self.tree(part, moving=moving) for part in entry.pair(f"two {what},", like))
        return first, second

    def angle(self, entry: Entry) -> tuple[Tree, int]:
        """A sum of whole multiples of unknown angles, and the quarter turns that are added to it."""
        tree = parsed(entry)

        def read() -> tuple[Tree, int]:
            angle, turns = split_angle(tree)
            evaluate(Call("cos", angle), self.moving)
            return angle, turns

        return located(read, entry)

    def symmetry(self, entry: Entry) -> dict[str, Tree]:
        """A substitution; angles stand in it as they are."""
        trees = {}
        for name, image in entry.entries().items():
            tree = parsed(image)
            for used in (name, *names_of(tree)):
                if used not in self.names:
                    raise image.error(f"unknown name '{used}'{did_you_mean(used, self.names)}")
            trees[name] = tree
        return trees


class _Names:
    """The ring in which only names and degrees count.

    Parameters
    ----------
    constants : parameters, and unknowns on the line where they may stand.
    angles : that may stand in cosines and sines.
    excluded : unknowns that may not occur.
    doubtful : unknowns of which nothing more is said.
    """

    def __init__(
        self, constants: Iterable[str], angles: Iterable[str], excluded: Iterable[str], doubtful: frozenset[str]
    ):
        # dictionaries for their order and for fast look-up: a hostile record has thousands of names
        self.constants, self.angles, self.excluded = map(dict.fromkeys, (constants, angles, excluded))
        self.doubtful = doubtful

    def constant(self, value: Fraction) -> _Degree:
        return _Degree(0)

    def parameter(self, name: str) -> _Degree:
        if name in self.angles and name not in self.doubtful:
            raise ExpressionError(f"{name} is an angle: it stands inside of cos or sin")
        self._check(name, self.constants)
        return _Degree(1)

    def cos(self, angle: str) -> _Degree:
        if angle in self.constants and angle not in self.doubtful:
            # of a rational angle neither is rational, so that no axis could be one
            raise ExpressionError(
                f"{angle} is not an unknown angle: for the cosine and sine of a fixed one use two parameters, given as "
                "(1 - t^2)/(1 + t^2) and 2*t/(1 + t^2), t the tangent of its half"
            )
        self._check(angle, self.angles)
        return _Degree(1)

    sin = cos

    def _check(self, name: str, known: Mapping[str, None]) -> None:
        if name in self.doubtful:
            return
        if name in self.excluded:
            raise ExpressionError(f"{name} is an unknown: only points may depend on it")
        if name == PI:
            raise ExpressionError(f"pi is no rational number: name a parameter in its place{did_you_mean(name, ())}")
        if name not in known:
            hint = did_you_mean(name, self.constants | self.angles) or (
                f"; the names are {', '.join(known)}" if known else "; no name is known here"
            )
            raise ExpressionError(f"unknown name '{name[:MAX_NAME]}'{hint}")


class _Degree:
    """What is known of an element: a bound of its degree."""

    __slots__ = ("bound",)

    def __init__(self, bound: int):
        self.bound = bound

    def __add__(self, other: _Degree) -> _Degree:
        return self if self.bound >= other.bound else other

    __sub__ = __add__

    def __mul__(self, other: _Degree) -> _Degree:
        if self.bound + other.bound > MAX_DEGREE:
            raise ExpressionError(f"the degree exceeds {MAX_DEGREE}")
        return _Degree(self.bound + other.bound)


def parsed(entry: Entry) -> Tree:
    """A text or an exact number as a tree."""
    value = entry.value
    if isinstance(value, str):
        return located(lambda: parse(value), entry)
    if isinstance(value, bool) or not isinstance(value, int | Fraction):
        raise entry.error(f"{as_written(value)} is neither an exact number nor an expression as text")
    number = Number(abs(Fraction(value)), int(value < 0))  # where it stands in the number's text, which is read alike
    return Negative(number) if value < 0 else number


def located(work: Callable[[], _T], entry: Entry) -> _T:
    """What the work returns; its `ExpressionError` as one that names the entry."""
    try:
        return work()
    except ExpressionError as error:
        raise entry.place.located(error, str(entry.value)) from None


def constant(entry: Entry, instead: str = "") -> str:
    """A number as text; ``instead`` says where expressions are written."""
    tree = parsed(entry)
    if names := names_of(tree):
        raise entry.error(f"expected a number, not an expression in {names[0]}{instead}")
    located(lambda: value_at(tree, {}), entry)
    return text_of(tree)
