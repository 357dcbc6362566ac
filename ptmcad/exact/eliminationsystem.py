"""The discriminant variety of a slice as an answer of its own, and the elimination system behind it:
equilibria with a singular Hessian, as polynomials with integer coefficients.

Guarantee: the ideal that they generate, cut with Q[x, y], vanishes on every CRITICAL component of
the slice. It has no solution where the slice's equations lose their meaning, nor one that an
inequality excludes all over the slice if the variety leaves these out: one more unknown is the
inverse of what is not zero.
"""

from __future__ import annotations

from itertools import count
from math import prod

from ptmcad.algebra.polynomials import ONE, UnknownPolynomial, irreducible_factors
from ptmcad.answer.slicevariety import EliminationSystem, SliceVariety, Term
from ptmcad.errors import A_SLICE, expect
from ptmcad.exact.mapassembly import versions
from ptmcad.exact.models.modelsystem import system_text
from ptmcad.exact.models.system import SystemOnAxes, on_slice, saturated
from ptmcad.exact.stages import problem_without_free_lengths, variety_of
from ptmcad.question.slice import Slice

INVERSE = "inverse"
"""The name of the unknown that is one, with a number where the name is taken."""


def elimination_system(
    given: SystemOnAxes, axes: tuple[str, str], excludes: bool
) -> EliminationSystem:
    """The equations of a slice, the circles, what is not zero times its inverse less 1, and the
    Hessian's determinant.

    Parameters
    ----------
    given : the system on the axes x and y.
    axes : their names.
    excludes : whether solutions at which an inequality's polynomial is zero are left out.
    """
    on = on_slice(*given)
    conditions = list(on.inequalities) if excludes else []
    if (nowhere := prod(irreducible_factors(*on.boundary, *given.limits), start=ONE)) != ONE:
        conditions.append({(0,) * on.unknowns: nowhere})
    for condition in conditions:
        on = saturated(on, condition)
    unknowns = system_text(given.system).unknowns
    for _ in conditions:
        names = (f"{INVERSE}{n or ''}" for n in count())
        unknowns += (next(name for name in names if name not in (*unknowns, *axes)),)
    polynomials = tuple(_terms(p) for p in (*on.equations, on.jacobian))
    return EliminationSystem(unknowns, axes, polynomials)


def _terms(p: UnknownPolynomial) -> tuple[Term, ...]:
    terms = [
        ((*unknowns, int(i), int(j)), int(c))
        for unknowns, q in p.items()
        for (i, j), c in q.terms()
    ]
    return tuple(sorted(terms, reverse=True))


def slice_variety(slice: Slice, without: frozenset[str] = frozenset()) -> SliceVariety:
    """The discriminant variety of a slice, the first stage of `exact_map` alone.

    Parameters
    ----------
    without : names of savings to switch off, of `ptmcad.question.savings`.

    Raises
    ------
    ConfigError
        When springs have a free length: then the variety is out of algebra's reach.
    HypothesisError
        When the slice is degenerate, has infinitely many equilibria, or leaves the domain of the
        geometry.
    """
    expect(slice, Slice, "slice", A_SLICE)
    problem = problem_without_free_lengths(slice, "the discriminant variety is")
    variety = variety_of(problem, without)
    return SliceVariety(
        slice,
        variety.components,
        variety.complex_solutions,
        elimination_system(problem.on, slice.axis_names, variety.excludes),
        versions(),
    )
