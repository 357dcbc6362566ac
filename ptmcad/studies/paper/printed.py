"""The paper's equations as they are printed, and as they should be, in SymPy.

Guarantee: none; this is the text under test. Every entry is compared with the model by a claim's check.

Equations with F3' = F3/k are multiplied by k, so that the symbols are those of `ptmcad.studies.paper.symbolic`.
"""

from __future__ import annotations

from collections.abc import Sequence

from ptmcad.studies.paper.symbolic import F3, F4, L1, L2, Expr, F3x, F4x, c1, c2, k, rho, s1, s2, t1, t2

SIN_SUM, COS_SUM = s1 * c2 + c1 * s2, c1 * c2 - s1 * s2


def potential_2(factor: Expr) -> Expr:
    """(2), with ``factor`` at the work of both loads: rho as printed, 1 as it should be."""
    lengths = (
        3 * rho**2 - 4 * L1 * rho * c1 + 2 * L1**2 + 2 * L2**2 - 4 * L2 * rho * c2 + 2 * L1 * L2 * COS_SUM
    )  # fmt: skip
    return k / 2 * lengths - F3 * L1 * factor * s1 - F4 * L2 * factor * s2


def potential_17(lengths: Sequence[Expr], free: Expr, work: Expr) -> Expr:
    """(17): the springs' lengths, their common free length, and the work F3 y3 + F4 y4."""
    return k / 2 * sum((length - free) ** 2 for length in lengths) - work


EQUATION_3 = k * L1 * SIN_SUM - 2 * k * rho * s2 + F4 * c2
EQUATION_4_PRINTED = k * L2 * SIN_SUM - 2 * k * rho * s1 + F4 * c1
EQUATION_4 = k * L2 * SIN_SUM - 2 * k * rho * s1 + F3 * c1
EQUATION_7 = L1 * SIN_SUM - 2 * rho * s2
EQUATION_8 = L2 * SIN_SUM - 2 * rho * s1

EQUATION_5 = (
    F3 * t1**2 * t2**2 + 2 * k * L2 * t1**2 * t2 + 2 * k * L2 * t2**2 * t1 + 4 * k * rho * t2**2 * t1 + F3 * t1**2
    - F3 * t2**2 - 2 * k * L2 * t1 - 2 * k * L2 * t2 + 4 * k * rho * t1 - F3
)  # fmt: skip
_COMMON_6 = (
    F4 * t1**2 * t2**2 + 2 * k * L1 * t1**2 * t2 + 2 * k * L1 * t2**2 * t1 + 4 * k * rho * t1**2 * t2
    - 2 * k * L1 * t1 - 2 * k * L1 * t2 + 4 * k * rho * t2 - F4
)  # fmt: skip
EQUATION_6_PRINTED = _COMMON_6 + F4 * t1**2 - F4 * t2**2
EQUATION_6 = _COMMON_6 - F4 * t1**2 + F4 * t2**2

FACTOR_10 = F4 * (t1 + t2) + 2 * k * rho * (1 - t1 * t2)
EQUATION_10 = (t1 - t2) * FACTOR_10
EQUATION_11 = (
    F4 * (t1**2 * t2**2 - 1) + 2 * L1 * k * (t1**2 * t2 + t1 * t2**2) + 4 * k * rho * (t1**2 * t2 + t2)
    + F4 * (t2**2 - t1**2) - 2 * L1 * k * (t1 + t2)
)  # fmt: skip
EQUATION_12 = (
    4 * F4 * k**2 * t2**2 * (L1 * rho + rho**2) + 16 * k**3 * rho**3 * t2 + F4**3 * (t2**2 - 1)
    + 4 * F4**2 * k * rho * t2 + 4 * F4 * k**2 * (L1 * rho - rho**2)
)  # fmt: skip
DETERMINANT_13 = (
    -4 * (t2**2 + 1) ** 2 * (4 * k**2 * rho**2 + F4**2) ** 2 * (-k * rho * t2**2 + F4 * t2 + k * rho) ** 2
    / (-2 * k * rho * t2 + F4) ** 4
)  # fmt: skip

BOUNDARY_15 = (
    F4**6 + 12 * 10**4 * F4**4 * rho**2 + 48 * 10**8 * F4**2 * rho**4 + 64 * 10**12 * rho**6
    - 16 * 10**8 * F4**2 * rho**2
)  # fmt: skip
BOUNDARY_16 = (
    F4**6 + 12 * 10**4 * F4**4 * rho**2 + 48 * 10**8 * F4**2 * rho**4 + 64 * 10**12 * rho**6 - 12 * 10**4 * F4**4
    + 336 * 10**8 * F4**2 * rho**2 - 192 * 10**12 * rho**4 + 48 * 10**8 * F4**2 + 192 * 10**12 * rho**2
    - 64 * 10**12
)  # fmt: skip
UNLOADED_LINES = (2 * rho - L2 - 1, 2 * rho - L2 + 1, 2 * rho + L2 - 1)

HORIZONTAL_5 = t2**2 * t1 + t1
"""The terms that a horizontal force at A3 multiplies in (5)."""
HORIZONTAL_6 = t1**2 * t2 + t2


def with_horizontal_forces(sign3: int, sign4: int) -> tuple[Expr, Expr]:
    """The right (5) and (6) with + 2 sign3 F3x and + 2 sign4 F4x at the terms that 5.1 names."""
    return EQUATION_5 + 2 * sign3 * F3x * HORIZONTAL_5, EQUATION_6 + 2 * sign4 * F4x * HORIZONTAL_6
