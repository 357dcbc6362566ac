"""Four-bar loops that fold flat whatever the loads: parallelograms, kites, rhombi, and lengths that
add up alike.

A loop A P Q B of four rigid parts with lengths a, c, d and b of AP, PQ, QB and BA is singular
exactly where its corners are on one line. It has such poses if and only if a + c = +-d +- b for
some choice of signs, that of c included. Where two pairs of lengths are equal, its poses are two or
three branches that cross there.

Guarantee: exact, for all values of the axes at once: what is called flat folds flat at every point
at which its lengths have values. Both engines take names and sentences from here.

Source: elementary; the product over all signs is a polynomial in the squares.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from itertools import combinations

from ptmcad.errors import ExpressionError
from ptmcad.model.description import Mechanism
from ptmcad.model.elements import Closing
from ptmcad.model.identities import Points
from ptmcad.model.involutions import SliceRing
from ptmcad.text.expressions import Expressions

IN_TWO_WAYS = (
    ", as lengths of its bars add up alike: two ways of assembling it meet there, and flat poses are multiple "
    "solutions whatever the loads are; give its bars other lengths, or write the branch that you mean as an open "
    "chain"
)
_SINGULAR = (
    "in flat poses, with {a}, {p}, {q} and {b} on one line, the loop is singular, and these are multiple solutions "
    "whatever the loads are"
)
_MIRRORED = (
    "angle and the length of {far} as unknowns, with {image} as the mirror image of {object} about {mirror} and "
    "{closing} as the closing bar: each pose is found twice then, once with a negative length"
)
_PARALLELOGRAM = (
    "{a}{p} and {b}{q} are parallel, on the other they cross; where the two meet, {singular}. Describe the parallel "
    "branch as an open chain, with {q} as far from {p} as {b} from {a}, and the crossed one by "
)
_RHOMBUS = (
    "{a}{p} and {b}{q} are parallel, on the others {p} stays at {b} or {q} at {a}; where they meet, {singular}. "
    "Describe each branch as an open chain"
)
_KITE = (
    "{image} stays at {object} and two bars turn about it, the other is symmetric about {far}; where the two meet, "
    "{singular}. Describe the symmetric branch by the {mirrored}; the other branch is an open chain"
)


class Fold(Enum):
    """Why a loop folds flat."""

    PARALLELOGRAM = "parallelogram"
    RHOMBUS = "rhombus"
    KITE_P = "kite, P may stay at B"
    KITE_Q = "kite, Q may stay at A"
    EQUAL_SUMS = "lengths add up alike"

    @property
    def words(self) -> str:
        """What a loop is, with the number of its branches."""
        if self is Fold.EQUAL_SUMS:
            return "a loop whose lengths add up alike, assembled in two ways"
        return f"a {self.value.partition(',')[0]} with {'three' if self is Fold.RHOMBUS else 'two'} branches"


@dataclass(frozen=True, slots=True)
class FourBar:
    """A loop of four rigid parts, whose corners are the points A, P, Q and B: PQ is the closing
    bar.
    """

    mechanism: Mechanism
    closing: Closing
    corners: tuple[str, str, str, str]

    def fold(self, parameters: Expressions) -> Fold | None:
        """Why the loop folds flat at all values of the axes; None where it does not, or that is not
        shown.
        """
        try:
            return self._fold(
                Points(self.mechanism, SliceRing(self.mechanism.unknowns, parameters))
            )
        except ExpressionError:
            return None

    def _fold(self, points: Points) -> Fold | None:
        a, p, q, b = self.corners
        one, two, ground = (points.squared(*pair) for pair in ((a, p), (q, b), (b, a)))
        length = points.value(self.closing.length)
        coupler = length * length
        if one == two and coupler == ground:
            return Fold.RHOMBUS if one == ground else Fold.PARALLELOGRAM
        if one == ground and coupler == two:
            return Fold.KITE_P
        if one == coupler and two == ground:
            return Fold.KITE_Q
        four = points.ring.constant(Fraction(4))
        s = one + coupler - two - ground
        t = s * s - (one * coupler + two * ground) * four
        return (
            Fold.EQUAL_SUMS if t * t == one * two * coupler * ground * four * four * four else None
        )

    def turns_freely(self) -> bool:
        """Whether the loop is all that joins the only two unknowns, angles that turn its sides to
        all directions.

        Then it has every pose in which its sides are closed, the flat ones too.
        """
        mechanism = self.mechanism
        if len(mechanism.closing) > 1 or len(mechanism.unknowns) != 2 or len(mechanism.angles) != 2:
            return False
        points, (a, p, q, b) = Points(mechanism), self.corners
        try:
            sides = [points.turning(*side) for side in ((a, b), (a, p), (b, q))]
        except ExpressionError:
            return False
        if None in sides:
            return False
        (g1, g2), (f1, f2), (s1, s2) = (
            [side[u] for u in mechanism.angles] for side in sides if side is not None
        )
        return (f1 - g1) * (s2 - g2) != (f2 - g2) * (s1 - g1)

    def named(self, fold: Fold, free_lengths: bool = False) -> str:
        """Which linkage the loop is, which branches its poses are, and how to describe each branch
        by itself.

        Parameters
        ----------
        free_lengths : whether springs have some, with which X-joints are not computed.
        """
        if fold is Fold.EQUAL_SUMS:
            return IN_TWO_WAYS
        a, p, q, b = self.corners
        corners = dict(zip("apqb", self.corners, strict=True))
        corners["singular"] = _SINGULAR.format(**corners)
        if fold is Fold.RHOMBUS:
            branches = _RHOMBUS.format(**corners)
        elif fold is Fold.PARALLELOGRAM:
            far = f"{a}{q}"
            mirrored = _MIRRORED.format(
                far=far,
                image=p,
                object=b,
                mirror=f"{far}'s perpendicular bisector",
                closing=f"{q}{b}",
            )
            branches = _PARALLELOGRAM.format(**corners) + (
                f"the {mirrored}" if free_lengths else "'x-joint:'"
            )
        else:
            image, centre, far, closing = (
                (p, b, a + q, q + b) if fold is Fold.KITE_P else (q, a, b + p, p + a)
            )
            there = {"image": image, "object": centre, "far": far}
            mirrored = _MIRRORED.format(**there, mirror=far, closing=closing)
            branches = _KITE.format(**corners, **there, mirrored=mirrored)
        return f": {a} {p} {q} {b} is {fold.words}, on one {branches}"

    def in_short(self, fold: Fold) -> str:
        """The same in one sentence, for a single point; no how-to."""
        return (
            f"{' '.join(self.corners)} is {fold.words}: where these meet, with its corners on one line, the loop is "
            "singular, and springs with free lengths leave nothing decided but of one branch by itself"
        )


def four_bars(mechanism: Mechanism) -> Iterator[FourBar]:
    """The loops of four rigid parts that closing bars are in."""
    fixed = [name for name in mechanism.points if name not in mechanism.moving]
    rigid = {
        frozenset(pair)
        for part in (*mechanism.bars, fixed, *mechanism.bodies.values())
        for pair in combinations(part, 2)
    }
    for closing in mechanism.closing:
        p, q = closing.start, closing.end
        for a in mechanism.points:
            for b in mechanism.points:
                if {a, b} & {p, q} or a == b:
                    continue
                if {frozenset((a, p)), frozenset((q, b)), frozenset((b, a))} <= rigid:
                    yield FourBar(mechanism, closing, (a, p, q, b))


def flat_everywhere(mechanism: Mechanism, parameters: Expressions) -> tuple[FourBar, Fold] | None:
    """The loop that has flat poses for all values of the axes, and why; None where there is none,
    or no proof.
    """
    for loop in four_bars(mechanism) if len(mechanism.closing) == 1 else ():
        fold = loop.fold(parameters)
        if fold is not None and loop.turns_freely():
            return loop, fold
    return None


def may_be_flat(mechanism: Mechanism, parameters: Expressions) -> str:
    """What to say of four-bar loops among others that fold flat where these let them; empty where
    there are none.
    """
    found = ((loop, loop.fold(parameters)) for loop in four_bars(mechanism))
    said = {
        loop.closing: f"{' '.join(loop.corners)} is {fold.words}"
        for loop, fold in found
        if fold is not None
    }
    if not said:
        return ""
    return f"{', '.join(said.values())}: nothing is decided wherever its corners can come to lie on one line"


def closed_by(mechanism: Mechanism) -> str:
    """The closing bars as a sentence has them: the loop that these close."""
    return " and ".join(f"{c.start}{c.end}" for c in mechanism.closing)
