"""The potential of a mechanism as its description says it: a formula, with the coordinates and springs it is made of.

Guarantee: every term is read off the description, no mechanism is known by name. A spring whose free length is zero
enters without its length, so that nothing is singular where it is short.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from ptmcad.formulas.graph import Formula, Graph, length
from ptmcad.model import Mechanism
from ptmcad.model.energy import points_in, with_springs
from ptmcad.model.evaluate import evaluate


@dataclass(frozen=True, slots=True)
class Potential:
    """A mechanism in one configuration.

    Attributes
    ----------
    points : coordinates, by name.
    lengths, forces : of the springs, in the description's order; a force is positive where the spring pulls.
    deflections : cosine and sine of each torsion spring's angle less the one at rest.
    energy : of the springs, torsion springs too, minus the loads' work, and that of moments as far as it has one value.
    """

    points: Mapping[str, tuple[Formula, Formula]]
    lengths: tuple[Formula, ...]
    forces: tuple[Formula, ...]
    energy: Formula
    deflections: tuple[tuple[Formula, Formula], ...] = ()


def potential(mechanism: Mechanism, values: Mapping[str, Formula], unknowns: Mapping[str, Formula]) -> Potential:
    """The potential at formulas for all variables of the description and for its unknowns, of one graph."""
    ring = _Ring(next(iter(unknowns.values())).graph, values, unknowns)
    points = points_in(mechanism, ring)
    lengths, forces, energy = [], [], ring.constant(Fraction(0))
    for spring in mechanism.springs:
        (x0, y0), (x1, y1) = points[spring.start], points[spring.end]
        k, free = evaluate(spring.stiffness, ring), evaluate(spring.free, ring)
        dx, dy = x1 - x0, y1 - y0
        extent = length(dx, dy)
        lengths.append(extent)
        forces.append(k * (extent - free))
        squared = dx.squared() + dy.squared() if free.value == 0 else (extent - free).squared()
        energy = energy + k * squared / 2
    energy = with_springs(mechanism, ring, points, energy)
    turned = (torsion.deflection for torsion in mechanism.torsion)
    deflections = tuple((evaluate(cosine, ring), evaluate(sine, ring)) for cosine, sine in turned)
    return Potential(points, tuple(lengths), tuple(forces), energy, deflections)


@dataclass(frozen=True, slots=True)
class _Ring:
    """Formulas of one graph."""

    graph: Graph
    values: Mapping[str, Formula]
    unknowns: Mapping[str, Formula]

    def constant(self, value: Fraction) -> Formula:
        return self.graph.constant(value)

    def parameter(self, name: str) -> Formula:
        return self.values[name] if name in self.values else self.unknowns[name]

    def cos(self, angle: str) -> Formula:
        return self.unknowns[angle].cos()

    def sin(self, angle: str) -> Formula:
        return self.unknowns[angle].sin()
