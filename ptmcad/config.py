"""From a problem record (YAML), a mapping or command-line options to a `Slice`.

Guarantee: a `Slice` that leaves here is complete and exact: every parameter of the mechanism is a rational function
of the two axes, its window is a nonempty rectangle, and no length or stiffness was found out of the range that the
geometry needs. Whatever is wrong with the input is a `ConfigError` that names file, line and key, and the remedy;
nothing unknown is ignored.

Not guaranteed: that a length given by an expression is positive in the whole window, where `ptmcad.positivity` could
not decide it (see there).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from decimal import Decimal
from enum import Enum
from fractions import Fraction
from pathlib import Path
from typing import Any

from ptmcad.errors import ConfigError, ExpressionError
from ptmcad.expressions import NAME, Expression, axis, constant, did_you_mean, names_in, parse
from ptmcad.positivity import find_nonpositive, find_pole
from ptmcad.slice import Axis, Count, Slice
from ptmcad.yamltree import Node, Place, Scalar, Sequence, Tree, from_python, plain_data, read_file

__all__ = [
    "PARAMETERS",
    "RECORD_KEYS",
    "Kind",
    "Parameter",
    "file_name",
    "load",
    "point_from_mapping",
    "point_from_options",
    "slice_from_mapping",
    "slice_from_options",
]


class Kind(Enum):
    """What a parameter measures; it decides which values make sense."""

    LENGTH = "length"
    BASE = "base length"
    STIFFNESS = "stiffness"
    FORCE = "force"
    FREE_LENGTH = "free length"


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of the paper's mechanism: its default and the window that ``--slice`` takes for it."""

    name: str
    kind: Kind
    default: str
    window: tuple[str, str]


PARAMETERS: Mapping[str, Parameter] = {
    parameter.name: parameter
    for parameter in (
        Parameter("L1", Kind.LENGTH, "1", ("0", "4")),
        Parameter("L2", Kind.LENGTH, "1", ("0", "4")),
        Parameter("rho", Kind.BASE, "1", ("0", "4")),
        Parameter("k", Kind.STIFFNESS, "100", ("0", "200")),
        Parameter("k1", Kind.STIFFNESS, "k", ("0", "200")),
        Parameter("k2", Kind.STIFFNESS, "k", ("0", "200")),
        Parameter("k3", Kind.STIFFNESS, "k", ("0", "200")),
        Parameter("F3", Kind.FORCE, "0", ("-30", "0")),
        Parameter("F4", Kind.FORCE, "0", ("-30", "0")),
        Parameter("F3x", Kind.FORCE, "0", ("-30", "30")),
        Parameter("F4x", Kind.FORCE, "0", ("-30", "30")),
        Parameter("l0", Kind.FREE_LENGTH, "0", ("0", "1")),
        Parameter("l0_1", Kind.FREE_LENGTH, "l0", ("0", "1")),
        Parameter("l0_2", Kind.FREE_LENGTH, "l0", ("0", "1")),
        Parameter("l0_3", Kind.FREE_LENGTH, "l0", ("0", "1")),
    )
}
RECORD_KEYS = ("name", "title", "notes", "mechanism", "parameters", "axes", "count", "reference")
_SPRINGS = ("k1", "k2", "k3")
MAX_DEGREE = 32
"""Of a parameter in the two axes; F3 = F^24 takes a minute and a half, and a dense polynomial far more."""
_MAX_NAME = 100
_MAX_TITLE = 300


def load(path: str | Path) -> Slice:
    """Read a problem record.

    Raises
    ------
    ConfigError
        For anything wrong in it, with file, line and key.
    """
    return slice_from_options(path)


def slice_from_mapping(mapping: Mapping[str, Any]) -> Slice:
    """The slice of a record given as Python data: numbers as text, int or Fraction, never float.

    >>> slice_from_mapping({"axes": {"rho": [0, 2], "L2": ["0", "2"]}, "parameters": {"F3": "-0.1"}}).axis_names
    ('rho', 'L2')
    """
    node = from_python(mapping, Place())
    if not isinstance(node, Tree):
        raise ConfigError("a record is a mapping")
    return _slice(_record(node))


