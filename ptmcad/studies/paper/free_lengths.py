"""Equilibria with springs of a free length, proved to exist one by one by Krawczyk's test in ball arithmetic.

Guarantee: each `ProvedEquilibrium` is a box of angles with exactly one zero of the gradient, at which the Hessian is
nonsingular, and the boxes are disjoint on the torus; so their number is a lower bound of the number of equilibria.

Not guaranteed: that none is missed. The boxes start from floating-point guesses, which prove nothing.

Reference: Krawczyk, Computing 4 (1969); Neumaier, Interval Methods for Systems of Equations (1990), theorem 5.1.8.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from flint import arb, ctx, fmpq

from ptmcad.mechanism import ptm
from ptmcad.studies.equilibria import balls, guesses, proved
from ptmcad.text.balls import ball_of
from ptmcad.text.flint_numbers import to_fraction

STARTS = 48
"""Starts of Newton's method along each angle."""
RADIUS = fmpq(1, 10**9)
BITS = 200


class FreeLengthDesign(NamedTuple):
    """rho, L1, L2 and the springs' common free length l0, in one unit; f3 = F3/k and f4 = F4/k, lengths too."""

    rho: Fraction
    length1: Fraction
    length2: Fraction
    free: Fraction
    f3: Fraction
    f4: Fraction

    @property
    def parameters(self) -> dict[str, Fraction]:
        """Those of the mechanism with forces and energy divided by k."""
        given = zip(("rho", "L1", "L2", "F3", "F4"), (*self[:3], *self[4:]), strict=True)
        springs = dict.fromkeys(ptm().stiffnesses, Fraction(1)) | dict.fromkeys(ptm().free_lengths, self.free)
        return dict(given) | springs


@dataclass(frozen=True, slots=True)
class ProvedEquilibrium:
    """A zero of the gradient within 10^-9 of ``angles``.

    Attributes
    ----------
    negative : number of the Hessian's negative eigenvalues.
    tense : whether every spring is longer than its free length; None when the box does not show it.
    """

    angles: tuple[Fraction, Fraction]
    negative: int
    tense: bool | None

    @property
    def stable(self) -> bool:
        return self.negative == 0


def proved_equilibrium(design: FreeLengthDesign, angles: tuple[float, float]) -> ProvedEquilibrium | None:
    """The equilibrium near two angles, proved; None when the test does not prove one."""
    with ctx.workprec(BITS):
        middle = [fmpq(*x.as_integer_ratio()) for x in angles]
        found = proved(balls(design.parameters), [arb(m) for m in middle], arb(RADIUS))
        if found is None:
            return None
        rest = ball_of(design.free) ** 2
        tense = None
        if any(square < rest for square in found.squares):
            tense = False
        elif all(square > rest for square in found.squares):
            tense = True
    first, second = (to_fraction(m) for m in middle)
    return ProvedEquilibrium((first, second), found.negative, tense)


def _distinct(a: ProvedEquilibrium, b: ProvedEquilibrium) -> bool:
    """Whether the two boxes are disjoint on the torus, proved: chords of the angles' differences exceed the boxes."""
    with ctx.workprec(BITS):
        for x, y in zip(a.angles, b.angles, strict=True):
            difference = x - y
            half = ball_of(difference) / 2
            if abs(half.sin()) > arb(2 * RADIUS):
                return True
    return False


def proved_equilibria(design: FreeLengthDesign) -> tuple[ProvedEquilibrium, ...]:
    """Different equilibria, each proved, in the order of their angles; a lower bound of what there is."""
    found: list[ProvedEquilibrium] = []
    for guess in guesses({name: float(value) for name, value in design.parameters.items()}, STARTS):
        equilibrium = proved_equilibrium(design, guess)
        if equilibrium is not None and all(_distinct(equilibrium, other) for other in found):
            found.append(equilibrium)
    return tuple(sorted(found, key=lambda e: e.angles))
