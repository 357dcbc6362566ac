"""The sextic in t = tan(th2/2) that is left of the paper's mechanism when th1 has been eliminated, over any ring.

Guarantee: exact as far as the ring is. It is a derivation by hand and owes nothing to an engine.

With b1 = (k2 + k3) rho + F3x, b2 = (k1 + k3) rho - F4x, X = b1 - k3 L2 c2 and Y = k3 L2 s2 + F3 the first equation is
Y c1 - X s1 = 0, so (c1, s1) = +-(X, Y)/|(X, Y)|; the second, k3 L1 s12 - b2 s2 + F4 c2 = 0, becomes, squared,

    (k3 L1)^2 V^2 = W^2 (X^2 + Y^2),    V = F3 c2 + b1 s2,    W = b2 s2 - F4 c2.

Each of its roots belongs to one of the two signs, that of V W. With c2 = (1 - t^2)/(1 + t^2), s2 = 2 t/(1 + t^2) and
the denominators cleared it is N(t) = 0, N of degree six. An equilibrium at th2 = pi is a root at infinity.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

Coefficients = tuple[Any, ...]
"""Of 1, t, t^2, ..., elements of one ring."""


def sextic(p: Mapping[str, Any]) -> tuple[Coefficients, Coefficients, Coefficients, Coefficients]:
    """The sextic N for the parameters L1, L2, rho, k1, k2, k3, F3, F4, F3x and F4x, elements of one ring.

    Beside it are V, W and X^2 + Y^2, each times 1 + t^2.
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
