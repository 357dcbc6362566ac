"""The equations of equilibrium with free lengths in complex balls, for either sign of each 1/l_i.

Guarantee: a value that does not contain zero is not zero; a pair of signs is returned only where every other one is
excluded. All in the precision of FLINT's context.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from flint import acb, acb_poly, arb, fmpz_poly


def complex_roots(p: fmpz_poly) -> list[acb]:
    """Disjoint balls around the roots, without multiplicities; the imaginary part of a real one is exactly 0."""
    pairs: Any = p.complex_roots()  # pairs; FLINT's stub says otherwise
    return [root for root, _ in pairs]


def value_at(p: fmpz_poly, at: acb) -> acb:
    return acb_poly(p)(at)


def vanishes(p: Sequence[acb], at: acb) -> bool:
    """Whether a polynomial may vanish in a ball; False is a proof that it does not."""
    value: acb = acb_poly(p)(at)
    return bool(value.contains(0))


def directions(*tangents: acb) -> tuple[tuple[acb, acb], ...]:
    """Cosines and sines from the tangents of half angles."""
    return tuple(((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)) for t in tangents)


@dataclass(frozen=True, slots=True)
class SignedEquations:
    """E1 and E2 in balls."""

    base: arb
    length1: arb
    length2: arb
    free: arb
    f3: arb
    f4: arb

    def squares(self, t1: acb, t2: acb) -> tuple[acb, acb, acb]:
        """l1^2, l2^2 and l3^2."""
        base, p, q = self.base, self.length1, self.length2
        (c1, s1), (c2, s2) = directions(t1, t2)
        return (
            base**2 + q**2 - 2 * base * q * c2,
            base**2 + p**2 - 2 * base * p * c1,
            base**2 + p**2 + q**2 + 2 * p * q * (c1 * c2 - s1 * s2) - 2 * base * p * c1 - 2 * base * q * c2,
        )

    def signs(self, t1: acb, t2: acb) -> tuple[tuple[int, int], tuple[int, int]] | None:
        """The only signs of (v2, v3) at which E1 can vanish, and of (v1, v3) for E2; None when it is not clear."""
        base, p, q = self.base, self.length1, self.length2
        (c1, s1), (c2, s2) = directions(t1, t2)
        s12 = s1 * c2 + c1 * s2
        squares = self.squares(t1, t2)
        if any(not s.is_finite() or s.contains(0) for s in squares):
            return None
        # any continuous choice of the root serves: both signs are tried
        v1, v2, v3 = (1 / s.sqrt() for s in squares)
        chosen = []
        for own, b, c, load in ((v2, base * s1, base * s1 - q * s12, self.f3 * c1),
                                (v1, base * s2, base * s2 - p * s12, self.f4 * c2)):  # fmt: skip
            zero = [
                (i, j)
                for i, j in product((1, -1), repeat=2)
                if ((1 - i * self.free * own) * b + (1 - j * self.free * v3) * c - load).contains(0)
            ]
            if len(zero) != 1:
                return None
            chosen.append(zero[0])
        return chosen[0], chosen[1]
