"""What the readers of descriptions share: shapes, names and expressions, each fault a `ConfigError` with its key.

Guarantee: an expression that leaves here has a value in every ring (`ptmcad.mechanism.evaluate`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import Enum
from fractions import Fraction
from typing import Any, TypeVar

from ptmcad.errors import ConfigError, ExpressionError, Faults, excerpt, quoted
from ptmcad.mechanism.angles import PI, split_angle, without_quarter_turns
from ptmcad.mechanism.description import Kind, Parameter, UnknownKind
from ptmcad.mechanism.evaluate import evaluate, value_at
from ptmcad.mechanism.sizes import size_of
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
MAX_ENTRIES = 400
"""Of any list or mapping in a description, so that what is read is read, and proved, in a fraction of a second."""
PARAMETER_KEYS = ("kind", "default", "range", "alias")
_EXPRESSIONS = ": what depends on other parameters is written under the record's 'parameters:'"
_UNSET = frozenset({Kind.FREE_LENGTH, Kind.FORCE, Kind.ANGLE})
"""Kinds that are zero where nothing is said."""
_Member = TypeVar("_Member", bound=Enum)
_T = TypeVar("_T")


# ------------------------------------------------------------------------------------------------------------ shapes


def mapping(value: object, key: str, most: int = MAX_ENTRIES, like: str = "") -> Mapping[str, Any]:
    """A mapping of at most so many entries.

    Parameters
    ----------
    like : an example for the message.
    """
    if not isinstance(value, Mapping):
        raise ConfigError(f"expected a mapping{like and f', such as {like}'}", key=key)
    _check_size(len(value), key, most)
    return value


def listed(value: object, key: str, like: str = "") -> Sequence[Any]:
    """A list of at most `MAX_ENTRIES` entries; ``like`` is an example for the message."""
    if not isinstance(value, list | tuple):
        raise ConfigError(f"expected a list{like and f', such as {like}'}", key=key)
    _check_size(len(value), key, MAX_ENTRIES)
    return value


def as_written(value: object) -> str:
    """What a value is, for messages: a text in quotation marks, or the kind of what is none."""
    if value is None:
        return "an empty value"
    if isinstance(value, bool):
        return f"the yes-or-no value '{str(value).lower()}'"
    if isinstance(value, list | tuple):
        return "a list"
    return "a mapping" if isinstance(value, Mapping) else quoted(value) if isinstance(value, str) else f"{value!r:.60}"


def _check_size(size: int, key: str, most: int) -> None:
    if size > most:
        raise ConfigError(f"{size} entries, more than the {most} that can be computed with", key=key)


def check_keys(entries: Mapping[str, Any], known: Sequence[str], key: str, faults: Faults) -> None:
    """Note every key that is not known."""
    for found in entries:
        if found not in known:
            hint = did_you_mean(str(found), known) or f"; the keys are {', '.join(known)}"
            with faults:
                raise ConfigError(f"unknown key{hint}", key=f"{key}.{found}" if key else str(found))


def faulty_entries(faults: Faults, part: str) -> frozenset[str]:
    """The entries of a part of a description of which something is noted."""
    keys = ((fault.key or "").split(".") for fault in faults.found)
    return frozenset(steps[1] for steps in keys if len(steps) > 1 and steps[0] == part)


def member(kinds: type[_Member], word: object, key: str) -> _Member:
    """The member of an enumeration that a word stands for."""
    for kind in kinds:
        if kind.value == word:
            return kind
    known = ", ".join(str(kind.value) for kind in kinds)
    raise ConfigError(f"{as_written(word)} is none of {known}{did_you_mean(str(word), known.split(', '))}", key=key)


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


def ends(value: object, key: str, points: Mapping[str, object]) -> tuple[str, str]:
    """The names of two different points."""
    pair = listed(value, key, "[A1, A3]")
    if len(pair) != 2:
        raise ConfigError("expected two points, such as [A1, A3]", key=key)
    start, end = (point_name(name, key, points) for name in pair)
    if start == end:
        raise ConfigError(f"both ends are {start}", key=key)
    return start, end


# ------------------------------------------------------------------------------------------- parameters and unknowns


def parameters_of(entries: Mapping[str, Any], faults: Faults) -> dict[str, Parameter]:
    """The parameters of a record; one that is faulty is there as a number."""
    found: dict[str, Parameter] = {}
    for name, entry in entries.items():
        key = f"parameters.{name}"
        with faults:
            new_name(name, key, found)
            found[name] = Parameter(name, Kind.NUMBER, "", None)
            fields = mapping(entry, key, like="{kind: length, default: 1}, or {} for a number")
            check_keys(fields, PARAMETER_KEYS, key, faults)
            kind = member(Kind, fields.get("kind", Kind.NUMBER.value), f"{key}.kind")
            default = "0" if kind in _UNSET else ""
            if "default" in fields:
                default = constant(fields["default"], f"{key}.default", _EXPRESSIONS)
            found[name] = Parameter(name, kind, default, _window(fields, f"{key}.range"))
            for n, alias in enumerate(listed(fields.get("alias", ()), f"{key}.alias", "[k1, k2]"), 1):
                with faults:
                    new_name(alias, f"{key}.alias.{n}", {})
                    if alias in entries:
                        raise ConfigError(f"'{alias}' is a parameter of its own: leave one out", key=f"{key}.alias.{n}")
                    new_name(alias, f"{key}.alias.{n}", found)
                    found[alias] = Parameter(alias, kind, name, found[name].window, name)
    return {name: p for last in (False, True) for name, p in found.items() if (p.kind is Kind.FREE_LENGTH) is last}


def _window(fields: Mapping[str, Any], key: str) -> tuple[str, str] | None:
    if "range" not in fields:
        return None
    window = listed(fields["range"], key, "[0, 2]")
    if len(window) != 2:
        raise ConfigError("expected a range such as [0, 2]", key=key)
    low, high = (constant(end, f"{key}.{n}") for n, end in enumerate(window, 1))
    if value_at(parse(low), {}) >= value_at(parse(high), {}):
        raise ConfigError(f"the range is reversed or empty: {low} to {high}", key=key)
    return low, high


def unknowns_of(value: object, taken: Mapping[str, object], faults: Faults) -> dict[str, UnknownKind]:
    """The unknowns of a record."""
    found: dict[str, UnknownKind] = {}
    entries = mapping(value, "unknowns", MAX_UNKNOWNS, "{th: angle, x: real}")
    if not entries:
        raise ConfigError("there is none", key="unknowns")
    for name, kind in entries.items():
        with faults:
            new_name(name, f"unknowns.{name}", taken)
            found[name] = UnknownKind.ANGLE  # known, whatever is wrong with it
            found[name] = member(UnknownKind, kind, f"unknowns.{name}")
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

    def tree(self, value: object, key: str, *, moving: bool = False) -> Tree:
        """An expression in the parameters, and in the unknowns where it may move."""
        tree = parsed(value, key)
        return located(lambda: self._without_offsets(tree, self.moving if moving else self.fixed), value, key)

    @staticmethod
    def _without_offsets(tree: Tree, names: _Names) -> Tree:
        """The tree with quarter turns in cosines and sines worked out, once it was found to have a value."""
        turned = without_quarter_turns(tree)
        evaluate(turned, names)
        size_of(turned)
        return turned

    def pair(
        self, value: object, key: str, *, moving: bool = False, what: str = "coordinates", like: str = "[rho, 0]"
    ) -> tuple[Tree, Tree]:
        """Two coordinates or components; what they are, and an example, are for messages."""
        pair = listed(value, key, like)
        if len(pair) != 2:
            raise ConfigError(f"expected two {what}, such as {like}", key=key)
        return self.tree(pair[0], f"{key}.1", moving=moving), self.tree(pair[1], f"{key}.2", moving=moving)

    def angle(self, value: object, key: str) -> tuple[Tree, int]:
        """A sum of whole multiples of unknown angles, and the quarter turns that are added to it."""
        tree = parsed(value, key)

        def read() -> tuple[Tree, int]:
            angle, turns = split_angle(tree)
            evaluate(Call("cos", angle), self.moving)
            return angle, turns

        return located(read, value, key)

    def symmetry(self, value: object, key: str) -> dict[str, Tree]:
        """A substitution; angles stand in it as they are."""
        trees = {}
        for name, image in mapping(value, key).items():
            tree = parsed(image, f"{key}.{name}")
            for used in (name, *names_of(tree)):
                if used not in self.names:
                    raise ConfigError(f"unknown name '{used}'{did_you_mean(used, self.names)}", key=f"{key}.{name}")
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


def parsed(value: object, key: str) -> Tree:
    """A text or an exact number as a tree."""
    if isinstance(value, str):
        return located(lambda: parse(value), value, key)
    if isinstance(value, bool) or not isinstance(value, int | Fraction):
        raise ConfigError(f"{as_written(value)} is neither an exact number nor an expression as text", key=key)
    number = Number(abs(Fraction(value)), int(value < 0))  # where it stands in the number's text, which is read alike
    return Negative(number) if value < 0 else number


def located(work: Callable[[], _T], text: object, key: str) -> _T:
    """What the work returns; its `ExpressionError` as one that names the key."""
    try:
        return work()
    except ExpressionError as error:
        at = error.position
        where = "" if at is None else f" (character {at + 1} of {excerpt(str(text), at)})"
        raise ConfigError(f"{error.message}{where}", key=key) from None


def constant(value: object, key: str, instead: str = "") -> str:
    """A number as text; ``instead`` says where expressions are written."""
    tree = parsed(value, key)
    if names_of(tree):
        raise ConfigError(f"expected a number, not an expression in {names_of(tree)[0]}{instead}", key=key)
    located(lambda: value_at(tree, {}), value, key)
    return text_of(tree)
