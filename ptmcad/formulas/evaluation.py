"""The values of formulas in any arithmetic with sums and products: each node of the graph is
computed once.

Guarantee: exact as far as the arithmetic is; a constant meets it as a fraction. Cosines and sines
are those of variables only, as in compiled systems, but for an arithmetic whose numbers have some:
that of `Substitution`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol, TypeVar

from ptmcad.formulas.graph import (
    OPERATORS,
    Formula,
    Graph,
    Operation,
    direction,
    inverse_length,
    length,
    meet,
)

V_co = TypeVar("V_co", covariant=True)


class Arithmetic(Protocol[V_co]):
    """Numbers, or what is computed with as with numbers: it has sums, differences, products and
    changes of sign.

    One with lengths has a method ``length(x, y)`` as well, of values; and so for other operations
    on two of them.
    """

    def constant(self, value: Fraction, /) -> V_co: ...

    def variable(self, number: int, /) -> V_co: ...

    def cos(self, number: int, /) -> V_co:
        """Of the variable of this number."""

    def sin(self, number: int, /) -> V_co: ...


@dataclass(frozen=True, slots=True)
class Substitution:
    """The arithmetic of formulas: with others in the place of some variables, of the same graph or
    of another one.
    """

    graph: Graph
    places: Mapping[int, Formula]

    def constant(self, value: Fraction) -> Formula:
        return self.graph.constant(value)

    def variable(self, number: int) -> Formula:
        place = self.places.get(number)
        return self.graph.variable(number) if place is None else place

    def cos(self, number: int) -> Formula:
        return self.variable(number).cos()

    def sin(self, number: int) -> Formula:
        return self.variable(number).sin()

    def divide(self, x: Formula, y: Formula) -> Formula:
        """Raises `ZeroDivisionError` by the constant zero."""
        return x / y

    length = staticmethod(length)
    inverse_length = staticmethod(inverse_length)
    direction = staticmethod(direction)
    meet = staticmethod(meet)


def values(formulas: Sequence[Formula], arithmetic: Arithmetic[Any]) -> list[Any]:
    """The formulas' values, in their order.

    Raises
    ------
    AttributeError
        Where a node is none of which the arithmetic has a value: a quotient, or the cosine of a
        sum.
    """
    known: dict[int, Any] = {}

    def value(node: Formula) -> Any:
        if node.number not in known:
            known[node.number] = _value(node, arithmetic, value)
        return known[node.number]

    for node in nodes_of(formulas):
        # a cosine is taken of a variable by its number, so that the variable itself need not have a
        # value
        if node.operation is not Operation.VARIABLE:
            value(node)
    return list(map(value, formulas))


def evaluated(structure: Any, arithmetic: Arithmetic[Any]) -> Any:
    """Tuples and mappings, nested in any way, with values in place of their formulas; anything else
    in them stays.

    Raises
    ------
    AttributeError
        As `values`.
    """
    found = iter(values(formulas_in(structure), arithmetic))
    return mapped(structure, lambda _: next(found))


def formulas_in(structure: Any) -> list[Formula]:
    """The formulas of such a structure, in their order."""
    formulas: list[Formula] = []
    mapped(structure, formulas.append)
    return formulas


def mapped(structure: Any, of: Callable[[Any], Any], leaf: type = Formula) -> Any:
    """Such a structure with something else in place of each formula, or of each instance of another
    class.
    """
    if isinstance(structure, leaf):
        return of(structure)
    if isinstance(structure, Mapping):
        return {key: mapped(part, of, leaf) for key, part in structure.items()}
    if isinstance(structure, tuple | list):
        make = getattr(structure, "_make", type(structure))  # of a named tuple its own
        return make(mapped(part, of, leaf) for part in structure)
    return structure


def substituted(formula: Formula, places: Mapping[int, Formula]) -> Formula:
    """The formula with others, of its graph, in the place of variables.

    Raises
    ------
    ZeroDivisionError
        Where something would be divided by the constant zero.
    """
    found: Formula = values([formula], Substitution(formula.graph, places))[0]
    return found


def nodes_of(formulas: Iterable[Formula]) -> list[Formula]:
    """All nodes that the formulas need: operands have smaller numbers than what is made of them,
    and come first.
    """
    found: dict[int, Formula] = {}
    waiting = list(formulas)
    while waiting:
        node = waiting.pop()
        if node.number not in found:
            found[node.number] = node
            waiting += [operand for operand in (node.a, node.b) if operand is not None]
    return [found[number] for number in sorted(found)]


def _value(node: Formula, arithmetic: Any, value: Callable[[Formula], Any]) -> Any:
    operation, a, b = node.operation, node.a, node.b
    if node.value is not None:
        return arithmetic.constant(node.value)
    if operation is Operation.VARIABLE:
        return arithmetic.variable(node.variable)
    assert a is not None
    if operation in (Operation.COSINE, Operation.SINE):
        name = "cos" if operation is Operation.COSINE else "sin"
        if a.operation is Operation.VARIABLE:
            return getattr(arithmetic, name)(a.variable)
        return getattr(value(a), name)()
    operands = [value(operand) for operand in (a, b) if operand is not None]
    if operation is Operation.SQUARE:
        return operands[0] * operands[0]
    return (OPERATORS.get(operation) or getattr(arithmetic, operation.name.lower()))(*operands)
