"""The equilibria at a cell's sample point, from the boxes that the result stores around them.

Guarantee: every text is within one unit of its last digit of the number it stands for, if the box
holds the equilibrium, as `ptmcad.verify` checks. Numbers that are not texts are for drawing only.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from operator import gt
from typing import Any, NamedTuple, TypeVar

from ptmcad.answer.regionmap import Cell, RegionMap, Solution
from ptmcad.errors import ConfigError, PoleError
from ptmcad.formulas.evaluation import evaluated
from ptmcad.model import Mechanism, Model
from ptmcad.model.compile import CompiledSystem, compiled
from ptmcad.question.slice import merged
from ptmcad.show.report.bounds import (
    Bounds,
    cosine_sine,
    decimal_text,
    degrees,
    exactly,
    last_place,
    square_root,
)
from ptmcad.show.report.potential import Potential, energy, potential_at
from ptmcad.text.expressions import values_at
from ptmcad.text.numerals import shortest_text, text_of

MAX_DRAWN = 10**100
"""Of parameters and coefficients that can be drawn: their products stay far within the range of
floating point.
"""

_MAX_TURNED = 1000
"""Radians in a stored angle, which is within one turn or a few."""
_DIGITS = 7
_DRAWN_DIGITS = 9
"""Of numbers for drawing, or from which the page's script begins: a little more than are shown."""

Value = TypeVar("Value")


def at_sample(result: RegionMap, cell: Cell) -> dict[str, Any]:
    """All that the page shows and draws for a cell's sample: parameters, loads, potential and
    equilibria, as JSON data.

    Parameters are those besides the axes, which the sample has. Moments are those on the unknowns,
    angles first, whose work is not in the potential; none where all are zero.

    Where springs have free lengths, whose energy is no polynomial, the potential's terms are left
    out.

    Raises
    ------
    ConfigError
        When a parameter has no value there, or the stored potential or a box is none.
    """
    try:
        values = values_at(result.slice.parameters, *cell.sample)
    except PoleError as error:
        raise ConfigError(f"a parameter has no value at a sample: {error}") from error
    model = result.slice.model
    # a certified map knows angles by themselves, and its potential may have roots, of lengths alone
    # too
    polynomial = result.cover is None and result.system.unknowns == coordinates(model)
    potential = (
        potential_at(result.system, values) if polynomial and result.system.potential else None
    )
    drawn = (
        (polynomial or result.system.unknowns == model.sorted_unknowns)
        and all(name in values for name in model.without_free_lengths)
        and all(abs(v) < MAX_DRAWN for v in (*values.values(), *(potential or {}).values()))
    )
    system = compiled(model)
    known = dict.fromkeys(model.free_lengths, Fraction(0)) | values
    acting = (system.shown.loads, system.moments[: system.criterion.order])
    loads, moments = evaluated(acting if drawn else ((), ()), _Within(system, known))
    others = {
        n: v for n, v in distinct_parameters(values, model).items() if n not in cell.sample.names
    }
    return {
        "parameters": [[n, both(v)] for n, v in others.items()],
        "loads": [[float(component[0]) for component in force] for force in loads],
        "potential": [[*exponents, float(c)] for exponents, c in (potential or {}).items()]
        if drawn
        else [],
        "moments": [float(moment[0]) for moment in moments if any(map(any, moments))],
        "equilibria": _solutions(model, cell, known, potential, polynomial) if drawn else [],
    }


def coordinates(model: Model) -> tuple[str, ...]:
    """The unknowns of a result's equations: cosine and sine of each angle, then those on the line."""
    return (
        *(f"{function}_{angle}" for angle in model.angles for function in ("cos", "sin")),
        *model.reals,
    )


def distinct_parameters(values: Mapping[str, Value], model: Model) -> dict[str, Value]:
    """The parameters worth telling: one k when all springs have it."""
    return merged(
        {name: value for name, value in values.items() if name not in model.shorthands}, model
    )


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


def _solutions(
    model: Model,
    cell: Cell,
    values: Mapping[str, Fraction],
    potential: Potential | None,
    polynomial: bool,
) -> list[dict[str, Any]]:
    """The solutions, the stable ones first, then by energy; all numbers of a kind to the same last
    place.
    """
    system = compiled(model)
    boxes = [_box(s, model, polynomial) for s in cell.solutions]
    drawn = system.shown
    formulas = _Pose(
        None if polynomial else system.potential(), drawn.points, drawn.stretches, drawn.elastic[1]
    )
    poses: list[_Pose] = [evaluated(formulas, _Within(system, values, box)) for box in boxes]
    energies = (
        [pose.energy for pose in poses]
        if potential is None
        else [energy(potential, box) for box in boxes]
    )
    known = [bounds for bounds in energies if bounds is not None]
    energy_place = _place(known)
    turns = 2 * len(model.angles)
    reals = [box[turns:] for box in boxes]
    real_place = _place(x for row in reals for x in row)
    parts = [{} for _ in boxes] if model.drawable is None else _parts(model.drawable, poses)
    kinds = [model.criterion.kind_of_signs(solution.signs) for solution in cell.solutions]
    order = {"stable": 0, "degenerate": len(model.unknowns) + 1}

    def rank(k: int) -> tuple[int, Fraction]:
        low, high = energies[k] or (Fraction(0), Fraction(0))
        return order.get(kinds[k], cell.solutions[k].signs.count("-")), low + high

    found = []
    for k in sorted(range(len(boxes)), key=rank):
        box, at = boxes[k], energies[k]
        angles = [degrees(box[n], box[n + 1]) for n in range(0, turns, 2)]
        unknowns = [_angle_text(angle) for angle in angles]
        entry = {
            "kind": kinds[k],
            "unknowns": unknowns + [decimal_text(x, real_place) for x in reals[k]],
            "at": [_drawn(c) for c in box],
            "energy": "" if at is None else decimal_text(at, energy_place),
            "level": 0.0 if at is None or abs(at[0] + at[1]) > MAX_DRAWN**3 else _drawn(at),
        }
        found.append(entry | parts[k])
    return found


