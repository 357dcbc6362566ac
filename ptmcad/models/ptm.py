"""The planar tensegrity mechanism of Wenger & Chablat: two crossed bars, three springs, one slider.

Guarantee: potential, equations and Hessian follow from the node coordinates; no equation of the paper is typed in.

The nodes are A1 = (0, 0), A2 = (rho, 0), A3 = L1 (cos th1, sin th1), A4 = (rho - L2 cos th2, L2 sin th2); the springs
are A1A4 (k1), A2A3 (k2), A3A4 (k3), of free length zero; the loads are (F3x, F3) at A3 and (F4x, F4) at A4.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from flint import fmpq

from ptmcad.algebra.trigonometric import TrigonometricPolynomial, TrigonometricRing
from ptmcad.models.system import ParametricSystem, from_potential

PARAMETERS = ("L1", "L2", "rho", "k1", "k2", "k3", "F3", "F4", "F3x", "F4x")
ANGLES = ("th1", "th2")
SPRINGS = (("A1", "A4", "k1"), ("A2", "A3", "k2"), ("A3", "A4", "k3"))
LOADS = (("A3", "F3x", "F3"), ("A4", "F4x", "F4"))

Vector = tuple[TrigonometricPolynomial, TrigonometricPolynomial]


def nodes(ring: TrigonometricRing) -> dict[str, Vector]:
    """Coordinates of the four nodes, in the length unit of the parameters."""
    zero = ring.context.constant(0)
    length1, length2, rho = (ring.parameter(name) for name in ("L1", "L2", "rho"))
    return {
        "A1": (zero, zero),
        "A2": (rho, zero),
        "A3": (length1 * ring.cos("th1"), length1 * ring.sin("th1")),
        "A4": (rho - length2 * ring.cos("th2"), length2 * ring.sin("th2")),
    }


def potential(ring: TrigonometricRing) -> TrigonometricPolynomial:
    """Elastic energy of the springs minus the work of the loads; Wenger & Chablat (1)."""
    at = nodes(ring)
    energy = ring.context.constant(0)
    for start, end, stiffness in SPRINGS:
        dx, dy = at[end][0] - at[start][0], at[end][1] - at[start][1]
        energy += ring.parameter(stiffness) * (dx**2 + dy**2) * fmpq(1, 2)
    for node, horizontal, vertical in LOADS:
        energy -= ring.parameter(horizontal) * at[node][0] + ring.parameter(vertical) * at[node][1]
    return ring.reduce(energy)


@lru_cache(maxsize=1)
def ptm_system() -> ParametricSystem:
    """The mechanism's equilibrium equations and Hessian with all ten parameters symbolic."""
    ring = TrigonometricRing(PARAMETERS, ANGLES)
    return from_potential(ring, potential(ring), positive=("L1", "L2", "k1", "k2", "k3"), nonnegative=("rho",))


@lru_cache(maxsize=1)
def ptm_nodes() -> Mapping[str, Vector]:
    """Coordinates of the four nodes as elements of the ring of `ptm_system`."""
    return nodes(ptm_system().ring)
