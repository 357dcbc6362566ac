"""Checks of the discriminant variety: nothing is missing, nothing is foreign, what is left out is not in the window.

The norm N of det H is compared with the product of the stored components at random integer points, of 48 bits in each
coordinate. If N = c A_1^e1 ... / B_1^f1 ..., its exponents are read off at the first point and the identity is checked
at the others. A false identity of degree d agrees at one random point with probability under d/2^47.

The points are drawn from a hash of the claims themselves, so that no one can choose claims to fit the points.

Guarantee: up to that probability, every CRITICAL component is a factor of N, and no other curve is a factor of it but
BOUNDARY components; the poles of the unknowns' characteristic polynomials lie on stored components, and every INFINITY
component consists of such poles (those that are marked as not examined excepted, which have no point in the window).
BOUNDARY components are exactly the factors of the parameters' denominators, of lengths and stiffnesses that vary, and
of the factors common to all coefficients of an equation.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
from math import gcd, lcm

from flint import arb_poly, ctx, fmpq, fmpz_poly

from ptmcad.errors import ExpressionError
from ptmcad.expressions import axis, names_in, parse
from ptmcad.plane import PlanePolynomial
from ptmcad.regionmap import CriticalValue, Kind
from ptmcad.verification.claims import PLANE, Claims, PlaneCurve, ball, fraction, short
from ptmcad.verification.fibre import Fibre
from ptmcad.verification.model import equation_factors
from ptmcad.verification.report import Violation
from ptmcad.verification.structure import points_over, projection_of_one
from ptmcad.verification.sturm import isolating_intervals, points_apart, roots_between

POINTS = 12

NO_POINT = "no point in the window"
NOT_EXAMINED = "no point in the window, so whether it has poles was not examined"


def check_irreducible(claims: Claims) -> str:
    """Every component is irreducible over Q, and none is stored twice."""
    names = claims.result.slice.axis_names
    seen = set()
    for n, c in enumerate(claims.result.components):
        text = c.polynomial.text(names)[:60]
        if c.polynomial.total_degree < 1:
            raise Violation(f"component {n} is a constant: {text}")
        if PlanePolynomial.of(c.polynomial.terms) != c.polynomial:
            raise Violation(f"component {n} is not primitive with a positive first coefficient: {text}")
        if not _is_irreducible(c.polynomial):
            raise Violation(f"component {n} is not irreducible: {text}")
        if c.polynomial in seen:
            raise Violation(f"component {n} is stored twice: {text}")
        seen.add(c.polynomial)
    return f"{len(seen)} components"


def _is_irreducible(p: PlanePolynomial) -> bool:
    factors = _factors(PlaneCurve.of(0, p, 0).flint())
    return len(factors) == 1 and factors[0] == p


def _factors(p: object) -> list[PlanePolynomial]:
    """Irreducible factors; by squarefree parts first, because FLINT's sorting of equal factors is limited."""
    terms = list(p.to_dict().items())  # type: ignore[attr-defined]
    if not any(m[0] for m, _ in terms) or not any(m[1] for m, _ in terms):
        k = 0 if any(m[0] for m, _ in terms) else 1
        row = {int(m[k]): int(c) for m, c in terms}
        line = fmpz_poly([row.get(i, 0) for i in range(max(row) + 1)])
        return [
            PlanePolynomial.of((i, 0, int(c)) if k == 0 else (0, i, int(c)) for i, c in enumerate(f.coeffs()))
            for f, _ in line.factor()[1]
        ]
    factors = p.factor_squarefree()[1]  # type: ignore[attr-defined]
    found = []
    for part, _ in factors:
        for f, _ in part.factor()[1]:
            found.append(PlanePolynomial.of((int(m[0]), int(m[1]), int(c)) for m, c in f.to_dict().items()))
    return found


def _random_fibres(claims: Claims, seed: str) -> list[tuple[Fraction, Fraction, Fibre]]:
    source = random.Random(seed)
    found = []
    for _ in range(POINTS):
        x, y = (Fraction(source.getrandbits(48) - 2**47) for _ in range(2))
        found.append((x, y, claims.fibre_at(x, y)))
    return found


