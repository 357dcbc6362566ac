"""A planar mechanism as data: parameters, unknowns, points, bars, and its `elements`, made of
expressions.

And any other parametric system: equations or a potential, and what a solution has to satisfy.

Guarantee: what `ptmcad.model.mechanismrecord` has read is consistent: every name that occurs is a parameter,
an unknown or a point, angles stand inside of cosines and sines only, and every tree has a value in
any ring (`evaluate`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from ptmcad.errors import ExpressionError
from ptmcad.model.antiparallelogram import XJoint
from ptmcad.model.criterion import CONDITIONS, DEFINITENESS, NOTHING, Criterion, by_hessian
from ptmcad.model.elements import (
    Closing,
    Element,
    Kind,
    Load,
    Moment,
    Spring,
    Support,
    TorsionSpring,
    Unit,
    UnknownKind,
)
from ptmcad.model.evaluate import multiples
from ptmcad.model.parametric import UNITS, Model, Nouns
from ptmcad.text.tree import Tree, names_of

__all__ = [
    "ClosedMechanism",
    "Mechanism",
    "Model",
    "System",
    "Unit",
    "equations_in",
    "looped",
]

_TORSION = (
    "energy k (1 - cos(angle - rest)), moment k sin(angle - rest): for small angles that of a linear spring, "
    "k (angle - rest)"
)


@dataclass(frozen=True)
class Mechanism(Model):
    """A mechanism and what follows from its description alone.

    Attributes
    ----------
    points : to the trees of their coordinates, in the unit of the lengths.
    bars : pairs of points, for drawings.
    springs, loads : in the record's order.
    symmetries : substitutions of parameters and unknowns under which the energy changes by what no
        unknown is in.
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
    def drawable(self) -> Mechanism | None:
        return self

    @property
    def whole(self) -> Mechanism:
        return self

    @cached_property
    def elements(self) -> Mapping[str, Element]:
        """What it is made of, by the keys of the description."""
        found = {
            **_numbered("springs", self.springs),
            **_numbered("torsion", self.torsion),
            **_named("loads", self.loads),
            **_named("moments", self.moments),
            **_numbered("closing", self.closing),
            **_named("x-joint", self.xjoints),
        }
        return {key: each.element for key, each in found.items()}

    def written(self, kind: Kind) -> tuple[Tree, ...]:
        """What is written for a kind of quantity, element by element."""
        return tuple(
            part.tree
            for element in self.elements.values()
            for part in element.written
            if part.kind is kind
        )

    @cached_property
    def coordinates(self) -> Mapping[str, Tree]:
        return {
            f"{point}.{c}": tree
            for point, place in self.points.items()
            for c, tree in zip("xy", place, strict=True)
        }

    @cached_property
    def polynomials(self) -> Mapping[str, tuple[Tree, ...]]:
        return {key: element.energies for key, element in self.elements.items() if element.energies}

    @cached_property
    def work(self) -> Mapping[str, Tree]:
        return {moment.unknown: moment.value for moment in self.moments}

    @cached_property
    def coupled(self) -> tuple[str, ...]:
        return tuple(
            u for u, value in self.work.items() if self.unknowns.keys() & set(names_of(value)) - {u}
        )

    @cached_property
    def criterion(self) -> Criterion:
        """A moment that depends on no unknown but its own has a potential, though of several values
        on a circle.
        """
        return NOTHING if self.coupled else by_hessian(len(self.unknowns))

    @cached_property
    def followers(self) -> Mapping[str, str]:
        """The angles that follow from an unknown one, to this: those of the second bars of
        X-joints.
        """
        return {joint.other: joint.angle for joint in self.xjoints}

    @cached_property
    def force_densities(self) -> tuple[str, ...]:
        """Names for the tension of each closing bar divided by its length, which are further
        unknowns where the bars leave several degrees of freedom; else none."""
        several = len(self.unknowns) > len(self.closing) + 1
        return (
            tuple(f"force_density_{bar.start}{bar.end}" for bar in self.closing) if several else ()
        )

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
            if start not in self.moving
            and any(angle in names_of(tree) for tree in self.points[end])
        }

    @property
    def census(self) -> Mapping[tuple[str, str], int]:
        """How many parts of each sort there are, by its noun and its plural."""
        found = {
            ("bar", "bars"): self.bars,
            ("body", "bodies"): self.bodies,
            ("spring", "springs"): self.springs,
            ("torsion spring", "torsion springs"): self.torsion,
            ("load", "loads"): self.loads,
            ("moment", "moments"): self.work.keys() & self.angles,
            ("force on a length", "forces on lengths"): self.work.keys() & self.reals,
        }
        return {nouns: len(parts) for nouns, parts in found.items() if parts}

    @property
    def laws(self) -> Mapping[str, str]:
        """What springs do, by the keys of the description, where it is not what an engineer
        expects.
        """
        return {"torsion": _TORSION} if self.torsion else {}

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
        """Every name under which a spring is asked for, to its number: its own, and its ends' names
        put together.
        """
        ends = {f"{start}{end}": k for k, (start, end) in enumerate(self.spring_ends)}
        return ends | {spring.name: k for k, spring in enumerate(self.springs)}

    def unit_of(self, name: str) -> Unit:
        """As of any model; a stiffness that is a number times those of springs of one sort alone
        has their unit.
        """
        known = super().unit_of(name)
        if known != UNITS[Kind.STIFFNESS]:
            return known
        names = {name, *self.shorthands.get(name, ())}
        stiff = [spring for spring in self.elastic if names & set(names_of(spring.stiffness))]
        found = {spring.unit if _is_multiple(spring.stiffness) else known for spring in stiff}
        return found.pop() if len(found) == 1 else known

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
    """A parametric system of any field: as many equations as unknowns, or a potential whose
    critical points are meant.

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

    @cached_property
    def criterion(self) -> Criterion:
        if self.potential is not None:
            return by_hessian(len(self.unknowns))
        return CONDITIONS if self.stability else NOTHING

    @property
    def conditions(self) -> Mapping[str, Tree]:
        return {**super().conditions, **_numbered("positive", self.inequalities)}

    @cached_property
    def polynomials(self) -> Mapping[str, tuple[Tree, ...]]:
        trees = (
            _numbered("equations", self.equations)
            | dict(self.conditions)
            | _numbered("stable", self.stability)
        )
        found = {key: (tree,) for key, tree in trees.items()}
        return found if self.potential is None else {**found, "potential": (self.potential,)}


@dataclass(frozen=True)
class ClosedMechanism(Model):
    """A mechanism with closed loops, or with X-joints: what its unknowns satisfy follows by
    `ptmcad.model.compile`.

    Attributes
    ----------
    mechanism : as it was described.
    """

    mechanism: Mechanism
    nouns = System.nouns

    __hash__ = Model.__hash__
    __repr__ = Model.__repr__

    @classmethod
    def of(cls, mechanism: Mechanism) -> ClosedMechanism:
        """That of a mechanism, with further unknowns where several degrees of freedom are left."""
        unknowns = {
            **mechanism.unknowns,
            **dict.fromkeys(mechanism.force_densities, UnknownKind.REAL),
        }
        own = mechanism.name, mechanism.parameters, unknowns, mechanism
        return cls(*own, source=mechanism.source, title=mechanism.title)

    @property
    def multipliers(self) -> tuple[str, ...]:
        """The last unknowns, where more degrees of freedom are left: of each closing bar its
        tension divided by its length."""
        return self.mechanism.force_densities

    @property
    def criterion(self) -> Criterion:
        return DEFINITENESS

    @cached_property
    def whole(self) -> Mechanism:
        """The mechanism with the bars that close its loops among the bars, and their tensions among
        the unknowns, for what shows its poses."""
        closing = tuple((closing.start, closing.end) for closing in self.mechanism.closing)
        return replace(self.mechanism, bars=self.mechanism.bars + closing, unknowns=self.unknowns)

    def _trees(self) -> Iterator[Tree]:
        yield from self.mechanism._trees()


def looped(model: Model) -> Mechanism | None:
    """The mechanism whose loops leave one degree of freedom, as it was described; None where there
    are none.
    """
    if not isinstance(model, ClosedMechanism) or model.multipliers or model.mechanism.xjoints:
        return None
    return model.mechanism


def equations_in(model: Model) -> System | None:
    """The system that a model is; None of a mechanism."""
    return model if isinstance(model, System) else None
