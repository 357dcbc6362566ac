"""Springs compiled: lengths, forces, deflections and energies as formulas."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from ptmcad.formulas.graph import Formula, length
from ptmcad.model.elements import Law, Spring
from ptmcad.model.evaluate import Ring, evaluated, value_among
from ptmcad.text.tree import Tree

Vector = tuple[Formula, Formula]


class ElasticLine(NamedTuple):
    """A spring between two points, by its law.

    Attributes
    ----------
    difference, square : from its start to its end, and the square of its length.
    smooth, density : its energy, and its force for each unit of length, as if its free length were
        zero.
    pull : what its energy with the free length lacks for each unit of length.
    """

    name: str
    start: str
    end: str
    law: Law
    stiffness: Formula
    free: Formula
    difference: Vector
    square: Formula
    smooth: Formula
    pull: Formula
    density: Formula

    @classmethod
    def of(cls, spring: Spring, points: Mapping[str, Vector], ring: Ring[Formula]) -> ElasticLine:
        (x0, y0), (x1, y1) = points[spring.start], points[spring.end]
        x, y = x1 - x0, y1 - y0
        stiffness, free = evaluated((spring.stiffness, spring.free), ring)
        names = {"k": stiffness, "f": free, "q": x * x + y * y}
        law = spring.law
        of_law = (
            value_among(tree, names, ring.constant) for tree in (law.smooth, law.pull, law.density)
        )
        return cls(
            spring.name, spring.start, spring.end, law, stiffness, free, (x, y), names["q"], *of_law
        )

    @property
    def length(self) -> Formula:
        return length(*self.difference)

    @property
    def force(self) -> Formula:
        """Positive where it pulls."""
        return self._at(self.law.force, self.length, self.square)

    @property
    def quantities(self) -> dict[str, Formula]:
        """What poses say of it."""
        return {"length": self.length, "force": self.force}

    @property
    def energy(self) -> Formula:
        """Where the free length is the number zero without the length, so that short springs are
        nothing singular.
        """
        return (
            self.smooth
            if self.free.value == 0
            else self._at(self.law.energy, self.length, self.square)
        )

    @property
    def collapsed(self) -> Formula:
        """The energy where it has no length."""
        nothing = self.stiffness.graph.constant(0)
        return self._at(self.law.energy, nothing, nothing)

    def _at(self, tree: Tree, extent: Formula, square: Formula) -> Formula:
        """A formula of the law at a length."""
        names = {"k": self.stiffness, "f": self.free, "l": extent, "q": square}
        return value_among(tree, names, self.stiffness.graph.constant)


class AngularSpring(NamedTuple):
    """A spring between directions: its energy is stiffness (1 - cos deflection), its moment
    stiffness sin deflection.

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
