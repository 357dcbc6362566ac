"""Checks of the discriminant variety: nothing is missing, nothing is foreign, what is left out is not in the window.

The norm N of det H is compared with the product of the stored components at random integer points, of 48 bits in each
coordinate. If N = c A_1^e1 ... / B_1^f1 ..., its exponents are read off at the first point and the identity is checked
at the others. A false identity of degree d agrees at one random point with probability under d/2^47.

Guarantee: up to that probability, every CRITICAL component is a factor of N, and no other curve is a factor of it but
BOUNDARY components; the poles of the unknowns' characteristic polynomials lie on stored components.

Not guaranteed: that an INFINITY component that is stored is needed.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
from math import gcd, lcm

from flint import fmpz_poly

from ptmcad.expressions import Expression
from ptmcad.plane import PlanePolynomial
from ptmcad.regionmap import Kind
from ptmcad.verification.claims import PLANE, Claims, PlaneCurve
from ptmcad.verification.fibre import Fibre, fibre
from ptmcad.verification.report import Violation
from ptmcad.verification.structure import projection_of_one
from ptmcad.verification.sturm import points_apart, roots_between

POINTS = 12


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


def _random_fibres(claims: Claims, seed: int) -> list[tuple[Fraction, Fraction, Fibre]]:
    source = random.Random(seed)
    parameters = claims.result.slice.parameters
    found = []
    for _ in range(POINTS):
        x, y = (Fraction(source.getrandbits(48) - 2**47) for _ in range(2))
        found.append((x, y, fibre({name: e.evaluate(x, y) for name, e in parameters.items()})))
    return found


def check_norm(claims: Claims, seed: int) -> str:
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


def _foreign_poles(claims: Claims, x: Fraction, y: Fraction, f: Fibre) -> int:
    """Denominator of the power traces at an integer point, without the primes of the stored components."""
    below = lcm(*(int(t.q) for t in f.form_traces((3, 5, 7, 11))))
    for c in claims.result.components:
        below = _without(below, int(c.polynomial(x, y)))
    return _without(below, _SMALL_PRIMES)


def check_boundary(claims: Claims) -> str:
    """Denominators of the parameters, and lengths and stiffnesses that vary, are among the components."""
    stored = {c.polynomial for c in claims.result.components}
    kinds = {c.polynomial: c.kind for c in claims.result.components}
    checked = 0
    needed = set()
    for name, e in claims.result.slice.parameters.items():
        parts = [e.denominator]
        if name in ("L1", "L2", "k1", "k2", "k3", "rho"):
            parts.append(e.numerator)
        for terms in parts:
            for factor in _expression_factors(terms):
                checked += 1
                needed.add(factor)
                if factor not in stored:
                    raise Violation(f"{factor.text(claims.result.slice.axis_names)} = 0 bounds the domain of {name}, "
                                    "but is not stored")  # fmt: skip
                if kinds[factor] is not Kind.BOUNDARY:
                    raise Violation(f"{factor.text(claims.result.slice.axis_names)} bounds the domain of {name}, "
                                    f"but is stored as {kinds[factor].value}")  # fmt: skip
    return f"{checked} factors of parameters"


def _expression_factors(terms: Sequence[tuple[int, int, Fraction]]) -> list[PlanePolynomial]:
    if not any(i or j for i, j, _ in terms):
        return []
    scale = lcm(*(c.denominator for _, _, c in terms))
    return _factors(PLANE.from_dict({(i, j): int(c * scale) for i, j, c in terms}))


def check_left_out(claims: Claims) -> str:
    """A component that is left out has no branch in the open window."""
    result = claims.result
    number = 0
    for n, c in enumerate(result.components):
        if not c.left_out:
            continue
        if c.left_out != "no point in the window":
            raise Violation(f"component {n} is left out for a reason that can not be checked: {c.left_out[:60]}")
        number += 1
        curve = PlaneCurve.of(n, c.polynomial, result.base)
        if curve.degrees[1] == 0:
            hit = roots_between(curve.in_v[0], *claims.base) > 0
        elif curve.degrees[0] == 0:
            hit = roots_between(curve.in_u[0], *claims.height) > 0
        else:
            product = fmpz_poly([1])
            for f in projection_of_one(curve, claims.height):
                product = product * f
            over = points_apart(product, *claims.base)
            hit = any(roots_between(curve.over(u), *claims.height) > 0 for u in over)
        if hit:
            text = c.polynomial.text(result.slice.axis_names)[:60]
            raise Violation(f"component {n} is left out, but runs through the window: {text}")
    return f"{number} components; isolated points are not excluded, they part no cells"


def positive_at(parameters: dict[str, Expression], x: Fraction, y: Fraction) -> str | None:
    """A length or stiffness that is not positive at a point, or None."""
    for name in ("L1", "L2", "k1", "k2", "k3"):
        if parameters[name].evaluate(x, y) <= 0:
            return name
    return "rho" if parameters["rho"].evaluate(x, y) < 0 else None


def _at(claims: Claims, x: Fraction, y: Fraction) -> str:
    names = claims.result.slice.axis_names
    return f"{names[0]}={x}, {names[1]}={y}"
