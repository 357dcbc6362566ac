"""The equilibria at a cell's sample point, from the boxes that the result stores around them.

Guarantee: every text is within one unit of its last digit of the number it stands for, if the box holds the
equilibrium, as `ptmcad.verify` checks. Numbers that are not texts are for drawing only.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeVar

from ptmcad.answer.regionmap import Cell, RegionMap, Solution
from ptmcad.errors import ConfigError, PoleError
from ptmcad.mechanism import Kind, ptm
from ptmcad.mechanism.evaluate import evaluate, value_at
from ptmcad.question.slice import merged
from ptmcad.show.report.bounds import (
    Bounds,
    decimal_text,
    degrees,
    exactly,
    last_place,
    plus,
    power,
    square_root,
    times,
)
from ptmcad.show.report.potential import Potential, energy, potential_at
from ptmcad.text.numerals import shortest_text, text_of

KINDS = {"++": "stable", "+-": "saddle", "--": "maximum"}
"""What the signs of the Hessian's eigenvalues say."""

MECHANISM = ptm()
UNKNOWNS = tuple(f"{function}_{angle}" for angle in MECHANISM.angles for function in ("cos", "sin"))
NEEDED = MECHANISM.without_free_lengths
"""Unknowns and parameters of the paper's mechanism, without which there is no drawing of it."""

MAX_DRAWN = 10**100
"""Of parameters and coefficients that can be drawn: their products stay far within the range of floating point."""

_DIGITS = 7

Point = tuple[Bounds, Bounds]
Value = TypeVar("Value")


def at_sample(result: RegionMap, cell: Cell) -> dict[str, Any]:
    """All that the page shows and draws for a cell's sample: parameters, loads, potential and equilibria, as JSON data.

    In a certified map, whose unknowns are angles, poses and potential are left out.

    Raises
    ------
    ConfigError
        When a parameter has no value there, or the stored potential or a box is none.
    """
    try:
        values = {n: e.evaluate(cell.sample[0], cell.sample[1]) for n, e in result.slice.parameters.items()}
    except PoleError as error:
        raise ConfigError(f"a parameter has no value at a sample: {error}") from error
    polynomial = result.system.unknowns == UNKNOWNS  # springs with free lengths have square roots in their potential
    potential = potential_at(result.system, values) if polynomial else {}
    drawn = (
        polynomial
        and all(name in values for name in NEEDED)
        and all(abs(v) < MAX_DRAWN for v in (*values.values(), *potential.values()))
    )
    return {
        "parameters": [[n, both(v)] for n, v in distinct_parameters(values).items()],
        "loads": [[float(value_at(load.x, values)), float(value_at(load.y, values))] for load in MECHANISM.loads]
        if drawn
        else [],
        "base": float(values[MECHANISM.first(Kind.BASE)]) if drawn else 0.0,
        "potential": [[*exponents, float(c)] for exponents, c in potential.items()] if drawn else [],
        "equilibria": _equilibria(cell, values, potential) if drawn else [],
    }


def distinct_parameters(values: Mapping[str, Value]) -> dict[str, Value]:
    """The parameters worth telling: one k when all springs have it."""
    return merged({name: value for name, value in values.items() if name not in MECHANISM.shorthands}, MECHANISM)


def _plain(value: Fraction) -> str:
    """A decimal beside a fraction; empty for an integer."""
    if value.denominator == 1:
        return ""
    text = shortest_text(value)
    if "/" not in text:
        return f"= {text}"
    rounded = decimal_text(exactly(value), last_place([exactly(value)], _DIGITS))
    return f"≈ {rounded.replace('−', '-')}"


def both(value: Fraction) -> str:
    """A number exactly, and as a decimal when it is not one: ``7/10 = 0.7``, ``1/3 ≈ 0.3333333``."""
    return f"{text_of(value)} {_plain(value)}".rstrip()


