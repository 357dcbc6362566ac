"""A planar mechanism as data: parameters, unknowns, points, bars, springs and loads (`elements`), made of expressions.

And any other parametric system: equations or a potential, and what a solution has to satisfy.

Guarantee: what `ptmcad.model.record` has read is consistent: every name that occurs is a parameter, an unknown or a
point, angles stand inside of cosines and sines only, and every tree has a value in any ring (`evaluate`).
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

from ptmcad.errors import ExpressionError
from ptmcad.model.elements import (
    Closing,
    Kind,
    Load,
    Moment,
    Parameter,
    Spring,
    Support,
    TorsionSpring,
    UnknownKind,
)
from ptmcad.model.evaluate import multiples
from ptmcad.model.xjoint import XJoint
from ptmcad.text.tree import Tree, names_of

Unit = tuple[str, ...]
"""Quantities, ``length`` and ``force``, and between two of them what joins them."""
_UNITS: Mapping[Kind, Unit] = {
    Kind.LENGTH: ("length",),
    Kind.BASE: ("length",),
    Kind.STIFFNESS: ("force", "/", "length"),
    Kind.FORCE: ("force",),
}


class Nouns(NamedTuple):
    """What solutions of one kind of model are called where they are followed, drawn and counted.

    Attributes
    ----------
    pose : one of them.
    whole : what is in it, with its article.
    total : what follows the number of all; empty where that is what they are called themselves.
    range : the parameters with as many stable ones as there are anywhere.
    range_with : the same with room for their number.
    usual : the number of stable ones that a range has which is called without it; 0 where none is.
    """

    pose: str
    whole: str
    total: str
    range: str
    range_with: str
    usual: int


@dataclass(frozen=True)
class Model:
    """What a mechanism and any other parametric system have in common.

    Attributes
    ----------
    parameters : by name; free lengths come last, and an alias after what it is an alias of.
    unknowns : in the order in which solutions list them.
    source : the record that it was read from; none for a built-in one.
    title : what the report calls it, where that is not its name.
    """

    name: str
    parameters: Mapping[str, Parameter]
    unknowns: Mapping[str, UnknownKind]
    source: Mapping[str, Any] = field(default_factory=dict, compare=False, repr=False, kw_only=True)
    title: str = field(default="", compare=False, repr=False, kw_only=True)
    nouns: ClassVar[Nouns]
    energy_unit: ClassVar[Unit] = ()

    @property
    def drawable(self) -> "Mechanism | None":
        """The mechanism whose points, bars and springs pages and films show; none of what has equations."""
        return None

    @property
    def record_key(self) -> str:
        """The key of a record under which its source stands."""
        return "mechanism"

    @property
    def has_potential(self) -> bool:
        """Whether solutions are critical points, whose Hessian has an index and tells what is stable."""
        return True

    @property
    def tells_stability(self) -> bool:
        """Whether it is known what a stable solution is."""
        return self.has_potential

    def __hash__(self) -> int:
        return hash((type(self).__name__, self.name, *self.parameters, *self.unknowns))

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}: unknowns {', '.join(self.unknowns)}; {', '.join(self.parameters)}>"

    @cached_property
    def angles(self) -> tuple[str, ...]:
        """The unknowns on the circle."""
        return tuple(name for name, kind in self.unknowns.items() if kind is UnknownKind.ANGLE)

    @cached_property
    def reals(self) -> tuple[str, ...]:
        """The unknowns on the line."""
        return tuple(name for name, kind in self.unknowns.items() if kind is not UnknownKind.ANGLE)

    @cached_property
    def variables(self) -> tuple[str, ...]:
        """The parameters that something uses, in their order."""
        used = {name for tree in self._trees() for name in names_of(tree)}
        return tuple(name for name in self.parameters if name in used)

    @cached_property
    def idle(self) -> tuple[str, ...]:
        """The parameters that nothing in the description uses: those of a record's own expressions."""
        used = {*self.variables, *self.shorthands}
        return tuple(name for name in self.parameters if name not in used)

    @cached_property
    def free_lengths(self) -> tuple[str, ...]:
        """The variables that are free lengths."""
        return self._of(Kind.FREE_LENGTH)

    @cached_property
    def without_free_lengths(self) -> tuple[str, ...]:
        """The other variables: those of the polynomial energy, or equations, of springs without free lengths."""
        return self._of(*(kind for kind in Kind if kind is not Kind.FREE_LENGTH))

    @cached_property
    def positive(self) -> tuple[str, ...]:
        """The variables that have to be positive: bars' lengths and stiffnesses."""
        return self._of(*(kind for kind in Kind if kind.is_positive))

    @cached_property
    def nonnegative(self) -> tuple[str, ...]:
        """The variables that may be zero, but not negative: bases and free lengths."""
        return self._of(*(kind for kind in Kind if kind.may_vanish))

    @cached_property
    def stiffnesses(self) -> tuple[str, ...]:
        """The variables that are stiffnesses."""
        return self._of(Kind.STIFFNESS)

    @cached_property
    def forces(self) -> tuple[str, ...]:
        """The variables that are forces."""
        return self._of(Kind.FORCE)

    def _of(self, *kinds: Kind) -> tuple[str, ...]:
        return tuple(name for name in self.variables if self.kind(name) in kinds)

    @cached_property
    def shorthands(self) -> Mapping[str, tuple[str, ...]]:
        """Parameters that only stand for others, such as one stiffness for all springs, to those others."""
        found: dict[str, list[str]] = {}
        for name, parameter in self.parameters.items():
            if parameter.alias_of:
                found.setdefault(parameter.alias_of, []).append(name)
        return {name: tuple(others) for name, others in found.items() if name not in self.variables}

    @cached_property
    def units(self) -> tuple[str, str]:
        """The first length and the first force: what the others are measured in; an empty name where there is none."""
        return self.first(Kind.LENGTH), self.first(Kind.FORCE)

    def first(self, kind: Kind) -> str:
        """The first parameter of a kind; an empty name when there is none."""
        return next((name for name, parameter in self.parameters.items() if parameter.kind is kind), "")

    def kind(self, name: str) -> Kind:
        """What a parameter measures."""
        return self.parameters[name].kind

    def unit_of(self, name: str) -> Unit:
        """What a parameter is measured in; empty of a number, and of what is no parameter."""
        return _UNITS.get(self.kind(name), ()) if name in self.parameters else ()

    def _trees(self) -> Iterator[Tree]:
        """All expressions."""
        raise NotImplementedError


