"""What descriptions are made of: parameters, springs, loads, moments and joints, with their
expressions as trees.

Guarantee: each says by `element` all that a traversal of a description needs of it: what is written
in it, its energy, and what an unknown has to change in it. So proofs, loops and X-joints need no
list of kinds. What a spring between points does is said once, by its `Law`, whose formulas both
engines, drawings and documents read; the checker has its own in `verification/derivation`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from enum import Enum
from fractions import Fraction
from typing import NamedTuple

from ptmcad.errors import shown
from ptmcad.model.evaluate import multiples
from ptmcad.model.trees import ONE, ZERO, cosine_and_sine, negative, product, total
from ptmcad.text.numerals import text_of as value_text
from ptmcad.text.syntax import parse
from ptmcad.text.tree import Chain, Name, Negative, Number, Power, Step, Tree, replaced
from ptmcad.text.tree import to_text as text_of

MAX_SHOWN = 60
"""Characters of an expression."""
Unit = tuple[str, ...]
"""Quantities, ``length`` and ``force``, and between two of them what joins them."""
LEVEL: Tree = ZERO
"""The direction of a base from left to right."""
_TWO: Tree = Number(Fraction(2))
Place = tuple[Tree, Tree]


class Kind(Enum):
    """What a parameter measures; it decides which values make sense."""

    LENGTH = "length"
    BASE = "base"
    STIFFNESS = "stiffness"
    FREE_LENGTH = "free length"
    FORCE = "force"
    ANGLE = "angle"
    NUMBER = "number"

    @property
    def noun(self) -> str:
        """As a message names it."""
        return "base length" if self is Kind.BASE else self.value

    @property
    def is_positive(self) -> bool:
        """Whether zero makes no sense, nor anything below."""
        return self in (Kind.LENGTH, Kind.STIFFNESS)

    @property
    def may_vanish(self) -> bool:
        """Whether zero makes sense, but nothing below."""
        return self in (Kind.BASE, Kind.FREE_LENGTH)

    @property
    def demand(self) -> str:
        """What a value has to be that makes sense; empty where each does."""
        return "positive" if self.is_positive else "not negative" if self.may_vanish else ""

    def excludes(self, value: Fraction) -> bool:
        """Whether a value makes no sense."""
        return value < 0 if self.may_vanish else self.is_positive and value <= 0


class UnknownKind(Enum):
    """Where an unknown lives: the word of records, then what others ask of it. A part of the line
    has a condition, too, in `Model.conditions`.

    Attributes
    ----------
    where : in words.
    turns : whether it is the circle; all others are on the line.
    unit : what it is measured in.
    """

    ANGLE = "angle", "on the circle", True, ("degrees",)
    LENGTH = "length", "on the line", False, ("length",)
    REAL = "real", "on the line, and no length"

    where: str
    turns: bool
    unit: Unit

    def __new__(cls, word: str, where: str, turns: bool = False, unit: Unit = ()) -> UnknownKind:
        kind = object.__new__(cls)
        kind._value_, kind.where, kind.turns, kind.unit = word, where, turns, unit
        return kind


class Support(Enum):
    """What holds a point, for drawings."""

    PIN = "pin"
    SLIDER_X = "slider x"
    SLIDER_Y = "slider y"


class Parameter(NamedTuple):
    """A parameter of a mechanism.

    Attributes
    ----------
    default : a number, or the name of the parameter that this one is an alias of.
    window : the range that ``--slice`` takes for it, if there is one.
    alias_of : the parameter that stands for this one where it is not given.
    """

    name: str
    kind: Kind
    default: str
    window: tuple[str, str] | None
    alias_of: str = ""


class Part(NamedTuple):
    """An expression that is written in an element.

    Attributes
    ----------
    key : where it stands, such as ``k`` in a spring and ``springs.2.k`` in a description.
    kind : what it measures, which decides which values make sense.
    meaning : what has to hold, in place of what its kind says.
    """

    key: str
    kind: Kind
    tree: Tree
    meaning: str = ""

    @property
    def text(self) -> str:
        """As it is written, for messages."""
        return shown(text_of(self.tree), MAX_SHOWN)

    def fault(self, value: Fraction) -> str:
        """What is wrong with its value, in words; empty where nothing is."""
        if not self.kind.excludes(value):
            return ""
        number = value_text(value)
        is_what = number if self.text == number else f"{self.text} = {number}"
        if self.meaning:
            return f"{self.meaning}, but {self.text} = {number}"
        return f"a {self.kind.noun} is {self.kind.demand}, but this is {is_what}"


class Element(NamedTuple):
    """What a traversal of a description needs of an element; coordinates are names, ``P.x``.

    Attributes
    ----------
    written : its expressions.
    energies : the summands of its energy, where there is a root without the free length.
    root : what the energy lacks with the free length, where that is not written as zero: a pull,
        which is times a length, and the square of this.
    varying : what an unknown has to change.
    idle : what is wrong where none does; without ``varying`` what is wrong at sight.
    """

    written: tuple[Part, ...]
    energies: tuple[Tree, ...] = ()
    root: tuple[Tree, Tree] | None = None
    varying: Tree | None = None
    idle: str = ""


def place_of(point: str) -> Place:
    """The names of a point's coordinates, ``P.x`` and ``P.y``, in place of what these are."""
    return Name(f"{point}.x"), Name(f"{point}.y")


