"""A mechanism's description read from a record: a mapping of texts, numbers, lists and mappings, as YAML gives it.

Guarantee: what is wrong is a `ConfigError` with its key; what `described` returns is consistent, see `description`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import Enum
from fractions import Fraction
from typing import Any, TypeVar

from ptmcad.errors import ConfigError, ExpressionError
from ptmcad.mechanism.description import Kind, Load, Mechanism, Parameter, Spring, Support, System, UnknownKind
from ptmcad.mechanism.evaluate import evaluate
from ptmcad.text.syntax import NAME, NOT_NUMBERS, did_you_mean, parse
from ptmcad.text.tree import FUNCTIONS, Name, Negative, Number, Tree, names_of, to_text

MAX_NAME = 40
MAX_DEGREE = 64
"""Of a coordinate, stiffness, free length or force in the parameters and the cosines and sines."""
SYSTEM_KEYS = ("name", "parameters", "unknowns", "equations", "potential", "positive", "stable")
KEYS = ("name", "parameters", "unknowns", "points", "bars", "supports", "springs", "loads", "symmetries")
_PARAMETER_KEYS = ("kind", "default", "range", "alias")
_SPRING_KEYS = ("between", "k", "free")
_ZERO = Number(Fraction(0))
_UNSET = frozenset({Kind.FREE_LENGTH, Kind.FORCE, Kind.ANGLE})
"""Kinds that are zero where nothing is said."""
_Member = TypeVar("_Member", bound=Enum)
_T = TypeVar("_T")


def described(record: Mapping[str, Any]) -> Mechanism:
    """The mechanism of a record, which is a mapping as YAML gives it: texts, integers, lists and mappings.

    Raises
    ------
    ConfigError
        With the key of what is wrong: an unknown key, kind, name or point, a name that is given twice, a text that is
        no expression, or one that has no value in every ring.
    """
    _check_keys(record, KEYS, "")
    for key in ("name", "parameters", "unknowns", "points"):
        if key not in record:
            raise ConfigError("is missing", key=key)
    parameters = _parameters(_mapping(record["parameters"], "parameters"))
    unknowns = {
        _new_name(name, f"unknowns.{name}", parameters): _member(UnknownKind, kind, f"unknowns.{name}")
        for name, kind in _mapping(record["unknowns"], "unknowns").items()
    }
    reader = _Reader(parameters, unknowns)
    points = {
        _new_name(name, f"points.{name}", {}): reader.pair(pair, f"points.{name}", moving=True)
        for name, pair in _mapping(record["points"], "points").items()
    }
    bars = tuple(_ends(bar, f"bars.{n}", points) for n, bar in enumerate(_list(record.get("bars", ()), "bars"), 1))
    supports = {
        _point(name, f"supports.{name}", points): _member(Support, kind, f"supports.{name}")
        for name, kind in _mapping(record.get("supports", {}), "supports").items()
    }
    loads = tuple(
        Load(_point(name, f"loads.{name}", points), *reader.pair(force, f"loads.{name}"))
        for name, force in _mapping(record.get("loads", {}), "loads").items()
    )
    return Mechanism(
        _new_name(record["name"], "name", {}),
        parameters,
        unknowns,
        points,
        bars,
        supports,
        _springs(_list(record.get("springs", ()), "springs"), reader, points),
        loads,
        tuple(reader.symmetry(s, f"symmetries.{n}")
              for n, s in enumerate(_list(record.get("symmetries", ()), "symmetries"), 1)),
        source=record,
    )  # fmt: skip


def described_system(record: Mapping[str, Any], name: str = "system") -> System:
    """The parametric system of a record, which is a mapping as YAML gives it.

    Names that are no unknowns are its parameters; those that the record does not list are numbers without a default.

    Raises
    ------
    ConfigError
        With the key of what is wrong; also where there are not as many equations as unknowns, or where an unknown
        stands in no equation.
    """
    _check_keys(record, SYSTEM_KEYS, "")
    if "unknowns" not in record:
        raise ConfigError("is missing", key="unknowns")
    listed = _parameters(_mapping(record.get("parameters", {}), "parameters"), defaults=False)
    unknowns = {
        _new_name(name, f"unknowns.{name}", listed): _member(UnknownKind, kind, f"unknowns.{name}")
        for name, kind in _mapping(record["unknowns"], "unknowns").items()
    }
    if not unknowns:
        raise ConfigError("there is none", key="unknowns")
    if ("equations" in record) is ("potential" in record):
        raise ConfigError("give either equations or a potential", key="equations")
    trees = {
        key: [_tree(text, f"{key}.{n}") for n, text in enumerate(_list(record.get(key, ()), key), 1)]
        for key in ("equations", "positive", "stable")
    }
    potential = _tree(record["potential"], "potential") if "potential" in record else None
    every = [tree for some in trees.values() for tree in some] + ([] if potential is None else [potential])
    used = dict.fromkeys(name for tree in every for name in names_of(tree))
    parameters = dict(listed)
    for found in used:
        if found not in parameters and found not in unknowns:
            parameters[_new_name(found, found, {})] = Parameter(found, Kind.NUMBER, "", None)
    reader = _Reader(parameters, unknowns)
    for key, some in trees.items():
        for n, _ in enumerate(some, 1):
            reader.tree(record[key][n - 1], f"{key}.{n}", moving=True)
    if potential is not None:
        reader.tree(record["potential"], "potential", moving=True)
        if trees["stable"]:
            raise ConfigError("of a potential the Hessian decides what is stable: leave this out", key="stable")
    elif len(trees["equations"]) != len(unknowns):
        raise ConfigError(
            f"{len(trees['equations'])} equations for {len(unknowns)} unknowns: give as many as there are unknowns",
            key="equations",
        )
    for unknown in unknowns:
        if not any(unknown in names_of(tree) for tree in (trees["equations"] if potential is None else [potential])):
            raise ConfigError("no equation holds this unknown", key=f"unknowns.{unknown}")
    for parameter in listed:
        if parameter not in used and not any(listed[a].alias_of == parameter for a in listed):
            raise ConfigError("nothing uses this parameter", key=f"parameters.{parameter}")
    return System(
        _new_name(record.get("name", name), "name", {}),
        parameters,
        unknowns,
        tuple(trees["equations"]),
        potential,
        tuple(trees["positive"]),
        tuple(trees["stable"]),
        source=record,
    )


def _parameters(entries: Mapping[str, Any], *, defaults: bool = True) -> dict[str, Parameter]:
    """The parameters of a record; with ``defaults`` lengths, stiffnesses and numbers need one."""
    found: dict[str, Parameter] = {}
    for name, entry in entries.items():
        key = f"parameters.{name}"
        fields = _mapping(entry, key)
        _check_keys(fields, _PARAMETER_KEYS, key)
        kind = _member(Kind, fields.get("kind", Kind.NUMBER.value), f"{key}.kind")
        if defaults and "default" not in fields and kind not in _UNSET:
            raise ConfigError(f"has no default, which a {kind.noun} needs", key=key)
        default = _constant(fields.get("default", 0), f"{key}.default") if defaults or "default" in fields else ""
        window = None
        if "range" in fields:
            ends = _list(fields["range"], f"{key}.range")
            if len(ends) != 2:
                raise ConfigError("expected a range such as [0, 2]", key=f"{key}.range")
            window = (_constant(ends[0], f"{key}.range"), _constant(ends[1], f"{key}.range"))
        found[_new_name(name, key, found)] = Parameter(name, kind, default, window)
        for alias in _list(fields.get("alias", ()), f"{key}.alias"):
            if alias in entries:
                raise ConfigError(f"'{alias}' is a parameter of its own: leave one out", key=f"{key}.alias")
            found[_new_name(alias, f"{key}.alias", found)] = Parameter(alias, kind, name, window, name)
    return {name: p for last in (False, True) for name, p in found.items() if (p.kind is Kind.FREE_LENGTH) is last}


def _springs(entries: Sequence[Any], reader: _Reader, points: Mapping[str, object]) -> tuple[Spring, ...]:
    springs: dict[str, Spring] = {}
    for n, entry in enumerate(entries, 1):
        key = f"springs.{n}"
        fields = _mapping(entry, key)
        _check_keys(fields, _SPRING_KEYS, key)
        for needed in ("between", "k"):
            if needed not in fields:
                raise ConfigError("is missing", key=f"{key}.{needed}")
        start, end = _ends(fields["between"], f"{key}.between", points)
        stiffness = reader.tree(fields["k"], f"{key}.k")
        free = reader.tree(fields["free"], f"{key}.free") if "free" in fields else _ZERO
        name = stiffness.name if isinstance(stiffness, Name) else f"{start}{end}"
        if name in springs:
            name = f"{start}{end}"
        if name in springs:
            name = f"{start}{end}_{n}"
        springs[name] = Spring(name, start, end, stiffness, free)
    return tuple(springs.values())


class _Reader:
    """Reads trees, and refuses those without a value in every ring."""

    def __init__(self, parameters: Mapping[str, Parameter], unknowns: Mapping[str, UnknownKind]):
        lengths = [name for name, kind in unknowns.items() if kind is not UnknownKind.ANGLE]
        angles = [name for name, kind in unknowns.items() if kind is UnknownKind.ANGLE]
        self.fixed = _Names(parameters, (), unknowns)
        self.moving = _Names((*parameters, *lengths), angles, ())
        self.names = dict.fromkeys((*parameters, *unknowns))

    def tree(self, value: object, key: str, *, moving: bool = False) -> Tree:
        tree = _tree(value, key)
        _located(lambda: evaluate(tree, self.moving if moving else self.fixed), value, key)
        return tree

    def pair(self, value: object, key: str, *, moving: bool = False) -> tuple[Tree, Tree]:
        pair = _list(value, key)
        if len(pair) != 2:
            raise ConfigError("expected two coordinates, such as [rho, 0]", key=key)
        return self.tree(pair[0], f"{key}.1", moving=moving), self.tree(pair[1], f"{key}.2", moving=moving)

    def symmetry(self, value: object, key: str) -> dict[str, Tree]:
        """A substitution; angles stand in it as they are."""
        trees = {}
        for name, image in _mapping(value, key).items():
            tree = _tree(image, f"{key}.{name}")
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
    """

    def __init__(self, constants: Iterable[str], angles: Iterable[str], excluded: Iterable[str]):
        # dictionaries for their order and for fast look-up: a hostile record has thousands of names
        self.constants, self.angles, self.excluded = map(dict.fromkeys, (constants, angles, excluded))

    def constant(self, value: Fraction) -> _Degree:
        return _Degree(0)

    def parameter(self, name: str) -> _Degree:
        if name in self.angles:
            raise ExpressionError(f"{name} is an angle: it stands inside of cos or sin")
        self._check(name, self.constants)
        return _Degree(1)

    def cos(self, angle: str) -> _Degree:
        if angle in self.constants:
            raise ExpressionError(f"{angle} is not an unknown angle")
        self._check(angle, self.angles)
        return _Degree(1)

    sin = cos

    def _check(self, name: str, known: Mapping[str, None]) -> None:
        if name in self.excluded:
            raise ExpressionError(f"{name} is an unknown: only points may depend on it")
        if name not in known:
            hint = did_you_mean(name, self.constants | self.angles) or f"; the names are {', '.join(known)}"
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