@dataclass(frozen=True)
class Mechanism(Model):
    """A mechanism and what follows from its description alone.

    Attributes
    ----------
    points : to the trees of their coordinates, in the unit of the lengths.
    bars : pairs of points, for drawings.
    springs, loads : in the record's order.
    symmetries : substitutions of parameters and unknowns under which the energy changes by what no unknown is in.
    bodies : to the points fixed to them, for drawings.
    moments : generalised forces that need not come from a potential.
    torsion : springs between directions, in the record's order.
    closing, xjoints : bars that close loops, and X-joints; with any, `ptmcad.model.closed` makes a
        `ClosedMechanism` of it.
    """

    points: Mapping[str, tuple[Tree, Tree]]
    bars: tuple[tuple[str, str], ...]
    supports: Mapping[str, Support]
    springs: tuple[Spring, ...]
    loads: tuple[Load, ...]
    symmetries: tuple[Mapping[str, Tree], ...] = ()
    bodies: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    moments: tuple[Moment, ...] = ()
    torsion: tuple[TorsionSpring, ...] = ()
    closing: tuple[Closing, ...] = ()
    xjoints: tuple[XJoint, ...] = ()

    nouns = Nouns("pose", "the mechanism", "in all", "operation range", "operation range ({})", 2)
    energy_unit = ("force", "·", "length")

    __hash__ = Model.__hash__
    __repr__ = Model.__repr__

    @property
    def drawable(self) -> "Mechanism | None":
        return self

    @property
    def has_potential(self) -> bool:
        """A moment that depends on no unknown but its own has one, though of several values on a circle."""
        return all(self.unknowns.keys() & set(names_of(moment.value)) <= {moment.unknown} for moment in self.moments)

    @cached_property
    def followers(self) -> Mapping[str, str]:
        """The angles that follow from an unknown one, to this: those of the second bars of X-joints."""
        return {joint.other: joint.angle for joint in self.xjoints}

    @cached_property
    def moving(self) -> tuple[str, ...]:
        """The points whose coordinates depend on an unknown."""
        return tuple(
            name
            for name, (x, y) in self.points.items()
            if {*names_of(x), *names_of(y)} & {*self.unknowns, *self.followers}
        )

    @cached_property
    def rising(self) -> tuple[str, ...]:
        """Those of them whose height does, unlike that of a slider on a level."""
        movers = {*self.unknowns, *self.followers}
        return tuple(name for name in self.moving if set(names_of(self.points[name][1])) & movers)

    @cached_property
    def pivots(self) -> Mapping[str, str]:
        """The angles that turn a bar about a point that no unknown moves, to those points."""
        return {
            angle: start
            for angle in self.angles
            for bar in self.bars
            for start, end in (bar, bar[::-1])
            if start not in self.moving and any(angle in names_of(tree) for tree in self.points[end])
        }

    @cached_property
    def spring_ends(self) -> tuple[tuple[str, str], ...]:
        """The points between which each spring is, in their order."""
        return tuple((spring.start, spring.end) for spring in self.springs)

    @cached_property
    def loaded(self) -> tuple[str, ...]:
        """The points at which each load acts, in their order."""
        return tuple(load.point for load in self.loads)

    @cached_property
    def spring_numbers(self) -> Mapping[str, int]:
        """Every name under which a spring is asked for, to its number: its own, and its ends' names put together."""
        ends = {f"{start}{end}": k for k, (start, end) in enumerate(self.spring_ends)}
        return ends | {spring.name: k for k, spring in enumerate(self.springs)}

    def unit_of(self, name: str) -> Unit:
        """As of any model; a stiffness that is a number times those of torsion springs alone is a moment."""
        known = super().unit_of(name)
        if known != _UNITS[Kind.STIFFNESS]:
            return known
        names = {name, *self.shorthands.get(name, ())}
        turning = [spring.stiffness for spring in self.torsion if names & set(names_of(spring.stiffness))]
        pulling = any(names & set(names_of(spring.stiffness)) for spring in self.springs)
        return self.energy_unit if turning and not pulling and all(map(_is_multiple, turning)) else known

    def held(self, support: Support) -> str:
        """The first point that is held so; an empty name when there is none."""
        return next((name for name, kind in self.supports.items() if kind is support), "")

    def _trees(self) -> Iterator[Tree]:
        for point in self.points.values():
            yield from point
        for spring in self.springs:
            yield from (spring.stiffness, spring.free)
        for load in self.loads:
            yield from (load.x, load.y)
        for moment in self.moments:
            yield moment.value
        for torsion in self.torsion:
            yield from (torsion.angle, torsion.stiffness)
        for closing in self.closing:
            yield closing.length
        for joint in self.xjoints:
            yield from (joint.length, joint.bars)


