"""What the readers of descriptions share: shapes, names and expressions, each fault a `ConfigError`
with its key.

Guarantee: an expression that leaves here has a value in every ring (`ptmcad.model.evaluate`).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any, TypeVar

from ptmcad.errors import ConfigError, ExpressionError, Faults, quoted
from ptmcad.model.elements import Kind, Parameter, UnknownKind
from ptmcad.model.evaluate import evaluate, value_at
from ptmcad.model.termbounds import KnownNames
from ptmcad.model.trees import PI, ZERO, split_angle, without_quarter_turns
from ptmcad.text.codec import Codec, Key, choice, part, reading, record
from ptmcad.text.entry import Scalar, as_written
from ptmcad.text.node import MAX_ENTRIES, Node
from ptmcad.text.numerals import FINITE
from ptmcad.text.syntax import NAME, NOT_NUMBERS, did_you_mean, parse
from ptmcad.text.tree import FUNCTIONS, Call, Tree, names_of
from ptmcad.text.tree import to_text as text_of

MAX_NAME = 40
MAX_TITLE = 300
MAX_DEGREE = 64
"""Of a coordinate, stiffness, free length or force in the parameters and the cosines and sines."""
MAX_UNKNOWNS = 12
MAX_BODIES = 100
"""One may be at a point of another, whose coordinates then stand in its own."""
_EXPRESSIONS = ": what depends on other parameters is written under the record's 'parameters:'"
_UNSET = frozenset({Kind.FREE_LENGTH, Kind.FORCE, Kind.ANGLE})
"""Kinds that are zero where nothing is said."""
_T = TypeVar("_T")
VALUE, NUMBER, NAME_SCHEMA = ({"$ref": f"#/$defs/{name}"} for name in ("value", "number", "name"))
"""Schemas of a record's leaves: an expression, a number, and a name."""


def two(items: Mapping[str, str]) -> dict[str, Any]:
    """The schema of a list of two."""
    return {"type": "array", "minItems": 2, "maxItems": 2, "items": items}


def faulty_entries(faults: Faults, part: str) -> frozenset[str]:
    """The entries of a part of a description of which something is noted."""
    return frozenset(steps[1] for steps in faults.steps if len(steps) > 1 and steps[0] == part)


# ------------------------------------------------------------------------------------------------------------- names


def new_name(name: object, key: str, taken: Mapping[str, object]) -> str:
    """A name that nothing else has."""
    if not isinstance(name, str) or not NAME.fullmatch(name) or len(name) > MAX_NAME:
        raise ConfigError(
            f"{as_written(name)} is no name: use ASCII letters, digits and '_', starting with a letter",
            key=key,
        )
    if name in FUNCTIONS or name == PI or name.lower() in NOT_NUMBERS:
        infinite = f"; {FINITE}" if name.lower() in NOT_NUMBERS else ""
        raise ConfigError(
            f"'{name}' has a meaning of its own: choose another name{infinite}", key=key
        )
    if name in taken:
        raise ConfigError(f"the name '{name}' is given twice: choose another one", key=key)
    return name


def name_of(entry: Node) -> str:
    """A name that anything may have."""
    return new_name(entry.plain, entry.key, {})


def text_in(entry: Node, limit: int) -> str:
    """A text of at most so many characters."""
    if not isinstance(entry.value, Scalar) or entry.value.is_null:
        raise entry.fault("expected a text")
    if len(entry.value.text) > limit:
        raise entry.fault(f"the text is longer than {limit} characters")
    return entry.value.text


def title_in(entry: Node) -> str:
    """A title as one line: YAML's folded and literal texts end with a line break."""
    line = " ".join(text_in(entry, MAX_TITLE).split())
    if not line.isprintable():
        hidden = next(c for c in line if not c.isprintable())
        raise entry.fault(
            f"the title has a character that cannot be printed, U+{ord(hidden):04X}: remove it"
        )
    return line


def _title(entry: Node) -> str:
    """The title of a description, which is no number."""
    if not isinstance(entry.plain, str):
        raise entry.fault(f"{as_written(entry.plain)} is no text")
    return title_in(entry)


# ------------------------------------------------------------------------------------------- parameters and unknowns


def _window(entry: Node) -> tuple[str, str]:
    low, high = (constant(end) for end in entry.pair("a range", "[0, 2]"))
    if value_at(parse(low), {}) >= value_at(parse(high), {}):
        raise entry.fault(f"the range is reversed or empty: {low} to {high}")
    return low, high


