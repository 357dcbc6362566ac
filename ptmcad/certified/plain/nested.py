"""Other ways to write the polynomials of a problem, for bounds: nested, scaled, and with a monomial eliminated.

Guarantee: every formula has the value of its polynomial; what `eliminated` gives vanishes where the polynomials do.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from ptmcad.certified.formula import Formula, Graph, Operation
from ptmcad.certified.plain.trigonometric import Multi, TrigonometricPolynomial
from ptmcad.certified.tape import Tape
from ptmcad.text.expressions import Expression

MAX_ELIMINATED = 40
"""Combinations of the equations; with three unknowns there may be many."""


def nested(
    graph: Graph,
    f: TrigonometricPolynomial,
    unknowns: Sequence[Formula],
    order: Sequence[tuple[int, bool]],
) -> Formula:
    """A polynomial by Horner's rule in one real unknown after the other.

    Parameters
    ----------
    order : numbers of unknowns, all the real ones; with True, even powers and odd ones are nested in its square, so
        that even powers are known not to be negative.
    """
    if not order:
        return f.formula(graph, unknowns)
    (k, folded), rest = order[0], order[1:]
    by_power: dict[int, dict[tuple[Multi, Multi], tuple[Expression, Expression]]] = {}
    for (m, e), coefficients in f.terms.items():
        lower = (*e[:k], 0, *e[k + 1 :])
        by_power.setdefault(e[k], {})[m, lower] = coefficients
    inner = {p: nested(graph, TrigonometricPolynomial(terms), unknowns, rest) for p, terms in by_power.items()}
    x = unknowns[k]
    if not folded:
        return _horner(graph, inner, x)
    halves = ({p // 2: g for p, g in inner.items() if p % 2 == parity} for parity in (0, 1))
    even, odd = (_horner(graph, half, x.squared()) for half in halves)
    return even + x * odd


def _horner(graph: Graph, coefficients: Mapping[int, Formula], x: Formula) -> Formula:
    total = graph.constant(0)
    for power in range(max(coefficients, default=0), -1, -1):
        total = total * x + coefficients.get(power, graph.constant(0))
    return total


def scaled(f: TrigonometricPolynomial, weights: Mapping[int, int]) -> TrigonometricPolynomial:
    """f with t_j u^-w_j in the place of some real unknowns, times u^d: a polynomial in one more unknown, u, the last.

    d is the least number that leaves no pole, so that at u = 0 it is what dominates f far away.
    """
    degrees = {key: sum(w * key[1][j] for j, w in weights.items()) for key in f.terms}
    most = max(degrees.values(), default=0)
    return TrigonometricPolynomial(
        {((*m, 0), (*e, most - degrees[m, e])): coefficients for (m, e), coefficients in f.terms.items()}
    )


def times(f: TrigonometricPolynomial, k: int) -> TrigonometricPolynomial:
    """f times a real unknown."""
    return TrigonometricPolynomial({(m, (*e[:k], e[k] + 1, *e[k + 1 :])): c for (m, e), c in f.terms.items()})


def eliminated(equations: Sequence[TrigonometricPolynomial]) -> list[TrigonometricPolynomial]:
    """Combinations of equations without one of their common terms, which vanish at every solution.

    What a reaction takes from one substance it often gives to another: then the sum of two equations bounds unknowns
    that neither of them does.
    """
    found: list[TrigonometricPolynomial] = []
    for _ in range(2):
        for f, g in combinations((*equations, *found), 2):
            for key in f.terms.keys() & g.terms.keys():
                (a, b), (c, d) = f.terms[key], g.terms[key]
                if not (a.numerator and c.numerator) or (b * c - a * d).numerator:
                    continue
                combined = f.scaled(c) - g.scaled(a)
                shorter = 0 < len(combined.terms) <= max(len(f.terms), len(g.terms))
                if shorter and len(found) < MAX_ELIMINATED and combined not in found:
                    found.append(combined)
    return found


def sharp_squares(tape: Tape) -> Tape:
    """A tape with two enclosures of each square: the evaluator's of an unbounded interval is [0, inf], a product's not.

    That of [2, inf] is [4, inf] as a product, and of [-inf, inf] only as a square is it known not to be negative.
    """
    rows: list[tuple[int, int, int, float, float]] = []
    place: list[int] = []
    leaves = {Operation.CONSTANT, Operation.VARIABLE}
    constants = {}
    for k, operation in enumerate(tape.operations):
        a, b = int(tape.first[k]), int(tape.second[k])
        if operation not in leaves:
            a, b = place[a], place[b] if b >= 0 else b
        if k in tape.constants:
            constants[len(rows)] = tape.constants[k]
        if operation == Operation.SQUARE:
            rows.append((Operation.MULTIPLY, a, a, 0.0, 0.0))
            rows.append((Operation.SQUARE, a, -1, 0.0, 0.0))
            rows.append((Operation.MEET, len(rows) - 2, len(rows) - 1, 0.0, 0.0))
        else:
            rows.append((int(operation), a, b, float(tape.low[k]), float(tape.high[k])))
        place.append(len(rows) - 1)
    operations, first, second, low, high = zip(*rows, strict=True)
    ends = [place[end - 1] + 1 if end else 0 for end in tape.stages]
    return replace(
        tape,
        operations=np.array(operations, np.int64),
        first=np.array(first, np.int64),
        second=np.array(second, np.int64),
        low=np.array(low),
        high=np.array(high),
        constants=constants,
        stages=np.array(ends, np.int64),
        outputs=tuple(np.array([place[p] for p in out], np.int64) for out in tape.outputs),
    )