def check_norm(claims: Claims, seed: str) -> str:
    """Norm of det H and poles against the stored components."""
    result = claims.result
    fibres = _random_fibres(claims, seed)
    for x, y, f in fibres:
        if f.dimension != result.complex_solutions:
            raise Violation(f"there are {f.dimension} complex solutions at {_at(claims, x, y)}, "
                            f"not {result.complex_solutions}")  # fmt: skip
    exponents: list[int] | None = None
    constant = Fraction(0)
    for x, y, f in fibres:
        norm = f.norm()
        n = Fraction(int(norm.p), int(norm.q))
        values = [c.polynomial(x, y) for c in result.components]
        if n == 0 or 0 in values:
            raise Violation(f"det H vanishes at the random point {_at(claims, x, y)}")
        if exponents is None:
            exponents = _exponents(n, [int(v) for v in values])
            for k, (e, c) in enumerate(zip(exponents, result.components, strict=True)):
                if c.kind is Kind.CRITICAL and e < 1:
                    raise Violation(f"component {k} is said to be critical, but is no factor of the norm of det H "
                                    f"at {_at(claims, x, y)}")  # fmt: skip
                if c.kind is Kind.INFINITY and e > 0:
                    raise Violation(f"component {k} is said to be at infinity, but det H vanishes on it")
        rest = n
        for v, e in zip(values, exponents, strict=True):
            rest /= v**e
        if constant == 0:
            constant = rest
        if rest != constant:
            raise Violation(f"the norm of det H at {_at(claims, x, y)} is no constant times powers of the stored "
                            "components: a curve of the variety is missing or wrong")  # fmt: skip
    for k, c in enumerate(result.components):
        if c.kind is Kind.INFINITY and c.left_out != NOT_EXAMINED and not _has_poles(c.polynomial, claims, fibres[:3]):
            raise Violation(f"component {k} is said to be at infinity, but solutions have no pole on it: "
                            f"{c.polynomial.text(result.slice.axis_names)[:60]}")  # fmt: skip
    poles = [_foreign_poles(claims, *point) for point in fibres[:3]]
    if max(poles) // gcd(*poles) > 2**20:  # a curve that is missing has values of 48 bits and more
        raise Violation(f"near {_at(claims, fibres[0][0], fibres[0][1])} solutions have a pole on no stored component")
    return f"{POINTS} points of 48 bits, seed {seed}; multiplicities {exponents}"


def _exponents(n: Fraction, values: Sequence[int]) -> list[int]:
    exponents = []
    for k, value in enumerate(values):
        own = abs(value)
        for j, other in enumerate(values):
            if j != k:
                own = _without(own, other)
        own = _without(own, _SMALL_PRIMES)
        above, below, e = n.numerator, n.denominator, 0
        while own > 1 and above % own == 0:
            above, e = above // own, e + 1
        while own > 1 and below % own == 0:
            below, e = below // own, e - 1
        exponents.append(e)
    return exponents


_SMALL_PRIMES = reduce(lambda a, b: a * b, (p for p in range(2, 2000) if all(p % q for q in range(2, p))))


def _without(n: int, other: int) -> int:
    """n without the primes of ``other``."""
    while (common := gcd(n, other)) > 1:
        n //= common
    return n


def _has_poles(p: PlanePolynomial, claims: Claims, points: Sequence[tuple[Fraction, Fraction, Fibre]]) -> bool:
    """Whether the value of p at each integer point consists, but for small primes, of primes in denominators of traces.

    For a curve without poles that would need a value of 48 bits or more to be made of such primes by accident.
    """
    for x, y, f in points:
        own = abs(int(p(x, y)))
        for c in claims.result.components:
            if c.polynomial != p:
                own = _without(own, int(c.polynomial(x, y)))
        if _without(_without(own, _SMALL_PRIMES), _denominator(f)) > 2**20:
            return False
    return True


def _denominator(f: Fibre) -> int:
    """The common denominator of the power traces of a linear form."""
    return lcm(*(int(t.q) for t in f.form_traces((3, 5, 7, 11))))


def _foreign_poles(claims: Claims, x: Fraction, y: Fraction, f: Fibre) -> int:
    """Denominator of the power traces at an integer point, without the primes of the stored components."""
    below = _denominator(f)
    for c in claims.result.components:
        below = _without(below, int(c.polynomial(x, y)))
    return _without(below, _SMALL_PRIMES)


def check_boundary(claims: Claims) -> str:
    """The BOUNDARY components are those that the slice's expressions ask for."""
    names = claims.result.slice.axis_names
    needed: dict[PlanePolynomial, str] = {}
    for name, e in claims.result.slice.parameters.items():
        parts = [e.denominator]
        if name in ("L1", "L2", "k1", "k2", "k3", "rho"):
            parts.append(e.numerator)
        for terms in parts:
            for factor in _expression_factors(terms):
                needed[factor] = f"it bounds the domain of {name}"
    for k, common in enumerate(equation_factors(claims)):
        for factor in _factors(common) if not common.is_constant() else []:
            needed.setdefault(factor, f"equation {k} vanishes on it")
    stored = {c.polynomial: c for c in claims.result.components}
    for factor, why in needed.items():
        if factor not in stored:
            raise Violation(f"{factor.text(names)} = 0 is not stored, but {why}")
        if stored[factor].kind is not Kind.BOUNDARY:
            raise Violation(f"{factor.text(names)} = 0 is stored as {stored[factor].kind.value}, but {why}")
    for n, c in enumerate(claims.result.components):
        if c.kind is Kind.BOUNDARY and c.polynomial not in needed:
            raise Violation(f"component {n} is stored as boundary, but bounds nothing: {c.polynomial.text(names)[:60]}")
    return f"{len(needed)} factors of parameters and equations"


