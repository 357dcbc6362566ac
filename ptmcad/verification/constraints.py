"""What equilibria of a mechanism with closed loops or X-joints satisfy, as polynomials in the coordinates.

Guarantee: nothing is taken from `ptmcad.model`, which has the same as formulas of one graph.

Closed loops: with g the squared distances that closing bars keep, less the squares of these, and U
the energy, an equilibrium is a zero of g and of E, the determinant of the gradients of g and U; it
is stable where the determinant of the gradients of g and E is positive. Where several degrees of
freedom are left, each bar's tension is one more unknown.

X-joints: the crossed branch is w (L - b z) = L z - b with the units z = exp(i th) and
w = exp(i psi) of the two bars. So w is e/D with e = (L z - b)(L - b/z) and D = (L - b z)(L - b/z),
and cos psi and sin psi are real and imaginary part of that. The energy is a polynomial in them, of
some degree p for each joint: times D^p it is one in the first bars' coordinates alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import prod
from typing import NamedTuple

from flint import fmpq, fmpq_mpoly

from ptmcad.verification.coordinates import CoordinateRing, circle_names
from ptmcad.verification.principalminors import determinant, total

Polynomials = tuple[fmpq_mpoly, ...]


def leave_one_way(unknowns: Sequence[str], kept: Polynomials) -> bool:
    """Whether closed loops leave one degree of freedom."""
    return 0 < len(kept) == len(unknowns) - 1


def along_loops(
    ring: CoordinateRing, unknowns: Sequence[str], kept: Polynomials, slopes: Polynomials
) -> fmpq_mpoly:
    """The derivative along loops with one degree of freedom of a function with these slopes."""
    found: fmpq_mpoly = determinant([*(ring.gradient(g, unknowns) for g in kept), slopes])
    return found


def loop_conditions(
    ring: CoordinateRing, unknowns: Sequence[str], kept: Polynomials, slopes: Polynomials
) -> tuple[Polynomials, Polynomials]:
    """Equations, each zero at an equilibrium with closed loops, and what is positive at a stable one.

    Parameters
    ----------
    kept : what the closing bars keep zero.
    slopes : of the energy, less the moments.
    """
    if not leave_one_way(unknowns, kept):
        return _with_tensions(ring, unknowns, kept, slopes)
    force = along_loops(ring, unknowns, kept, slopes)
    turn = along_loops(ring, unknowns, kept, ring.gradient(force, unknowns))
    return (*kept, force), (turn,)


def _with_tensions(
    ring: CoordinateRing, unknowns: Sequence[str], kept: Polynomials, slopes: Polynomials
) -> tuple[Polynomials, Polynomials]:
    """Where several degrees of freedom are left: the last unknowns are the bars' tensions.

    The equations are the derivatives of the energy plus half of each tension times what its bar
    keeps. With s added to the unknowns' own second derivatives the determinant of the bordered
    matrix is a polynomial in s; its coefficients, with one sign, are all positive at a minimum.
    """
    count, bars = len(unknowns), len(kept)
    tensions = (ring.elements[name] * fmpq(1, 2) for name in unknowns[-bars:])
    work = total(tension * g for tension, g in zip(tensions, kept, strict=True))
    equations = tuple(map(fmpq_mpoly.__add__, slopes, ring.gradient(work, unknowns)))
    rows = [ring.gradient(equation, unknowns) for equation in equations]
    sign = -1 if bars % 2 else 1

    def minors(size: int) -> fmpq_mpoly:
        """The sum of the principal minors without so many of the unknowns that are no tensions."""
        chosen = (
            [k for k in range(count) if k not in out]
            for out in combinations(range(count - bars), size)
        )
        found: fmpq_mpoly = total(
            determinant([[rows[i][j] for j in of] for i in of]) for of in chosen
        )
        return found * sign

    return equations, tuple(minors(size) for size in reversed(range(count - 2 * bars)))


class CrossedBars(NamedTuple):
    """An X-joint: the angles of its bars against its base, and the lengths of its base and its bars."""

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

    def powers(self, wide: CoordinateRing, p: fmpq_mpoly) -> list[tuple[int, int]]:
        """Of the second bar's cosine and sine in the terms of a polynomial."""
        i, j = (wide.names.index(name) for name in circle_names(self.second))
        return [(int(powers[i]), int(powers[j])) for powers in p.monoms()]


def crossed_conditions(
    ring: CoordinateRing,
    unknowns: Sequence[str],
    joints: Sequence[CrossedBars],
    degrees: Sequence[int],
    energy: tuple[fmpq_mpoly, CoordinateRing],
    moments: Sequence[fmpq_mpoly],
) -> tuple[Polynomials, Polynomials, Polynomials]:
    """Equations of a mechanism with X-joints, the distances D, and what is positive where it is stable.

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
    normal = wide.normal(p)
    parts: dict[tuple[tuple[int, int], ...], dict[tuple[int, ...], fmpq]] = {}
    keys = zip(*(joint.powers(wide, normal) for joint in joints), strict=True)
    for key, (powers, c) in zip(keys, normal.terms(), strict=True):
        parts.setdefault(key, {})[powers[: len(ring.names)]] = c
    whole = ring.context.constant(0)
    for key, terms in parts.items():
        part = ring.context.from_dict(terms)
        for joint, (i, j), degree in zip(joints, key, degrees, strict=True):
            real, imaginary, far = joint.second_bar(ring)
            part = part * real**i * imaginary**j * far ** (degree - i - j)
        whole += part
    return whole
