"""The vectors between a mechanism's springs' ends, as polynomials of a ring.

Guarantee: exact.
"""

from __future__ import annotations

from collections.abc import Iterator

from ptmcad.certified.plain.trigonometric import Harmonics, TrigonometricPolynomial
from ptmcad.model import Mechanism, ptm
from ptmcad.model.elements import Spring
from ptmcad.model.energy import points_in

Vector = tuple[TrigonometricPolynomial, TrigonometricPolynomial]


def springs_of(mechanism: Mechanism, ring: Harmonics) -> Iterator[tuple[Spring, Vector]]:
    """Each spring with the vector from its start to its end.

    The paper's springs are named by their ends there, as in all answers.
    """
    points, by_ends = points_in(mechanism, ring), mechanism == ptm()
    for spring in mechanism.springs:
        (a, b), (c, d) = points[spring.start], points[spring.end]
        named = spring._replace(name=f"{spring.start}{spring.end}") if by_ends else spring
        yield named, (c - a, d - b)
