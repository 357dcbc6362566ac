"""The certified engine's equations for springs with free lengths in SymPy, to be compared with a printed potential.

Guarantee: what is compared is the graph of formulas that the engine itself evaluates, translated node by node; a length
that belongs to no spring, or an operation that equations of equilibrium do not have, raises.

A spring's length l_i = sqrt(P_i) is a symbol of its own here, with derivative (dP_i/dth)/(2 l_i). Two expressions that
agree as rational functions of l1, l2, l3 agree wherever the lengths are what they are.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache

import sympy as sp

from ptmcad.certified.formula import Formula, Graph, Operation
from ptmcad.certified.potential import potential
from ptmcad.mechanism import ptm
from ptmcad.studies.paper.symbolic import (
    F3,
    F4,
    L1,
    L2,
    Expr,
    F3x,
    F4x,
    by_angle,
    c1,
    c2,
    coordinates,
    k,
    rho,
    s1,
    s2,
    vanishes,
)

NAMES = ptm().variables
LENGTHS = sp.symbols("l1 l2 l3", positive=True)
l0 = sp.Symbol("l0", positive=True)

_PARAMETERS: Mapping[str, Expr] = {
    "L1": L1, "L2": L2, "rho": rho, "k1": k, "k2": k, "k3": k, "F3": F3, "F4": F4, "F3x": F3x, "F4x": F4x,
    "l0_1": l0, "l0_2": l0, "l0_3": l0,
}  # fmt: skip
_BINARY: Mapping[Operation, Callable[[Expr, Expr], Expr]] = {
    Operation.ADD: lambda a, b: a + b,
    Operation.SUBTRACT: lambda a, b: a - b,
    Operation.MULTIPLY: lambda a, b: a * b,
    Operation.DIVIDE: lambda a, b: a / b,
}


@lru_cache(maxsize=1)
def squared_lengths() -> tuple[Expr, ...]:
    """The squares of the three springs' lengths, from the model's nodes: of A1A4, A2A3 and A3A4."""
    at = coordinates()
    ends = (("A1", "A4"), ("A2", "A3"), ("A3", "A4"))
    return tuple(sp.expand(sum((p - q) ** 2 for p, q in zip(at[a], at[b], strict=True))) for a, b in ends)


def derivative(energy: Expr, number: int) -> Expr:
    """The derivative by th1 or th2 of an expression in cosines, sines and the three lengths."""
    total = by_angle(energy, number)
    for length, square in zip(LENGTHS, squared_lengths(), strict=True):
        total += sp.diff(energy, length) * by_angle(square, number) / (2 * length)
    return total


@lru_cache(maxsize=1)
def engine_gradient() -> tuple[Expr, Expr]:
    """dU/dth1 and dU/dth2 as the certified engine has them, all stiffnesses k and all free lengths l0.

    Raises
    ------
    ArithmeticError
        When the engine's formulas have a length that is none of the three springs'.
    """
    graph = Graph()
    variables = [graph.variable(n) for n in range(len(NAMES) + 2)]
    values, angles = dict(zip(NAMES, variables, strict=False)), dict(zip(ptm().unknowns, variables[-2:], strict=True))
    energy = potential(ptm(), values, angles).energy
    known: dict[int, Expr] = {v.number: _PARAMETERS[name] for name, v in values.items()}
    slopes = (graph.derivative(energy, v.variable) for v in angles.values())
    first, second = (sp.expand(_translated(slope, known)) for slope in slopes)
    return first, second


def _translated(formula: Formula, known: dict[int, Expr]) -> Expr:
    if formula.number in known:
        return known[formula.number]
    if formula.value is not None:
        found = sp.Rational(formula.value.numerator, formula.value.denominator)
    elif formula.operation in (Operation.SINE, Operation.COSINE):
        found = _wave(formula)
    else:
        operands = [_translated(part, known) for part in (formula.a, formula.b) if part is not None]
        found = _combined(formula.operation, operands)
    known[formula.number] = found
    return found


def _combined(operation: Operation, operands: list[Expr]) -> Expr:
    if operation in _BINARY:
        return _BINARY[operation](*operands)
    if operation is Operation.NEGATE:
        return -operands[0]
    if operation is Operation.SQUARE:
        return operands[0] ** 2
    if operation is Operation.LENGTH:
        return _length(*operands)
    if operation is Operation.DIRECTION:
        return operands[0] / _length(*operands)
    raise ArithmeticError(f"an equation of equilibrium with the operation {operation.name}")


def _wave(formula: Formula) -> Expr:
    """The sine or cosine of th1, th2 or th1 + th2, in c1, s1, c2, s2."""
    angles = _angles(formula.a)
    sine, cosine = sp.Integer(0), sp.Integer(1)
    for angle in angles:
        c, s = ((c1, s1), (c2, s2))[angle]
        sine, cosine = sine * c + cosine * s, cosine * c - sine * s
    return sine if formula.operation is Operation.SINE else cosine


def _angles(formula: Formula | None) -> tuple[int, ...]:
    """Which of th1 and th2 (0 and 1) an argument is the sum of."""
    if formula is not None and formula.variable >= len(NAMES):
        return (formula.variable - len(NAMES),)
    if formula is not None and formula.operation is Operation.ADD:
        return (*_angles(formula.a), *_angles(formula.b))
    raise ArithmeticError("a sine or cosine of something else than a sum of the angles")


def _length(x: Expr, y: Expr) -> Expr:
    """The symbol of the spring that has these two coordinates."""
    for length, square in zip(LENGTHS, squared_lengths(), strict=True):
        if vanishes(x**2 + y**2 - square):
            return length
    raise ArithmeticError("a length that is no spring's")
