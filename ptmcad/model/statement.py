"""A description's potential as text, in the names of problem records.

Guarantee: it is written from the description alone, term by term.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from ptmcad.model.description import Mechanism
from ptmcad.model.elements import Load, Spring, TorsionSpring
from ptmcad.model.work import Split
from ptmcad.text.tree import Chain, Negative, Number, Step, Tree, to_text


def energy_text(mechanism: Mechanism, moments: Split) -> str:
    """The energy of springs less the work of loads and of moments; of springs with square roots."""
    stored = [
        *(_of_spring(spring, mechanism) for spring in mechanism.springs),
        *map(_of_torsion_spring, mechanism.torsion),
        *map(_factor, moments.energies),
    ]
    work = [part for load in mechanism.loads for part in _of_load(load, mechanism)]
    work += [f" - {_factor(moment.value)}*{moment.unknown}" for moment in moments.steady]
    return (" + ".join(stored) or "0") + "".join(work)


def _of_spring(spring: Spring, mechanism: Mechanism) -> str:
    (x0, y0), (x1, y1) = mechanism.points[spring.start], mechanism.points[spring.end]
    length = f"sqrt(({_difference(x1, x0)})^2 + ({_difference(y1, y0)})^2)"
    return f"1/2*{_factor(spring.stiffness)}*({length} - {_factor(spring.free)})^2"


def _of_torsion_spring(spring: TorsionSpring) -> str:
    turned = "".join(
        f" - {_number(value)}*{function}({to_text(spring.angle)})"
        for value, function in zip(spring.rest, ("cos", "sin"), strict=True)
        if value
    )
    return f"{_factor(spring.stiffness)}*(1{turned})"


def _of_load(load: Load, mechanism: Mechanism) -> Iterator[str]:
    for force, coordinate in zip((load.x, load.y), mechanism.points[load.point], strict=True):
        yield f" - {_factor(force)}*{_factor(coordinate)}"


def _number(value: Fraction) -> str:
    return to_text(Number(value)) if value.denominator == 1 and value > 0 else f"({value})"


def _difference(tree: Tree, less: Tree) -> str:
    match tree, less:
        case _, Number(value) if value == 0:
            return to_text(tree)
        case Chain(first, steps), _ if tree.is_sum:
            return to_text(Chain(first, (*steps, Step("-", less))))
    return to_text(Chain(tree, (Step("-", less),)))


def _factor(tree: Tree) -> str:
    return f"({to_text(tree)})" if isinstance(tree, Chain | Negative) else to_text(tree)
