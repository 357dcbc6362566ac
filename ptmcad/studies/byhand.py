"""The paper's mechanism worked out by hand: derivatives and a sextic over any ring, and what doubles make of them.

Guarantee: derivatives and sextic are exact as far as the ring is. They owe nothing to an engine; tests hold the
derivatives against the description. For poses and counts in double precision there is none: floating point and usual
tolerances decide which roots are real, which poses are one, and what is zero. The same input gives the same. Nothing
is imported that is not needed: ``python -m ptmcad.studies.byhand METHOD QUESTION N RESULT`` counts on a grid, as
people do, and is timed as a process.

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

*Doubles.* `companion` takes eigenvalues of stacked companion matrices (numpy, hence LAPACK) of the sextic, and th1 from
the first equation. It is treated kindly: th2 = pi, which t cannot reach, is put back where leading coefficients vanish,
and where the mechanism is flat both th1 are taken. `newton` is Newton's method from a grid of starts; an equilibrium
that no start leads to is not found.
"""

from __future__ import annotations

import json
import sys
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Values = Mapping[str, Floats]
"""Of the parameters by name, each of shape (points,); one that is missing is zero."""
Elements = Mapping[str, Any]
"""The same of elements of any one ring."""
REAL_TOLERANCE = 1e-8
"""A root is taken for real when its imaginary part is at most this much of 1 + its modulus."""
ZERO_TOLERANCE = 1e-12
"""A coefficient is taken for zero when it is at most this much of the largest."""
SAME_POSE = 1e-6
"""Poses no farther apart than this (radians) are taken for one."""
ROUNDS = 60
"""Of Newton's method."""
RESIDUAL = 1e-9
"""A gradient is taken for zero when it is at most this much of the largest force times length."""
MAX_IMAGINARY = 1e-7
"""The same on the grid of a rival; nearby values change little."""
BATCH_POINTS = 40_000
"""Points whose matrices are in memory together."""
GRID_STARTS = 5
"""Along each angle: 25 starts a point of a grid."""


