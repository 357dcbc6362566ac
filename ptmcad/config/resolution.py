"""From a record's texts to exact expressions and numbers.

Guarantee: what leaves here is complete and exact; no length or stiffness is known to be out of the range that the
geometry needs. Where its sign could not be decided (see `ptmcad.positivity`) it is left to the engines, which decide or
refuse: `ptmcad.domain.prove`, and the exact engine's samples.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ptmcad.config.parameters import PARAMETERS, Kind
from ptmcad.config.record import Record, Window
from ptmcad.domain import fault
from ptmcad.errors import ConfigError, ExpressionError
from ptmcad.expressions import Expression, axis, names_in, parse
from ptmcad.slice import FREE_LENGTHS, Axis, Slice
from ptmcad.syntax import did_you_mean
from ptmcad.yamltree import Place, Scalar

_SPRINGS = ("k1", "k2", "k3")
_MAY_VANISH = (Kind.BASE, Kind.FREE_LENGTH)
MAX_DEGREE = 32
"""Of a parameter in the two axes; F3 = F^24 takes a minute and a half, and a dense polynomial far more."""


def slice_of(record: Record) -> Slice:
    """Resolve a record to a slice."""
    if not record.axes:
        raise record.place.below("axes").error("is missing: a slice needs two axes, such as {rho: [0, 2], L2: [0, 2]}")
    for name in record.axes:
        if name in record.values:
            place = record.values[name].place
            raise place.error(f"{name} is an axis and can not be fixed too: remove it here or from the axes")
    axes = tuple(_axis(name, window) for name, window in record.axes.items())
    resolved = _Resolution(record, {name: axis(index) for index, name in enumerate(record.axes)}).run()
    for name, expression in resolved.items():
        if name not in record.axes:
            _check_value(name, expression, record, (axes[0], axes[1]))
    springs_set = all(spring in record.values or spring in record.axes for spring in _SPRINGS)
    without_free_lengths = not any(resolved[name].numerator for name in FREE_LENGTHS)
    effective = {
        name: expression
        for name, expression in resolved.items()
        if not (name == "k" and springs_set)
        and name != "l0"  # what the three free lengths have by default
        and not (name in FREE_LENGTHS and without_free_lengths)
    }
    _check_stiffness_is_used(record, springs_set)
    _check_free_length_is_used(record)
    for index, name in enumerate(record.axes):
        if not any(expression.uses(index) for expression in effective.values()):
            hint = did_you_mean(name, tuple(PARAMETERS)) if name not in PARAMETERS else ""
            remedy = f"no parameter depends on it{hint or ';'} use it in an expression, such as F3: {name}"
            if name in PARAMETERS:
                own = FREE_LENGTHS if PARAMETERS[name].kind is Kind.FREE_LENGTH else _SPRINGS
                remedy = f"{own[0]}, {own[1]} and {own[2]} are all given and none depends on it; use it in one of them"
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


def point_of(record: Record, axes: Mapping[str, Expression]) -> dict[str, Fraction]:
    """Resolve a record to a point; ``axes`` holds the values of its axes that are no parameters."""
    resolved = _Resolution(record, axes).run()
    values = {}
    for name, expression in resolved.items():
        place = _place_of(name, record)
        value = expression.constant()
        _check_number(name, value, place)
        values[name] = value
    _check_stiffness_is_used(record, all(spring in record.values for spring in _SPRINGS))
    del values["k"], values["l0"]  # what k1, k2 and k3, or l0_1, l0_2 and l0_3 have by default
    if not any(values[name] for name in FREE_LENGTHS):
        for name in FREE_LENGTHS:
            del values[name]
    return values


def _written(name: str, record: Record) -> str:
    if name in record.axes:
        return name
    if name in FREE_LENGTHS and name not in record.values:
        return _written("l0", record)  # which the slice does not name
    return record.values[name].text if name in record.values else PARAMETERS[name].default


def _axis(name: str, window: Window) -> Axis:
    low, high = number_of(window.low), number_of(window.high)
    if low == high:
        raise window.place.error(f"the range of {name} is empty: {low} to {high}")
    if low > high:
        raise window.place.error(f"the range of {name} is reversed: write [{high}, {low}]")
    if name in PARAMETERS and PARAMETERS[name].kind is not Kind.FORCE and low < 0:
        least = "not negative" if PARAMETERS[name].kind in _MAY_VANISH else "positive"
        raise window.place.error(f"the range of {name} goes below zero, but a {PARAMETERS[name].kind.value} is "
                                 f"{least}: start it at 0 or above")  # fmt: skip
    return Axis(name, low, high)


def number_of(scalar: Scalar, what: str = "the end of a range") -> Fraction:
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

    def __init__(self, record: Record, free: Mapping[str, Expression]):
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


def _check_value(name: str, expression: Expression, record: Record, axes: tuple[Axis, Axis]) -> None:
    """Refuse what the geometry excludes, and a denominator that vanishes in the window."""
    place = _place_of(name, record)
    if expression.degree > MAX_DEGREE:
        raise place.error(f"{name} has degree {expression.degree} in the axes: at most {MAX_DEGREE} can be computed")
    if expression.is_constant:
        _check_number(name, expression.constant(), place)
        return
    problem = fault(name, expression, axes)
    if problem:
        raise place.error(problem)


def _place_of(name: str, record: Record) -> Place:
    return record.values[name].place if name in record.values else record.place.below(name)


def _check_number(name: str, value: Fraction, place: Place) -> None:
    """Refuse a number that the geometry excludes."""
    kind = PARAMETERS[name].kind
    if kind is not Kind.FORCE and (value < 0 or (value == 0 and kind not in _MAY_VANISH)):
        least = "not negative" if kind in _MAY_VANISH else "positive"
        raise place.error(f"{name} is {value}, but a {kind.value} must be {least}")


def _check_stiffness_is_used(record: Record, springs_set: bool) -> None:
    """Refuse a k that nothing uses."""
    if not springs_set or "k" not in record.values:
        return
    if not any("k" in _names_in_scalar(scalar) for name, scalar in record.values.items() if name != "k"):
        raise record.values["k"].place.error("has no effect, since k1, k2 and k3 are all given: leave it out")


def _check_free_length_is_used(record: Record) -> None:
    """Refuse an l0 that nothing uses."""
    if "l0" not in record.values or not all(name in record.values or name in record.axes for name in FREE_LENGTHS):
        return
    if not any("l0" in _names_in_scalar(scalar) for name, scalar in record.values.items() if name != "l0"):
        raise record.values["l0"].place.error(
            f"has no effect, since {', '.join(FREE_LENGTHS[:2])} and {FREE_LENGTHS[2]} are all given: leave it out"
        )
