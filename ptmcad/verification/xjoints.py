"""What equilibria of a mechanism with X-joints satisfy, in the coordinates of the first bars alone.

Guarantee: nothing is taken from `ptmcad.model.crossed`, which replaces cosines and sines by
quotients. The crossed branch of a joint is w (L - b z) = L z - b with the units z = exp(i th) and
w = exp(i psi) of its two bars. So w is e/D with e = (L z - b)(L - b/z) and D = (L - b z)(L - b/z),
and cos psi and sin psi are real and imaginary part of that. The energy is a polynomial in them, of
some degree p for each joint: times D^p it is one in the first bars' coordinates.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import prod
from typing import NamedTuple

from flint import fmpq, fmpq_mpoly

from ptmcad.verification.coordinates import CoordinateRing, circle_names
from ptmcad.verification.inertia import determinant


class CrossedBars(NamedTuple):
    """An X-joint: the angles of its bars against its base, and what its base and its bars are long."""

    first: str
    second: str
    base: fmpq_mpoly
    bars: fmpq_mpoly

    def second_bar(self, ring: CoordinateRing) -> tuple[fmpq_mpoly, fmpq_mpoly, fmpq_mpoly]:
        """Real and imaginary part of e, and D."""
        cosine, sine = ring.circles[self.first]
        (a, b), (c, d) = (
            (self.bars * cosine - self.base, self.bars * sine),
            (self.bars - self.base * cosine, self.base * sine),
        )
        return a * c - b * d, a * d + b * c, c * c + d * d


def places(wide: CoordinateRing, angle: str) -> list[int]:
    """Of an angle's coordinates among the variables."""
    return [wide.names.index(name) for name in circle_names(angle)]


def degree(wide: CoordinateRing, angle: str, p: fmpq_mpoly) -> int:
    """That of a polynomial in an angle's coordinates; that of its normal form is the least."""
    return max(
        (sum(powers[k] for k in places(wide, angle)) for powers in wide.normal(p).monoms()),
        default=0,
    )


Conditions = tuple[tuple[fmpq_mpoly, ...], tuple[fmpq_mpoly, ...], tuple[fmpq_mpoly, ...]]


def conditions(
    ring: CoordinateRing,
    unknowns: Sequence[str],
    joints: Sequence[CrossedBars],
    degrees: Sequence[int],
    energy: tuple[fmpq_mpoly, CoordinateRing],
    moments: Sequence[fmpq_mpoly],
) -> Conditions:
    """Equations, each zero at an equilibrium, what is not zero there, and what is positive at a
    stable one.

    Parameters
    ----------
    degrees : of the energy, for each joint, or more.
    energy : with its ring, which has the second bars' coordinates besides.
    """
    bars = [joint.second_bar(ring) for joint in joints]
    whole = _without_second_bars(ring, joints, degrees, energy)
    below = prod(
        (far**p for (_, _, far), p in zip(bars, degrees, strict=True)),
        start=ring.context.constant(1),
    )
    equations = []
    for unknown, moment in zip(unknowns, moments, strict=True):
        equation = ring.by(whole, unknown) - moment * below
        for joint, (_, _, far), p in zip(joints, bars, degrees, strict=True):
            if joint.first == unknown and p:
                equation = equation * far - whole * ring.by(far, unknown) * p
        equations.append(equation)
    rows = [ring.gradient(equation, unknowns) for equation in equations]
    minors = tuple(determinant([row[:k] for row in rows[:k]]) for k in range(1, len(rows) + 1))
    return tuple(equations), tuple(far for _, _, far in bars) if len(bars) > 1 else (), minors


def _without_second_bars(
    ring: CoordinateRing,
    joints: Sequence[CrossedBars],
    degrees: Sequence[int],
    energy: tuple[fmpq_mpoly, CoordinateRing],
) -> fmpq_mpoly:
    """The energy times the powers of the D, in the first bars' coordinates."""
    p, wide = energy
    parts: dict[tuple[tuple[int, int], ...], dict[tuple[int, ...], fmpq]] = {}
    for powers, c in wide.normal(p).terms():
        key = tuple(
            (powers[i], powers[j]) for i, j in (places(wide, joint.second) for joint in joints)
        )
        parts.setdefault(key, {})[powers[: len(ring.names)]] = c
    whole = ring.context.constant(0)
    for key, terms in parts.items():
        part = ring.context.from_dict(terms)
        for joint, (i, j), degree in zip(joints, key, degrees, strict=True):
            real, imaginary, far = joint.second_bar(ring)
            part = part * real**i * imaginary**j * far ** (degree - i - j)
        whole += part
    return whole
