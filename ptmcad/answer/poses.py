"""Equilibria of the mechanism at one rational point, with everything that a designer asks of a pose.

Guarantee: all real equilibria are there; every number is exact or an `Enclosure`; what is zero is known to be zero.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from ptmcad.answer import with_methods
from ptmcad.answer.regionmap import Status
from ptmcad.text.enclosure import Enclosure

Vector = tuple[Enclosure, Enclosure]


@dataclass(frozen=True, slots=True)
class Spring:
    """A spring in a pose: ``name`` of its stiffness, nodes ``start`` and ``end``; ``force`` = stiffness * (length -
    free_length) is its tension, negative when the spring is pushed."""

    name: str
    start: str
    end: str
    stiffness: Fraction
    length: Enclosure
    force: Enclosure
    free_length: Fraction = Fraction(0)


@dataclass(frozen=True, slots=True)
class Pose:
    """One equilibrium.

    Attributes
    ----------
    angles : th1, th2 in radians, in (-pi, pi].
    degrees : the same in degrees, exact when rational.
    cosines_sines : cos th1, sin th1, cos th2, sin th2.
    nodes : A1, A2, A3, A4 to their coordinates, in the unit of the lengths.
    energy : of springs and loads, in force times length.
    eigenvalues : of the Hessian by the angles, the smaller first.
    multiplicity : of the solution in its fibre; 1 exactly when the Hessian is nonsingular.
    index : number of negative eigenvalues when the Hessian is nonsingular, else None.
    stable : whether the Hessian is positive definite; None when it is singular.
    flat : whether all four nodes lie on one line with A1A2 (both sines are exactly zero).
    admissible : whether it is stable with every spring longer than its free length, as cables demand; None when the
        springs have no free lengths.
    """

    angles: tuple[Enclosure, Enclosure]
    degrees: tuple[Enclosure, Enclosure]
    cosines_sines: tuple[Enclosure, Enclosure, Enclosure, Enclosure]
    nodes: Mapping[str, Vector]
    springs: tuple[Spring, ...]
    energy: Enclosure
    eigenvalues: tuple[Enclosure, Enclosure]
    multiplicity: int
    index: int | None
    stable: bool | None
    flat: bool
    admissible: bool | None = None


@with_methods
@dataclass(frozen=True, slots=True)
class Poses:
    """All equilibria at one point.

    Attributes
    ----------
    parameters : every parameter of the mechanism to its value.
    equilibria : stable ones first, then by energy.
    status : EXACT; CERTIFIED with free lengths, none degenerate; ON_VARIETY when an equilibrium is degenerate;
        UNDECIDED with no equilibria when there are infinitely many or they could not be separated; see ``remark``.
    digits : significant digits that each enclosure settles.
    bits : the precision that was needed.
    """

    mechanism: str
    parameters: Mapping[str, Fraction]
    equilibria: tuple[Pose, ...]
    status: Status
    digits: int
    bits: int
    remark: str = ""

    @property
    def stable(self) -> int:
        """The number of stable equilibria."""
        return sum(p.stable is True for p in self.equilibria)

    def __str__(self) -> str:
        return self.table()

    if TYPE_CHECKING:  # `ptmcad.methods` has them

        def table(self, digits: int | None = None) -> str: ...

        def to_json(self) -> str: ...

        @classmethod
        def from_json(cls, text: str) -> Poses: ...


DIGITS = 12
MAX_DIGITS = 1000