def slice_from_options(
    config: str | Path | None = None,
    slice: str | None = None,
    sets: Iterable[str] = (),
    ranges: Iterable[str] = (),
    count: str | Count | None = None,
) -> Slice:
    """The slice of the command line's options, with or without a record under them.

    Options override the record. `slice` replaces the record's axes: a parameter the record fixed becomes free when it
    is named there, and keeps the record's range when it was an axis there. Answers and title of a record are dropped
    when another slice than the recorded one is asked for.

    Parameters
    ----------
    config : a YAML file.
    slice : ``"X,Y"``, the two axes, the horizontal one first.
    sets : texts ``NAME=VALUE``.
    ranges : texts ``NAME=LO:HI``, for axes.
    count : which count tells two regions apart.

    Raises
    ------
    ConfigError
        For anything wrong, with file, line and key, or the option.
    """
    record = _record(read_file(config)) if config is not None else _Record()
    given_sets, given_ranges = _settings(sets), _ranges(ranges)
    if slice is not None:
        record = _with_axes(record, slice, given_sets, given_ranges)
    elif config is None:
        raise ConfigError("give a problem record (a YAML file), or two axes such as --slice L2,rho")
    for name, value in given_sets.items():
        if name in record.axes:
            raise value.place.error(f"{name} is an axis and can not be fixed too: choose other axes with --slice")
        record = replace(record, values={**record.values, name: value})
    for name, window in given_ranges.items():
        if name not in record.axes:
            axes = " and ".join(record.axes)
            raise window.place.error(f"{name} is not an axis; the axes are {axes}{did_you_mean(name, record.axes)}")
        record = replace(record, axes={**record.axes, name: window})
    if slice is not None or given_sets or given_ranges:
        record = replace(record, title="", reference={})
    if count is not None:
        text = count.value if isinstance(count, Count) else count
        record = replace(record, count=_count(Scalar(text, Place("--count"))))
    return _slice(record)


def point_from_mapping(values: Mapping[str, object]) -> dict[str, Fraction]:
    """Every parameter of the mechanism at a point: the given ones, and the defaults of `PARAMETERS`.

    >>> point = point_from_mapping({"rho": "0.7", "L2": "3/2", "F3": -10})
    >>> point["rho"], point["k3"], point["F4"]
    (Fraction(7, 10), Fraction(100, 1), Fraction(0, 1))

    Parameters
    ----------
    values : text (a number, or arithmetic with other parameters), int, Fraction or Decimal; no float, which is not the
        decimal that was written.

    Raises
    ------
    ConfigError
        For anything wrong, with the parameter's name.
    """
    given = {}
    for name, value in values.items():
        place = Place(name)
        if name not in PARAMETERS:
            raise ConfigError(_unknown_parameter(name))
        node = from_python(str(value) if isinstance(value, Decimal) else value, place)
        given[name] = _number_text(node)
    return _point(_Record(values=given), {})


def point_from_options(
    config: str | Path | None = None, at: Mapping[str, str] | None = None, sets: Iterable[str] = ()
) -> dict[str, Fraction]:
    """Every parameter of the mechanism at the point of the command line's options, with or without a record under them.

    Parameters
    ----------
    config : a YAML file, whose axes all need a value in ``at`` or ``sets``.
    at : names of parameters, or of the record's axes, to numbers or expressions.
    sets : texts ``NAME=VALUE``.

    Raises
    ------
    ConfigError
        For anything wrong, with file, line and key, or the option.
    """
    record = _record(read_file(config)) if config is not None else _Record()
    given = _settings(sets)
    axes: dict[str, Expression] = {}
    for name, text in (at or {}).items():
        scalar = Scalar(text, Place(f"--at {name[:40]}"))
        if name in given:
            raise scalar.place.error("is given with --set too: leave one out")
        if name in PARAMETERS:
            given[name] = scalar
        elif name in record.axes:
            axes[name] = constant(_bound(scalar, "the value of this axis"))
        else:
            raise scalar.place.error(_unknown_parameter(name))
    for name in record.axes:
        if name not in given and name not in axes:
            raise ConfigError(
                f"{name} is an axis of {record.place.file} and has no value: add {name}=VALUE", key="--at"
            )
    return _point(replace(record, values={**record.values, **given}), axes)


