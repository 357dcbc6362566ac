"""Poles of unknowns by traces of their powers: the way that the engine does not go."""

from __future__ import annotations

from ptmcad.algebra.polynomials import Coefficient, Ratio, add_ratios, lcm, ratio
from ptmcad.algebra.quotient_algebra import QuotientAlgebra, _times_unknown


def power_trace_denominators(algebra: QuotientAlgebra, k: int) -> Coefficient:
    """The common denominator of trace(u^j), j = 1 ... dimension, for the unknown number k.

    By Newton's identities its zeros are the poles of the characteristic polynomial of u.
    """
    scale = algebra.one
    vectors = [algebra.table[m] for m in algebra.basis]
    for _ in range(algebra.dimension):
        vectors = [_times_unknown(algebra, k, v) for v in vectors]
        total: Ratio = (algebra.zero, algebra.one)
        for i, (numerators, denominator) in enumerate(vectors):
            total = add_ratios(total, ratio(numerators[i], denominator))
        scale = lcm((scale, total[1]))
    return scale