def _is_multiple(tree: Tree) -> bool:
    """Whether an expression is a number times a name."""
    try:
        return len(multiples(tree)) == 1
    except ExpressionError:
        return False


@dataclass(frozen=True)
class System(Model):
    """A parametric system of any field: as many equations as unknowns, or a potential whose critical points are meant.

    Attributes
    ----------
    equations : each is zero at a solution; empty where there is a potential.
    inequalities : a solution counts where all of them are positive.
    stability : without a potential, a solution is stable where all of these are positive.
    """

    equations: tuple[Tree, ...]
    potential: Tree | None = None
    inequalities: tuple[Tree, ...] = ()
    stability: tuple[Tree, ...] = ()
    nouns = Nouns("solution", "the state", "", "range", "range with {}", 0)

    __hash__ = Model.__hash__
    __repr__ = Model.__repr__

    @property
    def record_key(self) -> str:
        return "system"

    @property
    def has_potential(self) -> bool:
        return self.potential is not None

    @property
    def tells_stability(self) -> bool:
        """Whether it is known what a stable solution is."""
        return self.has_potential or bool(self.stability)

    def _trees(self) -> Iterator[Tree]:
        yield from self.equations
        if self.potential is not None:
            yield self.potential
        yield from self.inequalities
        yield from self.stability
