"""Mechanisms with closed loops or X-joints as models whose equations are known not to be too large,
and as text.

Guarantee: what is refused may have too many terms when it is multiplied out; no equation is
simplified.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ptmcad.errors import ConfigError, ExpressionError
from ptmcad.formulas.graph import Formula
from ptmcad.model.compile import CompiledSystem, compiled
from ptmcad.model.crossed import MAX_PRODUCTS
from ptmcad.model.description import ClosedMechanism, Mechanism, Model, equations_in
from ptmcad.model.identities import PolynomialRing
from ptmcad.model.termbounds import MAX_TERMS, TOO_LARGE, Sizes
from ptmcad.model.work import tree_of
from ptmcad.text.tree import Tree

Trees = tuple[Tree, ...]


def without_loops(model: Mechanism) -> Model:
    """The mechanism itself, or with closed loops or X-joints the model of its equilibria.

    Raises
    ------
    ConfigError
        When its equations may have too many terms.
    """
    if not (model.closing or model.xjoints):
        return model
    found = ClosedMechanism.of(model)
    key, what = (
        ("x-joint", "with x-joints") if model.xjoints else ("closing", "with their loops closed")
    )
    try:
        system = compiled(found)
        if (
            model.closing
            and _terms(system, () if found.multipliers else system.stability) > MAX_TERMS
        ):
            raise ExpressionError(TOO_LARGE)
    except ExpressionError as error:
        raise ConfigError(f"{what} {error.message}", key=key) from error
    return found


def terms_of(model: Model) -> int:
    """A bound of the number of terms of a model's equations and conditions, or of its energy;
    `MAX_TERMS` where one of these may have more."""
    system = compiled(model)
    try:
        return _terms(system, (*system.inequalities, *system.stability))
    except ExpressionError:
        return MAX_TERMS


def _terms(system: CompiledSystem, more: Iterable[Formula]) -> int:
    own = system.summands() if system.are_slopes else system.equations
    return sum(size.terms for size in system.values((*own, *more), Sizes()))


def conditions_of(model: Model) -> tuple[Trees, Mapping[str, Tree], Trees]:
    """Equations, inequalities by keys, and conditions for stability as trees: of a system as they
    are written, with closed loops and X-joints multiplied out; inequalities alone where solutions
    are critical points of an energy."""
    own = equations_in(model)
    if own is not None:
        return own.equations, own.conditions, own.stability
    system = compiled(model)

    def written(formulas: Sequence[Formula]) -> Trees:
        return tuple(
            tree_of(p, model.angles) for p in system.values(formulas, PolynomialRing(MAX_PRODUCTS))
        )

    if system.are_slopes:
        return (), model.conditions, ()
    further = written(system.inequalities[len(model.conditions) :])
    positive = {f"positive.{n}": tree for n, tree in enumerate(further, 1)}
    return written(system.equations), {**model.conditions, **positive}, written(system.stability)
