"""A mechanism as a line drawing, in characters or as SVG: bars, springs, supports and the points'
names.

Springs between directions are spirals, where their joints are known (`ptmcad.model.joints`).

Floating point throughout: a drawing decides nothing. The pose is any, not an equilibrium.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from html import escape

from ptmcad.errors import ConfigError
from ptmcad.formulas.instructions import Doubles
from ptmcad.model import Mechanism, Support
from ptmcad.model.compile import compiled
from ptmcad.model.joints import joints_of
from ptmcad.show.spiral import spirals
from ptmcad.text.parsing import rational

WIDTH, HEIGHT = 48, 15
"""Characters of a drawing in text; one is about twice as high as wide."""
SIDE, MARGIN, TURNS = 360.0, 40.0, 8
SPIRAL = (4.5, 13.0, 3.0)
"""Inner and outer radius of a spiral, and the gap between two at one joint."""
_ANGLES = (0.9, 2.1, 0.3, 1.6)
"""Of the pose that is drawn, in turn: no two are alike, so that bars do not hide each other."""
_SUPPORTS = {
    Support.PIN: "fixed",
    Support.SLIDER_X: "slides along x",
    Support.SLIDER_Y: "slides along y",
}
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
        for name, (x, y) in _fitted(
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


def _fitted(places: Mapping[str, Place], shape: float) -> dict[str, Place]:
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


def approximate_svg(mechanism: Mechanism) -> str:
    """The drawing as SVG."""
    inner = SIDE - 2 * MARGIN
    at = {
        name: (MARGIN + inner * x, SIDE - MARGIN - inner * y)
        for name, (x, y) in _fitted(approximate_places(mechanism), 1.0).items()
    }
    parts = [
        f'<title>{escape(mechanism.name)}</title><rect width="{SIDE:g}" height="{SIDE:g}" fill="white"/>'
    ]
    for start, end in mechanism.bars:
        parts.append(_path([at[start], at[end]], "#17365d", 5))
    for start, end in mechanism.spring_ends:
        parts.append(_path(list(_zigzag(at[start], at[end])), "#1f1f1f", 1))
    joints = joints_of(mechanism)
    for spiral in spirals(joints, at, *SPIRAL).values():
        parts.append(_path(list(spiral), "#1f1f1f", 1))
    wound = {joint.point for joint in joints if joint is not None}
    for name, kind in mechanism.supports.items():
        x, y = at[name]
        parts.append(
            f'<path d="M{x:.1f} {y:.1f} l-8 12 h16 z" fill="white" stroke="#3a3a3a">'
            f"<title>{_SUPPORTS[kind]}</title></path>"
        )
    for name, (x, y) in at.items():
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="white" stroke="#3a3a3a"/>')
        aside = SPIRAL[1] if name in wound else 6
        parts.append(
            f'<text x="{x + aside:.1f}" y="{y - aside:.1f}" font-size="13" font-family="sans-serif">'
            f"{escape(name)}</text>"
        )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{SIDE:g}" height="{SIDE:g}" viewBox="0 0 {SIDE:g} {SIDE:g}">\n'
        + "\n".join(parts)
        + "\n</svg>\n"
    )


def _path(points: list[Place], colour: str, width: float) -> str:
    text = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polyline points="{text}" fill="none" stroke="{colour}" stroke-width="{width:g}" stroke-linecap="round"/>'


def _zigzag(start: Place, end: Place) -> Iterator[Place]:
    (x0, y0), (x1, y1) = start, end
    length = max(((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5, 1e-9)
    across = (-(y1 - y0) / length * 5, (x1 - x0) / length * 5)
    yield start
    for k in range(2 * TURNS + 1):
        share = 0.15 + 0.7 * k / (2 * TURNS)
        side = 0 if k in (0, 2 * TURNS) else 1 if k % 2 else -1
        yield (x0 + (x1 - x0) * share + side * across[0], y0 + (y1 - y0) * share + side * across[1])
    yield end
