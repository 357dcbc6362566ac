"""How much longer the springs are than their free lengths: what admissible equilibria are told by.

Guarantee: exact. A stable equilibrium is admissible if and only if the values of all excesses are positive there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ptmcad.certified.plain.trigonometric import Harmonics, TrigonometricPolynomial
from ptmcad.model.compile import CompiledSystem, LinearSpring


@dataclass(frozen=True, slots=True)
class Excess:
    """Of a spring.

    Attributes
    ----------
    spring : its name.
    value : |d|^2 - l0^2, d being the vector between its ends: the sign of |d| - l0, as no free length is negative.
    boundary : what vanishes where that does: the value itself, or where the free length is zero all over the window,
        so that the value has no simple zeros, the coordinates of d.
    """

    spring: str
    value: TrigonometricPolynomial
    boundary: tuple[TrigonometricPolynomial, ...]

    @property
    def text(self) -> str:
        """What it is, in words."""
        return f"the length of spring {self.spring} less its free length"


def excesses(named: Iterable[tuple[str, LinearSpring]], system: CompiledSystem, ring: Harmonics) -> Iterator[Excess]:
    """One for each spring; lengths that are constant are in no description."""
    for name, spring in named:
        dx, dy, free = system.values((*spring.difference, spring.free), ring)
        value = dx * dx + dy * dy - free * free
        yield Excess(name, value, (value,) if free.terms else tuple(d for d in (dx, dy) if d.terms))