def derivatives(
    parameters: Elements, circles: Sequence[tuple[Any, Any]], root: Callable[[Any], Any]
) -> tuple[tuple[Any, Any], tuple[Any, Any, Any]]:
    """The potential's derivatives at a pose: dU/dth1 and dU/dth2; U11, U12 and U22.

    Parameters
    ----------
    parameters : by name, those that are missing being zero.
    circles : cosine and sine of th1 and of th2, elements of the parameters' field, or arrays.
    root : the field's square root, of either sign; asked for the springs with a free length only,
        in their order.
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
            bends = [
                old + k * free / length**3 * new
                for old, new in zip(bends, (a * a, a * b, b * b), strict=True)
            ]
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


def sextic(p: Elements) -> tuple[tuple[Any, ...], ...]:
    """The sextic N, and in addition V, W and X^2 + Y^2, each times 1 + t^2: coefficients of 1, t,
    t^2, ...

    Parameters
    ----------
    p : L1, L2, rho, k1, k2, k3, F3, F4, F3x and F4x, elements of one ring.
    """
    b1, b2 = along_base(p)
    pull, stretch = p["k3"] * p["L1"], p["k3"] * p["L2"]
    v, w = (p["F3"], 2 * b1, -p["F3"]), (-p["F4"], 2 * b2, p["F4"])
    middle, along = b1 * b1 + stretch * stretch + p["F3"] * p["F3"], 2 * b1 * p["k3"] * p["L2"]
    square = (middle - along, 4 * p["k3"] * p["L2"] * p["F3"], middle + along)
    left, right = (
        product((pull * pull, 0 * pull, pull * pull), product(v, v)),
        product(square, product(w, w)),
    )
    return tuple(a - b for a, b in zip(left, right, strict=True)), v, w, square


def along_base(p: Elements) -> tuple[Any, Any]:
    """b1 and b2."""
    return (p["k2"] + p["k3"]) * p["rho"] + p["F3x"], (p["k1"] + p["k3"]) * p["rho"] - p["F4x"]


def parts(p: Elements, c2: Any, s2: Any) -> tuple[Any, Any, Any, Any]:
    """V, W, X and Y at cosine and sine of th2."""
    b1, b2 = along_base(p)
    v, w = p["F3"] * c2 + b1 * s2, b2 * s2 - p["F4"] * c2
    return v, w, b1 - p["k3"] * p["L2"] * c2, p["F3"] + p["k3"] * p["L2"] * s2


def on_circle(t: Any) -> tuple[Any, Any]:
    """Cosine and sine of an angle from the tangent of its half."""
    return (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)


def product(left: Sequence[Any], right: Sequence[Any]) -> tuple[Any, ...]:
    """The product of two polynomials in t."""
    total = [0] * (len(left) + len(right) - 1)
    for i, a in enumerate(left):
        for j, b in enumerate(right):
            total[i + j] = total[i + j] + a * b
    return tuple(total)


# ------------------------------------------------------------------------------------------------ in double precision


def companion(p: Values, real_tolerance: float = REAL_TOLERANCE) -> tuple[Floats, Floats]:
    """th1 and th2 of equilibria without free lengths, each of shape (12, points), NaN in places
    that have none.

    Two places belong to a root of the sextic; the second one has a pose where the mechanism is
    flat.

    Raises
    ------
    LinAlgError
        When numbers overflow, all coefficients vanish, or an eigenvalue is not found.
    """
    coefficients = np.stack(np.broadcast_arrays(*sextic(p)[0][::-1]))
    sizes = np.abs(coefficients)
    leading = (sizes > ZERO_TOLERANCE * sizes.max(axis=0)).argmax(axis=0)
    trailing = (coefficients[::-1] != 0).argmax(axis=0)
    th2 = np.full((6, len(leading)), np.nan)
    for first, last in {*zip(leading.tolist(), trailing.tolist(), strict=True)}:
        here = (leading == first) & (trailing == last)
        own = coefficients[first : 7 - last, here]
        degree = len(own) - 1
        matrices = np.zeros((own.shape[1], degree, degree))
        matrices[:, :1] = (-own[1:] / own[0]).T[:, None]
        matrices[:, np.arange(1, degree), np.arange(degree - 1)] = 1
        t = np.linalg.eigvals(matrices).T
        real = np.abs(t.imag) <= real_tolerance * (1 + np.abs(t))
        th2[:degree, here] = np.where(real, 2 * np.arctan(t.real), np.nan)
        th2[degree : degree + last, here] = 0
        th2[degree + last :, here] = np.pi
    v, w, x, y = parts(p, np.cos(th2), np.sin(th2))
    whole1, whole2, *_ = parts(p, 0.0, 1.0)
    flat = (np.abs(v) <= SAME_POSE * np.abs(whole1)) & (np.abs(w) <= SAME_POSE * np.abs(whole2))
    side = np.where(flat, 1.0, np.sign(v * w))
    th1 = np.stack(
        [np.arctan2(side * y, side * x), np.where(flat, np.arctan2(-y, -x), np.nan)], axis=1
    )
    return th1.reshape(12, -1), np.repeat(th2, 2, axis=0)


def newton(p: Values, starts: int) -> tuple[Floats, Floats]:
    """th1 and th2 to which so many starts along each angle lead, of shape (starts^2, points), or
    NaN.
    """
    grid = 2 * np.pi * (np.arange(starts) + 0.37) / starts - np.pi
    th1, th2 = (a.reshape(-1, 1) + 0 * p["rho"] for a in np.meshgrid(grid, grid))
    for _ in range(ROUNDS):
        (g1, g2), (h11, h12, h22) = at(p, th1, th2)
        determinant = h11 * h22 - h12 * h12
        step1, step2 = (h22 * g1 - h12 * g2) / determinant, (h11 * g2 - h12 * g1) / determinant
        longest = np.maximum(1.0, 2 * np.hypot(step1, step2))  # steps of at most half a radian
        th1, th2 = th1 - step1 / longest, th2 - step2 / longest
    good = np.hypot(*at(p, th1, th2)[0]) <= RESIDUAL * scale(p)
    first, second = (
        np.where(good, (angle + np.pi) % (2 * np.pi) - np.pi, np.nan) for angle in (th1, th2)
    )
    return first, second


def at(p: Values, th1: Floats, th2: Floats) -> tuple[Any, Any]:
    """Gradient and Hessian at many poses."""
    return derivatives(p, [(np.cos(a), np.sin(a)) for a in (th1, th2)], np.sqrt)


def scale(p: Elements) -> Any:
    """The largest summand of the gradient: of a spring's or a load's moment about a joint."""
    stiffness, longest, span, load = (
        np.max([np.abs(value) for name, value in p.items() if name.startswith(start)], axis=0)
        for start in ("k", "L", ("L", "rho", "l0"), "F")
    )
    return np.maximum(stiffness * span, load) * longest


def distinct(th1: Floats, th2: Floats) -> NDArray[np.bool_]:
    """Where a pose is none that is taken for one before it at the same point."""
    kept = np.isfinite(th1) & np.isfinite(th2)
    before: list[int] = []
    for place in np.flatnonzero(kept.any(axis=1)).tolist():
        for earlier in before:
            errors = [angle_error(a[place], a[earlier]) for a in (th1, th2)]
            kept[place] &= ~(kept[earlier] & (np.maximum(*errors) <= SAME_POSE))
        if kept[place].any():
            before.append(place)
    return kept


def angle_error(a: Any, b: Any) -> Any:
    """The distance of two angles from -pi to pi on the circle."""
    gap = abs(a - b)
    return np.minimum(gap, abs(2 * np.pi - gap))


def grid_values(question: Mapping[str, Any], n: int) -> dict[str, Floats]:
    """The mechanism's parameters at the n x n pixel centres, of shape (n * n,), the second axis
    running fastest.
    """
    x, y = (low + (high - low) * (np.arange(n) + 0.5) / n for low, high in question["window"])
    first, second = (a.ravel() for a in np.meshgrid(x, y, indexing="ij"))

    def evaluated(terms: list[list[float]]) -> Floats:
        return sum((c * first ** int(i) * second ** int(j) for i, j, c in terms), np.zeros(n * n))

    return {name: evaluated(a) / evaluated(b) for name, (a, b) in question["parameters"].items()}


def counts(method: str, p: Values) -> NDArray[np.int8]:
    """Stable and total counts at each point, of shape (2, points)."""
    found = []
    for k in range(0, len(p["rho"]), BATCH_POINTS):
        part = {name: values[k : k + BATCH_POINTS] for name, values in p.items()}
        with np.errstate(all="ignore"):
            poses = (
                companion(part, MAX_IMAGINARY)
                if method == "companion"
                else newton(part, GRID_STARTS)
            )
            kept = distinct(*poses)
            # roots count as often as they are there: at a double one floating point has two poses
            # that differ
            total = np.isfinite(poses[1][::2]) if method == "companion" else kept
            h11, h12, h22 = at(part, *poses)[1]
            stable = kept & (h11 > 0) & (h11 * h22 > h12 * h12)
        found.append(np.stack([stable.sum(axis=0), total.sum(axis=0)]).astype(np.int8))
    return np.concatenate(found, axis=1)


def main(method: str, question: str, n: str, result: str) -> None:
    """Count on N x N points, save the counts, of shape (2, N, N), and print the seconds."""
    asked = json.loads(Path(question).read_text(encoding="utf-8"))
    start = perf_counter()
    found = counts(method, grid_values(asked, int(n))).reshape(2, int(n), int(n))
    seconds = perf_counter() - start
    np.save(result, found)
    print(json.dumps({"timings": {"total": seconds}}))


if __name__ == "__main__":
    main(*sys.argv[1:])