def _equilibria(cell: Cell, values: Mapping[str, Fraction], potential: Potential) -> list[dict[str, Any]]:
    boxes = [_box(s) for s in cell.solutions]
    energies = [energy(potential, box) for box in boxes]
    nodes = [_nodes(box, values) for box in boxes]
    springs = MECHANISM.springs
    lengths = [[square_root(_squared_distance(where[s.start], where[s.end])) for s in springs] for where in nodes]
    stiffnesses = [exactly(value_at(spring.stiffness, values)) for spring in springs]
    forces = [[times(k, length) for k, length in zip(stiffnesses, row, strict=True)] for row in lengths]
    energy_place = last_place(energies, _DIGITS)
    coordinates = [x for where in nodes for place in where.values() for x in place]
    length_place = last_place([length for row in lengths for length in row] + coordinates, _DIGITS)
    force_place = last_place([f for row in forces for f in row], _DIGITS)
    order = {"++": 0, "+-": 1, "--": 2}
    found = []
    for k in sorted(range(len(boxes)), key=lambda k: (order.get(cell.solutions[k].signs, 3), sum(energies[k]))):
        solution, box = cell.solutions[k], boxes[k]
        angles = [degrees(box[0], box[1]), degrees(box[2], box[3])]
        found.append(
            {
                "kind": KINDS.get(solution.signs, "degenerate"),
                "angles": ["not determined" if a is None else _angle_text(a) for a in angles],
                "at": [float(sum(c) / 2) for c in box],
                "energy": decimal_text(energies[k], energy_place),
                "level": float(sum(energies[k]) / 2),
                "nodes": [[float(sum(x) / 2) for x in where] for where in nodes[k].values()],
                "places": [
                    f"({decimal_text(nodes[k][n][0], length_place)}, {decimal_text(nodes[k][n][1], length_place)})"
                    for n in MECHANISM.moving
                ],
                "lengths": [decimal_text(length, length_place) for length in lengths[k]],
                "forces": [decimal_text(force, force_place) for force in forces[k]],
            }
        )
    return found


def _angle_text(angle: Bounds) -> str:
    text = decimal_text(angle, -4)
    return f"{text.lstrip('−') if text in ('−180.0000', '−0.0000') else text}°"


def _box(solution: Solution) -> tuple[Bounds, ...]:
    if len(solution.center) != len(UNKNOWNS) or not 0 <= solution.radius < 1 or max(map(abs, solution.center)) > 2:
        raise ConfigError("a stored equilibrium is no box around cosines and sines; check it with ptmcad verify")
    return tuple((c - solution.radius, c + solution.radius) for c in solution.center)


def _nodes(box: tuple[Bounds, ...], values: Mapping[str, Fraction]) -> dict[str, Point]:
    """Bounds of the coordinates of all points."""
    within = _InBounds(box, values)
    return {name: (evaluate(x, within).bounds, evaluate(y, within).bounds) for name, (x, y) in MECHANISM.points.items()}


@dataclass(frozen=True, slots=True)
class _Bounded:
    """Bounds as an element of a ring."""

    bounds: Bounds

    def __add__(self, other: _Bounded) -> _Bounded:
        return _Bounded(plus(self.bounds, other.bounds))

    def __sub__(self, other: _Bounded) -> _Bounded:
        return _Bounded(plus(self.bounds, times(exactly(-1), other.bounds)))

    def __mul__(self, other: _Bounded) -> _Bounded:
        return _Bounded(times(self.bounds, other.bounds))


class _InBounds:
    """Values within bounds, at a box of cosines and sines."""

    def __init__(self, box: tuple[Bounds, ...], values: Mapping[str, Fraction]):
        self.box, self.values = box, values

    def constant(self, value: Fraction) -> _Bounded:
        return _Bounded(exactly(value))

    def parameter(self, name: str) -> _Bounded:
        return _Bounded(exactly(self.values[name]))

    def cos(self, angle: str) -> _Bounded:
        return _Bounded(self.box[2 * MECHANISM.angles.index(angle)])

    def sin(self, angle: str) -> _Bounded:
        return _Bounded(self.box[2 * MECHANISM.angles.index(angle) + 1])


def _squared_distance(p: Point, q: Point) -> Bounds:
    return plus(*(power(plus(a, times(b, exactly(-1))), 2) for a, b in zip(p, q, strict=True)))