# --------------------------------------------------------------------------------- the record, read but not resolved


@dataclass(frozen=True, slots=True)
class _Window:
    """The range of an axis as written."""

    low: Scalar
    high: Scalar
    place: Place


@dataclass(frozen=True, slots=True)
class _Record:
    """A record whose keys are known and whose values are still text."""

    name: str = ""
    title: str = ""
    mechanism: str = "ptm"
    values: Mapping[str, Scalar] = field(default_factory=dict)
    axes: Mapping[str, _Window] = field(default_factory=dict)
    count: Count = Count.STABLE
    reference: Mapping[str, Any] = field(default_factory=dict)
    place: Place = field(default_factory=Place)


def _record(tree: Tree) -> _Record:
    """Check the keys and shapes of a record."""
    for key, node in tree.entries.items():
        if key not in RECORD_KEYS:
            hint = did_you_mean(key, RECORD_KEYS) or f"; the keys are {', '.join(RECORD_KEYS)}"
            raise _node_place(node, key, tree).error(f"unknown key{hint}")
    entries = tree.entries
    mechanism = entries.get("mechanism")
    if mechanism is not None and (not isinstance(mechanism, Scalar) or mechanism.text != "ptm"):
        raise mechanism.place.error("unknown mechanism: the one that is built is 'ptm', the paper's")
    return _Record(
        name=_file_name(entries["name"]) if "name" in entries else _name_of_file(tree.place.file),
        title=_text(entries["title"], _MAX_TITLE) if "title" in entries else "",
        values=_values(entries["parameters"]) if "parameters" in entries else {},
        axes=_axes(entries["axes"]) if "axes" in entries else {},
        count=_count(entries["count"]) if "count" in entries else Count.STABLE,
        reference=_reference(entries["reference"]) if "reference" in entries else {},
        place=tree.place,
    )


def _node_place(node: Node, key: str, tree: Tree) -> Place:
    """The place of an entry: its own, which already has the key."""
    return node.place if node.place.key else tree.place.below(key)


def _text(node: Node, limit: int) -> str:
    if not isinstance(node, Scalar) or node.is_null:
        raise node.place.error("expected a text")
    if len(node.text) > limit:
        raise node.place.error(f"the text is longer than {limit} characters")
    return node.text


def file_name(name: str, option: str) -> str:
    """A name for files that an option gives.

    Raises
    ------
    ConfigError
        When it is not safe as the start of a file's name.
    """
    return _file_name(Scalar(name, Place(option)))


def _file_name(node: Node) -> str:
    """A name that is safe as the start of a file's name."""
    name = _text(node, _MAX_NAME)
    if not name or not name[0].isalnum() or not all(c.isalnum() or c in "._-" for c in name) or name.endswith("."):
        raise node.place.error(
            f"{name!r} can not name a file: use letters, digits, '.', '_' and '-', starting with a letter or digit"
        )
    return name


def _name_of_file(file: str | None) -> str:
    """The file's stem, with what `_file_name` refuses replaced; empty when there is no file."""
    stem = Path(file).stem if file else ""
    return "".join(c if c.isalnum() or c in "._-" else "-" for c in stem).strip(".-_")[:_MAX_NAME]


def _values(node: Node) -> dict[str, Scalar]:
    if isinstance(node, Scalar) and node.is_null:
        return {}
    if not isinstance(node, Tree):
        raise node.place.error("expected a mapping such as {L1: 1, F3: -10}")
    values = {}
    for name, value in node.entries.items():
        if name not in PARAMETERS:
            raise value.place.error(_unknown_parameter(name))
        values[name] = _number_text(value)
    return values


def _unknown_parameter(name: str) -> str:
    hint = did_you_mean(name, tuple(PARAMETERS)) or f"; the parameters are {', '.join(PARAMETERS)}"
    return f"unknown parameter '{name[:40]}'{hint}"


def _number_text(node: Node) -> Scalar:
    """A scalar that may hold a number or an expression."""
    if not isinstance(node, Scalar):
        raise node.place.error("expected a number or an expression, not a list or a mapping")
    if node.is_null:
        raise node.place.error("has no value: write a number or an expression, or leave the key out")
    if node.is_boolean:
        raise node.place.error(f"'{node.text}' is a yes-or-no value: write a number or an expression")
    return node


