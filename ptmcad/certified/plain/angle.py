"""Angles that are sums of whole multiples of variable ones, of quarter turns, and of such whose
half has a tangent.

Guarantee: sums and multiples are exact, so that what cancels does, and so are cosine and sine.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ptmcad.formulas.graph import Formula, Graph, direction


@dataclass(frozen=True, slots=True)
class Angle:
    """A sum.

    Attributes
    ----------
    graph : of the formulas.
    smooth : formulas of angles, with their multiples.
    quarters : the number of quarter turns.
    tangents : tan(a/2) of further angles a, with the multiples of a.
    """

    graph: Graph
    smooth: Mapping[Formula, int] = field(default_factory=dict)
    quarters: int = 0
    tangents: Mapping[Formula, int] = field(default_factory=dict)

    def __add__(self, other: Angle) -> Angle:
        return Angle(
            self.graph,
            _sum(self.smooth, other.smooth),
            self.quarters + other.quarters,
            _sum(self.tangents, other.tangents),
        )

    def __rmul__(self, multiple: int) -> Angle:
        return Angle(
            self.graph,
            {f: multiple * n for f, n in self.smooth.items()},
            multiple * self.quarters,
            {f: multiple * n for f, n in self.tangents.items()},
        )

    def cos(self) -> Formula:
        """The cosine."""
        return self._turned(0)

    def sin(self) -> Formula:
        """The sine."""
        return self._turned(-1)

    def _turned(self, quarters: int) -> Formula:
        """The cosine with quarter turns more."""
        run, rise = self._half()
        cosine, sine = (self._smooth(self.quarters + quarters + q) for q in (0, -1))
        if rise.value == 0:
            return cosine
        near, far = direction(run, rise), direction(rise, run)
        return cosine * (2 * near.squared() - 1) - sine * (2 * (near * far))

    def _smooth(self, quarters: int) -> Formula:
        """The cosine without the tangents' part, and with so many quarter turns."""
        angle = self.graph.constant(0)
        for f, n in self.smooth.items():
            angle = angle + n * f
        function, sign = ((angle.cos, 1), (angle.sin, -1), (angle.cos, -1), (angle.sin, 1))[
            quarters % 4
        ]
        if angle.value == 0:
            return self.graph.constant(sign * (1 - quarters % 2))
        return sign * function()

    def _half(self) -> tuple[Formula, Formula]:
        """Coordinates of a vector at half the tangents' angle."""
        run, rise = self.graph.constant(1), self.graph.constant(0)
        for tangent, n in self.tangents.items():
            t = tangent if n > 0 else -tangent
            for _ in range(abs(n)):
                run, rise = run - rise * t, rise + run * t
        return run, rise


def _sum(one: Mapping[Formula, int], other: Mapping[Formula, int]) -> dict[Formula, int]:
    total = {f: one.get(f, 0) + other.get(f, 0) for f in (*one, *other)}
    return {f: n for f, n in total.items() if n}


Unknown = Formula | Angle
"""What stands for an unknown in formulas."""
