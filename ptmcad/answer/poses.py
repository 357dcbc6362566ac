"""The solutions at one rational point: equilibria with everything that a designer asks of a pose.

Guarantee: all real equilibria are there unless the status is UNDECIDED; every number is exact or an
`Enclosure`. One that holds zero is of a number that is zero or too small to be distinguished from
it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from ptmcad.answer import with_methods
from ptmcad.answer.regionmap import Status
from ptmcad.model import Model
from ptmcad.question.counts import Count
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import Texts

Vector = tuple[Enclosure, Enclosure]


@dataclass(frozen=True, slots=True)
class Spring:
    """A spring in a pose: ``name`` of its stiffness, nodes ``start`` and ``end``; ``force`` is its
    tension, the slope of its energy by its length: negative when the spring is pushed."""

    name: str
    start: str
    end: str
    stiffness: Fraction
    length: Enclosure
    force: Enclosure
    free_length: Fraction = Fraction(0)


@dataclass(frozen=True, slots=True)
class TorsionSpring:
    """A torsion spring in a pose, by the ``name`` of its angle; its energy is
    stiffness * (1 - cos(deflection)).

    ``deflection`` = angle - rest in radians, in (-pi, pi], and the same in ``degrees``, exact when
    rational; ``moment`` = stiffness * sin(deflection), the energy's derivative: positive where it
    turns back what exceeds rest.
    """

    name: str
    stiffness: Fraction
    deflection: Enclosure
    degrees: Enclosure
    moment: Enclosure


_OF_TORSION = (
    ("deflection", "rad", "deflection"),
    ("deflection", "deg", "degrees"),
    ("moment", "", "moment"),
)
"""What is said of a torsion spring: the words, the unit, and the field."""
_TORSION = "deflection: angle - rest; moment: k sin(deflection), positive where it turns back an angle beyond rest"


NamedNumber = tuple[str, str, Enclosure]
"""A number of a pose: its name, its unit where that is none of the record's, and the number."""


def springs_of(
    elastic: tuple[Any, Any], constant: Callable[[Any], Fraction], stretch: Callable[[Any], tuple[Any, Any]],
    turn: Callable[[Any], Any],
) -> dict[str, Any]:  # fmt: skip
    """The springs of a pose, between points and between directions, by the fields' names.

    Parameters
    ----------
    elastic : as of a compiled model.
    constant : the value of a stiffness or a free length.
    stretch : length and force of a spring.
    turn : deflection of a torsion spring, in radians and in degrees, and its moment.
    """
    linear, angular = elastic
    return {
        "springs": tuple(
            Spring(s.name, s.start, s.end, constant(s.stiffness), *stretch(s), constant(s.free))
            for s in linear
        ),
        "torsion": tuple(TorsionSpring(s.name, constant(s.stiffness), *turn(s)) for s in angular),
    }


