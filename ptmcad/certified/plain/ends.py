"""The vectors between a mechanism's springs' ends, as polynomials of a ring.

Guarantee: exact.
"""

from __future__ import annotations

from collections.abc import Iterator

from ptmcad.certified.plain.trigonometric import Harmonics, TrigonometricPolynomial
from ptmcad.mechanism import Mechanism
from ptmcad.mechanism.description import Spring
from ptmcad.mechanism.energy import points_in

Vector = tuple[TrigonometricPolynomial, TrigonometricPolynomial]


def springs_of(mechanism: Mechanism, ring: Harmonics) -> Iterator[tuple[Spring, Vector]]:
    """Each spring with the vector from its start to its end."""
    points = points_in(mechanism, ring)
    for spring in mechanism.springs:
        (a, b), (c, d) = points[spring.start], points[spring.end]
        yield spring, (c - a, d - b)
