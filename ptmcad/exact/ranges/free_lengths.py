"""The free lengths at which equilibria are degenerate, all other parameters fixed, by algebra: where folds are.

Guarantee, as far as msolve's answer is right: every real l0 != 0 at which some solution with lengths of some signs is
degenerate is enclosed, with the signs; poses with a length of zero are not among them, they are no folds.

The number of equilibria also changes where one is swallowed by the cone l3 = 0, which is no fold.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from ptmcad.algebra.msolve import MsolveError, real_solutions
from ptmcad.answer.intervals import CriticalFreeLength
from ptmcad.errors import ConfigError
from ptmcad.exact.ranges.critical_lengths import NAMES, critical_system
from ptmcad.mechanism import Kind, ptm
from ptmcad.question.line import restricted, varying_axis
from ptmcad.question.slice import Slice
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.expressions import axis

_MECHANISM = ptm()
_BASE = _MECHANISM.first(Kind.BASE)
_RODS = tuple(name for name in _MECHANISM.variables if _MECHANISM.kind(name) is Kind.LENGTH)
_ACROSS, _UP = zip(*(load.names for load in _MECHANISM.loads), strict=True)


def critical_free_lengths(
    base: Fraction,
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
    if min(base, *rods) <= 0:
        raise ConfigError(f"{_BASE} and the rods must be positive")
    design = {_BASE: base, **dict(zip(_RODS + _UP, rods + loads, strict=True)), **dict.fromkeys(_ACROSS, Fraction(0))}
    found = []
    for box in real_solutions(NAMES, critical_system(design), timeout):
        low, high = box[-1]
        first, second, third = (_sign(*interval) for interval in box[:3])
        _sign(low, high)  # at l0 = 0 the signs have no meaning
        found.append(CriticalFreeLength(Enclosure(low, high), (first, second, third)))
    return tuple(sorted(found, key=lambda c: c.free.center))


def critical_on_line(
    slice: Slice, along: str, at: Mapping[str, Any], timeout: float | None = None
) -> tuple[CriticalFreeLength, ...]:
    """The critical free lengths in the window of a line along the common free length of all springs, ascending.

    Raises
    ------
    ConfigError
        When the line is of another kind: the springs need one stiffness, ``along`` has to be the free length of each
        of them, and all else has to be constant, without horizontal loads.
    MsolveError
        See `critical_free_lengths`.
    """
    varying, _, value = varying_axis(slice, along, at)
    on_line = {name: restricted(e, varying, value) for name, e in slice.parameters.items()}
    free_lengths = slice.model.free_lengths
    if any(on_line.get(name) != axis(0) for name in free_lengths):
        raise ConfigError(f"elimination needs {along} to be the free length of all three springs", key="along")
    constants = {name: e.constant() for name, e in on_line.items() if e.is_constant}
    missing = [name for name in on_line if name not in constants and name not in free_lengths]
    if missing:
        raise ConfigError(f"elimination needs {', '.join(missing)} to be constant along {along}", key="along")
    k, *others = (constants[name] for name in _MECHANISM.stiffnesses)
    if any(other != k for other in others) or k == 0:
        shorthand = next(name for name, of in _MECHANISM.shorthands.items() if of == _MECHANISM.stiffnesses)
        raise ConfigError("elimination needs three springs of one stiffness", key=shorthand)
    if any(constants.get(name, 0) != 0 for name in _ACROSS):
        raise ConfigError("elimination needs loads without horizontal parts", key=_ACROSS[0])
    (rod1, rod2), (load1, load2) = ([constants[name] for name in names] for names in (_RODS, _UP))
    found = critical_free_lengths(constants[_BASE], (rod1, rod2), (load1 / k, load2 / k), timeout)
    window = slice.axes[varying]
    return tuple(c for c in found if c.free.high > window.low and c.free.low < window.high)


def _sign(low: Fraction, high: Fraction) -> int:
    if low <= 0 <= high:
        raise MsolveError("msolve's boxes do not settle a sign")
    return 1 if low > 0 else -1