def _expression_factors(terms: Sequence[tuple[int, int, Fraction]]) -> list[PlanePolynomial]:
    if not any(i or j for i, j, _ in terms):
        return []
    scale = lcm(*(c.denominator for _, _, c in terms))
    return _factors(PLANE.from_dict({(i, j): int(c * scale) for i, j, c in terms}))


def check_left_out(claims: Claims) -> str:
    """A component that is left out has no point in the open window."""
    result = claims.result
    number = 0
    for n, c in enumerate(result.components):
        if not c.left_out:
            continue
        if c.left_out != NO_POINT and not (c.kind is Kind.INFINITY and c.left_out == NOT_EXAMINED):
            raise Violation(f"component {n} is left out for a reason that can not be checked: {c.left_out[:60]}")
        number += 1
        hit = _point_in_window(PlaneCurve.of(n, c.polynomial, result.base), claims)
        if hit is not None:
            raise Violation(f"component {n} is left out, but {hit}: {c.polynomial.text(result.slice.axis_names)[:60]}")
    return f"{number} components"


def _point_in_window(curve: PlaneCurve, claims: Claims) -> str | None:
    """What is known of a point of the curve in the open window; None when there is none."""
    runs = "runs through the window"
    if curve.degrees[1] == 0:
        return runs if roots_between(curve.in_v[0], *claims.base) else None
    if curve.degrees[0] == 0:
        return runs if roots_between(curve.in_u[0], *claims.height) else None
    product = fmpz_poly([1])
    singular = []
    for f, origin in projection_of_one(curve, claims.height):
        product = product * (f // f.gcd(product))
        if "edge" not in origin:
            singular.append(f)
    if any(roots_between(curve.over(u), *claims.height) for u in points_apart(product, *claims.base)):
        return runs
    # no branch runs through the window; what is left are isolated points, over roots of the discriminant
    for f in singular:
        for a, b in isolating_intervals(f, *claims.base):
            place = CriticalValue(tuple(int(c) for c in f.coeffs()), fraction(a), fraction(b), "")
            points = points_over(curve, place)
            for c, d in isolating_intervals(points, *claims.height):
                at = CriticalValue(tuple(int(k) for k in points.coeffs()), fraction(c), fraction(d), "")
                if not _excluded(curve, place, at):
                    return f"an isolated point near {short(a)}, {short(c)} could not be excluded"
    return None


def _excluded(curve: PlaneCurve, place: CriticalValue, at: CriticalValue) -> bool:
    """Whether the curve is proved not to pass through the point with these coordinates."""
    rows = [arb_poly(c) for c in curve.in_v]
    for bits in (64, 128, 256, 512, 1024):
        with ctx.workprec(2 * bits):
            u, v = (ball(value, fmpq(1, 2**bits)) for value in (place, at))
            if not arb_poly([row(u) for row in rows])(v).contains(0):
                return True
    return False


def check_text(claims: Claims) -> str:
    """Each parameter as the user wrote it, where it is kept, is the one that was computed with."""
    slice = claims.result.slice
    known = {slice.axis_names[0]: axis(0), slice.axis_names[1]: axis(1)}
    waiting = dict(slice.text)
    while waiting:
        # one whose names are all known by now, so that nothing is explained by itself
        name = next((n for n, text in waiting.items() if _names(n, text) <= known.keys()), None)
        if name is None:
            raise Violation(f"the texts kept for {', '.join(sorted(waiting))[:80]} name what is not explained")
        text = waiting.pop(name)
        if name not in slice.parameters:
            raise Violation(f"the text {text[:40]!r} is kept for {name[:40]!r}, which is no parameter")
        try:
            written = parse(text, known)
        except ExpressionError as error:
            raise Violation(f"the text kept for {name}, {text[:40]!r}, is no expression: {error}") from error
        if (written - slice.parameters[name]).numerator:
            true = slice.parameters[name].to_text(slice.axis_names)
            raise Violation(f"{name} was written as {text[:60]!r}, but is {true[:60]}")
        known.setdefault(name, written)
    return f"{len(slice.text)} parameters"


def _names(name: str, text: str) -> set[str]:
    try:
        return set(names_in(text))
    except ExpressionError as error:
        raise Violation(f"the text kept for {name[:40]!r}, {text[:40]!r}, is no expression: {error}") from error


def _at(claims: Claims, x: Fraction, y: Fraction) -> str:
    names = claims.result.slice.axis_names
    return f"{names[0]}={x}, {names[1]}={y}"
