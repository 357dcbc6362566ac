"""Derivatives and determinants of trees, as trees: of coordinates, whose divisors are constants.

Guarantee: exact. What is zero at sight is left out, and no more is simplified: values are expanded where they are made.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from ptmcad.model.evaluate import value_at
from ptmcad.text.tree import Call, Chain, Name, Negative, Number, Power, Step, Tree

ZERO: Tree = Number(Fraction(0))
ONE: Tree = Number(Fraction(1))


def derivative(tree: Tree, name: str) -> Tree:
    """The derivative of a tree by a name, an unknown angle or one on the line."""
    match tree:
        case Name():
            return ONE if tree.name == name else ZERO
        case Number():
            return ZERO
        case Negative(operand):
            return negative(derivative(operand, name))
        case Call(function, argument):
            inner = derivative(argument, name)
            if function == "cos":
                return negative(product(inner, Call("sin", argument)))
            return product(inner, Call("cos", argument))
        case Power(base, exponent):
            n = int(value_at(exponent, {}))
            if n == 0:
                return ZERO
            lower = (ONE, base)[n - 1] if n < 3 else Power(base, Number(Fraction(n - 1)))
            return product(Number(Fraction(n)), lower, derivative(base, name))
        case Chain(first, steps):
            return _of_sum(tree, name) if tree.is_sum else _of_product(first, steps, name)


def _of_sum(chain: Chain, name: str) -> Tree:
    parts = [derivative(chain.first, name)]
    for step in chain.steps:
        by = derivative(step.operand, name)
        parts.append(by if step.operator == "+" else negative(by))
    return total(*parts)


def _of_product(first: Tree, steps: Sequence[Step], name: str) -> Tree:
    """Divisors are constants, so that they only go along."""
    factors = [Step("*", first), *steps]
    parts = []
    for k, factor in enumerate(factors):
        if factor.operator == "*" and (by := derivative(factor.operand, name)) != ZERO:
            others = [*factors[:k], *factors[k + 1 :]]
            whole = product(by, *(step.operand for step in others if step.operator == "*"))
            divisors = tuple(step for step in others if step.operator == "/")
            parts.append(Chain(whole, divisors) if divisors else whole)
    return total(*parts)


def total(*trees: Tree) -> Tree:
    """A sum."""
    kept = [tree for tree in trees if tree != ZERO]
    if not kept:
        return ZERO
    steps = [Step("-", t.operand) if isinstance(t, Negative) else Step("+", t) for t in kept[1:]]
    return Chain(kept[0], tuple(steps)) if steps else kept[0]


def negative(tree: Tree) -> Tree:
    """The tree with the other sign."""
    if isinstance(tree, Negative):
        return tree.operand
    return ZERO if tree == ZERO else Negative(tree)


def product(*trees: Tree) -> Tree:
    """A product, with its number and sign in front."""
    number = Fraction(1)
    factors: list[Tree] = []
    for tree in trees:
        sign, operand = (-1, tree.operand) if isinstance(tree, Negative) else (1, tree)
        number *= sign
        parts = [operand]
        if isinstance(operand, Chain) and all(step.operator == "*" for step in operand.steps):
            parts = [operand.first, *(step.operand for step in operand.steps)]
        for part in parts:
            if isinstance(part, Number):
                number *= part.value
            else:
                factors.append(part)
    if number == 0:
        return ZERO
    if abs(number) != 1 or not factors:
        factors.insert(0, Number(abs(number)))
    whole = factors[0] if len(factors) == 1 else Chain(factors[0], tuple(Step("*", tree) for tree in factors[1:]))
    return Negative(whole) if number < 0 else whole


def determinant(rows: Sequence[Sequence[Tree]]) -> Tree:
    """The determinant of a square matrix, by its last row."""
    if not rows:
        return ONE
    return total(*(product(entry, c) for entry, c in zip(rows[-1], cofactors(rows[:-1]), strict=True)))


def cofactors(rows: Sequence[Sequence[Tree]]) -> tuple[Tree, ...]:
    """What a further row's entries are multiplied by in the determinant: a vector at right angles to all rows.

    Parameters
    ----------
    rows : one fewer than columns.
    """
    found = []
    for k in range(len(rows) + 1):
        minor = determinant([[*row[:k], *row[k + 1 :]] for row in rows])
        found.append(minor if (len(rows) + k) % 2 == 0 else negative(minor))
    return tuple(found)
