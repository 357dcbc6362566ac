"""The check of a family's surfaces: cut at a random value they are the critical curves of the
member there.

Guarantee: where the stored polynomials, at that value of the free parameter, have other irreducible
factors than the member's curves on which solutions meet, they are not those of the family, but for
finitely many values, of which a random one is none by accident. The member is classified alone,
without what the members have in common.
"""

from __future__ import annotations

import random
from collections import defaultdict
from collections.abc import Callable
from fractions import Fraction
from hashlib import sha256

from ptmcad.answer.family import FamilyMap, SpaceTerms
from ptmcad.answer.regionmap import Kind, RegionMap
from ptmcad.errors import HypothesisError, shown
from ptmcad.text.numerals import text_of
from ptmcad.text.plane import PlanePolynomial
from ptmcad.verification.plane import factors, polynomial
from ptmcad.verification.report import Check

_DRAWN = 10
"""Values that are tried, where members have no map."""
_SHARES = 1009
"""A prime: random values are such shares of the range."""


def verify_surfaces(
    found: FamilyMap, map_at: Callable[[Fraction], RegionMap], seed: int | None = None
) -> Check:
    """Check the polynomials of the surfaces on which solutions meet.

    Parameters
    ----------
    map_at : classifies a member, without what the members have in common; raises `HypothesisError`
        where it has no map.
    seed : of the random value; drawn from a hash of the claims when None.
    """
    if not found.surfaces:
        return Check("surfaces", "", None, "none are stored: those of the family are not said")
    name, method = "surfaces", "a member alone, factored"
    source = random.Random(_fingerprint(found) if seed is None else str(seed))
    for _ in range(_DRAWN):
        value = found.free.low + (found.free.high - found.free.low) * Fraction(
            source.randrange(1, _SHARES), _SHARES
        )
        try:
            alone = map_at(value)
        except HypothesisError:  # a value at which nothing is said of the family
            continue
        where = f"the member at {found.free.name} = {text_of(value)}"
        wrong = _difference(found, alone, value)
        if wrong:
            return Check(name, method, False, shown(f"{where} {wrong}"))
        number = f"{len(found.surfaces)} polynomial{'s' * (len(found.surfaces) > 1)}"
        return Check(name, method, True, f"{number} cut to the critical curves of {where}")
    return Check(name, method, None, f"of {_DRAWN} random members none has a map")


def _difference(found: FamilyMap, alone: RegionMap, value: Fraction) -> str:
    """In what the surfaces, cut at a value, are not the member's curves there; empty when they are."""
    names = alone.slice.axis_names
    cut = {f for terms in found.surfaces for f in _cut(terms, value)}
    known = {c.polynomial for c in alone.components}
    for curve in sorted(cut - known, key=lambda p: p.terms):
        return f"has no curve {curve.text(names)[:60]} = 0, as the surfaces have"
    for c in alone.components:
        if c.kind is Kind.CRITICAL and c.polynomial not in cut:
            return (
                f"has a critical curve {c.polynomial.text(names)[:60]} = 0 that lies on no surface"
            )
    return ""


def _cut(terms: SpaceTerms, value: Fraction) -> list[PlanePolynomial]:
    """The irreducible factors of a polynomial at a value of the third variable that are not
    constant.
    """
    degree = max(powers[2] for powers, _ in terms)
    plane: dict[tuple[int, int], int] = defaultdict(int)
    for (i, j, k), c in terms:
        plane[i, j] += c * value.numerator**k * value.denominator ** (degree - k)
    cut = polynomial((*powers, c) for powers, c in plane.items())
    return [] if cut.is_constant() else factors(cut)


def _fingerprint(found: FamilyMap) -> str:
    return sha256(repr((found.free, found.surfaces)).encode()).hexdigest()
