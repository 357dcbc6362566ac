"""Checks of the counts: at every cell's sample, by signatures of trace forms.

Guarantee: exact at the samples; that the counts hold in the whole cells follows from the checks of
the variety and of the decomposition.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ptmcad.answer.counts import Counts, euler_sum
from ptmcad.model import Model
from ptmcad.text.numerals import text_of
from ptmcad.verification.claims import Claims
from ptmcad.verification.fibre import FibreAlgebra
from ptmcad.verification.kinds import kind_of
from ptmcad.verification.report import Violation


def check_counts(claims: Claims) -> str:
    """Total, stable and index of every cell; on a torus the sum of the signs; lengths and
    stiffnesses positive.
    """
    model, name = claims.model, claims.result.slice.count.value
    kind = kind_of(claims.result.slice.count)
    for n, cell in enumerate(claims.result.cells):
        where = ", ".join(f"{axis}={text_of(cell.sample[axis])}" for axis in cell.sample.names)
        if (wrong := not_positive(model, claims.parameters_at(*cell.sample))) is not None:
            raise Violation(f"{wrong} is not positive at {where} in cell {n}")
        fibre = claims.fibre_at(*cell.sample)
        counts = fibre.counts()
        if counts is None:
            raise Violation(f"{claims.meaning.solution} is degenerate at {where} in cell {n}")
        if not model.reals and not fibre.point.inequalities and _euler_sum(fibre, counts) != 0:
            raise Violation(f"the Euler sum of {_text(counts)} at {where} in cell {n} is not zero")
        stored = Counts(cell.total or 0, cell.stable, cell.index)
        if cell.total is None or stored != counts:
            raise Violation(
                f"cell {n} is said to have {_text(stored)}; at {where} there are {_text(counts)}"
            )
        if kind.is_predicate and cell.further != (true := {name: fibre.number_held()}):
            raise Violation(
                f"cell {n} is said to have {_further(cell.further)}; at {where} there are {_further(true)}"
            )
    return f"{len(claims.result.cells)} samples"


def _euler_sum(fibre: FibreAlgebra, counts: Counts) -> int:
    """The sum of the signs of the Jacobian's determinant, which is zero on a torus (Poincare and
    Hopf).
    """
    if counts.index is None:
        return fibre.balance()
    return euler_sum(counts.index)


def _further(numbers: Mapping[str, int]) -> str:
    return ", ".join(f"{number} {name}" for name, number in numbers.items()) or "no further count"


def _text(counts: Counts) -> str:
    parts = [f"{counts.total} {'solutions' if counts.index is None else 'equilibria'}"]
    if counts.stable is not None:
        parts.append(f"{counts.stable} stable")
    if counts.index is not None:
        parts.append(f"index {counts.index}")
    return ", ".join(parts)


def not_positive(model: Model, values: Mapping[str, Fraction]) -> str | None:
    """A length or stiffness that is not positive, or None."""
    for name in model.positive:
        if values[name] <= 0:
            return name
    return next((name for name in model.nonnegative if values.get(name, 0) < 0), None)
