"""What a mechanism and any other parametric system have in common: parameters with kinds, unknowns,
units.

Guarantee: data, and what follows from names and kinds alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from ptmcad.model.criterion import Criterion
from ptmcad.model.elements import Kind, Parameter, Part, Unit, UnknownKind
from ptmcad.text.tree import Name, Tree, names_of

if TYPE_CHECKING:
    from ptmcad.model.description import Mechanism

UNITS: Mapping[Kind, Unit] = {
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
        """The mechanism whose points, bars and springs pages and films show; none of what has
        equations.
        """
        return None

    @property
    def record_key(self) -> str:
        """The key of a record under which its source stands."""
        return "mechanism"

    @property
    def whole(self) -> Mechanism | None:
        """The mechanism that it is, or of whose poses it has the equations; None of another system."""
        return None

    @cached_property
    def criterion(self) -> Criterion:
        """What is known of its solutions."""
        raise NotImplementedError

    @property
    def coupled(self) -> tuple[str, ...]:
        """The unknowns on which a moment works that depends on another one, so that there is no
        potential.
        """
        return ()

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
        """The other variables: those of the polynomial energy, or equations, of springs without
        free lengths.
        """
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
        """Parameters that only stand for others, such as one stiffness for all springs, to those
        others.
        """
        found: dict[str, list[str]] = {}
        for name, parameter in self.parameters.items():
            if parameter.alias_of:
                found.setdefault(parameter.alias_of, []).append(name)
        return {name: tuple(others) for name, others in found.items() if name not in self.variables}

    @cached_property
    def units(self) -> tuple[str, str]:
        """The first length and the first force: what the others are measured in; an empty name
        where there is none.
        """
        return self.first(Kind.LENGTH), self.first(Kind.FORCE)

    def first(self, kind: Kind) -> str:
        """The first parameter of a kind; an empty name when there is none."""
        return next(
            (name for name, parameter in self.parameters.items() if parameter.kind is kind), ""
        )

    def kind(self, name: str) -> Kind:
        """What a parameter measures."""
        return self.parameters[name].kind

    def unit_of(self, name: str) -> Unit:
        """What a parameter or an unknown is measured in; empty of a number, and of what is neither."""
        if name in self.unknowns:
            return self.unknowns[name].unit
        return UNITS.get(self.kind(name), ()) if name in self.parameters else ()

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """What is written in elements and has to be positive, or not negative, and is no parameter
        of such a kind itself; by the keys of the description."""
        elements = {} if self.whole is None else self.whole.elements
        found = (
            part._replace(key=f"{key}.{part.key}")
            for key, element in elements.items()
            for part in element.written
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
        """What its equations or its energy are made of, by the keys of the description; points have
        names there.
        """
        raise NotImplementedError

    def _trees(self) -> Iterator[Tree]:
        """All expressions."""
        for trees in self.polynomials.values():
            yield from trees
