"""Formulas in doubles: written out once, then evaluated often, at a point or at many points at
once.

Guarantee: none but that of doubles. Where a length is zero, what is divided by it is infinite or no
number.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from typing import Any

from ptmcad.formulas.graph import Operation
from ptmcad.formulas.values import formulas_in, mapped, nodes_of


class Doubles:
    """Tuples and mappings of formulas, as `ptmcad.formulas.values.evaluated` takes them.

    Parameters
    ----------
    functions : a module with ``cos``, ``sin`` and ``sqrt``: `math` for numbers, numpy for arrays
        that fit each other.
    """

    def __init__(self, structure: Any, functions: Any):
        self._structure = structure
        known = _functions(functions)
        self._constants: dict[int, float] = {}
        self._variables: dict[int, int] = {}
        self._steps: list[tuple[int, Callable[..., Any], list[int]]] = []
        for node in nodes_of(formulas_in(structure)):
            if node.value is not None:
                self._constants[node.number] = float(node.value)
            elif node.operation is Operation.VARIABLE:
                self._variables[node.number] = node.variable
            else:
                operands = [operand.number for operand in (node.a, node.b) if operand is not None]
                self._steps.append((node.number, known[node.operation], operands))

    def at(self, values: Mapping[int, Any], of: Callable[[Any], Any] = lambda value: value) -> Any:
        """The same with the formulas' values, or something made of each, given those of the
        variables by number.
        """
        found: dict[int, Any] = dict(self._constants)
        for number, variable in self._variables.items():
            found[number] = values[variable]
        for number, function, operands in self._steps:
            found[number] = function(*[found[operand] for operand in operands])
        return mapped(self._structure, lambda formula: of(found[formula.number]))


def _functions(functions: Any) -> dict[Operation, Callable[..., Any]]:
    root = functions.sqrt
    return {
        Operation.COSINE: functions.cos,
        Operation.SINE: functions.sin,
        Operation.ADD: operator.add,
        Operation.SUBTRACT: operator.sub,
        Operation.MULTIPLY: operator.mul,
        Operation.NEGATE: operator.neg,
        Operation.SQUARE: lambda x: x * x,
        Operation.LENGTH: lambda x, y: root(x * x + y * y),
        Operation.INVERSE_LENGTH: lambda x, y: 1 / root(x * x + y * y),
        Operation.DIRECTION: lambda x, y: x / root(x * x + y * y),
    }
