"""Equilibria that are their own images in a mirror along any line whose direction has a rational tangent, or rational.

Such as a chain that lies along the line from its pivot to where all its springs are held: the cosines are multiples of
one square root, and a point in which it ends may be exactly the pivot.

Guarantee: exact. The tangents are a guess, by balls. With u = p for all these angles at the guess, the reflection
u -> 2 p - u, whose 2 p have rational cosines and sines, is proved to leave the energy as it is, and the image of the
equilibrium to lie in a box that holds no other one: then it is its own image, and u = p. Or all cosines, sines and
real unknowns of the guess are rational, it is in such a box, and the gradient is zero there.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from flint import arb, ctx

from ptmcad.certified.plain.jets import rational_root
from ptmcad.certified.plain.symmetric import (
    NO_SURDS,
    Point,
    Surds,
    is_equilibrium,
    is_symmetry,
)
from ptmcad.mechanism import Mechanism
from ptmcad.text.balls import ball_of, exact

Direction = tuple[Fraction, Fraction]
"""Cosine and sine."""


def with_slanted(
    mechanism: Mechanism,
    parameters: Mapping[str, Fraction],
    at: Point,
    held: Mapping[str, arb],
    boxes: Mapping[str, arb],
) -> tuple[Point, Surds]:
    """The unknowns of an equilibrium that are proved to be fixed by a mirror, those that are rational and the others.

    Parameters
    ----------
    at : rational ones that are known already, which are among them.
    held : balls around the equilibrium, at the context's precision.
    boxes : wider ones, which together hold no other solution.
    """
    if len(at) == len(mechanism.angles) + len(mechanism.unknowns):
        return at, NO_SURDS
    doubled: dict[str, Direction] = {}
    reals: Point = {}
    for name, ball in held.items():
        double = _double(ball) if name in mechanism.angles else None
        place = _place(double, ball) if double else ball_of(_rational(ball)) if name in mechanism.reals else None
        if place is None or not (ball.overlaps(place) and boxes[name].contains(2 * place - ball)):
            continue
        if double is not None:
            doubled[name] = double
        else:
            reals[name] = _rational(ball)
    fixed, surds = _values(doubled, held)
    fixed |= reals
    if is_equilibrium(mechanism, parameters, fixed):
        return fixed, surds
    zeros = {name: value for name, value in reals.items() if not value}
    if doubled and is_symmetry(mechanism, parameters, (*doubled, *zeros), doubled):
        return at | _values(doubled, held)[0] | zeros, surds
    return at, NO_SURDS


def _rational(ball: arb) -> Fraction:
    """The fraction near a ball's middle that it seems to be: nearly no other number has one so near."""
    return exact(ball.mid()).limit_denominator(2 ** (ctx.prec // 4))


def _double(angle: arb) -> Direction | None:
    """Cosine and sine of twice an angle whose tangent seems to be rational."""
    steep = bool(abs(angle.sin()) > abs(angle.cos()))
    slope = angle.cot() if steep else angle.tan()
    if not slope.is_finite():
        return None
    t = _rational(slope)
    if not slope.overlaps(ball_of(t)):
        return None
    cosine = (1 - t * t) / (1 + t * t)
    return -cosine if steep else cosine, 2 * t / (1 + t * t)


def _place(double: Direction, near: arb) -> arb:
    """The angle about which a ball is, by twice its direction."""
    c, s = double
    base = arb.atan2(ball_of(s), ball_of(c)) / 2 if s or c > 0 else arb.pi() / 2
    return base + arb.pi() * round(float((near - base).mid()) / float(arb.pi().mid()))


def _values(doubled: Mapping[str, Direction], held: Mapping[str, arb]) -> tuple[Point, Surds]:
    """Cosines and sines of angles with these doubles: rational ones, and multiples of the first root that is none."""
    at: Point = {}
    multiples: dict[str, Fraction] = {}
    square: Fraction | None = None
    for name, (c, s) in doubled.items():
        steep = c < 0
        major = abs(c) / 2 + Fraction(1, 2)  # the square of the sine or the cosine, whichever is larger
        root = rational_root(major)
        known = at if root is not None else multiples
        if root is None:
            square = major if square is None else square
            root = rational_root(major / square)
            if root is None:
                continue
        if (held[name].sin() if steep else held[name].cos()) < 0:
            root = -root
        minor = root * s / (2 * major)
        known |= {f"cos {name}": minor if steep else root, f"sin {name}": root if steep else minor}
    return at, Surds(multiples, square or Fraction(1))
