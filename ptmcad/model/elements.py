"""What descriptions are made of: parameters, springs, loads and moments, each with its expressions as trees."""

from enum import Enum
from fractions import Fraction
from typing import NamedTuple

from ptmcad.text.tree import Call, Chain, Number, Step, Tree
from ptmcad.text.tree import to_text as text_of


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
    """Where an unknown lives."""

    ANGLE = "angle"
    """on the circle"""
    LENGTH = "length"
    """on the line"""
    REAL = "real"
    """on the line, and no length"""


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


class Spring(NamedTuple):
    """A spring between two points; its name, which no other has, is that of its stiffness or is made of its points'."""

    name: str
    start: str
    end: str
    stiffness: Tree
    free: Tree


class Load(NamedTuple):
    """A dead force at a point."""

    point: str
    x: Tree
    y: Tree

    @property
    def names(self) -> tuple[str, str]:
        """Its components as text: the forces' names where they are parameters."""
        return text_of(self.x), text_of(self.y)


class Moment(NamedTuple):
    """A generalised force that works on an unknown: a moment on an angle, a force on a length."""

    unknown: str
    value: Tree


class Closing(NamedTuple):
    """A bar that closes a loop: its ends keep their distance."""

    start: str
    end: str
    length: Tree


class TorsionSpring(NamedTuple):
    """A spring between directions: its energy is stiffness * (1 - cos(angle - rest)).

    Its moment is the energy's derivative by the angle, stiffness * sin(angle - rest): positive where it turns back an
    angle beyond rest, as a spring's force is positive where it pulls back ends that are too far apart.

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
    def energy(self) -> Tree:
        """As a tree; the cosine of the difference is expanded, since only the rest's cosine and sine are known."""
        turned = [
            Chain(Number(value), (Step("*", Call(function, self.angle)),))
            for value, function in zip(self.rest, ("cos", "sin"), strict=True)
        ]
        return Chain(self.stiffness, (Step("*", Chain(Number(Fraction(1)), tuple(Step("-", t) for t in turned))),))

    @property
    def deflection(self) -> tuple[Tree, Tree]:
        """Cosine and sine of angle - rest, expanded in the same way."""
        c, s = (Number(value) for value in self.rest)
        cosine, sine = (Call(function, self.angle) for function in ("cos", "sin"))
        return (
            Chain(Chain(c, (Step("*", cosine),)), (Step("+", Chain(s, (Step("*", sine),))),)),
            Chain(Chain(c, (Step("*", sine),)), (Step("-", Chain(s, (Step("*", cosine),))),)),
        )
