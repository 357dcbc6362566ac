"""Units of axes, areas and unknowns: those that the record declares, else what they are units of.

Guarantee: an axis has the unit of the parameters which are a number times it, or none.
"""

from __future__ import annotations

from ptmcad.model import Model
from ptmcad.model.elements import Unit
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import Expressions, axis
from ptmcad.text.numerals import Texts
from ptmcad.text.parsing import parse
from ptmcad.text.syntax import names_in

_SIGNS = frozenset("/·")
"""What joins two quantities."""


def _quantities(slice: Slice, axis: int) -> Unit:
    """Of an axis; empty where they are not known, or not the same for all parameters that are a
    number times it.
    """
    return _quantities_in(slice, slice.parameters, (1, 0) if axis == 0 else (0, 1))


def _quantities_in(slice: Slice, parameters: Expressions, exponents: tuple[int, int]) -> Unit:
    """Those of the parameters that are a number times the axis with these exponents."""
    found = {
        slice.model.unit_of(name)
        for name, expression in parameters.items()
        if expression.is_polynomial and [term[:2] for term in expression.numerator] == [exponents]
    } - {()}
    return found.pop() if len(found) == 1 else ()


def _joined(units: Texts, quantities: Unit, between: str = "") -> str:
    return between.join(units.get(part, part) for part in quantities)


def unit(slice: Slice, axis: int) -> str:
    """The unit of an axis, such as ``mm``, or ``length`` where the record declares none; empty when
    not known.
    """
    return _joined(slice.units, _quantities(slice, axis))


def unit_of_free(slice: Slice, free: str, text: Texts) -> str:
    """The same of a family's free parameter.

    Parameters
    ----------
    slice : one of the members.
    text : of the family's parameters, as `FamilyMap.text`.
    """
    own = {
        name: parse(written, {free: axis(0)})
        for name, written in text.items()
        if names_in(written) == (free,)
    }
    return _joined(slice.units, _quantities_in(slice, {free: axis(0), **own}, (1, 0)))


def energy_unit(model: Model, units: Texts) -> str:
    """The unit of a model's energies, such as ``kN·m``; in words as far as units are not declared,
    none of a system.
    """
    return _joined(units, model.energy_unit, " " * (not _declares(units, model.energy_unit)))


def _declares(units: Texts, quantities: Unit) -> bool:
    """Whether a record declares all units that these are made of, and there are any."""
    return bool(quantities) and all(part in units for part in quantities if part not in _SIGNS)


def declared_units(model: Model, units: Texts) -> dict[str, str]:
    """Of lengths, forces and energies, as far as a record declares them."""
    declared = _declares(units, model.energy_unit)
    return {**units, "energy": energy_unit(model, units)} if declared else {**units}


def unit_of_unknown(model: Model, name: str, units: Texts) -> str:
    """The unit of an unknown: degrees of an angle, and none of a number."""
    return _joined(units, model.unit_of(name))


def with_unit(name: str, unit: str) -> str:
    """A name with its unit in brackets, if it has one."""
    return f"{name} ({unit})" if unit else name


def area_unit(slice: Slice) -> str:
    """The unit of areas, such as ``mm²``; empty unless units are declared for both axes."""
    both = [_quantities(slice, axis) for axis in (0, 1)]
    if not all(_declares(slice.units, quantities) for quantities in both):
        return ""
    first, second = (unit(slice, axis) for axis in (0, 1))
    if both == [("length",), ("force",)]:
        first, second = second, first  # as energies are written
    if first != second:
        return f"{first}·{second}"
    return f"({first})²" if _SIGNS & set(first) else f"{first}²"
