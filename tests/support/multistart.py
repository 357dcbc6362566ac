"""Real solutions of a record's model by Newton's method from many starts, certified in 50 digits.

Shares no code with the package: SymPy reads the record's texts and differentiates, NumPy searches, mpmath's intervals
prove by Krawczyk's test that there is exactly one solution in a box around each end of the search. What is found is
there; that nothing is missing is not proved, so that a caller searches on while it knows of more.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import prod
from typing import Any

import mpmath
import numpy as np
import sympy

mpmath.iv.dps = 60

SEPARATE = 1e-7
"""Solutions nearer to each other than this are taken for one by the search; degenerate points are not asked for."""


Evaluation = Callable[[Mapping[str, Any], Any], Any]
"""An expression at names' values, in mpmath's context of numbers or of intervals."""


@dataclass(frozen=True)
class Model:
    """Equations, their Jacobian and the conditions of a record.

    Attributes
    ----------
    arrays : equations and Jacobian, row by row, as functions of NumPy arrays: unknowns, then parameters.
    """

    unknowns: tuple[str, ...]
    parameters: tuple[str, ...]
    angles: frozenset[str]
    equations: tuple[Evaluation, ...]
    jacobian: tuple[tuple[Evaluation, ...], ...]
    positive: tuple[Evaluation, ...]
    is_potential: bool
    arrays: tuple[Any, Any]


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
        energy += read(spring["k"]) * ((x1 - x0) ** 2 + (y1 - y0) ** 2) / 2
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
    unknowns: Mapping[str, str], equations: Sequence[Any], positive: tuple[Any, ...], is_potential: bool
) -> Model:
    symbols = [sympy.Symbol(u) for u in unknowns]
    jacobian = [[sympy.diff(e, u) for u in symbols] for e in equations]
    free = set().union(*(e.free_symbols for e in (*equations, *positive))) - set(symbols)
    parameters = sorted(free, key=str)
    given = [*symbols, *parameters]
    return Model(
        tuple(unknowns),
        tuple(map(str, parameters)),
        frozenset(u for u, kind in unknowns.items() if kind == "angle"),
        tuple(map(_evaluation, equations)),
        tuple(tuple(map(_evaluation, row)) for row in jacobian),
        tuple(map(_evaluation, positive)),
        is_potential,
        (
            sympy.lambdify(given, list(equations), modules="numpy", cse=True),
            sympy.lambdify(given, [d for row in jacobian for d in row], modules="numpy", cse=True),
        ),
    )


def _evaluation(e: Any) -> Evaluation:
    """An expression as nested functions, so that it is taken apart once."""
    if e.is_Symbol:
        name = str(e)
        return lambda at, _: at[name]
    if e.is_Rational:
        p, q = int(e.p), int(e.q)
        return lambda _, context: context.mpf(p) / q
    parts = tuple(map(_evaluation, e.args))
    if e.is_Add:
        return lambda at, context: sum((part(at, context) for part in parts), context.mpf(0))
    if e.is_Mul:
        return lambda at, context: prod((part(at, context) for part in parts), start=context.mpf(1))
    if e.is_Pow and e.exp.is_Integer:
        n = int(e.exp)
        return lambda at, context: parts[0](at, context) ** n
    if e.func in (sympy.cos, sympy.sin):
        function = e.func.__name__
        return lambda at, context: getattr(context, function)(parts[0](at, context))
    raise NotImplementedError(str(e))


@dataclass(frozen=True)
class Found:
    """A certified solution: its coordinates to 40 digits, and the number of the Hessian's negative eigenvalues."""

    at: tuple[Any, ...]
    negative: int
    counts: bool


