"""Halves of a window that a reflection maps to the other half: what lies before an abscissa, or
below a line.

Guarantee: exact. The stacks of the half cover it, the walls over each are all that lie in it, and
the last cell of a stack is cut off by the half's ceiling. They prove nothing about adjacency.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import prod

from flint import fmpq

from ptmcad.algebra.graphs import on_graph
from ptmcad.algebra.polynomials import RationalPolynomial, UnivariatePolynomial
from ptmcad.algebra.real_roots import (
    RealRoot,
    disjoint,
    halve,
    inside,
    isolate,
    order,
    squarefree_part,
)
from ptmcad.answer.regionmap import Wall
from ptmcad.exact.cad.area import RegionStacks
from ptmcad.exact.cad.stacks import BaseEnd, StackData, level_at
from ptmcad.text.flint_numbers import simplest_between


def before(parts: RegionStacks, middle: fmpq) -> RegionStacks:
    """The half before an abscissa."""
    stacks, rows = [], []
    for stack, row in zip(parts.stacks, parts.regions, strict=True):
        left, right = (_apart(end, middle) for end in (stack.left, stack.right))
        if left.value >= middle:
            break
        if right.value > middle:
            right = BaseEnd(middle, None, None)
        stacks.append(_between(left, right, stack.walls, stack.heights))
        rows.append(row)
    return parts._replace(stacks=stacks, regions=rows)


def below(parts: RegionStacks, line: RationalPolynomial) -> RegionStacks:
    """The half below a line, which is within the window: its stacks end where walls cross the line,
    too.
    """
    ends = [stack.right.root for stack in parts.stacks if stack.right.root]
    crossings = squarefree_part(
        prod(
            (q for c in parts.curves if (q := on_graph(c.in_v, line))),
            start=UnivariatePolynomial([1]),
        )
    )
    for polynomial in {id(r.polynomial): r.polynomial for r in ends}.values():
        crossings //= crossings.gcd(polynomial)
    roots = inside(disjoint([*ends, *isolate(crossings, *parts.base)]), parts.base)
    places = [BaseEnd(parts.base[0], None, None), *(BaseEnd(r.middle, r, None) for r in roots)]
    stacks, rows, number = [], [], 0
    for left, right in pairwise([*places, BaseEnd(parts.base[1], None, None)]):
        walls, heights = parts.stacks[number].walls, parts.stacks[number].heights
        stack = _between(left, right, walls, heights)
        level = level_at(parts.curves, stack.sample, line(stack.sample), parts.fibre)
        stacks.append(stack._replace(walls=walls[:level], heights=heights[: level + 1]))
        rows.append(parts.regions[number][: level + 1])
        number += right.root is not None and right.root.polynomial is not crossings
    return parts._replace(stacks=stacks, regions=rows, ceiling=line)


def _apart(end: BaseEnd, middle: fmpq) -> BaseEnd:
    """The end with the interval of its root before or behind an abscissa, or as that abscissa."""
    root = end.root
    if root is None:
        return end
    if order(middle, root) == 0:
        return BaseEnd(middle, RealRoot(root.polynomial, middle, middle), None)
    while root.low <= middle <= root.high:
        root = halve(root)
    return BaseEnd(root.middle, root, None)


def _between(
    left: BaseEnd, right: BaseEnd, walls: Sequence[Wall], heights: Sequence[fmpq]
) -> StackData:
    return StackData(
        left, right, simplest_between(left.high, right.low), tuple(walls), tuple(heights)
    )