_PARAMETER: Codec[dict[str, Any]] = record(
    dict, "{kind: length, default: 1}, or {} for a number",
    kind=part(choice(Kind), default=Kind.NUMBER, shown=Kind.NUMBER.value),
    default=part(reading(lambda entry: constant(entry, _EXPRESSIONS), **NUMBER), default=""),
    range=part(reading(_window, **two(NUMBER)), "What --slice takes for it.", None),
    alias=part(
        reading(lambda entry: entry.items(like="[k1, k2]"), type="array", maxItems=MAX_ENTRIES, items=NAME_SCHEMA),
        "Parameters for which this one stands where they are not given.", (),
    ),
)  # fmt: skip
_UNKNOWN = choice(UnknownKind)


def by_names(entry: Mapping[str, Any], most: int) -> dict[str, Any]:
    """The schema of several of the same by names that are given here."""
    return {
        "type": "object",
        "maxProperties": most,
        "propertyNames": NAME_SCHEMA,
        "additionalProperties": entry,
    }


DEFINITIONS: dict[str, Mapping[str, Any]] = {
    "parameter": _PARAMETER.schema,
    "parameters": {
        **by_names({"$ref": "#/$defs/parameter"}, MAX_ENTRIES),
        "description": "Names to what they measure, defaults and usual ranges. Something has to use each: the "
        "description, or an expression under the record's parameters.",
    },
    "unknowns": {
        **by_names(_UNKNOWN.schema, MAX_UNKNOWNS), "minProperties": 1,
        "description": f"Names to where they live: {'; '.join(f'{kind.value} {kind.where}' for kind in UnknownKind)}.",
    },
}  # fmt: skip
"""Schemas of what mechanisms and systems have."""

POINTS = by_names(two(VALUE), MAX_ENTRIES)


