"""The curves of a slice at which counts change, as systems whose solutions project to them.

Guarantee: each point of the window at which the chosen count changes lies on the projection of one of the curves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ptmcad.interval.formula import Formula, Graph
from ptmcad.interval.parameters import parameter_formulas, slice_mechanism
from ptmcad.interval.search import Boxes
from ptmcad.interval.system import System, system
from ptmcad.slice import Count, Slice

TORUS = (-3.0, -3.0 + 6.2832)
"""A little more than a full turn, cut where no symmetric solution lies."""


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """One curve: its name, why counts change there, and the system that defines it.

    The variables of its boxes are x, y and those that ``ranges`` gives.
    """

    name: str
    reason: str
    system: System
    ranges: tuple[tuple[float, float], ...]

    def start(self, window: Boxes) -> Boxes:
        """Boxes over rectangles (low x, low y, high x, high y) of the window that hold the whole curve over them."""
        count = len(window)
        low = np.tile(np.array([r[0] for r in self.ranges]), (count, 1))
        high = np.tile(np.array([r[1] for r in self.ranges]), (count, 1))
        return np.concatenate([window[:, :2], low, window[:, 2:], high], axis=1)


def curves(slice: Slice, count: Count) -> tuple[Curve, ...]:
    """The curves at which ``count`` may change; docs/free-lengths-curves.md proves that no other is needed."""
    return tuple(_CURVES[count](slice))


def _stable(slice: Slice) -> Iterator[Curve]:
    m = slice_mechanism(Graph(), slice)
    there = m.at_equilibrium
    yield Curve(
        "fold of a stable equilibrium",
        "a minimum meets a saddle: det H = 0 with nonnegative diagonal entries",
        system(
            [*m.equilibrium, m.hessian.determinant],
            (0, 1, 2, 3),
            (m.dependent, [there.determinant, m.turned]),
            [there.p11, there.p22, m.turn],
        ),
        (TORUS, TORUS),
    )


def _all(slice: Slice) -> Iterator[Curve]:
    yield from _folds(slice)
    yield from _cone(slice)
    yield from _creases(slice)


def _folds(slice: Slice) -> Iterator[Curve]:
    reason = "two equilibria meet: det H = 0"
    m = slice_mechanism(Graph(), slice)
    there = m.at_equilibrium
    cheap, costly = [*m.dependent, *_present(m.unit)], [there.determinant, m.turned, there.levelled]
    equations = [*m.equilibrium, m.hessian.determinant]
    if m.unit is None:
        yield Curve("fold", reason, system(equations, (0, 1, 2, 3), (cheap, costly)), (TORUS, TORUS))
        return
    yield Curve(
        "fold",
        reason,
        system(equations, (0, 1, 2, 3), (cheap, costly), [m.lengths[2] - SHORT]),
        (TORUS, TORUS),
    )
    m = slice_mechanism(Graph(), slice, phi=True)
    there = m.at_equilibrium
    yield Curve(
        "fold near the cone",
        f"{reason}, where spring 3 is shorter than {SHORT}",
        system(
            [*_present(m.aligned), *m.equilibrium, m.hessian.blown_up],
            (0, 1, 2, 3, 4),
            ([*m.dependent, *_present(m.unit)], [there.blown_up, there.levelled]),
            [m.lengths[2], SHORT - m.lengths[2]],
        ),
        (TORUS, TORUS, TORUS),
    )


def _cone(slice: Slice) -> Iterator[Curve]:
    m = slice_mechanism(Graph(), slice, phi=True)
    if m.unit is not None:
        yield Curve(
            "cone",
            "an equilibrium is swallowed by the cone l3 = 0",
            system([*m.vectors[2], *m.equilibrium], (0, 1, 2, 3, 4), ([*m.dependent, m.unit], [])),
            (TORUS, TORUS, TORUS),
        )


def _creases(slice: Slice) -> Iterator[Curve]:
    graph = Graph()
    values = parameter_formulas(graph, slice)
    for spring, bar in ((1, "L2"), (2, "L1")):
        if values[f"l0_{spring}"].value != 0 and values[f"k{spring}"].value != 0:
            line = values["rho"].squared() - values[bar].squared()
            yield Curve(
                f"crease l{spring} = 0", f"spring {spring} has no length on a circle", system([line], (0, 1)), ()
            )


def _admissible(slice: Slice) -> Iterator[Curve]:
    yield from _stable(slice)
    m = slice_mechanism(Graph(), slice)
    there = m.at_equilibrium
    for spring, (length, free, vector) in enumerate(zip(m.lengths, m.free, m.vectors, strict=True), start=1):
        third, dependent = (vector[0], [vector[1]]) if free.value == 0 else (length - free, [])
        yield Curve(
            f"l{spring} = l0_{spring}",
            f"spring {spring} of a stable equilibrium has its free length",
            system(
                [*m.equilibrium, third],
                (0, 1, 2, 3),
                ([*m.dependent, *dependent], []),
                [there.p11, there.p22, m.turn, there.determinant, m.turned],
            ),
            (TORUS, TORUS),
        )


def _present(formula: Formula | None) -> list[Formula]:
    return [] if formula is None else [formula]


SHORT = Fraction(1, 10)
"""Below this length of spring 3, in units of length, its direction is a variable of its own."""
_CURVES: dict[Count, Callable[[Slice], Iterator[Curve]]] = {
    Count.STABLE: _stable,
    Count.TOTAL: _all,
    Count.INDEX: _all,
    Count.ADMISSIBLE: _admissible,
}
