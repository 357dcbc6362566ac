"""Springs compiled: lengths, forces, deflections and energies as formulas."""

from __future__ import annotations

from typing import NamedTuple

from ptmcad.formulas.graph import Formula, length

Vector = tuple[Formula, Formula]


class LinearSpring(NamedTuple):
    """A spring between two points: its energy is stiffness (|difference| - free)^2/2.

    Attributes
    ----------
    difference : from its start to its end.
    """

    name: str
    start: str
    end: str
    stiffness: Formula
    free: Formula
    difference: Vector

    @property
    def pull(self) -> Formula:
        """What the energy lacks for each unit of length: stiffness times free length."""
        return self.stiffness * self.free

    @property
    def square(self) -> Formula:
        """Of its length."""
        x, y = self.difference
        return x * x + y * y

    @property
    def length(self) -> Formula:
        return length(*self.difference)

    @property
    def force(self) -> Formula:
        """Positive where it pulls."""
        return self.stiffness * (self.length - self.free)

    @property
    def quantities(self) -> dict[str, Formula]:
        """What poses say of it."""
        return {"length": self.length, "force": self.force}

    @property
    def relaxed_energy(self) -> Formula:
        """As if its free length were zero."""
        return self.stiffness * self.square / 2

    @property
    def energy(self) -> Formula:
        """Where the free length is the number zero without the length, so that short springs are nothing singular."""
        if self.free.value == 0:
            return self.relaxed_energy
        return self.stiffness * (self.length - self.free).squared() / 2


class AngularSpring(NamedTuple):
    """A torsion spring: its energy is stiffness (1 - cos deflection), its moment stiffness sin deflection.

    Attributes
    ----------
    cosine, sine : of its deflection, the angle less the one at rest.
    """

    name: str
    stiffness: Formula
    cosine: Formula
    sine: Formula

    @property
    def moment(self) -> Formula:
        return self.stiffness * self.sine

    @property
    def quantities(self) -> dict[str, Formula]:
        """What poses say of it."""
        return {"deflection.cos": self.cosine, "deflection.sin": self.sine, "moment": self.moment}
