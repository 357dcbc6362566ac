"""The count of solutions at a rational point, and how long it is searched for.

Guarantee: when a `PointCount` is decided, each solution (where stable ones alone are counted, each
of these) has its own box, proved to hold exactly one, and it is proved that there are no others.
What is not proved is undecided.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import frexp, inf

from ptmcad.answer.counts import Counted, MorseIndex
from ptmcad.answer.regionmap import Solution
from ptmcad.certified.search import Boxes

QUICK_BUDGET = 6_000
BUDGET = 60_000
"""Boxes in floating point for one point."""
MIN_BOX_WIDTHS = (1e-8, 1e-4)
"""Boxes this narrow are left to Arb; the second number counts where the first leaves too many, next
to a fold.
"""
PRECISIONS = (128, 320)


@dataclass(frozen=True, slots=True)
class PointCount(Counted):
    """The counts at a point; None where the count asked for does not need them, and where nothing
    is decided.

    Attributes
    ----------
    index : numbers of minima, saddles and maxima.
    cones : configurations in which springs have no length and the energy has a peak.
    solutions : disjoint boxes, angles in radians: all solutions, or the minima when only these were
        counted. Where nothing is decided those that are proved, without signs where these are open.
    open : boxes in which there may be more of them.
    further : by the names of predicates, how many of the stable solutions they hold at.
    """

    total: int | None = None
    stable: int | None = None
    index: MorseIndex | None = None
    cones: int | None = None
    solutions: tuple[Solution, ...] = ()
    decided: bool = False
    open: int = 0
    further: Mapping[str, int] = field(default_factory=dict)


def boxed(unique: Boxes, narrow: Boxes, signs: str, unknowns: Sequence[int]) -> Solution:
    """A cube between the two boxes, its radius a power of two.

    Parameters
    ----------
    unique, narrow : shape (2v,): low ends, then high ends; ``narrow`` lies in ``unique``.
    unknowns : numbers of the variables that the cube has, in order.
    """
    variables = len(narrow) // 2
    center = [0.5 * (narrow[k] + narrow[k + variables]) for k in unknowns]
    room = inf
    need = 0.0
    for c, k in zip(center, unknowns, strict=True):
        room = min(room, c - unique[k], unique[k + variables] - c)
        need = max(need, c - narrow[k], narrow[k + variables] - c)
    return Solution(
        tuple(map(Fraction, center)), radius_between(Fraction(need), Fraction(room)), signs
    )


def radius_between(need: Fraction, room: Fraction) -> Fraction:
    """A power of two well below ``room``, or all of it where ``need`` leaves no choice."""
    if room <= 0:
        raise ArithmeticError("a narrow box leaves the box in which its zero is the only one")
    _, exponent = frexp(float(room)) if room > Fraction(1, 2**1000) else (0.0, -1000)
    radius = Fraction(2) ** (exponent - 3)
    return radius if need <= radius else room