def _tree(value: object, key: str) -> Tree:
    if isinstance(value, str):
        return _located(lambda: parse(value), value, key)
    if isinstance(value, bool) or not isinstance(value, int | Fraction):
        raise ConfigError(f"{value!r:.60} is neither an exact number nor an expression as text", key=key)
    number = Number(abs(Fraction(value)))
    return Negative(number) if value < 0 else number


def _located(work: Callable[[], _T], text: object, key: str) -> _T:
    """What the work returns; its `ExpressionError` as one that names the key."""
    try:
        return work()
    except ExpressionError as error:
        where = "" if error.position is None else f" (character {error.position + 1} of {str(text)!r:.60})"
        raise ConfigError(f"{error.message}{where}", key=key) from None


def _constant(value: object, key: str) -> str:
    """A number as text."""
    tree = _tree(value, key)
    if names_of(tree):
        raise ConfigError(f"expected a number, not an expression in {names_of(tree)[0]}", key=key)
    return to_text(tree)


def _new_name(name: object, key: str, taken: Mapping[str, object]) -> str:
    if not isinstance(name, str) or not NAME.fullmatch(name) or len(name) > MAX_NAME:
        raise ConfigError(f"{name!r:.60} is no name: use letters, digits and '_', starting with a letter", key=key)
    if name in FUNCTIONS or name.lower() in NOT_NUMBERS:
        raise ConfigError(f"'{name}' has a meaning of its own: choose another name", key=key)
    if name in taken:
        raise ConfigError(f"the name '{name}' is given twice: choose another one", key=key)
    return name


