"""The equilibria at a cell's sample point, from the boxes that the result stores around them.

Guarantee: every text is within one unit of its last digit of the number it stands for, if the box holds the
equilibrium, as `ptmcad.verify` checks. Numbers that are not texts are for drawing only.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeVar

from ptmcad.answer.regionmap import Cell, RegionMap, Solution
from ptmcad.answer.words import kind_name
from ptmcad.errors import ConfigError, PoleError
from ptmcad.model import Mechanism, Model, System
from ptmcad.model.energy import points_in, with_springs
from ptmcad.model.evaluate import evaluate, value_at
from ptmcad.model.work import moments_at
from ptmcad.question.slice import merged
from ptmcad.show.report.bounds import (
    Bounds,
    cosine_sine,
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

MAX_DRAWN = 10**100
"""Of parameters and coefficients that can be drawn: their products stay far within the range of floating point."""

_MAX_TURNED = 1000
"""Radians in a stored angle, which is within one turn or a few."""
_DIGITS = 7
_DRAWN_DIGITS = 9
"""Of numbers for drawing, or from which the page's script begins: a little more than are shown."""

Point = tuple[Bounds, Bounds]
Value = TypeVar("Value")


def at_sample(result: RegionMap, cell: Cell) -> dict[str, Any]:
    """All that the page shows and draws for a cell's sample: parameters, loads, potential and equilibria, as JSON data.

    Parameters are those besides the axes, which the sample has.
    Moments are those on the unknowns, angles first, whose work is not in the potential; none where all are zero.

    Where springs have free lengths, whose energy is no polynomial, the potential's terms are left out.

    Raises
    ------
    ConfigError
        When a parameter has no value there, or the stored potential or a box is none.
    """
    try:
        values = {n: e.evaluate(cell.sample[0], cell.sample[1]) for n, e in result.slice.parameters.items()}
    except PoleError as error:
        raise ConfigError(f"a parameter has no value at a sample: {error}") from error
    model = result.slice.model
    # a certified map knows angles by themselves, and its potential may have roots, of lengths alone too
    polynomial = result.cover is None and result.system.unknowns == coordinates(model)
    potential = potential_at(result.system, values) if polynomial and result.system.potential else None
    drawn = (
        (polynomial or result.system.unknowns == (*model.angles, *model.reals))
        and all(name in values for name in model.without_free_lengths)
        and all(abs(v) < MAX_DRAWN for v in (*values.values(), *(potential or {}).values()))
    )
    known = dict.fromkeys(model.free_lengths, Fraction(0)) | values
    moments = moments_at(model, known) if drawn and model.has_potential else {}
    loads = model.loads if drawn and isinstance(model, Mechanism) else ()
    others = {n: v for n, v in distinct_parameters(values, model).items() if n not in cell.sample.names}
    return {
        "parameters": [[n, both(v)] for n, v in others.items()],
        "loads": [[float(value_at(load.x, known)), float(value_at(load.y, known))] for load in loads],
        "potential": [[*exponents, float(c)] for exponents, c in (potential or {}).items()] if drawn else [],
        "moments": [float(moments.get(name, 0)) for name in (*model.angles, *model.reals)] if moments else [],
        "equilibria": _solutions(model, cell, known, potential, polynomial) if drawn else [],
    }


def coordinates(model: Model) -> tuple[str, ...]:
    """The unknowns of a result's equations: cosine and sine of each angle, then those on the line."""
    return (*(f"{function}_{angle}" for angle in model.angles for function in ("cos", "sin")), *model.reals)


def kind_of(solution: Solution, model: Model) -> str:
    """What the signs of the Hessian's eigenvalues say, or those of the conditions for stability."""
    if not model.has_potential:
        told = model.tells_stability and solution.signs
        return "solution" if not told else "unstable" if solution.signs.strip("+") else "stable"
    if set(solution.signs) - set("+-") or len(solution.signs) != len(model.unknowns):
        return "degenerate"
    negative = solution.signs.count("-")
    return "stable" if negative == 0 else kind_name(negative, len(model.unknowns))


