"""A model's equations as data for the page's script: one list of operations, from which the script reads all it draws.

Guarantee: the operations are those of the description, in the order in which it is evaluated, with its constants
rounded to doubles. No model is known by name, and nothing is computed here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import inf, isfinite
from typing import Any

from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.words import kind_name
from ptmcad.model import ClosedMechanism, Mechanism, Model, System
from ptmcad.model.energy import points_in, with_springs
from ptmcad.model.evaluate import evaluate
from ptmcad.model.work import split_moments
from ptmcad.question.slice import Slice, have_free_lengths
from ptmcad.text.tree import Tree

MAX_CONSTANT = 10**100
"""Of constants and coefficients: products of a few stay within the range of doubles."""
MAX_OPERATIONS = 2000
"""The script runs through them for each step of each solution."""

Operation = tuple[Any, ...]
"""``("=", number)``, ``("p", parameter)``, ``("c" | "s", angle)``, ``("u", unknown)``, ``("r", operand)`` for a square
root, or ``("+" | "-" | "*", left, right)`` by the numbers of earlier operations."""


@dataclass(frozen=True, slots=True)
class _Tape:
    """Operations, each once, as a ring whose elements are their numbers."""

    model: Model
    names: tuple[str, ...]
    numbers: dict[Operation, int] = field(default_factory=dict)

    def node(self, *operation: Any) -> _Node:
        return _Node(self, self.numbers.setdefault(operation, len(self.numbers)))

    def constant(self, value: Fraction) -> _Node:
        return self.node("=", _double(value))

    def parameter(self, name: str) -> _Node:
        if name in self.model.reals:
            return self.node("u", len(self.model.angles) + self.model.reals.index(name))
        return self.node("p", self.names.index(name)) if name in self.names else self.constant(Fraction(0))

    def cos(self, angle: str) -> _Node:
        return self.node("c", self.model.angles.index(angle))

    def sin(self, angle: str) -> _Node:
        return self.node("s", self.model.angles.index(angle))

    def of(self, trees: Sequence[Tree]) -> list[int]:
        return [evaluate(tree, self).number for tree in trees]


@dataclass(frozen=True, slots=True)
class _Node:
    """An operation's result."""

    tape: _Tape
    number: int

    def __add__(self, other: _Node) -> _Node:
        return self.tape.node("+", self.number, other.number)

    def __sub__(self, other: _Node) -> _Node:
        return self.tape.node("-", self.number, other.number)

    def __mul__(self, other: _Node) -> _Node:
        return self.tape.node("*", self.number, other.number)

    def root(self) -> _Node:
        return self.tape.node("r", self.number)


def tape(result: RegionMap) -> dict[str, Any] | None:
    """What the script needs to follow solutions over the map; None where nothing can be followed.

    That is where no cell has solutions, a parameter has no value or a number is too large for doubles; and with free
    lengths in closed loops, whose roots are in no equation of the description.
    """
    slice = result.slice
    model = slice.model
    if isinstance(model, ClosedMechanism) and slice.has_free_lengths:
        return None
    if not any(cell.solutions for cell in result.cells) or not _fits(slice):
        return None
    names = tuple(name for name in model.variables if name in slice.parameters)
    t = _Tape(model, names)
    found = _mechanism(model, t, slice) if isinstance(model, Mechanism) else _system(model, t)
    constants = [operation[1] for operation in t.numbers if operation[0] == "="]
    if len(t.numbers) > MAX_OPERATIONS or not all(map(isfinite, constants)):
        return None
    n = len(model.unknowns)
    return found | {
        "operations": [list(operation) for operation in t.numbers],
        "parameters": [
            [[[i, j, float(c)] for i, j, c in side] for side in (e.numerator, e.denominator)]
            for e in (slice.parameters[name] for name in names)
        ],
        "angles": len(model.angles),
        "unknowns": n,
        "window": [[float(axis.low), float(axis.high)] for axis in slice.axes],
        "kinds": ["stable", *(kind_name(k, n) for k in range(1, n + 1))],
        "stableOnly": _only_stable(result),
    }


def _double(value: Fraction) -> float:
    return float(value) if abs(value) < MAX_CONSTANT else inf


def _fits(slice: Slice) -> bool:
    coefficients = [
        c for e in slice.parameters.values() for side in (e.numerator, e.denominator) for _, _, c in side
    ]  # fmt: skip
    ends = [end for axis in slice.axes for end in (axis.low, axis.high)]
    return all(name in slice.parameters for name in slice.model.without_free_lengths) and all(
        abs(value) < MAX_CONSTANT for value in (*coefficients, *ends)
    )


def _only_stable(result: RegionMap) -> bool:
    """Whether the stable solutions alone are known, as in certified maps that count these."""
    return any(cell.total is None or len(cell.solutions) < cell.total for cell in result.cells if cell.solutions)


def _system(model: Model, t: _Tape) -> dict[str, Any]:
    assert isinstance(model, System)
    return _parts(
        energy=None if model.potential is None else evaluate(model.potential, t).number,
        equations=t.of(model.equations),
        conditions=t.of(model.inequalities),
        stability=t.of(model.stability),
    )


def _parts(**known: Any) -> dict[str, Any]:
    """Numbers of operations; what a model does not have is empty."""
    names = ("equations", "conditions", "stability", "moments", "points", "loads")
    return {"energy": None, "force": None} | {name: [] for name in names} | known


def _mechanism(model: Mechanism, t: _Tape, slice: Slice) -> dict[str, Any]:
    points = points_in(model, t)
    half, twice = t.constant(Fraction(1, 2)), t.constant(Fraction(2))
    energy = t.constant(Fraction(0))
    for spring in model.springs:
        (x0, y0), (x1, y1) = points[spring.start], points[spring.end]
        dx, dy = x1 - x0, y1 - y0
        square = dx * dx + dy * dy
        k, free = evaluate(spring.stiffness, t), evaluate(spring.free, t)
        # a root has no slope at zero, so that there is none where no free length is
        if have_free_lengths(replace(model, springs=(spring,)), slice.parameters):
            square = square - twice * free * square.root() + free * free
        energy = energy + half * k * square
    energy = with_springs(model, t, points, energy)
    unknowns = (*model.angles, *model.reals)
    return _parts(
        energy=energy.number if model.has_potential else None,
        force=energy.number,
        moments=[[unknowns.index(m.unknown), evaluate(m.value, t).number] for m in split_moments(model).steady],
        points=[[x.number, y.number] for x, y in points.values()],
        loads=[t.of((load.x, load.y)) for load in model.loads],
    )
