"""A parametric system as text, for the stored result.

Guarantee: potential, equations and Jacobian are written exactly as the engine uses them.
"""

from __future__ import annotations

from ptmcad.answer.regionmap import System
from ptmcad.exact.models.system import ParametricSystem


def system_text(system: ParametricSystem) -> System:
    """The system's polynomials as text in the parameters and the coordinates of the unknowns."""
    ring = system.ring
    return System(
        unknowns=ring.coordinates,
        relations=tuple(f"cos_{angle}^2 + sin_{angle}^2 - 1" for angle in ring.angles),
        potential="" if system.potential is None else str(system.potential),
        gradient=tuple(str(e) for e in system.equations),
        hessian=tuple(tuple(str(d) for d in row) for row in system.jacobian),
        inequalities=tuple(str(p) for p in system.inequalities),
        stability=tuple(str(p) for p in system.stability),
    )
