"""Units of axes, areas and unknowns: those that the record declares, else what they are units of.

Guarantee: an axis has the unit of the parameters which are a number times it, or none.
"""

from __future__ import annotations

from collections.abc import Mapping

from ptmcad.mechanism import Kind
from ptmcad.mechanism.description import UnknownKind
from ptmcad.question.slice import Slice

_LENGTH, _FORCE, _STIFFNESS = ("length",), ("force",), ("force", "length")
_ENERGY = (*_FORCE, *_LENGTH)
_QUANTITIES = {Kind.LENGTH: _LENGTH, Kind.BASE: _LENGTH, Kind.STIFFNESS: _STIFFNESS, Kind.FORCE: _FORCE}
"""The quantities, of which a second one divides."""


def _quantities(slice: Slice, axis: int) -> tuple[str, ...]:
    """Of an axis; empty where they are not known, or not the same for all parameters that are a number times it."""
    exponents = (1, 0) if axis == 0 else (0, 1)
    found = set()
    for name, expression in slice.parameters.items():
        if expression.is_polynomial and [term[:2] for term in expression.numerator] == [exponents]:
            known = slice.model.parameters.get(name)
            found |= {_QUANTITIES[known.kind]} if known is not None and known.kind in _QUANTITIES else set()
    return found.pop() if len(found) == 1 else ()


def unit(slice: Slice, axis: int) -> str:
    """The unit of an axis, such as ``mm``, or ``length`` where the record declares none; empty when not known."""
    return "/".join(slice.units.get(quantity, quantity) for quantity in _quantities(slice, axis))


def energy_unit(units: Mapping[str, str]) -> str:
    """The unit of energies of a mechanism, such as ``kN·m``; in words as far as units are not declared."""
    return (
        "·".join(units[q] for q in _ENERGY)
        if all(q in units for q in _ENERGY)
        else " · ".join(units.get(q, q) for q in _ENERGY)
    )


def declared_units(units: Mapping[str, str]) -> dict[str, str]:
    """Of lengths, forces and energies, as far as a record declares them."""
    return {**units, **({"energy": energy_unit(units)} if all(q in units for q in _ENERGY) else {})}


def unit_of_unknown(slice: Slice, name: str) -> str:
    """The unit of an unknown: degrees of an angle, and none of a number."""
    kind = slice.model.unknowns[name]
    return {UnknownKind.ANGLE: "degrees", UnknownKind.LENGTH: slice.units.get("length", "length")}.get(kind, "")


def with_unit(name: str, unit: str) -> str:
    """A name with its unit in brackets, if it has one."""
    return f"{name} ({unit})" if unit else name


def area_unit(slice: Slice) -> str:
    """The unit of areas, such as ``mm²``; empty unless units are declared for both axes."""
    both = [_quantities(slice, axis) for axis in (0, 1)]
    if not all(quantities and all(q in slice.units for q in quantities) for quantities in both):
        return ""
    first, second = (unit(slice, axis) for axis in (0, 1))
    if first != second:
        return f"{first}·{second}"
    return f"({first})²" if "/" in first else f"{first}²"
