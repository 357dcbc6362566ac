"""The polynomial system of a model, from its compiled formulas, and its text for the stored result.

Guarantee: potential, equations and conditions are those of the formulas, expanded; no equation is
typed in. Springs are of free length zero: their energy is a polynomial.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache, partial

from ptmcad.algebra.trigonometric_ring import TrigonometricPolynomial, TrigonometricRing
from ptmcad.answer.regionmap import System
from ptmcad.errors import ConfigError
from ptmcad.exact.models.system import ParametricSystem, from_equations
from ptmcad.formulas.evaluation import values
from ptmcad.formulas.graph import Formula
from ptmcad.model import Model
from ptmcad.model.compile import compiled
from ptmcad.model.evaluate import ByNames, evaluate
from ptmcad.question.counts import Count


def ring_of(model: Model) -> TrigonometricRing:
    """The ring of a model's polynomials, with all parameters but free lengths symbolic."""
    return TrigonometricRing(model.without_free_lengths, model.angles, model.reals)


def elements_of(model: Model, formulas: Sequence[Formula]) -> tuple[TrigonometricPolynomial, ...]:
    """A compiled model's formulas in parameters and unknowns as elements of its ring, reduced."""
    ring = ring_of(model)
    return tuple(map(ring.reduce, values(formulas, ByNames(compiled(model).names, ring))))


@lru_cache(maxsize=8)
def system_from(model: Model) -> ParametricSystem:
    """The equations and Jacobian of a mechanism or system, with all parameters symbolic."""
    known, ring = compiled(model), ring_of(model)
    elements = partial(elements_of, model)
    potential = known.potential(relaxed=())
    return from_equations(
        ring,
        elements(known.equations),
        potential=None if potential is None else next(iter(elements([potential]))),
        inequalities=elements(known.inequalities),
        stability=elements(known.stability),
        positive=tuple(name for name in model.positive if name in ring.parameters),
        nonnegative=tuple(name for name in model.nonnegative if name in ring.parameters),
        criterion=known.criterion,
    )


def system_counted(model: Model, count: Count) -> ParametricSystem:
    """The system of a model, with the margins of a count's predicate as conditions for stability.

    Raises
    ------
    ConfigError
        Where nothing but conditions says what is stable, but a predicate asks for more.
    """
    system, predicate, mechanism = system_from(model), count.kind.predicate, model.whole
    if predicate is None or mechanism is None:
        return system
    if not system.criterion.order:
        raise ConfigError(
            f"without a potential only the certified engine counts by {count.value}", key="engine"
        )
    ring = system.ring
    margins = tuple(
        ring.reduce(evaluate(margin.value, ring)) for margin in predicate.margins(mechanism)
    )
    return system._replace(stability=margins)


def system_text(system: ParametricSystem) -> System:
    """The system's polynomials as text in the parameters and the coordinates of the unknowns."""
    ring = system.ring
    return System(
        unknowns=ring.coordinates,
        relations=tuple(f"cos_{angle}^2 + sin_{angle}^2 - 1" for angle in ring.angles),
        potential="" if system.potential is None else str(system.potential),
        gradient=tuple(str(e) for e in system.equations),
        hessian=tuple(tuple(str(d) for d in row) for row in system.jacobian),
        inequalities=tuple(str(p) for p in system.inequalities),
        stability=tuple(str(p) for p in system.stability),
    )
