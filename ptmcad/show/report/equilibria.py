"""The equilibria at a cell's sample point, from the boxes that the result stores around them.

Guarantee: every text is within one unit of its last digit of the number it stands for, if the box
holds the equilibrium, as `ptmcad.verify` checks. Numbers that are not texts are for drawing only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import atan2
from operator import gt, itemgetter
from typing import Any, TypeVar

from flint import acb, arb, ctx

from ptmcad.answer.regionmap import Cell, RegionMap, Solution
from ptmcad.errors import ConfigError, PoleError
from ptmcad.formulas.evaluation import evaluated
from ptmcad.model import Mechanism, Model
from ptmcad.model.compile import CompiledSystem, compiled
from ptmcad.question.slice import merged
from ptmcad.text.balls import ball_of, ball_over, enclosure_of, exact
from ptmcad.text.expressions import values_at
from ptmcad.text.numerals import (
    integer_text,
    magnitude,
    nearest_multiple,
    pointed,
    shortest_text,
    text_of,
)

MAX_DRAWN = 10**100
"""Of parameters that can be drawn: their products stay far within the range of
floating point.
"""

_MAX_TURNED = 1000
"""Radians in a stored angle, which is within one turn or a few."""
_BITS = 192
"""Of the precision, beyond that of any box that is stored."""
_DIGITS = 7
_DRAWN_DIGITS = 9
"""Of numbers for drawing, or from which the page's script begins: a little more than are shown."""

Value = TypeVar("Value")


