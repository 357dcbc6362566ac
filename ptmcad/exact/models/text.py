"""A parametric system as text, for the stored result.

Guarantee: potential, gradient and Hessian are written exactly as the engine uses them.
"""

from __future__ import annotations

from ptmcad.answer.regionmap import System
from ptmcad.exact.models.system import ParametricSystem


def system_text(system: ParametricSystem) -> System:
    """The system's polynomials as text in the parameters and the cosines and sines of the angles."""
    ring = system.ring
    unknowns = tuple(f"{function}_{angle}" for angle in ring.angles for function in ("cos", "sin"))
    return System(
        unknowns=unknowns,
        relations=tuple(f"cos_{angle}^2 + sin_{angle}^2 - 1" for angle in ring.angles),
        potential=str(system.potential),
        gradient=tuple(str(g) for g in system.gradient),
        hessian=tuple(tuple(str(h) for h in row) for row in system.hessian),
    )