def difference(start: Place, end: Place) -> Place:
    """The way from one place to another."""
    (x0, y0), (x1, y1) = start, end
    return total(x1, negative(x0)), total(y1, negative(y0))


def squared(tree: Tree) -> Tree:
    """The square of a tree."""
    return Power(tree, _TWO)


def squared_distance(start: str, end: str) -> Tree:
    """The square of the distance of two points, in the names of their coordinates."""
    return total(*map(squared, difference(place_of(start), place_of(end))))


def factor(tree: Tree) -> str:
    """As text, in brackets where these are needed in a product."""
    return f"({text_of(tree)})" if isinstance(tree, Chain | Negative) else text_of(tree)


def _number(value: Fraction) -> str:
    return text_of(Number(value)) if value.denominator == 1 and value > 0 else f"({value})"


def _difference(tree: Tree, less: Tree) -> str:
    match tree, less:
        case _, Number(value) if value == 0:
            return text_of(tree)
        case Chain(first, steps), _ if tree.is_sum:
            return text_of(Chain(first, (*steps, Step("-", less))))
    return text_of(Chain(tree, (Step("-", less),)))


class Law(Enum):
    """What springs between points do, in the stiffness k, the free length f, the length l and its
    square q.

    Attributes
    ----------
    unit : of the stiffness.
    energy : smooth - pull*l, but for what has no length in it.
    smooth : the energy without a free length: a polynomial in q.
    density : twice its slope by q, the force for each unit of length.
    pull : what the energy lacks for each unit of length; without lengths, and zero without a free
        length.
    force : the energy's slope by the length, positive where the spring pulls.
    """

    LINEAR = (("force", "/", "length"), "1/2*k*(l - f)^2", "1/2*k*q", "k", "k*f", "k*(l - f)")

    def __init__(self, unit: Unit, *formulas: str) -> None:
        self.unit = unit
        self.energy, self.smooth, self.density, self.pull, self.force = map(parse, formulas)


class Spring(NamedTuple):
    """A spring between two points; its name, which no other has, is that of its stiffness or is
    made of its points'.
    """

    name: str
    start: str
    end: str
    stiffness: Tree
    free: Tree
    law: Law = Law.LINEAR

    @property
    def unit(self) -> Unit:
        """Of its stiffness."""
        return self.law.unit

    @property
    def element(self) -> Element:
        """For traversals."""
        square = squared_distance(self.start, self.end)
        is_zero = isinstance(self.free, Number) and not self.free.value
        names = {"k": self.stiffness, "f": self.free, "q": square}
        return Element(
            (Part("k", Kind.STIFFNESS, self.stiffness), Part("free", Kind.FREE_LENGTH, self.free)),
            (replaced(self.law.smooth, names),),
            None if is_zero else (replaced(self.law.pull, names), square),
            square,
            f"the length of {self.start}{self.end} is constant, so that this spring does nothing: leave it out, or put "
            "an end where it moves",
        )

    def text(self, points: Mapping[str, Place]) -> str:
        """Its energy as problem records write it, with a root."""
        (x0, y0), (x1, y1) = points[self.start], points[self.end]
        square = f"({_difference(x1, x0)})^2 + ({_difference(y1, y0)})^2"
        names = {
            "k": factor(self.stiffness),
            "f": factor(self.free),
            "l": f"sqrt({square})",
            "q": f"({square})",
        }
        return re.sub("[kflq]", lambda name: names[name[0]], text_of(self.law.energy))


