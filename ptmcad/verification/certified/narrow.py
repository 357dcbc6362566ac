"""Boxes that are too narrow for doubles: whether one has a solution, by one test in balls of as
many digits as it asks.

Guarantee: a box that is said to have one solution has exactly one, and it is in the enclosure; one
that is said to have none has none. A solution on the box's edge, to nearly all digits, or a
degenerate one leaves it open.

The test is Krawczyk's (`ptmcad.verification.certified.krawczyk`) of the stored box itself, without
doubles on the way: in a box of half width r the Jacobian hardly varies, so that the image is nearly
the point m - C f(m), which either is within r of m or is not. A search by halving gains nothing
there, and rounding a middle to doubles loses the box.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from flint import arb

from ptmcad.answer.regionmap import Solution
from ptmcad.text.balls import ball_of
from ptmcad.verification.certified.ballequations import Matrix
from ptmcad.verification.certified.krawczyk import image
from ptmcad.verification.normalform.boxes import Floats

NARROW = Fraction(1, 2**10)
"""Half the width of a box, as a share of 1 and its coordinates, up to which it is tested; nothing is
said of a wider one.
"""
_MIN_BITS, _SPARE_BITS = 128, 64
_NARROWINGS = 8
_MAX_BITS = 2**16
"""Beyond, a box stays open: its number of digits is the maker's choice."""

Function = Callable[[Sequence[arb]], tuple[Sequence[arb], Matrix]]
"""The equations and their derivatives over a box; not finite where they have none."""


@dataclass(frozen=True, slots=True)
class Judgement:
    """What a test shows of a box: whether it has a solution, and then where, with the derivatives
    all over the box.
    """

    holds: bool
    within: tuple[arb, ...] = ()
    jacobian: Matrix = field(default_factory=list)

    def in_floats(self) -> tuple[Floats, Floats]:
        """Middle and half widths of a box of doubles that has the solution."""
        center = tuple(float(x.mid()) for x in self.within)
        off = (abs(x - c) for x, c in zip(self.within, center, strict=True))
        return center, tuple(float(d.upper()) * (1 + 2.0**-40) + 2.0**-1000 for d in off)


def _size(solution: Solution) -> Fraction:
    return max((abs(c) for c in solution.center), default=Fraction(0)) + 1


def is_wide(solution: Solution) -> bool:
    """Whether a box is wider than those that are tested."""
    return solution.radius > NARROW * _size(solution)


def precisions(solution: Solution) -> list[int]:
    """Bits with which a test may show something of a stored box; none where it is too wide."""
    if is_wide(solution):
        return []
    bits = max(_MIN_BITS, _SPARE_BITS + 2 * int(_size(solution) / solution.radius).bit_length())
    return [times * bits for times in (1, 2, 4) if times * bits <= _MAX_BITS]


def tested(function: Function, solution: Solution) -> Judgement | None:
    """What one test shows of a stored box at the precision that is set; None where nothing.

    A solution that it has is the only one in a box that is twice as wide, too.
    """
    given, radius = [ball_of(c) for c in solution.center], ball_of(solution.radius)
    middle = [x.mid() for x in given]
    lost = max((x.rad() for x in given), key=float)
    # the first box has the stored one
    outer = (radius + lost).upper()
    found = _image(function, middle, [outer] * len(middle))
    if found is not None and any(abs(s) > outer for s in found[0]):
        return Judgement(False)
    # next to an edge the image of a box may cross it: that of one twice as wide is narrowed until
    # it does not
    reach, is_alone = [2 * outer] * len(middle), False
    for _ in range(2 * _NARROWINGS):
        if (found := _image(function, middle, reach)) is None:
            return None
        steps, jacobian = found
        within = tuple(m + s for m, s in zip(middle, steps, strict=True))
        is_alone = is_alone or all(abs(s) < r for s, r in zip(steps, reach, strict=True))
        away = [abs(x - c) for x, c in zip(within, given, strict=True)] if is_alone else []
        boxes = [arb(m, r) for m, r in zip(middle, reach, strict=True)]
        # all solutions of a box are in its image, so that one coordinate may narrow another one's
        if any(d > radius for d in away) or not all(map(arb.overlaps, within, boxes)):
            return Judgement(False)
        if is_alone and all(d < radius for d in away):
            return Judgement(True, within, jacobian)
        kept = list(map(arb.intersection, within, boxes))
        middle, reach = [x.mid() for x in kept], [(2 - is_alone) * x.rad() for x in kept]
    return None


def narrowed(function: Function, found: Judgement) -> Judgement:
    """The same with a narrower box of the solution, where one more image is narrower."""
    new = _image(function, [x.mid() for x in found.within], [x.rad() for x in found.within])
    if new is None:
        return found
    within = tuple(
        (x.mid() + step).intersection(x) for x, step in zip(found.within, new[0], strict=True)
    )
    return Judgement(True, within, new[1])


def _image(
    function: Function, middle: list[arb], reach: list[arb]
) -> tuple[list[arb], Matrix] | None:
    """Krawczyk's image of a box, less its middle, and the derivatives over the box; None where they
    are singular.
    """
    values, _ = function(middle)
    _, jacobian = function([arb(m, r) for m, r in zip(middle, reach, strict=True)])
    found = image(values, jacobian, reach)
    return None if found is None else (found, jacobian)
