"""The values of formulas in any arithmetic with sums and products: each node of the graph is computed once.

Guarantee: exact as far as the arithmetic is; a constant meets it as a fraction. Cosines and sines are those of
variables only, as in compiled systems.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any, Protocol, TypeVar

from ptmcad.formulas.graph import Formula, Operation

V_co = TypeVar("V_co", covariant=True)


class Arithmetic(Protocol[V_co]):
    """Numbers, or what is computed with as with numbers: it has sums, differences, products and changes of sign.

    One with lengths has a method ``length(x, y)`` as well, of values.
    """

    def constant(self, value: Fraction, /) -> V_co: ...

    def variable(self, number: int, /) -> V_co: ...

    def cos(self, number: int, /) -> V_co:
        """Of the variable of this number."""

    def sin(self, number: int, /) -> V_co: ...


def values(formulas: Sequence[Formula], arithmetic: Arithmetic[Any]) -> list[Any]:
    """The formulas' values, in their order.

    Raises
    ------
    TypeError
        Where a node is none of which the arithmetic has a value: a quotient, or the cosine of a sum.
    """
    known: dict[int, Any] = {}
    for node in _in_order(formulas):
        known[node.number] = _value(node, known, arithmetic)
    return [known[formula.number] for formula in formulas]


def evaluated(structure: Any, arithmetic: Arithmetic[Any]) -> Any:
    """Tuples and mappings, nested in any way, with values in place of their formulas; anything else in them stays.

    Raises
    ------
    TypeError
        As `values`.
    """
    formulas: list[Formula] = []
    _mapped(structure, formulas.append)
    found = iter(values(formulas, arithmetic))
    return _mapped(structure, lambda _: next(found))


def _mapped(structure: Any, of: Callable[[Formula], Any]) -> Any:
    if isinstance(structure, Formula):
        return of(structure)
    if isinstance(structure, Mapping):
        return {key: _mapped(part, of) for key, part in structure.items()}
    if isinstance(structure, tuple):
        make = getattr(structure, "_make", tuple)  # of a named tuple its own
        return make(_mapped(part, of) for part in structure)
    return structure


def _in_order(formulas: Sequence[Formula]) -> list[Formula]:
    """All nodes that the formulas need: operands have smaller numbers than what is made of them."""
    needed: dict[int, Formula] = {}
    waiting = list(formulas)
    while waiting:
        node = waiting.pop()
        if node.number not in needed:
            needed[node.number] = node
            # a cosine is taken of a variable by its number, so that the variable itself need not have a value
            if node.operation not in (Operation.COSINE, Operation.SINE):
                waiting += [operand for operand in (node.a, node.b) if operand is not None]
    return [needed[number] for number in sorted(needed)]


def _value(node: Formula, known: dict[int, Any], arithmetic: Any) -> Any:
    operation, a, b = node.operation, node.a, node.b
    if node.value is not None:
        return arithmetic.constant(node.value)
    if operation is Operation.VARIABLE:
        return arithmetic.variable(node.variable)
    assert a is not None
    if operation in (Operation.COSINE, Operation.SINE):
        if a.operation is not Operation.VARIABLE:
            raise TypeError("the cosine or sine of what is no variable")
        return (arithmetic.cos if operation is Operation.COSINE else arithmetic.sin)(a.variable)
    x = known[a.number]
    if operation is Operation.NEGATE:
        return -x
    if operation is Operation.SQUARE:
        return x * x
    assert b is not None
    y = known[b.number]
    if operation is Operation.ADD:
        return x + y
    if operation is Operation.SUBTRACT:
        return x - y
    if operation is Operation.MULTIPLY:
        return x * y
    if operation is Operation.LENGTH:
        return arithmetic.length(x, y)
    raise TypeError(f"{operation.name.lower()} has no value in this arithmetic")
