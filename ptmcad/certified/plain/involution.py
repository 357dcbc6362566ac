"""The involutions by which the certified engine searches less: some keep each point of a slice, one moves its window.

Guarantee: that of `ptmcad.mechanism.involutions`; a problem's springs, too, are kept up to their order.
"""

from __future__ import annotations

from collections import Counter

from ptmcad.certified.plain.problem import Problem
from ptmcad.certified.plain.trigonometric import TrigonometricPolynomial
from ptmcad.mechanism.involutions import Involution, involutions
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import Expression


def mirrors(slice: Slice, problem: Problem) -> list[Involution]:
    """Those that keep each point, and fix some configurations; first those with the most odd unknowns.

    There are none in half angles, where springs are pushes, and in closed loops.
    """
    if problem.pushes or problem.covering or problem.closing or not problem.is_gradient:
        return []
    found = [
        each
        for each in involutions(slice.model, slice.parameters)
        if each.odd and each.has_fixed_unknowns and _squares(problem) == _squares(problem, each)
    ]
    return sorted(found, key=lambda each: -each.odd)


def square_of(vector: tuple[TrigonometricPolynomial, TrigonometricPolynomial]) -> TrigonometricPolynomial:
    """The squared length."""
    x, y = vector
    return x * x + y * y


def image_of(f: TrigonometricPolynomial, change: Involution) -> TrigonometricPolynomial:
    """The polynomial's values at the images."""
    return f.moved(change.images, change.signs, change.halves)


def _squares(problem: Problem, change: Involution | None = None) -> Counter[tuple[Expression, frozenset[object]]]:
    """The pulls of springs with their squared lengths, or those at the images."""
    found = [(cone.pull, square_of(cone.difference)) for cone in problem.cones]
    return Counter((pull, frozenset((image_of(f, change) if change else f).terms.items())) for pull, f in found)
