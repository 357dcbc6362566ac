"""Real solutions of a record's model by Newton's method from many starts, certified in 50 digits.

Shares no code with the package: SymPy reads the record's texts and differentiates, NumPy searches,
mpmath's intervals prove by Krawczyk's test that there is exactly one solution in a box around each
end of the search. What is found is there; that nothing is missing is not proved, so that a caller
searches on while it knows of more.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import mpmath
import numpy as np
import sympy

mpmath.iv.dps = 60

SEPARATE = 1e-7
"""Solutions nearer to each other than this are taken for one by the search; degenerate points are
not asked for.
"""


class Functions(NamedTuple):
    """What is asked of a model at a point, as functions of the unknowns and then the parameters: in
    numbers of 50 digits, in intervals, or in NumPy's arrays. The Jacobian comes row by row."""

    equations: Callable[..., Sequence[Any]]
    jacobian: Callable[..., Sequence[Any]]
    positive: Callable[..., Sequence[Any]]


@dataclass(frozen=True)
class Model:
    """Equations, their Jacobian and the conditions of a record."""

    unknowns: tuple[str, ...]
    parameters: tuple[str, ...]
    angles: frozenset[str]
    is_potential: bool
    numbers: Functions
    intervals: Functions
    arrays: Functions


def model_of(record: Mapping[str, Any]) -> Model:
    """The model of a record with a key ``system`` or ``mechanism``."""
    if "system" in record:
        given = record["system"]
        unknowns = given["unknowns"]
        read = _reader()
        symbols = [sympy.Symbol(u) for u in unknowns]
        if "potential" in given:
            potential = read(given["potential"])
            equations = [sympy.diff(potential, u) for u in symbols]
        else:
            equations = [read(e) for e in given["equations"]]
        positive = tuple(read(p) for p in given.get("positive", ()))
        return _model(unknowns, equations, positive, "potential" in given)
    given = record["mechanism"]
    read = _reader()
    points = {name: tuple(read(c) for c in pair) for name, pair in given["points"].items()}
    energy: Any = sympy.Integer(0)
    for spring in given.get("springs", ()):
        (x0, y0), (x1, y1) = (points[p] for p in spring["between"])
        square = (x1 - x0) ** 2 + (y1 - y0) ** 2
        energy += read(spring["k"]) * (
            square / 2 - read(spring.get("free", 0)) * sympy.sqrt(square)
        )
    for name, force in given.get("loads", {}).items():
        energy -= sum(read(f) * c for f, c in zip(force, points[name], strict=True))
    symbols = [sympy.Symbol(u) for u in given["unknowns"]]
    return _model(given["unknowns"], [sympy.diff(energy, u) for u in symbols], (), True)


def _reader() -> Any:
    """Texts to expressions with exact numbers."""

    def read(text: object) -> Any:
        return sympy.sympify(str(text).replace("^", "**"), rational=True, locals=_Names())

    return read


class _Names(dict[str, Any]):
    """Every name but cos and sin is a symbol, also those that SymPy has another meaning for."""

    def __missing__(self, name: str) -> Any:
        if name in ("cos", "sin"):
            return getattr(sympy, name)
        if name in ("Integer", "Rational", "Float", "Symbol"):
            raise KeyError(name)
        return sympy.Symbol(name)


def _model(
    unknowns: Mapping[str, str],
    equations: Sequence[Any],
    positive: tuple[Any, ...],
    is_potential: bool,
) -> Model:
    symbols = [sympy.Symbol(u) for u in unknowns]
    jacobian = [[sympy.diff(e, u) for u in symbols] for e in equations]
    free = set().union(*(e.free_symbols for e in (*equations, *positive))) - set(symbols)
    parameters = sorted(free, key=str)
    given = [*symbols, *parameters]
    asked = list(equations), [d for row in jacobian for d in row], list(positive)
    of_intervals = {
        "mpf": mpmath.iv.mpf,
        "cos": mpmath.iv.cos,
        "sin": mpmath.iv.sin,
        "sqrt": mpmath.iv.sqrt,
    }

    def functions(modules: Any) -> Functions:
        return Functions(*(sympy.lambdify(given, e, modules=modules, cse=True) for e in asked))

    return Model(
        tuple(unknowns),
        tuple(map(str, parameters)),
        frozenset(u for u, kind in unknowns.items() if kind == "angle"),
        is_potential,
        numbers=functions("mpmath"),
        intervals=functions([of_intervals, "mpmath"]),
        arrays=functions("numpy"),
    )


@dataclass(frozen=True)
class Found:
    """A certified solution: its coordinates to 40 digits, and the number of the Hessian's negative
    eigenvalues.
    """

    at: tuple[Any, ...]
    negative: int
    counts: bool


