"""The work of moments, which a stored potential lacks: told by its slopes, so that no moment is
integrated.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from flint import fmpq, fmpq_mpoly, fmpz

from ptmcad.verification.coordinates import CoordinateRing, circle_names

START = "at zero"
"""Where all unknowns are zero, work is."""


def fault_in_work(
    ring: CoordinateRing,
    work: fmpq_mpoly,
    moments: Mapping[str, fmpq_mpoly],
    *,
    varying: bool = False,
) -> str:
    """The unknown by which work has not the slope that is the moment on it, or `START`; empty where
    nothing is wrong.

    Parameters
    ----------
    varying : whether it is the work of the moments without their constant parts: of a force along a
        line that is the one without the unknown.
    """
    coordinates = _coordinates(ring, moments)
    places = [k for k, name in enumerate(ring.names) if name in coordinates]
    for unknown, moment in moments.items():
        slope = ring.normal(ring.by(work, unknown))
        missing = ring.normal(moment - slope)
        right = missing.is_zero()
        if varying:
            steady = unknown in ring.angles or slope.subs({ring.names.index(unknown): 0}).is_zero()
            right = steady and not any(missing.degrees()[k] > 0 for k in places)
        if not right:
            return unknown
    zeros: dict[str | int, int | fmpz | fmpq] = {
        ring.names.index(name): value for name, value in coordinates.items()
    }
    return "" if work.subs(zeros).is_zero() else START


def _coordinates(ring: CoordinateRing, unknowns: Iterable[str]) -> dict[str, int]:
    """The variables by which unknowns are in a ring, and what they are where all unknowns are zero."""
    found = {name: 0 for name in unknowns if name in ring.names}
    for angle in ring.angles:
        found |= dict(zip(circle_names(angle), (1, 0), strict=True))
    return found
