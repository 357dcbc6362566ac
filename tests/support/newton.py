"""Real solutions of a record's model by Newton's method from many starts, certified in 50 digits.

Shares no code with the package: SymPy reads the record's texts and differentiates, NumPy searches, mpmath's intervals
prove by Krawczyk's test that there is exactly one solution in a box around each end of the search. What is found is
there; that nothing is missing is not proved, so that a caller searches on while it knows of more.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import sympy

mpmath.iv.dps = 60
SEPARATE = 1e-7
"""Solutions nearer to each other than this are taken for one by the search; degenerate points are not asked for."""


@dataclass(frozen=True)
class Model:
    """Equations, their Jacobian and the conditions of a record, as SymPy expressions in names."""

    unknowns: tuple[str, ...]
    angles: frozenset[str]
    equations: tuple[Any, ...]
    jacobian: tuple[tuple[Any, ...], ...]
    positive: tuple[Any, ...]
    is_potential: bool

    def functions(self, values: Mapping[str, Fraction]) -> tuple[Any, Any]:
        """Equations and Jacobian at the parameters' values as functions of arrays, one for each unknown."""
        numbers = {sympy.Symbol(n): sympy.Rational(v.numerator, v.denominator) for n, v in values.items()}
        names = [sympy.Symbol(u) for u in self.unknowns]
        equations = [e.subs(numbers) for e in self.equations]
        jacobian = [[d.subs(numbers) for d in row] for row in self.jacobian]
        return (
            sympy.lambdify(names, equations, modules="numpy"),
            sympy.lambdify(names, [d for row in jacobian for d in row], modules="numpy"),
        )


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
    return Model(
        tuple(unknowns),
        frozenset(u for u, kind in unknowns.items() if kind == "angle"),
        tuple(equations),
        tuple(tuple(sympy.diff(e, u) for u in symbols) for e in equations),
        positive,
        is_potential,
    )


@dataclass(frozen=True)
class Found:
    """A certified solution: its coordinates to 40 digits, and the number of the Hessian's negative eigenvalues."""

    at: tuple[Any, ...]
    negative: int
    counts: bool


def solutions(model: Model, values: Mapping[str, Fraction], starts: int, seed: int) -> list[Found]:
    """What Newton's method reaches from so many random starts, each solution once and certified."""
    generator = np.random.default_rng(seed)
    equations, jacobian = model.functions(values)
    n = len(model.unknowns)
    x = np.empty((n, starts))
    for k, name in enumerate(model.unknowns):
        if name in model.angles:
            x[k] = generator.uniform(-np.pi, np.pi, starts)
        else:  # of all sizes
            x[k] = generator.choice([-1, 1], starts) * 10 ** generator.uniform(-3, 2.5, starts)
    with np.errstate(all="ignore"):
        for _ in range(60):
            f = np.array([np.broadcast_to(e, starts) for e in equations(*x)], dtype=float)
            j = np.array([np.broadcast_to(d, starts) for d in jacobian(*x)], dtype=float).reshape(n, n, starts)
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
    names = [sympy.Symbol(u) for u in model.unknowns]
    numbers = {sympy.Symbol(n): sympy.Rational(v.numerator, v.denominator) for n, v in values.items()}
    n = len(names)
    with mpmath.workdps(50):
        f = [sympy.lambdify(names, e.subs(numbers), modules="mpmath") for e in model.equations]
        j = [[sympy.lambdify(names, d.subs(numbers), modules="mpmath") for d in row] for row in model.jacobian]
        x = mpmath.matrix([mpmath.mpf(c) for c in end])
        try:
            for _ in range(8):
                slope = mpmath.matrix([[d(*x) for d in row] for row in j])
                x = x - mpmath.lu_solve(slope, mpmath.matrix([g(*x) for g in f]))
            inverse = mpmath.matrix([[d(*x) for d in row] for row in j]) ** -1
        except ZeroDivisionError:
            return None
        radius = mpmath.mpf(10) ** -35
        hull = [_interval(c, radius * (1 + abs(c))) for c in x]
        wide = [[_on_intervals(model.jacobian[i][k].subs(numbers), names, hull) for k in range(n)] for i in range(n)]
        here = [_on_intervals(e.subs(numbers), names, [_interval(c, 0) for c in x]) for e in model.equations]
        inside = _interval(mpmath.mpf(0), radius / 2)
        for i in range(n):
            moved = -sum((mpmath.iv.mpf(inverse[i, m]) * here[m] for m in range(n)), mpmath.iv.mpf(0))
            for k in range(n):
                entry = mpmath.iv.mpf(int(i == k))
                entry -= sum((mpmath.iv.mpf(inverse[i, m]) * wide[m][k] for m in range(n)), mpmath.iv.mpf(0))
                moved += entry * (hull[k] - mpmath.iv.mpf(x[k]))
            if moved not in inside:
                return None
        negative = 0
        if model.is_potential:
            matrix = mpmath.matrix([[d(*x) for d in row] for row in j])
            eigenvalues = mpmath.eigsy((matrix + matrix.T) / 2, eigvals_only=True)
            assert min(abs(e) for e in eigenvalues) > mpmath.mpf(10) ** -20
            negative = sum(e < 0 for e in eigenvalues)
        conditions = [sympy.lambdify(names, p.subs(numbers), modules="mpmath")(*x) for p in model.positive]
        return Found(tuple(x), negative, all(c > 0 for c in conditions))


def _interval(center: Any, radius: Any) -> Any:
    return mpmath.iv.mpf([center - radius, center + radius])


def _on_intervals(expression: Any, names: Sequence[Any], at: Sequence[Any]) -> Any:
    """The range of an expression over a box."""
    known = dict(zip(names, at, strict=True))

    def value(e: Any) -> Any:
        if e.is_Symbol:
            return known[e]
        if e.is_Rational:
            return mpmath.iv.mpf(int(e.p)) / int(e.q)
        if e.is_Add:
            return sum((value(a) for a in e.args), mpmath.iv.mpf(0))
        if e.is_Mul:
            product = mpmath.iv.mpf(1)
            for a in e.args:
                product *= value(a)
            return product
        if e.is_Pow and e.exp.is_Integer:
            return value(e.base) ** int(e.exp)
        if e.func in (sympy.cos, sympy.sin):
            return getattr(mpmath.iv, e.func.__name__)(value(e.args[0]))
        raise NotImplementedError(str(e))

    return value(expression)
