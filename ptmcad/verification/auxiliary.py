"""Checks of the curves that are there only because a saving which leaves them out was switched off.

With "sign-curve" switched off these are the irreducible factors of the norms of the Hessian's proper leading minors,
with "hermite-matrix" those of the determinant of the matrix trace(b_i b_j), where the b_i are the monomials that are
standard in graded reverse lexicographic order; as far as they are stored for no other reason. These functions of the
axes are known at random integer points, as the norm of det H is in `ptmcad.verification.variety`.

Guarantee: up to its error probability, every AUXILIARY component is such a factor and no factor or pole of the norm of
det H, and no such factor is missing.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from fractions import Fraction
from math import gcd, isqrt, prod

from flint import fmpq

from ptmcad.answer.regionmap import Kind
from ptmcad.text.flint_numbers import to_fraction
from ptmcad.verification.algebra import Monomial
from ptmcad.verification.claims import Claims
from ptmcad.verification.fibre import Fibre, standard_monomials
from ptmcad.verification.plan import switched_off
from ptmcad.verification.report import Unchecked, Violation

POINTS, BITS = 12, 48
MIN_CERTAIN_PART = 2**16
"""A value's part that it shares with no other one shows its multiplicity when it is larger than this."""
_HERMITE = "the Hermite matrix's determinant"
_SAVINGS = {"sign-curve": "the norm of H11 or of another leading minor", "hermite-matrix": _HERMITE}

Values = tuple[Fraction, tuple[int, ...]]
"""The value of a function at a point, and those of the components there."""


def check_auxiliary(claims: Claims, seed: str) -> str:
    """Auxiliary components against the functions that they are factors of."""
    components = claims.result.components
    auxiliary = [n for n, c in enumerate(components) if c.kind is Kind.AUXILIARY]
    savings = [name for name in _SAVINGS if name in switched_off(claims.result)]
    if not savings:
        if auxiliary:
            raise Violation(f"component {auxiliary[0]} is auxiliary, but no saving was switched off that leaves it out")
        return "none"
    first = claims.fibre_at(*_points(seed, 1)[0])
    if first.saturated and "hermite-matrix" in savings:
        return Unchecked("the Hermite matrix where solutions at which an inequality's polynomial is zero are left out")
    norms, functions = _values(claims, seed, savings)
    multiplicities = {name: _multiplicities(values, len(components)) for name, values in functions.items()}
    of_norm = _multiplicities(norms, len(components))
    for n in auxiliary:
        text = components[n].polynomial.text(claims.result.slice.axis_names)[:60]
        if of_norm[n]:
            raise Violation(f"component {n} is said to be auxiliary, but det H vanishes or has poles on it: {text}")
        if not any(m[n] > 0 or (m[n] and name == _HERMITE) for name, m in multiplicities.items()):
            raise Violation(f"component {n} is said to be auxiliary, but is no factor of "
                            f"{' or '.join(_SAVINGS[name] for name in savings)}: {text}")  # fmt: skip
    for name, values in functions.items():
        if len({_rest(at, multiplicities[name]) for at in values}) > 1:
            saving = next((kept for kept, what in _SAVINGS.items() if what == name), "sign-curve")
            raise Violation(f"the plan says that {saving!r} was kept, but a factor of {name} is not stored")
    return f"{len(auxiliary)} components; {POINTS} points of {BITS} bits, seed {seed}"


def _points(seed: str, number: int) -> list[tuple[Fraction, Fraction]]:
    """Random points; the first ones are the same for any number."""
    source = random.Random(f"auxiliary {seed}")

    def coordinate() -> Fraction:
        return Fraction(source.getrandbits(BITS) - 2 ** (BITS - 1))

    return [(coordinate(), coordinate()) for _ in range(number)]


def _values(claims: Claims, seed: str, savings: Sequence[str]) -> tuple[list[Values], dict[str, list[Values]]]:
    """At each point the norm of det H, and the functions that the savings leave out."""
    norms: list[Values] = []
    functions: dict[str, list[Values]] = {}
    for x, y in _points(seed, POINTS):
        fibre = claims.fibre_at(x, y)
        if not norms:
            monomials = standard_monomials(claims.model, claims.parameters_at(x, y))
        at = tuple(int(c.polynomial(x, y)) for c in claims.result.components)
        norm, found = (
            to_fraction(fibre.norm()),
            {n: to_fraction(v) for n, v in _functions(savings, fibre, monomials).items()},
        )
        if 0 in at or 0 in (norm, *found.values()):
            raise Violation(f"a function that defines curves vanishes at the random point {x}, {y}")
        norms.append((norm, at))
        for name, value in found.items():
            functions.setdefault(name, []).append((value, at))
    return norms, functions


def _functions(savings: Sequence[str], fibre: Fibre, monomials: Sequence[Monomial]) -> dict[str, fmpq]:
    """The values of the functions whose factors the savings leave out."""
    found = {}
    if "sign-curve" in savings and fibre.point.has_index:
        for order in range(1, len(fibre.point.jacobian)):
            found["the norm of H11" if order == 1 else f"the norm of the leading minor of order {order}"] = (
                fibre.minor_norm(order)
            )
    if "hermite-matrix" in savings:
        found[_HERMITE] = fibre.determinant_of_traces(monomials)
    return found


def _multiplicities(values: Sequence[Values], number: int) -> list[int]:
    """How often each component divides a function, negative for poles: what most points tell."""
    votes = [
        Counter(e for value, at in values if (e := _multiplicity(value, at, k)) is not None) for k in range(number)
    ]
    return [counter.most_common(1)[0][0] if counter else 0 for counter in votes]


def _multiplicity(value: Fraction, at: Sequence[int], k: int) -> int | None:
    """What one point shows of it: how often the primes of the component's value alone divide the function's.

    Small primes are left out: they may divide the constant, by which the function differs from a product of components.
    """
    own = abs(at[k])
    for other in (_SMALL_PRIMES, *at[:k], *at[k + 1 :]):
        while (common := gcd(own, other)) > 1:
            own //= common
    if own < MIN_CERTAIN_PART:
        return None
    numerator, denominator, found = value.numerator, value.denominator, 0
    while numerator % own == 0:
        numerator, found = numerator // own, found + 1
    while denominator % own == 0:
        denominator, found = denominator // own, found - 1
    return found


_SMALL_PRIMES = prod(p for p in range(2, 2000) if all(p % q for q in range(2, isqrt(p) + 1)))


def _rest(values: Values, multiplicities: Sequence[int]) -> Fraction:
    value, at = values
    for v, e in zip(at, multiplicities, strict=True):
        value /= Fraction(v) ** e
    return value
