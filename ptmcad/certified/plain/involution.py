"""The involutions by which the certified engine searches less: some keep each point of a slice, one
moves its window.

Guarantee: that of `ptmcad.model.involutions`; a problem's springs, too, are kept up to their order.
"""

from __future__ import annotations

from collections import Counter
from itertools import product

from ptmcad.certified.plain.problem import Problem, problem_of
from ptmcad.certified.plain.trigonometric import TrigonometricPolynomial
from ptmcad.model.involutions import Involution, involutions
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import Expression, constant


def mirrors(slice: Slice, problem: Problem) -> list[Involution]:
    """Those that keep each point, and fix some configurations; first those with the most odd
    unknowns.

    There are none in half angles, where springs are pushes, and in closed loops.
    """
    if problem.pushes or problem.covering or problem.closing or not problem.is_gradient:
        return []
    found = [
        each
        for each in involutions(slice.model, slice.parameters)
        if each.odd and each.has_fixed_unknowns and _squares(problem) == _squares(problem, each)
        if not _is_short_where_fixed(problem, each)
    ]
    return sorted(found, key=lambda each: -each.odd)


def _is_short_where_fixed(problem: Problem, change: Involution) -> bool:
    """Whether all unknowns are odd, so that fixed configurations are isolated, and a spring has no
    length in one of them, whatever the axes. Its cone is there at each point of the window:
    coordinates about it are not regular, but for the single unknown of a crease."""
    if change.odd < max(len(problem.unknowns), 2):
        return False
    # in quarter turns; real unknowns are 0
    choices = [
        (half, half + 2) if is_angle else (0,)
        for is_angle, half in zip(problem.is_angle, change.halves, strict=True)
    ]
    return any(
        all(_vanishes(f, quarters) for f in cone.difference)
        for quarters in product(*choices)
        for cone in problem.cones
    )


def _vanishes(f: TrigonometricPolynomial, quarters: tuple[int, ...]) -> bool:
    """Whether a polynomial is zero for all axes where angles are so many quarter turns and real
    unknowns are zero.
    """
    total = constant(0)
    for (multiples, powers), (cosine, sine) in f.terms.items():
        if not any(powers):
            turned = sum(m * q for m, q in zip(multiples, quarters, strict=True)) % 4
            total = total + (cosine, sine, -cosine, -sine)[turned]
    return not total.numerator


def halving(slice: Slice) -> Involution | None:
    """One that takes the window to itself, and does not keep its points; a reflection if there is
    any.

    None where a predicate is counted by that symmetries do not keep; or one of whose margins is a
    sum of squares, as what vanishes in its place is kept as that sum only.
    """
    predicate = slice.count.kind.predicate
    if predicate is not None and not predicate.is_symmetric:
        return None
    if any(condition.squares for condition in problem_of(slice).further):
        return None
    x, y = slice.axes
    found = involutions(slice.model, slice.parameters, ((x.low, x.high), (y.low, y.high)))
    moving = [each for each in found if not each.keeps_points]
    return min(moving, key=lambda each: (each.axes, -sum(each.axis_signs)), default=None)


def square_of(
    vector: tuple[TrigonometricPolynomial, TrigonometricPolynomial],
) -> TrigonometricPolynomial:
    """The squared length."""
    x, y = vector
    return x * x + y * y


def image_of(f: TrigonometricPolynomial, change: Involution) -> TrigonometricPolynomial:
    """The polynomial's values at the images."""
    return f.moved(change.images, change.signs, change.halves)


def _squares(
    problem: Problem, change: Involution | None = None
) -> Counter[tuple[Expression, frozenset[object]]]:
    """The pulls of springs with their squared lengths, or those at the images."""
    found = [(cone.pull, square_of(cone.difference)) for cone in problem.cones]
    return Counter(
        (pull, frozenset((image_of(f, change) if change else f).terms.items())) for pull, f in found
    )