def _axes(node: Node) -> dict[str, _Window]:
    if not isinstance(node, Tree):
        raise node.place.error("expected two axes with their ranges, such as {rho: [0, 2], L2: [0, 2]}")
    if len(node.entries) != 2:
        raise node.place.error(f"{len(node.entries)} axes are given: a slice has two, the horizontal one first")
    return {name: _window(name, entry) for name, entry in node.entries.items()}


def _window(name: str, node: Node) -> _Window:
    _check_axis_name(name, node.place)
    if not isinstance(node, Sequence) or len(node.items) != 2:
        raise node.place.error("expected a range such as [0, 2]")
    low, high = (_number_text(item) for item in node.items)
    return _Window(low, high, node.place)


def _check_axis_name(name: str, place: Place) -> None:
    if not NAME.fullmatch(name) or len(name) > 40 or name.lower() in ("nan", "inf", "infinity"):
        raise place.error(f"{name[:40]!r} can not name an axis: use letters, digits and '_', starting with a letter")


def _count(node: Node) -> Count:
    words = [member.value for member in Count]
    if not isinstance(node, Scalar) or node.text not in words:
        found = f"'{node.text[:40]}'" if isinstance(node, Scalar) else "a list or a mapping"
        raise node.place.error(f"{found} is not a count: write {', '.join(words[:-1])} or {words[-1]}")
    return Count(node.text)


def _reference(node: Node) -> dict[str, Any]:
    data = plain_data(node)
    if data is None:
        return {}
    if not isinstance(data, dict):
        raise node.place.error("expected a mapping of published answers")
    return data


# ------------------------------------------------------------------------------------------------------------ options


def _settings(sets: Iterable[str]) -> dict[str, Scalar]:
    """``NAME=VALUE`` texts."""
    settings: dict[str, Scalar] = {}
    for text in sets:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name or not value:
            raise ConfigError(f"{text[:80]!r} is not NAME=VALUE, such as F3=-10", key="--set")
        place = Place(f"--set {name[:40]}")
        if name not in PARAMETERS:
            raise place.error(_unknown_parameter(name))
        if name in settings:
            raise place.error("is given twice: leave one out")
        settings[name] = Scalar(value, place)
    return settings


def _ranges(ranges: Iterable[str]) -> dict[str, _Window]:
    """``NAME=LO:HI`` texts."""
    windows: dict[str, _Window] = {}
    for text in ranges:
        name, equals, window = (part.strip() for part in text.partition("="))
        low, colon, high = (part.strip() for part in window.partition(":"))
        if not (equals and name and colon and low and high):
            raise ConfigError(f"{text[:80]!r} is not NAME=LO:HI, such as rho=0:2", key="--range")
        place = Place(f"--range {name[:40]}")
        if name in windows:
            raise place.error("is given twice: leave one out")
        windows[name] = _Window(Scalar(low, place), Scalar(high, place), place)
    return windows


def _with_axes(record: _Record, slice: str, sets: Mapping[str, Scalar], ranges: Mapping[str, _Window]) -> _Record:
    """The record with the axes of ``--slice X,Y``."""
    place = Place("--slice")
    names = [name.strip() for name in slice.split(",")]
    if len(names) != 2 or not all(names):
        raise place.error(f"{slice[:80]!r} is not X,Y: name two axes, such as L2,rho")
    if names[0] == names[1]:
        raise place.error(f"the two axes are both {names[0][:40]}: name two different ones")
    axes = {}
    for name in names:
        _check_axis_name(name, place)
        if name in ranges:
            axes[name] = ranges[name]
        elif name in record.axes:
            axes[name] = record.axes[name]
        elif name in PARAMETERS:
            low, high = PARAMETERS[name].window
            axes[name] = _Window(Scalar(low, place), Scalar(high, place), place)
        else:
            hint = did_you_mean(name, tuple(PARAMETERS))
            raise place.error(f"'{name}' is no parameter{hint}; any new name needs --range {name}=LO:HI")
    for name in record.axes:
        if name in PARAMETERS and name not in axes and name not in sets and name not in record.values:
            raise place.error(f"{name} was an axis of {record.place.file} and has no value now: add --set {name}=VALUE")
    return replace(record, axes=axes, values={name: v for name, v in record.values.items() if name not in axes})


