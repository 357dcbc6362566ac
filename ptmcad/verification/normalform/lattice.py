"""A slice with the lattice of squares in which covers are written.

Guarantee: exact; balls have all values.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from flint import arb

from ptmcad.question.slice import Slice
from ptmcad.text.balls import ball_of
from ptmcad.text.expressions import Expression
from ptmcad.verification.coordinates import ball
from ptmcad.verification.normalform.boxes import Unproved
from ptmcad.verification.planecurves import PLANE, polynomial

Range = tuple[Fraction, Fraction]
"""An interval of one axis, in steps."""


class SliceLattice(NamedTuple):
    """A window that is divided into so many steps along both axes."""

    slice: Slice
    steps: int

    @property
    def square(self) -> tuple[Fraction, Fraction]:
        """The sides of one square."""
        one, two = ((axis.high - axis.low) / self.steps for axis in self.slice.axes)
        return one, two

    @property
    def window(self) -> Range:
        """All of one axis."""
        return Fraction(0), Fraction(self.steps)

    def on(self, x: Fraction, y: Fraction) -> tuple[Fraction, Fraction]:
        """A point of the plane in steps."""
        (one, two), (width, height) = self.slice.axes, self.square
        return (x - one.low) / width, (y - two.low) / height

    def off(self, u: Fraction, v: Fraction) -> tuple[Fraction, Fraction]:
        """The inverse."""
        (one, two), (width, height) = self.slice.axes, self.square
        return one.low + u * width, two.low + v * height

    def balls(self, u: Range, v: Range) -> tuple[arb, arb]:
        """Of both axes, over a rectangle in steps."""
        low, high = (self.off(*corner) for corner in zip(u, v, strict=True))
        x, y = (ball_of(a).union(ball_of(b)) for a, b in zip(low, high, strict=True))
        return x, y

    def values(self, u: Range, v: Range) -> dict[str, arb]:
        """The values of all parameters over a rectangle in steps; of free lengths that are none 0.

        Raises
        ------
        Unproved
            When one may have a pole there.
        """
        x, y = self.balls(u, v)
        zeros = {name: arb(0) for name in self.slice.model.free_lengths}
        return zeros | {name: over(e, x, y) for name, e in self.slice.parameters.items()}


def over(expression: Expression, x: arb, y: arb) -> arb:
    """A parameter's values over a box.

    Raises
    ------
    Unproved
        When it may have a pole there.
    """
    at = dict(zip(PLANE.names(), (x, y), strict=True))
    numerator, denominator = (
        ball(polynomial(terms), at) for terms in (expression.numerator, expression.denominator)
    )
    if denominator.contains(0):
        raise Unproved("a parameter may have a pole")
    return numerator / denominator
