"""A planar mechanism as data: parameters, unknowns, points, bars, and its `elements`, made of expressions.

And any other parametric system: equations or a potential, and what a solution has to satisfy; so are a mechanism's
closed loops.

Guarantee: what `ptmcad.model.record` has read is consistent: every name that occurs is a parameter, an unknown or a
point, angles stand inside of cosines and sines only, and every tree has a value in any ring (`evaluate`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

from ptmcad.errors import ExpressionError
from ptmcad.model.elements import (
    NAMES,
    Closing,
    Element,
    Kind,
    Load,
    Moment,
    Parameter,
    Part,
    Place,
    Spring,
    Support,
    TorsionSpring,
    Unit,
    UnknownKind,
    XJoint,
)
from ptmcad.model.evaluate import multiples
from ptmcad.text.tree import Name, Tree, names_of

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
    def drawable(self) -> Mechanism | None:
        """The mechanism whose points, bars and springs pages and films show; none of what has equations."""
        return None

    @property
    def record_key(self) -> str:
        """The key of a record under which its source stands."""
        return "mechanism"

    @property
    def whole(self) -> Mechanism | None:
        """The mechanism that it is, or of whose poses it has the equations; None of another system."""
        return None

    @property
    def has_potential(self) -> bool:
        """Whether solutions are critical points, whose Hessian has an index and tells what is stable."""
        return True

    @property
    def tells_stability(self) -> bool:
        """Whether it is known what a stable solution is."""
        return self.has_potential

    @property
    def stability(self) -> tuple[Tree, ...]:
        """What is positive where a solution is stable; nothing where its index says so."""
        return ()

    def __hash__(self) -> int:
        return hash((type(self).__name__, self.name, *self.parameters, *self.unknowns))

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}: unknowns {', '.join(self.unknowns)}; {', '.join(self.parameters)}>"

    @cached_property
    def angles(self) -> tuple[str, ...]:
        """The unknowns on the circle."""
        return tuple(name for name, kind in self.unknowns.items() if kind.turns)

    @cached_property
    def reals(self) -> tuple[str, ...]:
        """The unknowns on the line."""
        return tuple(name for name, kind in self.unknowns.items() if not kind.turns)

    @cached_property
    def sorted_unknowns(self) -> tuple[str, ...]:
        """The unknowns as answers list them: angles first."""
        return self.angles + self.reals

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
        """What a parameter or an unknown is measured in; empty of a number, and of what is neither."""
        if name in self.unknowns:
            return self.unknowns[name].unit
        return _UNITS.get(self.kind(name), ()) if name in self.parameters else ()

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """What is written in elements and has to be positive, or not negative, and is no parameter of such a kind
        itself; by the keys of the description."""
        elements = {} if self.whole is None else self.whole.elements
        found = (
            part._replace(key=f"{key}.{part.key}") for key, element in elements.items() for part in element.written
        )
        return tuple(part for part in found if self._has_to_be_shown(part))

    def _has_to_be_shown(self, part: Part) -> bool:
        if not (part.kind.is_positive or part.kind.may_vanish):
            return False
        known = self.kind(part.tree.name) if isinstance(part.tree, Name) else Kind.NUMBER
        return not (known.is_positive or (known.may_vanish and part.kind.may_vanish))

    @cached_property
    def work(self) -> Mapping[str, Tree]:
        """The unknowns on which moments work, to these."""
        return {}

    @cached_property
    def coordinates(self) -> Mapping[str, Tree]:
        """What the names ``P.x`` and ``P.y`` of its points stand for."""
        return {}

    @property
    def conditions(self) -> Mapping[str, Tree]:
        """What is positive at solutions that count, by the keys of the description."""
        return {}

    @cached_property
    def polynomials(self) -> Mapping[str, tuple[Tree, ...]]:
        """What its equations or its energy are made of, by the keys of the description; points have names there."""
        raise NotImplementedError

    def _trees(self) -> Iterator[Tree]:
        """All expressions."""
        for trees in self.polynomials.values():
            yield from trees


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
    closing, xjoints : bars that close loops, and X-joints; with any, `ptmcad.model.loops` makes a
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
    def drawable(self) -> Mechanism | None:
        return self

    @property
    def whole(self) -> Mechanism:
        return self

    def elements_with(self, points: Mapping[str, Place]) -> Mapping[str, Element]:
        """What it is made of, by the keys of the description, given the points' coordinates."""
        found = {
            **_numbered("springs", self.springs),
            **_numbered("torsion", self.torsion),
            **_named("loads", self.loads),
            **_named("moments", self.moments),
            **_numbered("closing", self.closing),
            **_named("x-joint", self.xjoints),
        }
        return {key: each.element(points) for key, each in found.items()}

    @cached_property
    def elements(self) -> Mapping[str, Element]:
        """The same with the points' coordinates as names, ``P.x`` and ``P.y``."""
        return self.elements_with(NAMES)

    def written(self, kind: Kind) -> tuple[Tree, ...]:
        """What is written for a kind of quantity, element by element."""
        return tuple(part.tree for element in self.elements.values() for part in element.written if part.kind is kind)

    @cached_property
    def coordinates(self) -> Mapping[str, Tree]:
        return {
            f"{point}.{c}": tree for point, place in self.points.items() for c, tree in zip("xy", place, strict=True)
        }

    @cached_property
    def polynomials(self) -> Mapping[str, tuple[Tree, ...]]:
        return {key: element.energies for key, element in self.elements.items() if element.energies}

    @cached_property
    def work(self) -> Mapping[str, Tree]:
        return {moment.unknown: moment.value for moment in self.moments}

    @cached_property
    def coupled(self) -> tuple[str, ...]:
        """The unknowns on which a moment works that depends on another one, so that there is no potential."""
        return tuple(u for u, value in self.work.items() if self.unknowns.keys() & set(names_of(value)) - {u})

    @property
    def has_potential(self) -> bool:
        """A moment that depends on no unknown but its own has one, though of several values on a circle."""
        return not self.coupled

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

    @property
    def elastic(self) -> tuple[Spring | TorsionSpring, ...]:
        """The springs, between points and then between directions."""
        return self.springs + self.torsion

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
        stiff = [spring for spring in self.elastic if names & set(names_of(spring.stiffness))]
        turning = stiff and all(spring in self.torsion and _is_multiple(spring.stiffness) for spring in stiff)
        return self.energy_unit if turning else known

    def _trees(self) -> Iterator[Tree]:
        yield from self.coordinates.values()
        yield from (part.tree for element in self.elements.values() for part in element.written)


