"""Formulas written out once as instructions: in doubles, to be evaluated often, at a point or at many
points at once; and as data for a page's script.

Guarantee: the instructions are those of the formulas, each once, with constants rounded to doubles;
of their values none but that of doubles. Where a length is zero, what is divided by it is infinite
or no number.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf
from typing import Any

from ptmcad.formulas.evaluation import formulas_in, mapped, nodes_of
from ptmcad.formulas.graph import OPERATORS, Operation


class Doubles:
    """Tuples and mappings of formulas, as `ptmcad.formulas.evaluation.evaluated` takes them.

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


def _functions(functions: Any) -> dict[int, Callable[..., Any]]:
    root = functions.sqrt
    return {
        **OPERATORS,
        Operation.COSINE: functions.cos,
        Operation.SINE: functions.sin,
        Operation.SQUARE: lambda x: x * x,
        Operation.LENGTH: lambda x, y: root(x * x + y * y),
        Operation.INVERSE_LENGTH: lambda x, y: 1 / root(x * x + y * y),
        Operation.DIRECTION: lambda x, y: x / root(x * x + y * y),
    }


MAX_CONSTANT = 10**100
"""Of constants: products of a few stay within the range of doubles."""

Instruction = tuple[Any, ...]
"""``("=", number)``; ``("p", number)`` for a parameter, ``("u" | "c" | "s", number)`` for an
unknown, its cosine and sine; ``("r", operand)`` for a square root; ``("+" | "-" | "*", left,
right)``."""

_SIGNS = {
    Operation.ADD: "+",
    Operation.SUBTRACT: "-",
    Operation.MULTIPLY: "*",
    Operation.COSINE: "c",
    Operation.SINE: "s",
}


def script(structure: Any, sources: Mapping[int, Instruction]) -> tuple[list[Instruction], Any]:
    """The instructions, and the structure with places of these in place of its formulas.

    Parameters
    ----------
    structure : tuples and mappings of formulas, as `ptmcad.formulas.evaluation.evaluated` takes them.
    sources : the instructions for variables, by their numbers.
    """
    written: dict[Instruction, int] = {}
    places: dict[int, int] = {}

    def put(*instruction: Any) -> int:
        return written.setdefault(instruction, len(written))

    for node in nodes_of(formulas_in(structure)):
        operation, operands = (
            node.operation,
            [operand for operand in (node.a, node.b) if operand is not None],
        )
        if node.value is not None:
            place = put("=", float(node.value) if abs(node.value) < MAX_CONSTANT else inf)
        elif operation is Operation.VARIABLE:
            place = put(*sources[node.variable])
        elif operation in (Operation.COSINE, Operation.SINE):
            place = put(_SIGNS[operation], sources[operands[0].variable][1])
        else:
            own = [places[operand.number] for operand in operands]
            if operation is Operation.LENGTH:
                place = put("r", put("+", *(put("*", operand, operand) for operand in own)))
            elif operation is Operation.SQUARE:
                place = put("*", *own, *own)
            elif operation is Operation.NEGATE:
                place = put("-", put("=", 0.0), *own)
            else:
                place = put(_SIGNS[operation], *own)
        places[node.number] = place
    return list(written), mapped(structure, lambda formula: places[formula.number])
