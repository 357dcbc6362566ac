"""The system whose solutions are the degenerate equilibria along the axis of the free length, all else fixed.

Guarantee: integer polynomials in v1, v2, v3 (v_i = 1/l_i of either sign), the cosines and sines, and l0. They vanish
at degenerate equilibria with l1, l2 and l3 not zero, and at real values with all v_i > 0 only there.

With m_i = 1 - l0 v_i and n_i = l0 v_i^3, and with squared lengths q_i, the Hessian of U/k is the sum over the springs
of m_i q_i''/2 + n_i q_i' q_i'/4, and of the loads' part. The last polynomial is its determinant.
"""

from __future__ import annotations

import math
from fractions import Fraction

from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx

NAMES = ("v1", "v2", "v3", "c1", "s1", "c2", "s2", "l0")
_RING: fmpz_mpoly_ctx = fmpz_mpoly_ctx.get(NAMES, Ordering.degrevlex)


def critical_system(
    rho: Fraction, rods: tuple[Fraction, Fraction], loads: tuple[Fraction, Fraction]
) -> tuple[str, ...]:
    """Polynomials in `NAMES` as text, for base, rods and loads over k in one unit; stiffnesses and l0 are equal."""
    numbers = (rho, *rods, *loads)
    # numbers times this are integers; the unknowns stay as they are, because longer roots make elimination slower
    scale = math.lcm(*(n.denominator for n in numbers))
    r, length1, length2, f3, f4 = (int(n * scale) for n in numbers)
    v1, v2, v3, c1, s1, c2, s2, l0 = _RING.gens()
    inverses = (v1, v2, v3)
    squares = (
        r * r + length2**2 - 2 * r * length2 * c2,
        r * r + length1**2 - 2 * r * length1 * c1,
        r * r + length1**2 + length2**2 + 2 * length1 * length2 * (c1 * c2 - s1 * s2)
        - 2 * r * length1 * c1 - 2 * r * length2 * c2,
    )  # fmt: skip
    gradient = [-2 * f3 * length1 * c1, -2 * f4 * length2 * c2]  # twice that of U/k
    unit = scale**2
    # 4 unit times the Hessian of U/k
    h11, h12, h22 = 4 * unit * f3 * length1 * s1, _RING.constant(0), 4 * unit * f4 * length2 * s2
    for v, q in zip(inverses, squares, strict=True):
        m, n = 1 - l0 * v, l0 * v**3
        q1, q2 = _by_angle(q, 1), _by_angle(q, 2)
        gradient = [gradient[0] + m * q1, gradient[1] + m * q2]
        h11 += 2 * unit * m * _by_angle(q1, 1) + n * q1 * q1
        h12 += 2 * unit * m * _by_angle(q1, 2) + n * q1 * q2
        h22 += 2 * unit * m * _by_angle(q2, 2) + n * q2 * q2
    equations = [c1**2 + s1**2 - 1, c2**2 + s2**2 - 1]
    equations += [v**2 * q - unit for v, q in zip(inverses, squares, strict=True)]
    equations += [*gradient, h11 * h22 - h12 * h12]
    return tuple(str(_primitive(e)).replace(" ", "") for e in equations)


def _by_angle(p: fmpz_mpoly, rod: int) -> fmpz_mpoly:
    """The derivative by th1 or th2."""
    cosine, sine = (3, 4) if rod == 1 else (5, 6)
    generators = _RING.gens()
    return generators[cosine] * p.derivative(sine) - generators[sine] * p.derivative(cosine)


def _primitive(p: fmpz_mpoly) -> fmpz_mpoly:
    return p.primitive()[1]
