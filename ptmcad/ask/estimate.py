"""How long an exact map will take, in a word, from what is known before anything is computed.

The curves are factors of a polynomial whose degree in an axis is at most about twice the number of solutions times the
sum of the equations' degrees in that axis: it is, as in a discriminant, of that degree in each equation's coefficients.
On slices of all kinds the time follows the product of these two degrees: see `SIZES`.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from math import gcd
from typing import TYPE_CHECKING

from ptmcad.text.expressions import Expression

if TYPE_CHECKING:
    from ptmcad.exact.models.system import ParametricSystem, Terms

WORDS = (
    "about a second",
    "seconds",
    "from seconds to minutes",
    "minutes to hours: try --timeout, and counts along lines by ptmcad range",
    "hours or more: ask for counts at points or along lines instead",
)
SIZES = (150, 700, 5_000)
"""Products of the degrees up to which the first words hold. Measured: 1.5 s at most up to 150, 1.3 s up to 700, and
between a second and one and a half minutes up to 5000."""
SOLUTIONS = (8, 8, 16, 20)
"""Complex solutions up to which they hold, whatever the degrees."""


def cost(solutions: int, system: ParametricSystem, parameters: Mapping[str, Expression]) -> str:
    """The time of an exact map, in a word.

    Parameters
    ----------
    solutions : the number of different complex ones.
    system : the equations.
    parameters : of these, as functions of the axes.
    """
    across, up = (2 * solutions * d for d in degrees(system, parameters))
    by_size = next((k for k, most in enumerate(SIZES) if across * up <= most), len(SIZES))
    by_solutions = next((k for k, most in enumerate(SOLUTIONS) if solutions <= most), len(SOLUTIONS))
    return WORDS[max(by_size, by_solutions)]


def degrees(system: ParametricSystem, parameters: Mapping[str, Expression]) -> tuple[int, int]:
    """The sum of the equations' degrees in each axis, without what is common to all terms of an equation.

    Where an axis occurs in powers of its cube only, say, its cube counts as the axis.
    """
    names = system.ring.parameters
    simplest = system if system.turns is None else system.turns.system
    found = []
    for axis in (0, 1):
        above = [max((int(t[axis]) for t in parameters[name].numerator), default=0) for name in names]
        below = [max((int(t[axis]) for t in parameters[name].denominator), default=0) for name in names]
        powers = (int(t[axis]) for name in names for t in parameters[name].numerator + parameters[name].denominator)
        step = reduce(gcd, powers, 0) or 1
        found.append(sum(_degree(terms, above, below) for terms in simplest.equation_terms) // step)
    return found[0], found[1]


def _degree(equation: Terms, above: list[int], below: list[int]) -> int:
    """The degree in an axis of an equation cleared of denominators, from those of its parameters'."""
    terms = [dict(powers) for _, part in equation for powers, _ in part]
    least = [min((t.get(k, 0) for t in terms), default=0) for k in range(len(above))]
    most = [max((t.get(k, 0) for t in terms), default=0) for k in range(len(above))]
    varying = [k for k in range(len(above)) if above[k] or below[k]]
    return max(
        (sum((t.get(k, 0) - least[k]) * above[k] + (most[k] - t.get(k, 0)) * below[k] for k in varying) for t in terms),
        default=0,
    )