class Context:
    """What has been read of a description, to which its further parts refer; their codecs, of
    mappings as of keys.

    Attributes
    ----------
    points : any name may be one's until they are known, or where what lists them is missing or
        faulty.
    second : names of angles that follow from unknown ones.
    """

    def __init__(self, faults: Faults, second: Sequence[str] = ()):
        self.faults = faults
        self.second = second
        self.parameters: dict[str, Parameter] = {}
        self.unknowns: dict[str, UnknownKind] = {}
        self.points: dict[str, tuple[Tree, Tree]] = defaultdict(lambda: (ZERO, ZERO))

    @cached_property
    def fixed(self) -> KnownNames:
        """The names of which what no unknown moves is made, once parameters and unknowns are read."""
        return KnownNames(self.parameters, (), (*self.unknowns, *self.second), self._doubtful)

    @cached_property
    def moving(self) -> KnownNames:
        """The names of which what unknowns move is made."""
        angles = [name for name, kind in self.unknowns.items() if kind.turns]
        lengths = [name for name in self.unknowns if name not in angles or name in self._doubtful]
        return KnownNames((*self.parameters, *lengths), (*angles, *self.second), (), self._doubtful)

    @property
    def _doubtful(self) -> frozenset[str]:
        """Unknowns that are faulty themselves: they may stand anywhere."""
        return faulty_entries(self.faults, "unknowns")

    def parameters_of(self, node: Node) -> dict[str, Parameter]:
        """The parameters; one that is faulty is there as a number."""
        entries, found = node.mapping(), dict[str, Parameter]()

        def read(entry: Node) -> None:
            name = new_name(entry.name, entry.key, found)
            found[name] = Parameter(name, Kind.NUMBER, "", None)
            said = _PARAMETER.read(entry)
            kind, default = said["kind"], said["default"]
            if not default and kind in _UNSET:
                default = "0"
            found[name] = Parameter(name, kind, default, said["range"])
            for alias in said["alias"]:
                with self.faults:
                    other = name_of(alias)
                    if other in entries:
                        raise alias.fault(f"'{other}' is a parameter of its own: leave one out")
                    new_name(other, alias.key, found)
                    found[other] = Parameter(other, kind, name, found[name].window, name)

        node.gathered(read, entries.values())
        ordered = sorted(found.items(), key=lambda item: item[1].kind is Kind.FREE_LENGTH)
        self.parameters = dict(ordered)
        return self.parameters

    def add(self, name: str) -> None:
        """Take a name for a parameter, of which nothing else is said."""
        self.parameters[name] = Parameter(name, Kind.NUMBER, "", None)
        self.moving.constants[name] = None

    def unknowns_of(self, node: Node) -> dict[str, UnknownKind]:
        """The unknowns; one that is faulty is there as an angle."""

        def read(entry: Node) -> None:
            new_name(entry.name, entry.key, self.parameters)
            self.unknowns[entry.name] = UnknownKind.ANGLE
            self.unknowns[entry.name] = _UNKNOWN.read(entry)

        entries = node.mapping(MAX_UNKNOWNS, "{th: angle, x: real}")
        if not entries:
            raise node.fault("there is none")
        node.gathered(read, entries.values())
        return self.unknowns

    def start(self, name: str, parameters: str = "") -> dict[str, Key]:
        """The keys with which every description begins.

        Parameters
        ----------
        name : that it has by default.
        parameters : what these are, where it is not what they mostly are.
        """
        known, unknown = ({"$ref": f"#/$defs/{key}"} for key in ("parameters", "unknowns"))
        return {
            "name": part(reading(name_of, **NAME_SCHEMA), "A name of its own.", name, shown=name),
            "title": part(
                reading(_title, type="string", maxLength=MAX_TITLE),
                "What the report calls it, by default its name.", "",
            ),
            "parameters": part(reading(self.parameters_of, **known), parameters, {}),
            "unknowns": part(reading(self.unknowns_of, **unknown), instead={}),
        }  # fmt: skip

    def known_point(self, entry: Node, name: object) -> str:
        """The name of a point that there is, or of one that there may be."""
        points = self.points
        if isinstance(name, str) and (name in points or isinstance(points, defaultdict)):
            return name
        known = f"; the points are {', '.join(points)}" if points else ": there are no points"
        if isinstance(name, str) and points:
            raise entry.fault(
                f"there is no point {quoted(name)}{did_you_mean(name, points) or known}"
            )
        raise entry.fault(f"{as_written(name)} is no point's name{known}")

    def known_unknown(self, entry: Node, name: str) -> str:
        """The name of an unknown that there is."""
        if name not in self.unknowns:
            hint = did_you_mean(name, self.unknowns, "; they are ")
            raise entry.fault(f"there is no unknown {quoted(name)}{hint}")
        return name

    def value(self, moving: bool = False) -> Codec[Tree]:
        """The codec of an expression in the parameters, and in the unknowns where it may move."""
        return reading(lambda entry: self.tree(entry, moving), **VALUE)

    def between(self) -> Codec[tuple[str, str]]:
        """Two points that there are."""
        return reading(self._ends, **two(NAME_SCHEMA), description="Two points.")

    def _ends(self, entry: Node) -> tuple[str, str]:
        """The names of two different points."""
        start, end = (
            self.known_point(entry, end.plain) for end in entry.pair("two points", "[A1, A3]")
        )
        if start == end:
            raise entry.fault(f"both ends are {start}")
        return start, end

    # ------------------------------------------------------------------------------------------------- expressions

    def tree(self, entry: Node, moving: bool = False) -> Tree:
        """An expression in the parameters, and in the unknowns where it may move.

        Quarter turns in cosines and sines are worked out, once it was found to have a value.
        """
        tree = parsed(entry)

        def read() -> Tree:
            turned = without_quarter_turns(tree)
            if evaluate(turned, self.moving if moving else self.fixed).degree > MAX_DEGREE:
                raise ExpressionError(f"the degree exceeds {MAX_DEGREE}")
            return turned

        return located(read, entry)

    def pair(
        self, entry: Node, moving: bool = False, what: str = "coordinates", like: str = "[rho, 0]"
    ) -> tuple[Tree, Tree]:
        """Two coordinates or components; what they are, and an example, are for messages."""
        first, second = (self.tree(one, moving) for one in entry.pair(f"two {what}", like))
        return first, second

    def angle(self, entry: Node) -> tuple[Tree, int]:
        """A sum of whole multiples of unknown angles, and the quarter turns that are added to it."""
        tree = parsed(entry)

        def read() -> tuple[Tree, int]:
            angle, turns = split_angle(tree)
            evaluate(Call("cos", angle), self.moving)
            return angle, turns

        return located(read, entry)

    def symmetry(self, entry: Node) -> dict[str, Tree]:
        """A substitution; angles stand in it as they are."""
        names, trees = {**self.parameters, **self.unknowns}, {}
        for name, image in entry.mapping().items():
            trees[name] = parsed(image)
            for used in (name, *names_of(trees[name])):
                if used not in names:
                    raise image.fault(f"unknown name '{used}'{did_you_mean(used, names)}")
        return trees


def parsed(entry: Node) -> Tree:
    """A text or an exact number as a tree."""
    value = entry.plain
    if isinstance(value, bool) or not isinstance(value, int | str):
        raise entry.fault(
            f"{as_written(value)} is neither an exact number nor an expression as text"
        )
    found: Tree = entry.place.read(str(value), parse)
    return found


def located(work: Callable[[], _T], entry: Node) -> _T:
    """What the work returns; its `ExpressionError` as one that names the entry."""
    found: _T = entry.place.read(str(entry.plain), lambda _: work())
    return found


def constant(entry: Node, instead: str = "") -> str:
    """A number as text; ``instead`` says where expressions are written."""
    tree = parsed(entry)
    if names := names_of(tree):
        raise entry.fault(f"expected a number, not an expression in {names[0]}{instead}")
    located(lambda: value_at(tree, {}), entry)
    return text_of(tree)
