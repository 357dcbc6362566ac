"""Formulas as data for a page's script: one list of instructions, each with the places of earlier
ones.

Guarantee: the instructions are those of the formulas, each once, with constants rounded to doubles.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import inf
from typing import Any

from ptmcad.formulas.graph import Operation
from ptmcad.formulas.values import formulas_in, mapped, nodes_of

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
    structure : tuples and mappings of formulas, as `ptmcad.formulas.values.evaluated` takes them.
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
