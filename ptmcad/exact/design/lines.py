"""The longest interval with the wanted count on the line of one design, from the variety of all
designs.

Guarantee: exact, for designs off a set without interior: the ends are roots of the variety's
polynomials at the design, and the count is that of samples between all of them.
"""

from __future__ import annotations

from itertools import pairwise

from flint import fmpq

from ptmcad.algebra.bernstein import on_lines
from ptmcad.algebra.real_roots import Interval, disjoint, inside, isolate, refine, squarefree_part
from ptmcad.exact.design.cover import Space
from ptmcad.exact.ranges.exactline import runs
from ptmcad.text.flint_numbers import simplest_between

_WIDTH = fmpq(1, 2**80)
"""Of what isolates a root, against the window's power."""


def longest_on_line(space: Space, design: tuple[fmpq, ...]) -> tuple[Interval, Interval] | None:
    """The two ends of the longest interval, enclosed; equal ends where there is none.

    None where the design is on the variety, as far as that is seen.
    """
    at = (*design, fmpq(0))[:2]
    low, high = (end**space.power for end in space.window)
    product = on_lines(space.tables, (at[0], at[1]))
    if not product:
        return None
    found = disjoint(isolate(squarefree_part(product), low, high))
    roots = [refine(root, (high - low) * _WIDTH) for root in inside(found, (low, high))]
    ends = [(low, low), *((root.low, root.high) for root in roots), (high, high)]
    counts = []
    for (_, left), (right, _) in pairwise(ends):
        counts.append(space.count_at(simplest_between(*space.inside(left, right)), (at[0], at[1])))
    if None in counts:
        return None
    here = runs([count == space.working for count in counts])
    spans = [(space.outside(*ends[first]), space.outside(*ends[last])) for first, last in here]
    if not spans:
        return (space.window[0],) * 2, (space.window[0],) * 2
    return max(spans, key=lambda span: span[1][0] - span[0][1])
