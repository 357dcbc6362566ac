"""The paper's mechanism worked out by hand, over any ring: the potential's derivatives, and the sextic in t.

Guarantee: exact as far as the ring is. Both owe nothing to an engine; tests hold the derivatives against the
description. The rivals of the benchmark are timed as processes with them, so that nothing is imported.

*Derivatives.* A spring of stiffness k, free length l0 and squared length q has the energy k (sqrt q - l0)^2 / 2. Its
derivatives, K q_i / 2 and K q_ij / 2 + k l0/l^3 (q_i / 2) (q_j / 2), are those of a spring without free length and with
the stiffness K = k (1 - l0/l), but for the last term. The squares are

    q1 = rho^2 + L2^2 - 2 rho L2 c2,    q2 = rho^2 + L1^2 - 2 rho L1 c1,
    q3 = rho^2 + L1^2 + L2^2 - 2 rho (L1 c1 + L2 c2) + 2 L1 L2 c12.

*Sextic.* In t = tan(th2/2) it is what is left when th1 has been eliminated, without free lengths.
With b1 = (k2 + k3) rho + F3x, b2 = (k1 + k3) rho - F4x, X = b1 - k3 L2 c2 and Y = k3 L2 s2 + F3 the first equation is
Y c1 - X s1 = 0, so (c1, s1) = +-(X, Y)/|(X, Y)|; the second, k3 L1 s12 - b2 s2 + F4 c2 = 0, becomes, squared,

    (k3 L1)^2 V^2 = W^2 (X^2 + Y^2),    V = F3 c2 + b1 s2,    W = b2 s2 - F4 c2.

Each of its roots belongs to one of the two signs, that of V W. With c2 = (1 - t^2)/(1 + t^2), s2 = 2 t/(1 + t^2) and
the denominators cleared it is N(t) = 0, N of degree six. An equilibrium at th2 = pi is a root at infinity.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from typing import Any


def derivatives(
    parameters: Mapping[str, Any], circles: Sequence[tuple[Any, Any]], root: Callable[[Any], Any]
) -> tuple[tuple[Any, Any], tuple[Any, Any, Any]]:
    """The potential's derivatives at a pose: dU/dth1 and dU/dth2; U11, U12 and U22.

    Parameters
    ----------
    parameters : by name, those that are missing being zero.
    circles : cosine and sine of th1 and of th2, elements of the parameters' field, or arrays.
    root : the field's square root, of either sign; asked for the springs with a free length only, in their order.
    """
    p = defaultdict[str, Any](int, parameters)
    rho, first, second = p["rho"], p["L1"], p["L2"]
    (c1, s1), (c2, s2) = circles
    x, y, z = rho * first * c1, rho * second * c2, first * second * (c1 * c2 - s1 * s2)
    u, v, w = rho * first * s1, rho * second * s2, first * second * (s1 * c2 + c1 * s2)
    springs = (
        (rho**2 + second**2 - 2 * y, (0, v)),
        (rho**2 + first**2 - 2 * x, (u, 0)),
        (rho**2 + first**2 + second**2 - 2 * (x + y) + 2 * z, (u - w, v - w)),
    )
    pulls, bends = [], [0, 0, 0]
    for number, (square, (a, b)) in enumerate(springs, 1):
        k, free = p[f"k{number}"], p[f"l0_{number}"]
        if free != 0:
            length = root(square)
            bends = [old + k * free / length**3 * new for old, new in zip(bends, (a * a, a * b, b * b), strict=True)]
            k = k * (1 - free / length)
        pulls.append(k)
    k1, k2, k3 = pulls
    return (
        (
            k2 * u + k3 * (u - w) + first * (p["F3x"] * s1 - p["F3"] * c1),
            k1 * v + k3 * (v - w) - second * (p["F4x"] * s2 + p["F4"] * c2),
        ),
        (
            k2 * x + k3 * (x - z) + first * (p["F3x"] * c1 + p["F3"] * s1) + bends[0],
            bends[1] - k3 * z,
            k1 * y + k3 * (y - z) + second * (p["F4"] * s2 - p["F4x"] * c2) + bends[2],
        ),
    )


def sextic(p: Mapping[str, Any]) -> tuple[tuple[Any, ...], ...]:
    """The sextic N, and beside it V, W and X^2 + Y^2, each times 1 + t^2: coefficients of 1, t, t^2, ...

    Parameters
    ----------
    p : L1, L2, rho, k1, k2, k3, F3, F4, F3x and F4x, elements of one ring.
    """
    b1, b2 = (p["k2"] + p["k3"]) * p["rho"] + p["F3x"], (p["k1"] + p["k3"]) * p["rho"] - p["F4x"]
    pull, stretch = p["k3"] * p["L1"], p["k3"] * p["L2"]
    v, w = (p["F3"], 2 * b1, -p["F3"]), (-p["F4"], 2 * b2, p["F4"])
    middle, along = b1 * b1 + stretch * stretch + p["F3"] * p["F3"], 2 * b1 * p["k3"] * p["L2"]
    square = (middle - along, 4 * p["k3"] * p["L2"] * p["F3"], middle + along)
    left, right = product((pull * pull, 0 * pull, pull * pull), product(v, v)), product(square, product(w, w))
    return tuple(a - b for a, b in zip(left, right, strict=True)), v, w, square


def parts(p: Mapping[str, Any], c2: Any, s2: Any) -> tuple[Any, Any, Any, Any]:
    """V, W, X and Y at cosine and sine of th2."""
    b1, b2 = (p["k2"] + p["k3"]) * p["rho"] + p["F3x"], (p["k1"] + p["k3"]) * p["rho"] - p["F4x"]
    v, w = p["F3"] * c2 + b1 * s2, b2 * s2 - p["F4"] * c2
    return v, w, b1 - p["k3"] * p["L2"] * c2, p["F3"] + p["k3"] * p["L2"] * s2


def product(left: Sequence[Any], right: Sequence[Any]) -> tuple[Any, ...]:
    """The product of two polynomials in t."""
    total: list[Any] = [0] * (len(left) + len(right) - 1)
    for i, a in enumerate(left):
        for j, b in enumerate(right):
            total[i + j] = total[i + j] + a * b
    return tuple(total)