def solutions(model: Model, values: Mapping[str, Fraction], starts: int, seed: int) -> list[Found]:
    """What Newton's method reaches from so many random starts, each solution once and certified."""
    generator = np.random.default_rng(seed)
    equations, jacobian = model.arrays
    numbers = [float(values[name]) for name in model.parameters]
    n = len(model.unknowns)
    x = np.empty((n, starts))
    for k, name in enumerate(model.unknowns):
        if name in model.angles:
            x[k] = generator.uniform(-np.pi, np.pi, starts)
        else:  # of all sizes
            x[k] = generator.choice([-1, 1], starts) * 10 ** generator.uniform(-3, 2.5, starts)
    with np.errstate(all="ignore"):
        for _ in range(60):
            f = np.array([np.broadcast_to(e, starts) for e in equations(*x, *numbers)], dtype=float)
            j = np.array([np.broadcast_to(d, starts) for d in jacobian(*x, *numbers)], dtype=float).reshape(
                n, n, starts
            )
            j = np.moveaxis(j, 2, 0)
            regular = np.isfinite(j).all((1, 2)) & np.isfinite(f).all(0)
            regular[regular] &= np.abs(np.linalg.det(j[regular])) > 1e-300
            step = np.zeros((starts, n))
            step[regular] = np.linalg.solve(j[regular], f.T[regular][..., None])[..., 0]
            limit = np.array([1.0 if u in model.angles else np.inf for u in model.unknowns])
            x = x - np.clip(step, -limit, limit).T
            x[:, ~regular] = np.nan
    ends: list[tuple[Any, ...]] = []
    for column in x.T[np.isfinite(x).all(0)]:
        wrapped = [_wrapped(c) if u in model.angles else c for u, c in zip(model.unknowns, column, strict=True)]
        if not any(_near(model, wrapped, other) for other in ends):
            ends.append(tuple(wrapped))
    found: list[Found] = []
    for end in ends:
        certified = _certified(model, values, end)
        if certified is not None and not any(_near(model, certified.at, other.at) for other in found):
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
        exact = {m: mpmath.mpf(values[m].numerator) / values[m].denominator for m in model.parameters}
        wide = {m: mpmath.iv.mpf(values[m].numerator) / values[m].denominator for m in model.parameters}

        def numbers(functions: Sequence[Evaluation], at: Sequence[Any]) -> list[Any]:
            known = {**exact, **dict(zip(model.unknowns, at, strict=True))}
            return [f(known, mpmath.mp) for f in functions]

        def intervals(functions: Sequence[Evaluation], at: Sequence[Any]) -> list[Any]:
            known = {**wide, **dict(zip(model.unknowns, at, strict=True))}
            return [f(known, mpmath.iv) for f in functions]

        x = [mpmath.mpf(c) for c in end]
        try:
            for _ in range(8):
                slope = mpmath.matrix([numbers(row, x) for row in model.jacobian])
                step = mpmath.lu_solve(slope, mpmath.matrix(numbers(model.equations, x)))
                x = [c - d for c, d in zip(x, step, strict=True)]
            matrix = mpmath.matrix([numbers(row, x) for row in model.jacobian])
            inverse = matrix**-1
        except ZeroDivisionError:
            return None
        radius = mpmath.mpf(10) ** -35
        hull = [_interval(c, radius * (1 + abs(c))) for c in x]
        slopes = [intervals(row, hull) for row in model.jacobian]
        here = intervals(model.equations, [_interval(c, mpmath.mpf(0)) for c in x])
        inside = _interval(mpmath.mpf(0), radius / 2)
        for i in range(n):
            moved = -sum((mpmath.iv.mpf(inverse[i, m]) * here[m] for m in range(n)), mpmath.iv.mpf(0))
            for k in range(n):
                entry = mpmath.iv.mpf(int(i == k))
                entry -= sum((mpmath.iv.mpf(inverse[i, m]) * slopes[m][k] for m in range(n)), mpmath.iv.mpf(0))
                moved += entry * (hull[k] - mpmath.iv.mpf(x[k]))
            if moved not in inside:
                return None
        negative = 0
        if model.is_potential:
            eigenvalues = mpmath.eigsy((matrix + matrix.T) / 2, eigvals_only=True)
            assert min(abs(e) for e in eigenvalues) > mpmath.mpf(10) ** -20
            negative = sum(e < 0 for e in eigenvalues)
        return Found(tuple(x), negative, all(c > 0 for c in numbers(model.positive, x)))


def _interval(center: Any, radius: Any) -> Any:
    return mpmath.iv.mpf([center - radius, center + radius])