# ----------------------------------------------------------------------------------------------------------- resolution


def _slice(record: _Record) -> Slice:
    """Resolve a record to a slice."""
    if not record.axes:
        raise record.place.below("axes").error("is missing: a slice needs two axes, such as {rho: [0, 2], L2: [0, 2]}")
    for name, window in record.axes.items():
        if name in record.values:
            place = record.values[name].place
            raise place.error(f"{name} is an axis and can not be fixed too: remove it here or from the axes")
        if name in PARAMETERS and PARAMETERS[name].kind is Kind.FREE_LENGTH:
            raise window.place.error(_NO_FREE_LENGTHS)
    axes = tuple(_axis(name, window) for name, window in record.axes.items())
    resolved = _Resolution(record, {name: axis(index) for index, name in enumerate(record.axes)}).run()
    for name, expression in resolved.items():
        if name not in record.axes:
            _check_value(name, expression, record, (axes[0], axes[1]))
    springs_set = all(spring in record.values or spring in record.axes for spring in _SPRINGS)
    effective = {
        name: expression
        for name, expression in resolved.items()
        if PARAMETERS[name].kind is not Kind.FREE_LENGTH and not (name == "k" and springs_set)
    }
    _check_stiffness_is_used(record, springs_set)
    for index, name in enumerate(record.axes):
        if not any(expression.uses(index) for expression in effective.values()):
            hint = did_you_mean(name, tuple(PARAMETERS)) if name not in PARAMETERS else ""
            remedy = f"no parameter depends on it{hint or ';'} use it in an expression, such as F3: {name}"
            if name in PARAMETERS:
                remedy = "k1, k2 and k3 are all given and none depends on it; use it in one of them"
            raise record.axes[name].place.error(f"the axis {name} is not used: {remedy}")
    return Slice(
        name=record.name or "slice-" + "-".join(record.axes),
        mechanism=record.mechanism,
        axes=(axes[0], axes[1]),
        parameters=effective,
        count=record.count,
        title=record.title,
        reference=record.reference,
        text={name: _written(name, record) for name in effective},
    )


def _point(record: _Record, axes: Mapping[str, Expression]) -> dict[str, Fraction]:
    """Resolve a record to a point; ``axes`` holds the values of its axes that are no parameters."""
    resolved = _Resolution(record, axes).run()
    values = {}
    for name, expression in resolved.items():
        place = _place_of(name, record)
        value = expression.constant()
        if PARAMETERS[name].kind is Kind.FREE_LENGTH:
            if value:
                raise place.error(_NO_FREE_LENGTHS)
            continue
        _check_number(name, value, place)
        values[name] = value
    _check_stiffness_is_used(record, all(spring in record.values for spring in _SPRINGS))
    del values["k"]  # what k1, k2 and k3 have by default
    return values


_NO_FREE_LENGTHS = "free lengths other than 0 are not supported yet: the certified engine they need is not built"


def _written(name: str, record: _Record) -> str:
    if name in record.axes:
        return name
    return record.values[name].text if name in record.values else PARAMETERS[name].default


def _axis(name: str, window: _Window) -> Axis:
    low, high = _bound(window.low), _bound(window.high)
    if low == high:
        raise window.place.error(f"the range of {name} is empty: {low} to {high}")
    if low > high:
        raise window.place.error(f"the range of {name} is reversed: write [{high}, {low}]")
    if name in PARAMETERS and PARAMETERS[name].kind is not Kind.FORCE and low < 0:
        raise window.place.error(f"the range of {name} goes below zero, but a {PARAMETERS[name].kind.value} is "
                                 "positive: start it at 0 or above")  # fmt: skip
    return Axis(name, low, high)


def _bound(scalar: Scalar, what: str = "the end of a range") -> Fraction:
    names = _names_in_scalar(scalar)
    if names and names[0].lower() not in ("nan", "inf", "infinity"):
        raise scalar.place.error(f"{what} is a number, not an expression in {names[0][:40]}")
    return _parsed(scalar, {}).constant()


