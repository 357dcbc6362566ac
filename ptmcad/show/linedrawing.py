"""A mechanism as a drawing in characters: bars, springs and the points' names.

Floating point throughout: a drawing decides nothing. The pose is any, not an equilibrium.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from ptmcad.errors import ConfigError
from ptmcad.formulas.instructions import Doubles
from ptmcad.model import Mechanism
from ptmcad.model.compile import compiled
from ptmcad.model.joints import joints_of
from ptmcad.text.parsing import rational

WIDTH, HEIGHT = 48, 15
"""Characters of a drawing in text; one is about twice as high as wide."""
_ANGLES = (0.9, 2.1, 0.3, 1.6)
"""Of the pose that is drawn, in turn: no two are alike, so that bars do not hide each other."""
Place = tuple[float, float]


def _default(mechanism: Mechanism, name: str) -> float:
    parameter = mechanism.parameters[name]
    if parameter.alias_of:
        return _default(mechanism, parameter.alias_of)
    return float(rational(parameter.default)) if parameter.default else 1.0


def approximate_places(mechanism: Mechanism) -> dict[str, Place]:
    """The points at the parameters' defaults, in a pose of no meaning.

    Raises
    ------
    ConfigError
        Where a coordinate is too large for floating point.
    """
    system = compiled(mechanism)
    try:
        known = {name: _default(mechanism, name) for name in mechanism.variables}
        known |= dict.fromkeys(mechanism.reals, 0.7)
        known |= {name: _ANGLES[n % len(_ANGLES)] for n, name in enumerate(mechanism.angles)}
        given = {number: known[name] for number, name in enumerate(system.names)}
        points = Doubles(system.points, math).at(given)
    except OverflowError as error:
        raise ConfigError("a coordinate is too large to be drawn", key="points") from error
    return {name: (x, y) for name, (x, y) in points.items()}


def approximate_text(mechanism: Mechanism) -> str:
    """The drawing in characters: bars ``#``, springs ``.``, points ``o`` or, with spirals, ``@``,
    and names.
    """
    canvas = [[" "] * WIDTH for _ in range(HEIGHT)]
    at = {
        name: (round(x * (WIDTH - 6)), round((1 - y) * (HEIGHT - 1)))
        for name, (x, y) in fitted(
            approximate_places(mechanism), 2.0 * (HEIGHT - 1) / (WIDTH - 6)
        ).items()
    }
    for pairs, character in ((mechanism.spring_ends, "."), (mechanism.bars, "#")):
        for start, end in pairs:
            for column, row in _line(at[start], at[end]):
                canvas[row][column] = character
    wound = {joint.point for joint in joints_of(mechanism) if joint is not None}
    for name, (column, row) in at.items():
        for k, character in enumerate(f"{'@' if name in wound else 'o'}{name}"[:6]):
            if k == 0 or canvas[row][column + k] in " .":
                canvas[row][column + k] = character
    return "\n".join("".join(row).rstrip() for row in canvas).strip("\n")


def fitted(places: Mapping[str, Place], shape: float) -> dict[str, Place]:
    """Places in the unit square that stands for a frame as many times as high as wide."""
    (left, right), (low, high) = (
        (min(ends), max(ends)) for ends in zip(*places.values(), strict=True)
    )
    unit = max(right - left, (high - low) / shape) or 1.0
    across, up = (1 - (right - left) / unit) / 2, (1 - (high - low) / (unit * shape)) / 2
    return {
        name: (across + (x - left) / unit, up + (y - low) / (unit * shape))
        for name, (x, y) in places.items()
    }


def _line(start: tuple[int, int], end: tuple[int, int]) -> Iterator[tuple[int, int]]:
    steps = max(abs(end[0] - start[0]), abs(end[1] - start[1]), 1)
    for k in range(steps + 1):
        yield tuple(round(a + (b - a) * k / steps) for a, b in zip(start, end, strict=True))  # type: ignore[misc]