def _point(name: object, key: str, points: Mapping[str, object]) -> str:
    if not isinstance(name, str) or name not in points:
        hint = did_you_mean(str(name), points) or f"; the points are {', '.join(points)}"
        raise ConfigError(f"there is no point {name!r:.60}{hint}", key=key)
    return name


def _ends(value: object, key: str, points: Mapping[str, object]) -> tuple[str, str]:
    pair = _list(value, key)
    if len(pair) != 2:
        raise ConfigError("expected two points, such as [A1, A3]", key=key)
    start, end = (_point(name, key, points) for name in pair)
    if start == end:
        raise ConfigError(f"both ends are {start}", key=key)
    return start, end


def _member(kinds: type[_Member], word: object, key: str) -> _Member:
    for kind in kinds:
        if kind.value == word:
            return kind
    known = ", ".join(str(kind.value) for kind in kinds)
    raise ConfigError(f"{word!r:.60} is none of {known}{did_you_mean(str(word), known.split(', '))}", key=key)


def _mapping(value: object, key: str) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise ConfigError("expected a mapping", key=key)
    return value


def _list(value: object, key: str) -> Sequence[Any]:
    if not isinstance(value, list | tuple):
        raise ConfigError("expected a list", key=key)
    return value


def _check_keys(entries: Mapping[str, Any], known: tuple[str, ...], key: str) -> None:
    for found in entries:
        if found not in known:
            hint = did_you_mean(str(found), known) or f"; the keys are {', '.join(known)}"
            raise ConfigError(f"unknown key{hint}", key=f"{key}.{found}" if key else str(found))
