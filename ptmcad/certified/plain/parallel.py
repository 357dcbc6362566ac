"""Springs side by side: vectors of which one is a function of the axes, other than zero, times the
other.

Guarantee: the functions are exact, and proved to be positive in the whole open window; what is not
proved is none.
"""

from __future__ import annotations

from collections.abc import Sequence

from ptmcad.certified.plain.divisors import absolute, lowest_terms
from ptmcad.certified.plain.harmonics import TrigonometricPolynomial
from ptmcad.question.slice import Axis
from ptmcad.text.expressions import Expression, constant

Vector = Sequence[TrigonometricPolynomial]
"""Its coordinates."""


def shares(
    d: Vector, other: Vector, axes: tuple[Axis, Axis]
) -> tuple[Expression, Expression] | None:
    """Positive f and g for which d/f and other/g are one vector, or each is the other's negative;
    None without a proof.

    So |d| = f |e| and |other| = g |e| with one e, which is among d, the other and what both are
    polynomials times the one whose coefficients have the least degree: where a coefficient loses a
    factor, springs have a length next to where that is zero, too.
    """
    c = _ratio(other, d)
    if c is None:
        return None
    above, below = (absolute(Expression(terms), axes) for terms in (c.numerator, c.denominator))
    if above is None or below is None:
        return None
    unit = constant(1)
    ways = (unit, above / below), (below, above), (below / above, unit)
    return min(ways, key=lambda way: _degree([x.scaled(1 / way[0]) for x in d]))


def _ratio(d: Vector, other: Vector) -> Expression | None:
    """The c, in lowest terms, for which d is c times another vector, other than zero: then so are
    all derivatives.
    """
    key, k = next((key, k) for k, x in enumerate(other) for key in x.terms)
    pairs = zip(d[k].terms.get(key, ()), other[k].terms[key], strict=False)
    c = next((a / b for a, b in pairs if b.numerator), None)
    if c is None or not c.numerator:
        return None
    return (
        None
        if any((f - g.scaled(c)).terms for f, g in zip(d, other, strict=True))
        else lowest_terms(c)
    )


def _degree(d: Vector) -> int:
    """The largest one of a vector's coefficients."""
    return max(c.degree for x in d for pair in x.terms.values() for c in pair)
