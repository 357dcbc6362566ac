"""Formulas as data for a page's script: one list of instructions, each with the places of earlier ones.

Guarantee: the instructions are those of the formulas, each once, with constants rounded to doubles.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf
from typing import Any

from ptmcad.formulas.graph import Formula, Operation
from ptmcad.formulas.values import nodes_of

MAX_CONSTANT = 10**100
"""Of constants: products of a few stay within the range of doubles."""

Instruction = tuple[Any, ...]
"""``("=", number)``; ``("p", number)`` for a parameter, ``("u" | "c" | "s", number)`` for an unknown, its cosine and
sine; ``("r", operand)`` for a square root; ``("+" | "-" | "*", left, right)``."""

_SIGNS = {
    Operation.ADD: "+",
    Operation.SUBTRACT: "-",
    Operation.MULTIPLY: "*",
    Operation.COSINE: "c",
    Operation.SINE: "s",
}


def script(
    formulas: Mapping[str, Sequence[Formula]], sources: Mapping[int, Instruction]
) -> tuple[list[Instruction], dict[str, list[int]]]:
    """The instructions, and for each group of formulas their places.

    Parameters
    ----------
    sources : the instructions for variables, by their numbers.
    """
    written: dict[Instruction, int] = {}
    places: dict[int, int] = {}

    def put(*instruction: Any) -> int:
        return written.setdefault(instruction, len(written))

    for node in nodes_of([formula for group in formulas.values() for formula in group]):
        operation, operands = node.operation, [operand for operand in (node.a, node.b) if operand is not None]
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
    return list(written), {name: [places[formula.number] for formula in group] for name, group in formulas.items()}