def distinct_parameters(values: Mapping[str, Value], model: Model) -> dict[str, Value]:
    """The parameters worth telling: one k when all springs have it."""
    return merged({name: value for name, value in values.items() if name not in model.shorthands}, model)


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
    model: Model, cell: Cell, values: Mapping[str, Fraction], potential: Potential | None, polynomial: bool
) -> list[dict[str, Any]]:
    """The solutions, the stable ones first, then by energy; all numbers of a kind to the same last place."""
    boxes = [_box(s, model) if polynomial else _box_of_angles(s, model) for s in cell.solutions]
    energies = [
        _energy(model, box, values) if not polynomial else None if potential is None else energy(potential, box)
        for box in boxes
    ]
    known = [bounds for bounds in energies if bounds is not None]
    energy_place = last_place(known, _DIGITS)
    turns = 2 * len(model.angles)
    reals = [box[turns:] for box in boxes]
    real_place = last_place([x for row in reals for x in row], _DIGITS)
    parts = _parts(model, boxes, values) if isinstance(model, Mechanism) else [{} for _ in boxes]
    kinds = [kind_of(solution, model) for solution in cell.solutions]
    order = {"stable": 0, "degenerate": len(model.unknowns) + 1}

    def rank(k: int) -> tuple[int, Fraction]:
        low, high = energies[k] or (Fraction(0), Fraction(0))
        return order.get(kinds[k], cell.solutions[k].signs.count("-")), low + high

    found = []
    for k in sorted(range(len(boxes)), key=rank):
        box, at = boxes[k], energies[k]
        angles = [degrees(box[n], box[n + 1]) for n in range(0, turns, 2)]
        unknowns = ["not determined" if a is None else _angle_text(a) for a in angles]
        entry = {
            "kind": kinds[k],
            "unknowns": unknowns + [decimal_text(x, real_place) for x in reals[k]],
            "at": [_drawn(c) for c in box],
            "energy": "" if at is None else decimal_text(at, energy_place),
            "level": 0.0 if at is None or abs(at[0] + at[1]) > MAX_DRAWN**3 else _drawn(at),
        }
        found.append(entry | parts[k])
    return found


def _parts(
    mechanism: Mechanism, boxes: Sequence[tuple[Bounds, ...]], values: Mapping[str, Fraction]
) -> list[dict[str, Any]]:
    """Of each equilibrium the points, the springs' lengths and forces, and what torsion springs do."""
    nodes = [_nodes(mechanism, box, values) for box in boxes]
    springs = mechanism.springs
    lengths = [[square_root(_squared_distance(where[s.start], where[s.end])) for s in springs] for where in nodes]
    stiffnesses = [exactly(value_at(spring.stiffness, values)) for spring in springs]
    free = [exactly(-value_at(spring.free, values)) for spring in springs]
    forces = [
        [times(k, plus(length, rest)) for k, length, rest in zip(stiffnesses, row, free, strict=True)]
        for row in lengths
    ]  # fmt: skip
    of_points = [x for where in nodes for place in where.values() for x in place]
    length_place = last_place([length for row in lengths for length in row] + of_points, _DIGITS)
    force_place = last_place([f for row in forces for f in row], _DIGITS)
    return [
        {
            "nodes": [[_drawn(x) for x in place] for place in where.values()],
            "places": [
                f"({decimal_text(where[n][0], length_place)}, {decimal_text(where[n][1], length_place)})"
                for n in mechanism.moving
            ],
            "lengths": [decimal_text(length, length_place) for length in long],
            "forces": [decimal_text(force, force_place) for force in strong],
            **({"torsion": turned} if turned else {}),
        }
        for where, long, strong, turned in zip(nodes, lengths, forces, _torsion(mechanism, boxes, values), strict=True)
    ]


def _torsion(
    mechanism: Mechanism, boxes: Sequence[tuple[Bounds, ...]], values: Mapping[str, Fraction]
) -> list[list[tuple[str, str]]]:
    """Of each equilibrium the deflection and the moment of every torsion spring, as texts."""
    rings = [_InBounds(mechanism, box, values) for box in boxes]
    turned = [[tuple(evaluate(t, ring).bounds for t in s.deflection) for s in mechanism.torsion] for ring in rings]
    stiffnesses = [exactly(value_at(spring.stiffness, values)) for spring in mechanism.torsion]
    moments = [[times(k, sine) for k, (_, sine) in zip(stiffnesses, row, strict=True)] for row in turned]
    place = last_place([moment for row in moments for moment in row], _DIGITS)
    angles = [[degrees(cosine, sine) for cosine, sine in row] for row in turned]
    return [
        [
            ("not determined" if angle is None else _angle_text(angle), decimal_text(moment, place))
            for angle, moment in zip(of_angles, of_moments, strict=True)
        ]
        for of_angles, of_moments in zip(angles, moments, strict=True)
    ]