class _Pose(NamedTuple):
    """What is shown of a pose, as formulas, or as their bounds."""

    energy: Any
    points: Mapping[str, tuple[Any, Any]]
    stretches: tuple[tuple[Any, Any, Any], ...]
    turned: tuple[Any, ...]


def _parts(mechanism: Mechanism, poses: Sequence[_Pose]) -> list[dict[str, Any]]:
    """Of each equilibrium the points, and what springs of both sorts do."""
    places = [
        coordinate for pose in poses for place in pose.points.values() for coordinate in place
    ]
    length_place = _place([*places, *(length for pose in poses for length, _, _ in pose.stretches)])
    force_place = _place(force for pose in poses for _, _, force in pose.stretches)
    moment_place = _place(spring.moment for pose in poses for spring in pose.turned)
    found = []
    for pose in poses:
        shown = {
            name: f"({decimal_text(x, length_place)}, {decimal_text(y, length_place)})"
            for name, (x, y) in pose.points.items()
        }
        turned = [
            (
                _angle_text(degrees(spring.cosine, spring.sine)),
                decimal_text(spring.moment, moment_place),
            )
            for spring in pose.turned
        ]
        entry: dict[str, Any] = {
            "nodes": [[_drawn(x) for x in place] for place in pose.points.values()],
            "places": [shown[name] for name in mechanism.moving],
            "lengths": [decimal_text(length, length_place) for length, _, _ in pose.stretches],
            "forces": [decimal_text(force, force_place) for _, _, force in pose.stretches],
        }
        found.append(entry | ({"deflections": turned} if turned else {}))
    return found


def _place(values: Iterable[Bounds]) -> int:
    return last_place(list(values), _DIGITS)


def _drawn(value: Bounds) -> float:
    """The middle of bounds, in few characters."""
    middle = float(f"{float(sum(value) / 2):.{_DRAWN_DIGITS}g}")
    return int(middle) if middle.is_integer() and abs(middle) < 10**_DRAWN_DIGITS else middle


def _angle_text(angle: Bounds | None) -> str:
    if angle is None:
        return "not determined"
    text = decimal_text(angle, -4)
    return f"{text.lstrip('−') if text in ('−180.0000', '−0.0000') else text}°"


def _box(solution: Solution, model: Model, polynomial: bool) -> tuple[Bounds, ...]:
    """Cosines, sines and unknowns on the line, from a box around them, or around the angles, as
    certified maps have.
    """
    angles = len(model.angles)
    turns, kind = (
        (2 * angles, "cosines, sines and unknowns on the line")
        if polynomial
        else (angles, "the unknowns")
    )
    widest = 1 if turns or not polynomial else MAX_DRAWN
    most = [2 if polynomial else _MAX_TURNED] * turns + [MAX_DRAWN] * len(model.reals)
    center, radius = solution.center, solution.radius
    if len(center) != len(most) or not 0 <= radius < widest or any(map(gt, map(abs, center), most)):
        raise ConfigError(f"a stored solution is no box around {kind}; check it with ptmcad verify")
    ends = [Bounds(c - radius, c + radius) for c in center]
    if polynomial:
        return tuple(ends)
    return (*(bounds for end in ends[:angles] for bounds in cosine_sine(end)), *ends[angles:])


@dataclass(frozen=True, slots=True)
class _Within:
    """The arithmetic of bounds, at exact parameters and a box of cosines, sines and unknowns on the
    line.
    """

    system: CompiledSystem
    values: Mapping[str, Fraction]
    box: tuple[Bounds, ...] = ()

    def constant(self, value: Fraction) -> Bounds:
        return exactly(value)

    def variable(self, number: int) -> Bounds:
        if number in self.system.reals:
            return self.box[2 * len(self.system.angles) + self.system.reals.index(number)]
        return self.constant(self.values[self.system.names[number]])

    def cos(self, number: int) -> Bounds:
        return self.box[2 * self.system.angles.index(number)]

    def sin(self, number: int) -> Bounds:
        return self.box[2 * self.system.angles.index(number) + 1]

    def length(self, x: Bounds, y: Bounds) -> Bounds:
        return square_root(x * x + y * y)