def solutions(
    model: Model, values: Mapping[str, Fraction], starts: int, seed: int, span: float = np.inf
) -> list[Found]:
    """What Newton's method reaches from so many random starts, each solution once and certified.

    Parameters
    ----------
    span : lengths start from -span to span with short steps, which finds peaks beside short
        springs; else of all sizes.
    """
    generator = np.random.default_rng(seed)
    equations, jacobian = model.arrays.equations, model.arrays.jacobian
    numbers = [float(values[name]) for name in model.parameters]
    n = len(model.unknowns)
    x = np.empty((n, starts))
    for k, name in enumerate(model.unknowns):
        if name in model.angles:
            x[k] = generator.uniform(-np.pi, np.pi, starts)
        elif span < np.inf:
            x[k] = generator.uniform(-span, span, starts)
        else:  # of all sizes
            x[k] = generator.choice([-1, 1], starts) * 10 ** generator.uniform(-3, 2.5, starts)
    with np.errstate(all="ignore"):
        for _ in range(60):
            f = np.array([np.broadcast_to(e, starts) for e in equations(*x, *numbers)], dtype=float)
            j = np.array(
                [np.broadcast_to(d, starts) for d in jacobian(*x, *numbers)], dtype=float
            ).reshape(n, n, starts)
            j = np.moveaxis(j, 2, 0)
            regular = np.isfinite(j).all((1, 2)) & np.isfinite(f).all(0)
            regular[regular] &= np.abs(np.linalg.det(j[regular])) > 1e-300
            step = np.zeros((starts, n))
            step[regular] = np.linalg.solve(j[regular], f.T[regular][..., None])[..., 0]
            limit = np.array([1.0 if u in model.angles else span / 20 for u in model.unknowns])
            x = x - np.clip(step, -limit, limit).T
            x[:, ~regular] = np.nan
    ends: list[tuple[Any, ...]] = []
    for column in x.T[np.isfinite(x).all(0)]:
        wrapped = [
            _wrapped(c) if u in model.angles else c
            for u, c in zip(model.unknowns, column, strict=True)
        ]
        if not any(_near(model, wrapped, other) for other in ends):
            ends.append(tuple(wrapped))
    found: list[Found] = []
    for end in ends:
        certified = _certified(model, values, end)
        if certified is not None and not any(
            _near(model, certified.at, other.at) for other in found
        ):
            found.append(certified)
    return found


def _wrapped(angle: float) -> float:
    return float((angle + np.pi) % (2 * np.pi) - np.pi)


def _near(model: Model, a: Sequence[Any], b: Sequence[Any]) -> bool:
    for name, p, q in zip(model.unknowns, a, b, strict=True):
        distance = float(abs(p - q))
        if name in model.angles:
            distance = min(distance % (2 * np.pi), 2 * np.pi - distance % (2 * np.pi))
        if distance > SEPARATE * (1 + float(abs(p))):
            return False
    return True


def _certified(model: Model, values: Mapping[str, Fraction], end: Sequence[float]) -> Found | None:
    """Polished in 50 digits and proved by Krawczyk's test; None when it converges to nothing."""
    n = len(model.unknowns)
    with mpmath.workdps(50):
        exact = [mpmath.mpf(values[m].numerator) / values[m].denominator for m in model.parameters]
        wide = [
            mpmath.iv.mpf(values[m].numerator) / values[m].denominator for m in model.parameters
        ]

        def slope(functions: Functions, *at: Any) -> list[list[Any]]:
            flat = functions.jacobian(*at)
            return [list(flat[k * n : (k + 1) * n]) for k in range(n)]

        x = [mpmath.mpf(c) for c in end]
        try:
            for _ in range(8):
                at = mpmath.matrix(model.numbers.equations(*x, *exact))
                step = mpmath.lu_solve(mpmath.matrix(slope(model.numbers, *x, *exact)), at)
                x = [c - d for c, d in zip(x, step, strict=True)]
                if max(abs(d) / (1 + abs(c)) for c, d in zip(x, step, strict=True)) < 1e-40:
                    break  # what it has come to is proved below
            matrix = mpmath.matrix(slope(model.numbers, *x, *exact))
            inverse = matrix**-1
        except ZeroDivisionError:
            return None
        radius = mpmath.mpf(10) ** -35
        hull = [_interval(c, radius * (1 + abs(c))) for c in x]
        slopes = slope(model.intervals, *hull, *wide)
        here = model.intervals.equations(*(_interval(c, mpmath.mpf(0)) for c in x), *wide)
        inside = _interval(mpmath.mpf(0), radius / 2)
        for i in range(n):
            moved = -sum(
                (mpmath.iv.mpf(inverse[i, m]) * here[m] for m in range(n)), mpmath.iv.mpf(0)
            )
            for k in range(n):
                entry = mpmath.iv.mpf(int(i == k))
                entry -= sum(
                    (mpmath.iv.mpf(inverse[i, m]) * slopes[m][k] for m in range(n)),
                    mpmath.iv.mpf(0),
                )
                moved += entry * (hull[k] - mpmath.iv.mpf(x[k]))
            if moved not in inside:
                return None
        negative = 0
        if model.is_potential:
            eigenvalues = mpmath.eigsy((matrix + matrix.T) / 2, eigvals_only=True)
            assert min(abs(e) for e in eigenvalues) > mpmath.mpf(10) ** -20
            negative = sum(e < 0 for e in eigenvalues)
        return Found(tuple(x), negative, all(c > 0 for c in model.numbers.positive(*x, *exact)))


def _interval(center: Any, radius: Any) -> Any:
    return mpmath.iv.mpf([center - radius, center + radius])
