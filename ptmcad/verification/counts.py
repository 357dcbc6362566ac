"""Checks of the counts: at every cell's sample, by signatures of trace forms.

Guarantee: exact at the samples; that the counts hold in the whole cells follows from the checks of the variety and of
the decomposition.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ptmcad.text.numerals import text_of
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import NOT_NEGATIVE, POSITIVE
from ptmcad.verification.report import Violation


def check_counts(claims: Claims) -> str:
    """Total, stable and Morse index of every cell; Euler sum; lengths and stiffnesses positive."""
    for n, cell in enumerate(claims.result.cells):
        where = ", ".join(f"{name}={text_of(cell.sample[name])}" for name in cell.sample.names)
        if (name := _not_positive(claims.parameters_at(*cell.sample))) is not None:
            raise Violation(f"{name} is not positive at {where} in cell {n}")
        index = claims.fibre_at(*cell.sample).morse_index()
        if index is None:
            raise Violation(f"an equilibrium is degenerate at {where} in cell {n}")
        if index[0] - index[1] + index[2] != 0:
            raise Violation(f"the Euler sum of {index} at {where} in cell {n} is not zero")
        if (cell.index, cell.total, cell.stable) != (index, sum(index), index[0]):
            raise Violation(
                f"cell {n} is said to have {cell.total} equilibria, {cell.stable} stable, index "
                f"{cell.index}; at {where} there are {sum(index)}, {index[0]} stable, index {index}"
            )
    return f"{len(claims.result.cells)} samples"


def _not_positive(values: Mapping[str, Fraction]) -> str | None:
    """A length or stiffness that is not positive, or None."""
    for name in POSITIVE:
        if values[name] <= 0:
            return name
    return next((name for name in NOT_NEGATIVE if values.get(name, 0) < 0), None)