class Load(NamedTuple):
    """A dead force at a point."""

    point: str
    x: Tree
    y: Tree

    @property
    def names(self) -> tuple[str, str]:
        """Its components as text: the forces' names where they are parameters."""
        return text_of(self.x), text_of(self.y)

    @property
    def element(self) -> Element:
        """For traversals."""
        x, y = place_of(self.point)
        return Element(
            (Part("1", Kind.FORCE, self.x), Part("2", Kind.FORCE, self.y)),
            (negative(product(self.x, x)), negative(product(self.y, y))),
        )

    def text(self, points: Mapping[str, Place]) -> str:
        """What its work takes off the energy, as problem records write it."""
        x, y = map(factor, points[self.point])
        return f" - {factor(self.x)}*{x} - {factor(self.y)}*{y}"


class Moment(NamedTuple):
    """A generalised force that works on an unknown: a moment on an angle, a force on a length."""

    unknown: str
    value: Tree

    @property
    def element(self) -> Element:
        """For traversals; its work is in no energy that is written (`ptmcad.model.work`)."""
        return Element((Part("", Kind.NUMBER, self.value),))


class Closing(NamedTuple):
    """A bar that closes a loop: its ends keep their distance."""

    start: str
    end: str
    length: Tree

    @property
    def element(self) -> Element:
        """For traversals."""
        return Element((Part("length", Kind.LENGTH, self.length),))

    def text(self, points: Mapping[str, Place]) -> str:
        """What is zero where it has its length, given the points' coordinates."""
        sides = difference(points[self.start], points[self.end])
        return text_of(total(total(*map(squared, sides)), negative(squared(self.length))))


class TorsionSpring(NamedTuple):
    """A spring between directions: its energy is stiffness * (1 - cos(angle - rest)).

    Its moment is the energy's derivative by the angle, stiffness * sin(angle - rest): positive
    where it turns back an angle beyond rest, as a spring's force is positive where it pulls back
    ends that are too far apart.

    Attributes
    ----------
    angle : a sum of whole multiples of unknown angles.
    rest : cosine and sine of the angle at which it is relaxed.
    name : its angle's, and a number where another one has that.
    at : the point at which the description draws it; empty where it does not say.
    """

    angle: Tree
    stiffness: Tree
    rest: tuple[Fraction, Fraction]
    name: str = ""
    at: str = ""

    @property
    def unit(self) -> Unit:
        """Of its stiffness, a moment."""
        return "force", "·", "length"

    @property
    def energy(self) -> Tree:
        """As a tree; the cosine of the difference is expanded, since only the rest's cosine and
        sine are known.
        """
        return product(self.stiffness, total(ONE, negative(self.deflection[0])))

    @property
    def deflection(self) -> tuple[Tree, Tree]:
        """Cosine and sine of angle - rest, expanded in the same way."""
        (c, s), (cosine, sine) = map(Number, self.rest), cosine_and_sine(self.angle, 0)
        return (
            total(product(c, cosine), product(s, sine)),
            total(product(c, sine), negative(product(s, cosine))),
        )

    @property
    def element(self) -> Element:
        """For traversals."""
        return Element(
            (Part("angle", Kind.ANGLE, self.angle), Part("k", Kind.STIFFNESS, self.stiffness)),
            (self.energy,),
            idle="" if any(multiples(self.angle).values())
            else "no unknown changes its angle, so that this spring does nothing",
        )  # fmt: skip

    def text(self, points: Mapping[str, Place]) -> str:
        """Its energy as problem records write it."""
        pairs = zip(self.rest, ("cos", "sin"), strict=True)
        turned = "".join(
            f" - {_number(value)}*{name}({text_of(self.angle)})" for value, name in pairs if value
        )
        return f"{factor(self.stiffness)}*(1{turned})"