def at_sample(result: RegionMap, cell: Cell) -> dict[str, Any]:
    """All that the page shows and draws for a cell's sample: parameters, loads and equilibria, as
    JSON data.

    Parameters are those besides the axes, which the sample has. Moments are those on the unknowns,
    angles first, whose work is not in the energy; none where all are zero.

    Raises
    ------
    ConfigError
        When a parameter has no value there, or a box is none.
    """
    try:
        values = values_at(result.slice.parameters, *cell.sample)
    except PoleError as error:
        raise ConfigError(f"a parameter has no value at a sample: {error}") from error
    model = result.slice.model
    # a certified map knows angles by themselves
    polynomial = result.cover is None and result.system.unknowns == coordinates(model)
    drawn = (
        (polynomial or result.system.unknowns == model.sorted_unknowns)
        and all(name in values for name in model.without_free_lengths)
        and all(abs(v) < MAX_DRAWN for v in values.values())
    )
    system = compiled(model)
    known = dict.fromkeys(model.free_lengths, Fraction(0)) | values
    acting = (system.shown.loads, system.moments[: system.criterion.order])
    others = {
        n: v for n, v in distinct_parameters(values, model).items() if n not in cell.sample.names
    }
    with ctx.workprec(_BITS):
        loads, moments = evaluated(acting if drawn else ((), ()), _Within(system, known))
        return {
            "parameters": [[n, both(v)] for n, v in others.items()],
            "loads": [[float(component) for component in force] for force in loads],
            "moments": [
                float(moment) for moment in moments if not all(m.is_zero() for m in moments)
            ],
            "equilibria": _solutions(model, cell, known, polynomial) if drawn else [],
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
    rounded = decimal_text((value, value), magnitude(abs(value)) + 1 - _DIGITS)
    return f"≈ {rounded.replace('−', '-')}"


def both(value: Fraction) -> str:
    """A number exactly, and as a decimal when it is not one: ``7/10 = 0.7``, ``1/3 ≈ 0.3333333``."""
    return f"{text_of(value)} {_plain(value)}".rstrip()


def _solutions(
    model: Model, cell: Cell, values: Mapping[str, Fraction], polynomial: bool
) -> list[dict[str, Any]]:
    """The solutions, the stable ones first, then by energy; all numbers of a kind to the same last
    place.
    """
    system = compiled(model)
    shown, turns = system.shown, 2 * len(model.angles)
    boxes = [_box(s, model, polynomial) for s in cell.solutions]
    formulas = (system.potential(), shown.points, shown.stretches, shown.elastic[1])
    poses: list[Any] = [evaluated(formulas, _Within(system, values, box)) for box in boxes]
    energy_text = _alike(pose[0] for pose in poses if pose[0] is not None)
    real_text = _alike(x for box in boxes for x in box[turns:])
    parts = [{} for _ in boxes] if model.drawable is None else _parts(model.drawable, poses)
    order = {"stable": 0, "degenerate": len(model.unknowns) + 1}
    found = []
    for solution, box, (energy, *_), part in zip(cell.solutions, boxes, poses, parts, strict=True):
        kind = model.criterion.kind_of_signs(solution.signs)
        angles = [_angle_text(degrees(box[n], box[n + 1])) for n in range(0, turns, 2)]
        entry = {
            "kind": kind,
            "unknowns": [*angles, *map(real_text, box[turns:])],
            "at": [_drawn(c) for c in box],
            "energy": "" if energy is None else energy_text(energy),
            "level": 0.0 if energy is None or energy.abs_upper() > MAX_DRAWN**3 else _drawn(energy),
        }
        # those of one energy stay in their order
        rank = order.get(kind, solution.signs.count("-")), 0.0 if energy is None else _drawn(energy)
        found.append((rank, entry | part))
    return [entry for _, entry in sorted(found, key=itemgetter(0))]


def _alike(balls: Iterable[arb]) -> Callable[[arb], str]:
    """How some numbers are written, all to the same last place."""
    return partial(ball_text, exponent=last_place(balls, _DIGITS))


def _parts(mechanism: Mechanism, poses: Sequence[Any]) -> list[dict[str, Any]]:
    """Of each equilibrium the points, and what springs of both sorts do."""
    stretches = [stretch for _, _, own, _ in poses for stretch in own]
    places = (x for _, points, _, _ in poses for place in points.values() for x in place)
    length_text = _alike([*places, *(length for length, _, _ in stretches)])
    force_text = _alike(force for _, _, force in stretches)
    moment_text = _alike(spring.moment for *_, turned in poses for spring in turned)
    found = []
    for _, points, own, turned in poses:
        moving = (map(length_text, points[name]) for name in mechanism.moving)
        entry: dict[str, Any] = {
            "nodes": [[_drawn(x) for x in place] for place in points.values()],
            "places": [f"({', '.join(place)})" for place in moving],
            "lengths": [length_text(length) for length, _, _ in own],
            "forces": [force_text(force) for _, _, force in own],
        }
        if turned:
            entry["deflections"] = [
                (_angle_text(degrees(s.cosine, s.sine)), moment_text(s.moment)) for s in turned
            ]
        found.append(entry)
    return found


def _drawn(value: arb) -> float:
    """The middle of a ball, in few characters."""
    middle = float(f"{float(value.mid()):.{_DRAWN_DIGITS}g}")
    return int(middle) if middle.is_integer() and abs(middle) < 10**_DRAWN_DIGITS else middle


def _angle_text(angle: arb | None) -> str:
    if angle is None:
        return "not determined"
    text = ball_text(angle, -4)
    return f"{text.lstrip('−') if text in ('−180.0000', '−0.0000') else text}°"


def _box(solution: Solution, model: Model, polynomial: bool) -> tuple[arb, ...]:
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
    balls = [ball_over(c - radius, c + radius) if radius else ball_of(c) for c in center]
    if polynomial:
        return tuple(balls)
    turned = (part for ball in balls[:angles] for part in (ball.cos(), ball.sin()))
    return (*turned, *balls[angles:])


@dataclass(frozen=True, slots=True)
class _Within:
    """The arithmetic of balls, at exact parameters and a box of cosines, sines and unknowns on the
    line.
    """

    system: CompiledSystem
    values: Mapping[str, Fraction]
    box: tuple[arb, ...] = ()

    def constant(self, value: Fraction) -> arb:
        return ball_of(value)

    def variable(self, number: int) -> arb:
        if number in self.system.reals:
            return self.box[2 * len(self.system.angles) + self.system.reals.index(number)]
        return self.constant(self.values[self.system.names[number]])

    def cos(self, number: int) -> arb:
        return self.box[2 * self.system.angles.index(number)]

    def sin(self, number: int) -> arb:
        return self.box[2 * self.system.angles.index(number) + 1]

    def length(self, x: arb, y: arb) -> arb:
        return abs(acb(x, y))


_MAX_PLAIN_PLACES = 12
"""Places before or after the point from which the form with an exponent is used."""
_WIDEST = 1e-3
"""Radians by which an angle may be uncertain that is said to be known."""


def degrees(cosine: arb, sine: arb) -> arb | None:
    """The angle, in (-180, 180] up to its own width, whose cosine and sine lie in these balls.

    None when the balls are too wide to decide.
    """
    if cosine.contains(0) and sine.contains(0):
        return None
    guess = arb(atan2(float(sine.mid()), float(cosine.mid())))
    c, s = guess.cos(), guess.sin()
    rest = arb.atan2(sine * c - cosine * s, cosine * c + sine * s)
    return (guess + rest) * 180 / arb.pi() if rest.abs_upper() < _WIDEST else None


def decimal_text(bounds: tuple[Fraction, Fraction], exponent: int) -> str:
    """A decimal with 10^exponent as the unit of its last digit, or a larger unit where the bounds
    are wider.

    >>> decimal_text((Fraction(-1, 3), Fraction(-1, 3)), -4), decimal_text((Fraction(1), Fraction(11, 10)), -4)
    ('−0.3333', '1.0')
    >>> decimal_text((Fraction(123456),) * 2, 3), decimal_text((Fraction(1, 10**20),) * 2, -22)
    ('123e3', '100e-22')
    """
    width = bounds[1] - bounds[0]
    if width > 0:
        exponent = max(exponent, magnitude(width))
    unit = Fraction(10) ** exponent
    while (digits := nearest_multiple(bounds, unit)) is None:
        exponent, unit = exponent + 1, unit * 10
    text = integer_text(abs(digits))
    sign = "−" if digits < 0 else ""
    if exponent > 0 or exponent < -_MAX_PLAIN_PLACES:
        return f"{sign}{text}e{exponent}" if digits else "0"
    return sign + pointed(text, exponent)


def ball_text(ball: arb, exponent: int) -> str:
    """The same of all numbers in a ball."""
    ends = enclosure_of(ball)
    return decimal_text((ends.low, ends.high), exponent)


def last_place(balls: Iterable[arb], digits: int) -> int:
    """The exponent of the last place that gives the largest of some numbers so many digits."""
    largest = max((exact(ball.abs_upper()) for ball in balls), default=Fraction(0))
    return (magnitude(largest) if largest else 0) + 1 - digits
