"""The polynomial system of a mechanism, derived from its description.

Guarantee: potential, equations and Hessian follow from the points, springs and loads that the description lists; no
equation is typed in. Springs are of free length zero: their energy is a polynomial.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import lru_cache, partial
from typing import Any, NamedTuple

from flint import fmpq

from ptmcad.algebra.trigonometric import TrigonometricPolynomial, TrigonometricRing
from ptmcad.exact.models.system import ParametricSystem, from_equations, from_potential
from ptmcad.exact.models.turns import with_turns
from ptmcad.model import ClosedMechanism, Mechanism, Model, System
from ptmcad.model.evaluate import evaluate
from ptmcad.model.work import split_moments
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.tree import Tree

Vector = tuple[TrigonometricPolynomial, TrigonometricPolynomial]


class Geometry(NamedTuple):
    """What has a place in a mechanism, as elements of its system's ring.

    Attributes
    ----------
    nodes : coordinates of each point, in the length unit of the parameters.
    stiffnesses : of each spring, in the description's order.
    """

    ring: TrigonometricRing
    nodes: Mapping[str, Vector]
    stiffnesses: tuple[TrigonometricPolynomial, ...]
    loads: tuple[tuple[str, Vector], ...]


class _Evaluation(NamedTuple):
    """A trigonometric ring as one in which trees have values."""

    ring: TrigonometricRing

    def constant(self, value: Fraction) -> TrigonometricPolynomial:
        return self.ring.context.constant(from_fraction(value))

    def parameter(self, name: str) -> TrigonometricPolynomial:
        return self.ring.parameter(name)

    def cos(self, angle: str) -> TrigonometricPolynomial:
        return self.ring.cos(angle)

    def sin(self, angle: str) -> TrigonometricPolynomial:
        return self.ring.sin(angle)


@lru_cache(maxsize=8)
def geometry_of(mechanism: Mechanism) -> Geometry:
    """The points, stiffnesses and loads of a mechanism, with all parameters symbolic.

    Angles that follow from others, of X-joints, are angles of the ring after the unknown ones.
    """
    angles = (*mechanism.angles, *mechanism.followers)
    ring = TrigonometricRing(mechanism.without_free_lengths, angles, mechanism.reals)
    within = _Evaluation(ring)
    return Geometry(
        ring,
        {name: (evaluate(x, within), evaluate(y, within)) for name, (x, y) in mechanism.points.items()},
        tuple(evaluate(spring.stiffness, within) for spring in mechanism.springs),
        tuple((load.point, (evaluate(load.x, within), evaluate(load.y, within))) for load in mechanism.loads),
    )


def squared_lengths(mechanism: Mechanism) -> tuple[TrigonometricPolynomial, ...]:
    """The square of each spring's length, reduced."""
    geometry = geometry_of(mechanism)
    return tuple(geometry.ring.reduce(_squared(geometry, s.start, s.end)) for s in mechanism.springs)


def deflections_of(mechanism: Mechanism) -> tuple[Vector, ...]:
    """Cosine and sine of each torsion spring's angle less the one at rest, reduced."""
    ring = geometry_of(mechanism).ring
    within = _Evaluation(ring)

    def reduced(tree: Tree) -> TrigonometricPolynomial:
        return ring.reduce(evaluate(tree, within))

    return tuple((reduced(cosine), reduced(sine)) for cosine, sine in (t.deflection for t in mechanism.torsion))


def potential(mechanism: Mechanism) -> TrigonometricPolynomial:
    """Elastic energy of the springs minus the work of the loads; for ``ptm`` this is (1) of Wenger & Chablat.

    Of moments it has the work that is of one value for each pose (`split_moments`): none of constant ones.
    """
    geometry = geometry_of(mechanism)
    energy = geometry.ring.context.constant(0)
    for spring, stiffness in zip(mechanism.springs, geometry.stiffnesses, strict=True):
        energy += stiffness * _squared(geometry, spring.start, spring.end) * fmpq(1, 2)
    for node, (horizontal, vertical) in geometry.loads:
        energy -= horizontal * geometry.nodes[node][0] + vertical * geometry.nodes[node][1]
    for tree in (*(torsion.energy for torsion in mechanism.torsion), *split_moments(mechanism).energies):
        energy += evaluate(tree, _Evaluation(geometry.ring))
    return geometry.ring.reduce(energy)


@lru_cache(maxsize=8)
def system_from(model: Model) -> ParametricSystem:
    """The equations and Jacobian of a mechanism or system, with all parameters symbolic."""
    if isinstance(model, System):
        return with_turns(_equations_of(model))
    assert isinstance(model, Mechanism)
    return with_turns(_equilibria_of(model))


def elements_of(model: System, trees: Iterable[Tree]) -> tuple[TrigonometricPolynomial, ...]:
    """Trees in a system's parameters and unknowns as elements of its ring, reduced."""
    return _elements(TrigonometricRing(_parameters_of(model), model.angles, model.reals), trees)


def _parameters_of(model: System) -> tuple[str, ...]:
    """Those of a system's ring; the equations of closed loops have no free lengths."""
    return model.without_free_lengths if isinstance(model, ClosedMechanism) else model.variables


def _elements(ring: TrigonometricRing, trees: Iterable[Tree]) -> tuple[TrigonometricPolynomial, ...]:
    return tuple(ring.reduce(evaluate(tree, _Evaluation(ring))) for tree in trees)


def _equations_of(model: System) -> ParametricSystem:
    parameters = _parameters_of(model)
    ring = TrigonometricRing(parameters, model.angles, model.reals)
    elements = partial(_elements, ring)

    asked: dict[str, Any] = {
        "inequalities": elements(model.inequalities),
        "positive": tuple(name for name in model.positive if name in parameters),
        "nonnegative": tuple(name for name in model.nonnegative if name in parameters),
    }
    if model.potential is not None:
        (potential,) = elements([model.potential])
        return from_potential(ring, potential, **asked)
    return from_equations(
        ring,
        elements(model.equations),
        stability=elements(model.stability),
        definite=isinstance(model, ClosedMechanism),
        **asked,
    )


def _equilibria_of(mechanism: Mechanism) -> ParametricSystem:
    kept = set(mechanism.without_free_lengths)
    ring = geometry_of(mechanism).ring
    system = from_potential(
        ring,
        potential(mechanism),
        positive=tuple(name for name in mechanism.positive if name in kept),
        nonnegative=tuple(name for name in mechanism.nonnegative if name in kept),
        moments={m.unknown: ring.reduce(evaluate(m.value, _Evaluation(ring))) for m in split_moments(mechanism).steady},
    )
    # another unknown that cancels out of a moment counts as the description says, to which the question was put
    return system if mechanism.has_potential else system._replace(potential=None)


def _squared(geometry: Geometry, start: str, end: str) -> TrigonometricPolynomial:
    (x0, y0), (x1, y1) = geometry.nodes[start], geometry.nodes[end]
    return (x1 - x0) ** 2 + (y1 - y0) ** 2
