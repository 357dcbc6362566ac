"""Checks of the discriminant variety: nothing is missing, nothing is foreign.

The norm N of det H is compared with the product of the stored components at random integer points, of 48 bits in each
coordinate. If N = c A_1^e1 ... / B_1^f1 ..., its exponents are read off at the first point and the identity is checked
at the others. A false identity of degree d agrees at one random point with probability under d/2^47.

The points are drawn from a hash of the claims themselves, so that no one can choose claims to fit the points.

Guarantee: up to that probability, every CRITICAL component is a factor of N, and no other curve is a factor of it but
BOUNDARY components; the poles of the unknowns' characteristic polynomials lie on stored components, and every INFINITY
component consists of such poles. Where one is left out as harmless, the values of det H at the solutions stay away from
0 near almost all of its points.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
from math import gcd, lcm

from flint import fmpq, fmpz_poly

from ptmcad.numerals import text_of
from ptmcad.plane import PlanePolynomial
from ptmcad.regionmap import HARMLESS, Kind
from ptmcad.verification.claims import Claims, PlaneCurve
from ptmcad.verification.fibre import Fibre
from ptmcad.verification.report import Violation

POINTS = 12
FAR_POINTS, FAR_BITS = 3, 400
"""For poles: a value of so many bits is not made of small primes by accident, nor by trying."""


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
    return factors(PlaneCurve.of(0, p, 0).flint()) == [p]


def factors(p: object) -> list[PlanePolynomial]:
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


def _random_fibres(claims: Claims, seed: str, number: int, bits: int) -> list[tuple[Fraction, Fraction, Fibre]]:
    source = random.Random(f"{bits} {seed}")
    found = []
    for _ in range(number):
        x, y = (Fraction(source.getrandbits(bits) - 2 ** (bits - 1)) for _ in range(2))
        found.append((x, y, claims.fibre_at(x, y)))
    return found


def check_norm(claims: Claims, seed: str) -> str:
    """Norm of det H and poles against the stored components."""
    result = claims.result
    fibres = _random_fibres(claims, seed, POINTS, 48)
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
    far = _random_fibres(claims, seed, FAR_POINTS, FAR_BITS)
    for k, c in enumerate(result.components):
        if c.kind is Kind.INFINITY and not _has_poles(c.polynomial, claims, far):
            raise Violation(f"component {k} is said to be at infinity, but solutions have no pole on it: "
                            f"{c.polynomial.text(result.slice.axis_names)[:60]}")  # fmt: skip
        if c.left_out == HARMLESS and not _is_harmless(c.polynomial, claims, far):
            raise Violation(f"component {k} is said to be harmless, but det H may vanish at solutions near it: "
                            f"{c.polynomial.text(result.slice.axis_names)[:60]}")  # fmt: skip
    poles = [_foreign_poles(claims, *point) for point in far]
    if max(poles) // gcd(*poles) > 2**20:  # a curve that is missing has values of some hundred bits
        raise Violation("solutions have a pole on no stored component")
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

    For a curve without poles that would need a value of 400 bits or more to be made of such primes by accident.
    """
    for x, y, f in points:
        own = abs(int(p(x, y)))
        for c in claims.result.components:
            if c.polynomial != p:
                own = _without(own, int(c.polynomial(x, y)))
        if _without(_without(own, _SMALL_PRIMES), _denominator(f)) > 2**20:
            return False
    return True


def _is_harmless(p: PlanePolynomial, claims: Claims, points: Sequence[tuple[Fraction, Fraction, Fibre]]) -> bool:
    """Whether the primes of p's value do not divide the constant coefficient of det H's characteristic polynomial.

    That polynomial is made integral and primitive first. On a curve that divides its constant coefficient as a
    polynomial in the axes, all primes of p's values divide it.
    """
    for x, y, f in points:
        own = abs(int(p(x, y)))
        for c in claims.result.components:
            if c.polynomial != p:
                own = _without(own, int(c.polynomial(x, y)))
        own = _without(own, _SMALL_PRIMES)
        coefficients = f.jacobian.charpoly().coeffs()
        constant = fmpq(coefficients[0]) * lcm(*(int(fmpq(c).q) for c in coefficients))
        if own // gcd(own, int(constant.p)) > 2**20:
            return True
    return False


def _denominator(f: Fibre) -> int:
    """The common denominator of the power traces of a linear form."""
    return lcm(*(int(t.q) for t in f.form_traces((3, 5, 7, 11))))


def _foreign_poles(claims: Claims, x: Fraction, y: Fraction, f: Fibre) -> int:
    """Denominator of the power traces at an integer point, without the primes of the stored components."""
    below = _denominator(f)
    for c in claims.result.components:
        if c.kind is not Kind.AUXILIARY:
            below = _without(below, int(c.polynomial(x, y)))
    return _without(below, _SMALL_PRIMES)


def _at(claims: Claims, x: Fraction, y: Fraction) -> str:
    names = claims.result.slice.axis_names
    return f"{names[0]}={text_of(x)}, {names[1]}={text_of(y)}"
