"""The free lengths at which equilibria are degenerate, all other parameters fixed, by algebra: where folds are.

Guarantee, as far as msolve's answer is right: every real l0 != 0 at which some solution with lengths of some signs is
degenerate is enclosed, with the signs; poses with a length of zero are not among them, they are no folds.

The number of equilibria also changes where one is swallowed by the cone l3 = 0, which is no fold.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from ptmcad.algebra.critical_lengths import NAMES, critical_system
from ptmcad.enclosure import Enclosure
from ptmcad.errors import ConfigError
from ptmcad.msolve import MsolveError, real_solutions


@dataclass(frozen=True, slots=True)
class CriticalFreeLength:
    """A degenerate solution: its free length, and the signs of l1, l2 and l3; (1, 1, 1) is a pose."""

    free: Enclosure
    signs: tuple[int, int, int]

    @property
    def fold(self) -> bool:
        """Whether equilibria of the mechanism meet here: positive lengths and a positive free length."""
        return self.signs == (1, 1, 1) and self.free.low > 0


def critical_free_lengths(
    rho: Fraction,
    rods: tuple[Fraction, Fraction],
    loads: tuple[Fraction, Fraction],
    timeout: float | None = None,
) -> tuple[CriticalFreeLength, ...]:
    """All critical free lengths, ascending; lengths in one unit, loads divided by k.

    They come in pairs: l0 with signs s, and -l0 with signs -s, are one solution of the squared equations.

    Raises
    ------
    ConfigError
        When a length is not positive.
    MsolveError
        When msolve is not there, takes longer than ``timeout`` seconds, or finds infinitely many solutions, as it does
        without loads where two poses are degenerate along a whole interval.
    """
    if min(rho, *rods) <= 0:
        raise ConfigError("rho and the rods must be positive")
    found = []
    for box in real_solutions(NAMES, critical_system(rho, rods, loads), timeout):
        low, high = box[-1]
        first, second, third = (_sign(*interval) for interval in box[:3])
        _sign(low, high)  # at l0 = 0 the signs have no meaning
        found.append(CriticalFreeLength(Enclosure(low, high), (first, second, third)))
    return tuple(sorted(found, key=lambda c: c.free.center))


def _sign(low: Fraction, high: Fraction) -> int:
    if low <= 0 <= high:
        raise MsolveError("msolve's boxes do not settle a sign")
    return 1 if low > 0 else -1