def _drawn(value: Bounds) -> float:
    """The middle of bounds, in few characters."""
    middle = float(f"{float(sum(value) / 2):.{_DRAWN_DIGITS}g}")
    return int(middle) if middle.is_integer() and abs(middle) < 10**_DRAWN_DIGITS else middle


def _angle_text(angle: Bounds) -> str:
    text = decimal_text(angle, -4)
    return f"{text.lstrip('−') if text in ('−180.0000', '−0.0000') else text}°"


def _box(solution: Solution, model: Model) -> tuple[Bounds, ...]:
    turns = 2 * len(model.angles)
    size = turns + len(model.reals)
    if (
        len(solution.center) != size
        or not 0 <= solution.radius < (1 if turns else MAX_DRAWN)
        or any(abs(x) > (2 if n < turns else MAX_DRAWN) for n, x in enumerate(solution.center))
    ):
        raise ConfigError(
            "a stored solution is no box around cosines, sines and unknowns on the line; check it with ptmcad verify"
        )
    return tuple((c - solution.radius, c + solution.radius) for c in solution.center)


def _box_of_angles(solution: Solution, model: Model) -> tuple[Bounds, ...]:
    """Cosines and sines from a box around the angles themselves, as a certified map stores it."""
    angles, reals = solution.center[: len(model.angles)], solution.center[len(model.angles) :]
    if (
        len(solution.center) != len(model.unknowns)
        or not 0 <= solution.radius < 1
        or any(abs(x) > _MAX_TURNED for x in angles)
        or any(abs(x) > MAX_DRAWN for x in reals)
    ):
        raise ConfigError("a stored solution is no box around the unknowns; check it with ptmcad verify")
    ends = [(c - solution.radius, c + solution.radius) for c in solution.center]
    turns = [bounds for end in ends[: len(model.angles)] for bounds in cosine_sine(end)]
    return (*turns, *ends[len(model.angles) :])


def _energy(model: Model, box: tuple[Bounds, ...], values: Mapping[str, Fraction]) -> Bounds | None:
    """Bounds of the energy by the description, with free lengths; None where there is none."""
    within = _InBounds(model, box, values)
    if isinstance(model, System):
        return None if model.potential is None else evaluate(model.potential, within).bounds
    if not isinstance(model, Mechanism) or not model.has_potential:
        return None
    points = points_in(model, within)
    springs = []
    for spring in model.springs:
        start, end = ((x.bounds, y.bounds) for x, y in (points[spring.start], points[spring.end]))
        stretch = plus(square_root(_squared_distance(start, end)), exactly(-value_at(spring.free, values)))
        springs.append(times(exactly(value_at(spring.stiffness, values) / 2), power(stretch, 2)))
    return with_springs(model, within, points, _Bounded(plus(*springs))).bounds


def _nodes(mechanism: Mechanism, box: tuple[Bounds, ...], values: Mapping[str, Fraction]) -> dict[str, Point]:
    """Bounds of the coordinates of all points."""
    within = _InBounds(mechanism, box, values)
    return {name: (x.bounds, y.bounds) for name, (x, y) in points_in(mechanism, within).items()}


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

    def __init__(self, model: Model, box: tuple[Bounds, ...], values: Mapping[str, Fraction]):
        self.box, self.values = dict(zip(coordinates(model), box, strict=True)), values

    def constant(self, value: Fraction) -> _Bounded:
        return _Bounded(exactly(value))

    def parameter(self, name: str) -> _Bounded:
        return _Bounded(self.box[name] if name in self.box else exactly(self.values[name]))

    def cos(self, angle: str) -> _Bounded:
        return _Bounded(self.box[f"cos_{angle}"])

    def sin(self, angle: str) -> _Bounded:
        return _Bounded(self.box[f"sin_{angle}"])


def _squared_distance(p: Point, q: Point) -> Bounds:
    return plus(*(power(plus(a, times(b, exactly(-1))), 2) for a, b in zip(p, q, strict=True)))
