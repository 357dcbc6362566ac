"""Where a mechanism's points are, and the vectors between its springs' ends, as polynomials of a ring.

Guarantee: exact.
"""

from __future__ import annotations

from collections.abc import Iterator

from ptmcad.certified.plain.trigonometric import Harmonics, TrigonometricPolynomial
from ptmcad.mechanism import Mechanism
from ptmcad.mechanism.description import Spring
from ptmcad.mechanism.evaluate import evaluate

Vector = tuple[TrigonometricPolynomial, TrigonometricPolynomial]


def points_of(mechanism: Mechanism, ring: Harmonics) -> dict[str, Vector]:
    """All points by name."""
    return {name: (evaluate(x, ring), evaluate(y, ring)) for name, (x, y) in mechanism.points.items()}


def springs_of(mechanism: Mechanism, ring: Harmonics) -> Iterator[tuple[Spring, Vector]]:
    """Each spring with the vector from its start to its end."""
    points = points_of(mechanism, ring)
    for spring in mechanism.springs:
        (a, b), (c, d) = points[spring.start], points[spring.end]
        yield spring, (c - a, d - b)