def _numbered(key: str, entries: Iterable[Any]) -> dict[str, Any]:
    return {f"{key}.{n}": entry for n, entry in enumerate(entries, 1)}


def _named(key: str, entries: Iterable[Any]) -> dict[str, Any]:
    """By their names, which come first in each."""
    return {f"{key}.{entry[0]}": entry for entry in entries}


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

    @property
    def conditions(self) -> Mapping[str, Tree]:
        return _numbered("positive", self.inequalities)

    @cached_property
    def polynomials(self) -> Mapping[str, tuple[Tree, ...]]:
        trees = _numbered("equations", self.equations) | dict(self.conditions) | _numbered("stable", self.stability)
        found = {key: (tree,) for key, tree in trees.items()}
        return found if self.potential is None else {**found, "potential": (self.potential,)}


@dataclass(frozen=True, eq=False)  # equal where the systems are: nothing more is compared
class ClosedMechanism(System):
    """A mechanism with closed loops, or with X-joints, as the equations of its equilibria; without its springs' free
    lengths, as `without_free_lengths` has none of their parameters.

    Its conditions for stability hold together where a symmetric matrix is positive definite, and the last one is the
    determinant of that matrix, times what is positive: so off its zeros no other one matters where it changes its sign.

    Attributes
    ----------
    mechanism : as it was described.
    tangent : the direction in which loops with one degree of freedom let the unknowns move; zero where one folds flat.
    multipliers : the last unknowns, where more degrees of freedom are left: of each closing bar its tension divided by
        its length.
    """

    mechanism: Mechanism = field(kw_only=True, compare=False)
    tangent: tuple[Tree, ...] = field(kw_only=True, compare=False)
    multipliers: tuple[str, ...] = field(default=(), kw_only=True, compare=False)

    __hash__ = Model.__hash__
    __repr__ = Model.__repr__

    @classmethod
    def of(cls, mechanism: Mechanism, further: Mapping[str, UnknownKind], **parts: Any) -> ClosedMechanism:
        """That of a mechanism, with further unknowns."""
        return cls(
            mechanism.name, mechanism.parameters, {**mechanism.unknowns, **further}, **parts, mechanism=mechanism,
            multipliers=tuple(further), source=mechanism.source, title=mechanism.title,
        )  # fmt: skip

    @property
    def record_key(self) -> str:
        return "mechanism"

    @cached_property
    def whole(self) -> Mechanism:
        """The mechanism with the bars that close its loops among the bars, and their tensions among the unknowns, for
        what shows its poses."""
        closing = tuple((closing.start, closing.end) for closing in self.mechanism.closing)
        return replace(self.mechanism, bars=self.mechanism.bars + closing, unknowns=self.unknowns)

    def _trees(self) -> Iterator[Tree]:
        yield from super()._trees()
        yield from self.mechanism._trees()


def looped(model: Model) -> Mechanism | None:
    """The mechanism whose loops leave one degree of freedom, as it was described; None where there are none."""
    return model.mechanism if isinstance(model, ClosedMechanism) and model.tangent else None


def equations_in(model: Model) -> System | None:
    """The system that a model is, also in the place of closed loops; None of another mechanism."""
    return model if isinstance(model, System) else None


def mechanism_in(model: Model) -> Mechanism | None:
    """The mechanism that a model is, or of whose poses it has the equations; None of another system."""
    return model.whole
