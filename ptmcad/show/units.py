"""Units of axes, areas and unknowns: those that the record declares, else what they are units of.

Guarantee: an axis has the unit of the parameters which are a number times it, or none.
"""

from __future__ import annotations

from collections.abc import Mapping

from ptmcad.errors import ExpressionError
from ptmcad.model import Kind, Mechanism, Model, Parameter
from ptmcad.model.elements import UnknownKind
from ptmcad.model.evaluate import multiples
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import Expression, axis
from ptmcad.text.parsing import parse
from ptmcad.text.syntax import names_in
from ptmcad.text.tree import Tree, names_of

_LENGTH, _FORCE, _STIFFNESS, _MOMENT = ("length",), ("force",), ("force", "/", "length"), ("force", "·", "length")
_ENERGY = ("force", "length")
_QUANTITIES = {Kind.LENGTH: _LENGTH, Kind.BASE: _LENGTH, Kind.STIFFNESS: _STIFFNESS, Kind.FORCE: _FORCE}
"""The quantities, and what joins two."""
_SIGNS = frozenset("/·")


def _quantities_of(model: Model, parameter: Parameter) -> tuple[str, ...]:
    """Of a parameter of one of these kinds; a stiffness that is a number times those of torsion springs is a moment."""
    if parameter.kind is Kind.STIFFNESS and isinstance(model, Mechanism):
        names = {parameter.name, *model.shorthands.get(parameter.name, ())}
        turning = [t.stiffness for t in model.torsion if names & set(names_of(t.stiffness))]
        pulling = any(names & set(names_of(spring.stiffness)) for spring in model.springs)
        if turning and not pulling and all(map(_is_multiple, turning)):
            return _MOMENT
    return _QUANTITIES[parameter.kind]


def _is_multiple(tree: Tree) -> bool:
    """Whether an expression is a number times a name."""
    try:
        found = multiples(tree)
    except ExpressionError:
        return False
    return len(found) == 1


def _quantities(slice: Slice, axis: int) -> tuple[str, ...]:
    """Of an axis; empty where they are not known, or not the same for all parameters that are a number times it."""
    return _quantities_in(slice, slice.parameters, (1, 0) if axis == 0 else (0, 1))


def _quantities_in(slice: Slice, parameters: Mapping[str, Expression], exponents: tuple[int, int]) -> tuple[str, ...]:
    """Those of the parameters that are a number times the axis with these exponents."""
    found = set()
    for name, expression in parameters.items():
        if expression.is_polynomial and [term[:2] for term in expression.numerator] == [exponents]:
            known = slice.model.parameters.get(name)
            found |= {_quantities_of(slice.model, known)} if known is not None and known.kind in _QUANTITIES else set()
    return found.pop() if len(found) == 1 else ()


def _joined(slice: Slice, quantities: tuple[str, ...]) -> str:
    return "".join(slice.units.get(part, part) for part in quantities)


def unit(slice: Slice, axis: int) -> str:
    """The unit of an axis, such as ``mm``, or ``length`` where the record declares none; empty when not known."""
    return _joined(slice, _quantities(slice, axis))


def unit_of_free(slice: Slice, free: str, text: Mapping[str, str]) -> str:
    """The same of a family's free parameter.

    Parameters
    ----------
    slice : one of the members.
    text : of the family's parameters, as `FamilyMap.text`.
    """
    own = {name: parse(written, {free: axis(0)}) for name, written in text.items() if names_in(written) == (free,)}
    return _joined(slice, _quantities_in(slice, {free: axis(0), **own}, (1, 0)))


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
    if not all(quantities and all(q in slice.units for q in quantities if q not in _SIGNS) for quantities in both):
        return ""
    first, second = (unit(slice, axis) for axis in (0, 1))
    if both == [_LENGTH, _FORCE]:
        first, second = second, first  # as energies are written
    if first != second:
        return f"{first}·{second}"
    return f"({first})²" if _SIGNS & set(first) else f"{first}²"