def _names_in_scalar(scalar: Scalar) -> tuple[str, ...]:
    """The names in a scalar's text; raises `ConfigError` at its place."""
    try:
        return names_in(scalar.text)
    except ExpressionError as error:
        raise _located(scalar, error) from error


def _parsed(scalar: Scalar, names: Mapping[str, Expression]) -> Expression:
    try:
        return parse(scalar.text, names)
    except ExpressionError as error:
        raise _located(scalar, error) from error


def _located(scalar: Scalar, error: ExpressionError) -> ConfigError:
    shown = scalar.text if len(scalar.text) <= 60 else f"{scalar.text[:57]}..."
    where = f" (character {error.position + 1} of {shown!r})" if error.position is not None and len(shown) > 1 else ""
    return scalar.place.error(f"{error.message}{where}")


class _Resolution:
    """Replaces names by what they stand for, depth first, refusing cycles."""

    def __init__(self, record: _Record, free: Mapping[str, Expression]):
        self.record = record
        self.done = dict(free)
        self.known = tuple(dict.fromkeys((*free, *PARAMETERS)))

    def run(self) -> dict[str, Expression]:
        for name in PARAMETERS:
            self.resolve(name, ())
        return {name: self.done[name] for name in PARAMETERS}

    def resolve(self, name: str, chain: tuple[str, ...]) -> Expression:
        if name in self.done:
            return self.done[name]
        scalar = self.record.values.get(name) or Scalar(PARAMETERS[name].default, self.record.place.below(name))
        if name in chain:
            cycle = " -> ".join((*chain[chain.index(name) :], name))
            raise scalar.place.error(f"the definition goes round in a circle: {cycle}")
        names = {}
        for other in _names_in_scalar(scalar):
            if other in self.known:
                names[other] = self.resolve(other, (*chain, name))
            elif other.lower() not in ("nan", "inf", "infinity"):
                hint = did_you_mean(other, self.known) or f"; the names are {', '.join(self.known)}"
                raise scalar.place.error(f"unknown name '{other[:40]}'{hint}")
        self.done[name] = _parsed(scalar, names)
        return self.done[name]


def _check_value(name: str, expression: Expression, record: _Record, axes: tuple[Axis, Axis]) -> None:
    """Refuse what the geometry excludes, and a denominator that vanishes in the window."""
    kind = PARAMETERS[name].kind
    place = _place_of(name, record)
    if expression.degree > MAX_DEGREE:
        raise place.error(f"{name} has degree {expression.degree} in the axes: at most {MAX_DEGREE} can be computed")
    if kind is Kind.FREE_LENGTH:
        if expression.numerator:
            raise place.error(_NO_FREE_LENGTHS)
        return
    if expression.is_constant:
        _check_number(name, expression.constant(), place)
        return
    pole = find_pole(expression, axes)
    if pole is not None:
        raise place.error(f"division by zero inside the window: the denominator of {name} vanishes {pole}")
    witness = find_nonpositive(expression, axes) if kind is not Kind.FORCE else None
    if witness is not None:
        raise place.error(
            f"a {kind.value} must be positive in the whole window, but {name} is {witness}: narrow the window"
        )


def _place_of(name: str, record: _Record) -> Place:
    return record.values[name].place if name in record.values else record.place.below(name)


def _check_number(name: str, value: Fraction, place: Place) -> None:
    """Refuse a number that the geometry excludes."""
    kind = PARAMETERS[name].kind
    if kind is not Kind.FORCE and (value < 0 or (value == 0 and kind is not Kind.BASE)):
        least = "not negative" if kind is Kind.BASE else "positive"
        raise place.error(f"{name} is {value}, but a {kind.value} must be {least}")


def _check_stiffness_is_used(record: _Record, springs_set: bool) -> None:
    """Refuse a k that nothing uses."""
    if not springs_set or "k" not in record.values:
        return
    if not any("k" in _names_in_scalar(scalar) for name, scalar in record.values.items() if name != "k"):
        raise record.values["k"].place.error("has no effect, since k1, k2 and k3 are all given: leave it out")