@dataclass(frozen=True, slots=True)
class Pose:
    """One equilibrium.

    Attributes
    ----------
    angles : the unknown angles in radians, in (-pi, pi].
    degrees : the same in degrees, exact when rational.
    cosines_sines : cosine and sine of each.
    reals : the unknowns on the line.
    nodes : the mechanism's points to their coordinates, in the unit of the lengths; none of another
        system.
    energy : of springs and loads, in force times length, without the work of constant moments; or a
        system's potential. None where there is none: of equations, and where a moment depends on
        another unknown.
    eigenvalues : of the Hessian by the unknowns, the smallest first; none without a potential.
    multiplicity : of the solution in its fibre; 1 exactly when the Jacobian is nonsingular.
    index : number of negative eigenvalues when the Hessian is nonsingular, else None.
    stable : whether the Hessian is positive definite, or a system's conditions hold; None when it
        is singular, nothing says what stable is, or it is not decided.
    flat : whether all points of a mechanism lie on the x axis, exactly.
    further : by the names of their counts, whether it is stable and predicates of
        `ptmcad.question.counts` hold, as far as that is decided.
    torsion : the torsion springs, in the description's order.
    """

    angles: tuple[Enclosure, ...]
    degrees: tuple[Enclosure, ...]
    cosines_sines: tuple[Enclosure, ...]
    nodes: Mapping[str, Vector]
    springs: tuple[Spring, ...]
    energy: Enclosure | None
    eigenvalues: tuple[Enclosure, ...]
    multiplicity: int
    index: int | None
    stable: bool | None
    flat: bool
    further: Mapping[str, bool] = field(default_factory=dict)
    reals: tuple[Enclosure, ...] = ()
    torsion: tuple[TorsionSpring, ...] = ()

    @property
    def admissible(self) -> bool | None:
        """Whether it is stable with every spring longer than its free length, as cables demand;
        None when the springs have no free lengths, or it is not decided."""
        return self.further.get(Count.ADMISSIBLE.value)

    @property
    def notes(self) -> Texts:
        """What words of its quantities stand for."""
        return {"torsion": _TORSION} if self.torsion else {}

    @property
    def forces(self) -> tuple[Enclosure, ...]:
        """Of the springs, positive where one is longer than its free length."""
        return tuple(spring.force for spring in self.springs)

    @property
    def has_predicates(self) -> bool:
        """Whether it is asked if predicates hold: where some spring has a free length, or it is
        said that they do.
        """
        return bool(self.further) or any(spring.free_length for spring in self.springs)

    @property
    def may_be_slack(self) -> bool:
        """Whether it is not proved to be admissible although some spring has a free length."""
        return self.has_predicates and self.admissible is not True

    def as_known_to(self, other: Pose) -> Pose:
        """Without the torsion springs where another pose, which version 0.1.0 wrote, has none."""
        return self if other.torsion else replace(self, torsion=())

    def quantities(self, model: Model) -> tuple[tuple[NamedNumber, ...], ...]:
        """Unknowns, coordinates of points that move, springs' lengths and forces, torsion springs'
        deflections and moments; the same ones for all poses of a model."""
        moving = () if model.whole is None else model.whole.moving
        unknowns = [
            (name, unit, number)
            for unit, names, numbers in (
                ("rad", model.angles, self.angles),
                ("deg", model.angles, self.degrees),
                ("", model.reals, self.reals),
            )
            for name, number in zip(names, numbers, strict=True)
        ]
        nodes = [
            (f"{name} {axis}", "", x)
            for name, place in self.nodes.items()
            if name in moving
            for axis, x in zip("xy", place, strict=True)
        ]
        springs = [
            (f"{what} {spring.start}{spring.end}", "", getattr(spring, what))
            for what in ("length", "force")
            for spring in self.springs
        ]
        torsion = [
            (f"{what} {spring.name}", unit, getattr(spring, field))
            for what, unit, field in _OF_TORSION
            for spring in self.torsion
        ]
        return tuple(unknowns), tuple(nodes), tuple(springs), tuple(torsion)

    def __repr__(self) -> str:
        kind = {True: "stable", False: "unstable", None: "degenerate, or not decided"}[self.stable]
        angles = ", ".join(f"{d.text(6)}°" for d in self.degrees)
        reals = ", ".join(r.text(6) for r in self.reals)
        energy = "" if self.energy is None else f", energy {self.energy.text(6)}"
        return f"<Pose {kind}: {', '.join(filter(None, (angles, reals)))}{energy}>"

    @property
    def known_energy(self) -> Enclosure:
        """The energy of a pose that has one; raises `ValueError` for others."""
        if self.energy is None:
            raise ValueError(
                "equations, and moments that depend on other unknowns, leave solutions without an energy"
            )
        return self.energy


@with_methods
@dataclass(frozen=True, slots=True)
class Poses:
    """All equilibria at one point.

    Attributes
    ----------
    model : the mechanism or system.
    parameters : every one of its parameters to its value.
    equilibria : stable ones first, then by energy.
    status : EXACT; CERTIFIED with free lengths, none degenerate; ON_VARIETY when an equilibrium is
        degenerate; UNDECIDED with those that are proved when there are infinitely many or some
        could not be separated; see ``remark``.
    digits : significant digits that each enclosure settles, but for one that holds zero; one more
        where it cannot be distinguished from halfway between two such texts.
    bits : the precision that was needed.
    units : of ``length`` and ``force``, where the record declares them; nothing but text depends on
        them.
    undecided : number of boxes of configurations in which there may be more equilibria.
    """

    model: Model
    parameters: Mapping[str, Fraction]
    equilibria: tuple[Pose, ...]
    status: Status
    digits: int
    bits: int
    remark: str = ""
    units: Texts = field(default_factory=dict)
    undecided: int = 0

    @property
    def mechanism(self) -> str:
        """The model's name."""
        return self.model.name

    @property
    def stable(self) -> int:
        """The number of stable equilibria."""
        return sum(p.stable is True for p in self.equilibria)

    @property
    def known_stable(self) -> int | None:
        """The same; None where nothing says which are stable."""
        return self.model.criterion.number(pose.stable for pose in self.equilibria)

    @property
    def in_order(self) -> tuple[Pose, ...]:
        """Stable equilibria first, then the others, each by energy, as they are stored."""
        return tuple(sorted(self.equilibria, key=lambda pose: pose.stable is not True))

    @property
    def working(self) -> tuple[Pose, ...]:
        """The stable equilibria, or all of them where nothing says which are stable."""
        return tuple(pose for pose in self.in_order if self.model.criterion.works(pose.stable))

    def __str__(self) -> str:
        return self.table()

    def __repr__(self) -> str:
        stable = "" if self.known_stable is None else f", {self.known_stable} stable"
        return f"<Poses of {self.mechanism}: {len(self.equilibria)}{stable}, {self.status.value}>"

    if TYPE_CHECKING:  # `ptmcad.methods` has them

        def table(self, digits: int | None = None) -> str: ...

        def to_json(self) -> str: ...

        @classmethod
        def from_json(cls, text: str) -> Poses: ...


DIGITS = 12
MAX_DIGITS = 1000
