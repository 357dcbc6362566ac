"""The picture of the energy over one unknown as a curve, or over two as contours, with all
equilibria marked by kind.

An angle goes round once; an unknown on the line goes through a range that holds all equilibria.
Where moments work, the energy less their work is drawn, in which the equilibria are level. Over an
angle it is not periodic: it is cut at 180 degrees, and a title says so.

Guarantee: every equilibrium is marked, at both edges where an angle is 180 degrees, with its number
in the picture of `ptmcad.show.render.posepicture.draw_poses`. Contours pass through saddles and
degenerate equilibria, as far as doubles tell their energies apart.

Not guaranteed: anything that only the picture shows. It is drawn in floating point from the exact
poses.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise, product
from math import dist
from typing import Any

import numpy as np
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.words import noun
from ptmcad.errors import ConfigError
from ptmcad.model.work import moments_at
from ptmcad.show.drawable import no_landscape
from ptmcad.show.render.axes import scale_of, symbol, ticks
from ptmcad.show.render.colours import INK
from ptmcad.show.render.energy import Energy, UnknownAxis, copies, drawn, is_cut, place_of, sides_of
from ptmcad.show.render.inches import TITLE_LINE, axes_at, titled
from ptmcad.show.render.labels import Box, Label, Position, around, place, polyline
from ptmcad.show.render.legend import Entry, draw_legend, point_mark
from ptmcad.show.render.posepicture import MARGIN as POSE_MARGIN
from ptmcad.show.render.posepicture import empty
from ptmcad.show.render.posewords import describe, heading, kind, value_text
from ptmcad.show.render.printing import settings
from ptmcad.show.render.view import Floats
from ptmcad.show.units import energy_unit, with_unit

SIDE, LEFT, BOTTOM, BAR, KEY, MARGIN = 4.6, 0.85, 0.65, 1.25, 2.2, 0.15
"""In inches: the square's side, the space at its left and below, the colour bar, the legend, the
rim.
"""
_GRID, _FINE = 145, 433
"""Points along a side for all contours, and for those through saddles, which are narrow crosses
near a fold.
"""
_EVEN, _MIN_STEPS = 16, 4
"""Intervals of contours in all, and at least between two neighbouring critical energies."""
_COLOURS = ("#16324f", "#3d6b8c", "#7fa6b5", "#c3d2c5", "#f3edd3")
"""From low to high energy, rising in lightness."""
_MARKERS = {
    "stable (minimum)": ("o", 8.5, "white"),
    "saddle": ("X", 9.0, "#f0b429"),
    "maximum": ("^", 9.0, "#d35c37"),
    "degenerate": ("*", 13.0, "#e9a7c4"),
}

_PLURALS = {"stable (minimum)": "stable (minima)", "saddle": "saddles", "maximum": "maxima"}
_COLUMNS = 90
"""Characters of a line of the title."""
_SPACE = "\N{NO-BREAK SPACE}"
_RING = 5.0
"""Points by which a marker is larger for each other one on its place."""


def draw_landscape(poses: Poses) -> Figure:
    """The energy with the equilibria; returns what `draw_poses` does.

    Raises
    ------
    ConfigError
        For a system without a potential, for more than two unknowns, and where a parameter is too
        large for doubles.
    """
    if reason := no_landscape(poses.model):
        raise ConfigError(reason)
    shown = poses.in_order
    if not shown:
        return empty(poses)
    return (_draw_curve if len(poses.model.unknowns) == 1 else _draw_contours)(poses, shown)


def _draw_curve(poses: Poses, shown: Sequence[Pose]) -> Figure:
    """The energy over one unknown."""
    energy = Energy(poses.model, poses.parameters)
    (side,) = sides_of(poses.model, shown, poses.units)
    values, inputs = side.sampled(_FINE)
    heights = energy(inputs)
    with settings():
        figure, axes = _page(poses, KEY + 2 * MARGIN, f"{side.name} as a curve")
        axes.plot(values, heights, color=_COLOURS[0], linewidth=1.6, zorder=3)
        room = 0.08 * float(np.ptp(heights)) or 1.0
        low, high = float(heights.min()) - room, float(heights.max()) + room
        axes.set_ylim(low, high)
        _decorate(axes.xaxis, side)
        _energy_ticks(axes, energy, low, high, energy_unit(poses.model, poses.units))
        places = [
            [(x, energy.level(pose, (x,))) for (x,) in _copies((side,), pose)] for pose in shown
        ]
        _mark(axes, shown, places, np.stack([values, heights], axis=1))
        draw_legend(figure, tuple(_legend(poses, shown)), LEFT + SIDE + 2 * MARGIN, BOTTOM + SIDE)
    return figure


def _page(poses: Poses, beside: float, what: str) -> tuple[Figure, Any]:
    """The figure with so much room beside the landscape, and its axes."""
    title = _title(poses)
    size = (LEFT + SIDE + beside, BOTTOM + SIDE + TITLE_LINE * len(title) + 3 * MARGIN)
    words = f"{drawn(poses)} over {what}. {describe(poses)}"
    figure = titled(title, words, size, LEFT, POSE_MARGIN)
    return figure, axes_at(figure, (LEFT, BOTTOM, SIDE, SIDE), "landscape")


def _draw_contours(poses: Poses, shown: Sequence[Pose]) -> Figure:
    """The energy over two unknowns."""
    energy, sides = (
        Energy(poses.model, poses.parameters),
        sides_of(poses.model, shown, poses.units),
    )
    (across, up), heights = _sampled(energy, sides, _GRID)
    critical = sorted({level for pose in shown for level in _levels(energy, sides, pose)})
    levels = contour_levels(critical, float(heights.min()), float(heights.max()))
    with settings():
        turning = all(side.is_angle for side in sides)
        what = "the two angles" if turning else " and ".join(side.name for side in sides)
        figure, axes = _page(poses, BAR + KEY + MARGIN, f"{what} as contours")
        colours = LinearSegmentedColormap.from_list("energy", _COLOURS, N=256)
        norm = BoundaryNorm(levels, colours.N)
        clipped = np.clip(heights, levels[0], levels[-1])
        filled = axes.contourf(across, up, clipped, levels=levels, cmap=colours, norm=norm)
        axes.contour(
            across,
            up,
            heights,
            levels=levels[1:-1],
            colors="white",
            linewidths=0.35,
            linestyles="solid",
        )
        through = sorted(
            {v for p in shown if p.index in (1, None) for v in _levels(energy, sides, p)}
        )
        finer, fine_heights = _sampled(energy, sides, _FINE)
        axes.contour(
            *finer, fine_heights, levels=through, colors=INK, linewidths=1.2, linestyles="solid"
        )
        for axis, side in zip((axes.xaxis, axes.yaxis), sides, strict=True):
            _decorate(axis, side)
        _mark(axes, shown, [_copies(sides, pose) for pose in shown])
        bar = axes_at(figure, (LEFT + SIDE + 0.2, BOTTOM, 0.16, SIDE))
        figure.colorbar(filled, cax=bar, spacing="proportional", drawedges=False, ticks=[])
        _energy_ticks(bar, energy, levels[0], levels[-1], energy_unit(poses.model, poses.units))
        for value in through:
            bar.axhline(value, color=INK, linewidth=1.2)
        left = LEFT + SIDE + BAR + 0.1
        draw_legend(figure, tuple(_legend(poses, shown)), left, BOTTOM + SIDE)
    return figure


def _copies(sides: Sequence[UnknownAxis], pose: Pose) -> list[Any]:
    """Where a pose lies: once, and again at the other edge of an angle."""
    shown = (side.copies(value) for side, value in zip(sides, place_of(pose), strict=True))
    return list(product(*shown))


def _levels(energy: Energy, sides: Sequence[UnknownAxis], pose: Pose) -> list[float]:
    return [energy.level(pose, place) for place in _copies(sides, pose)]


def _title(poses: Poses) -> list[str]:
    """The title's lines; where moments work with what is drawn, V."""
    lines, moments = heading(poses, _COLUMNS), moments_at(poses.model, poses.parameters)
    if not moments:
        return lines
    terms = {name: value_text(abs(value)) for name, value in moments.items()}
    about = "≈" if any(text[0] == "≈" for text in terms.values()) else "="
    work = "".join(
        f" {'−' if value > 0 else '+'} {terms[name].lstrip('=≈' + _SPACE)}{_SPACE}{symbol(name)}"
        for name, value in moments.items()
    )
    unit = " (radians)" if is_cut(poses) else ""
    return [
        *lines,
        *textwrap.wrap(f"V {about} U{work}{unit}: {drawn(poses).lower().rstrip(',')}", _COLUMNS),
    ]


def _sampled(
    energy: Energy, sides: Sequence[UnknownAxis], number: int
) -> tuple[tuple[Floats, Floats], Floats]:
    """What is shown along the sides, and the energy, shape (number, number), the first unknown
    along rows.
    """
    (across, first), (up, second) = (side.sampled(number) for side in sides)
    return (across, up), energy(first[None, :], second[:, None])


def contour_levels(critical: Sequence[float], low: float, high: float) -> list[float]:
    """Increasing levels from the least to the largest energy, all critical ones and some between
    any two.
    """
    marks = [low]
    for value in [*critical, high]:
        # energies nearer than what floats distinguish are one
        if value - marks[-1] > 1e-9 * (high - low):
            marks.append(value)
    levels = [marks[0]]
    for first, last in pairwise(marks):
        steps = max(_MIN_STEPS, round(_EVEN * (last - first) / (high - low)))
        levels += [first + (last - first) * k / steps for k in range(1, steps)] + [last]
    return levels


def _decorate(axis: Any, side: UnknownAxis) -> None:
    """An axis of matplotlib's that shows an unknown."""
    axis.axes.set(**{f"{axis.axis_name}lim": (side.low, side.high)})
    axis.set_tick_params(labelsize=9, direction="out", length=3.5)
    if side.is_angle:
        axis.set_ticks(range(-180, 181, 60))
    axis.set_label_text(side.label, fontsize=11)


def _mark(
    axes: Any,
    shown: Sequence[Pose],
    places: Sequence[Sequence[Position]],
    curve: Floats | None = None,
) -> None:
    """A marker at each place of each equilibrium, and its number, clear of the curve, at the first."""
    length = SIDE * 72
    to_paper = axes.transData - axes.transAxes

    def on_paper(place: Any) -> Any:
        return (to_paper.transform(place) * length).tolist()

    first = [on_paper(own[0]) for own in places]
    boxes: list[Box] = []
    for number, (pose, own) in enumerate(zip(shown, places, strict=True), 1):
        # what is drawn later on the same place would hide it: it stands out around that
        further = _RING * sum(dist(first[number - 1], p) < SIDE for p in first[number:])
        look = _marker(_kind(pose), further)
        for k, (x, y) in enumerate(own):
            gid = None if k else f"equilibrium-{number}"
            axes.add_artist(Line2D((x,), (y,), clip_on=False, zorder=6, gid=gid, **look))
            half = look["markersize"] / 2 + 1
            boxes.append(around(on_paper((x, y)), (half, half)))
    labels = []
    for number, at in enumerate(first, 1):
        towards = (length / 2 - at[0] or 1.0, length / 2 - at[1] or 1.0)
        labels.append(Label(str(number), at, (3.4 * len(str(number)) + 2, 6.2), towards))
    strokes = () if curve is None else polyline(on_paper(curve), 0.8)
    for placed in place(labels, strokes, boxes, (3.0, 3.0, length - 3, length - 3)):
        x, y = (value / length for value in placed.center)
        if placed.leader is not None:
            ends = np.array([placed.at, placed.leader]) / length
            axes.plot(*ends.T, color=INK, linewidth=0.6, zorder=5, transform=axes.transAxes)
        axes.text(
            x, y, placed.text, gid=f"number-{placed.text}", transform=axes.transAxes, fontsize=9,
            fontweight="bold", color=INK, ha="center", va="center", zorder=7,
            bbox={"boxstyle": "round,pad=0.12", "facecolor": "white", "edgecolor": "none", "alpha": 0.85},
        )  # fmt: skip


def _kind(pose: Pose) -> str:
    return "degenerate" if pose.index is None else kind(pose)


def _energy_ticks(axes: Any, energy: Energy, low: float, high: float, unit: str) -> None:
    """Energies along a vertical axis between two levels."""
    ends = (Fraction(low), Fraction(high))
    scale = scale_of(*ends)
    found = ticks(ends, scale, 7)
    at = [low + float(share) * (high - low) for _, share in found]
    axes.yaxis.set_ticks(at, [text for text, _ in found])
    axes.minorticks_off()
    axes.tick_params(labelsize=9, direction="out", length=3.5)
    axes.set_ylabel(with_unit(scale.name("V" if energy.works else "U"), unit), fontsize=10)


def _legend(poses: Poses, shown: Sequence[Pose]) -> Iterator[Entry]:
    model = poses.model
    yield Entry((noun(model).capitalize(),), strong=True)
    kinds = [_kind(pose) for pose in shown]
    for name in _MARKERS:
        if name in kinds:
            several = kinds.count(name) > 1
            count = f"{kinds.count(name)} {_PLURALS.get(name, name) if several else name}"
            numbers = ", ".join(str(k) for k, other in enumerate(kinds, 1) if other == name)
            lines = [count, f"{'numbers' if several else 'number'} {numbers}"]
            if name == "degenerate":
                lines += [f"multiplicity {p.multiplicity}" for p in shown if p.index is None]
            yield Entry(tuple(lines), point_mark(**_marker(name)))
    if any(len(copies(float(angle))) == 2 for p in shown for angle in p.degrees):
        level = ("at two levels of V: one pose",) if is_cut(poses) else ("which are the same",)
        yield Entry(("at 180° marked at both edges,", *level))
    if len(model.unknowns) == 1:
        return
    yield Entry(())
    yield Entry(("V",) if moments_at(model, poses.parameters) else ("Energy",), strong=True)
    if any(p.index in (1, None) for p in shown):
        yield Entry(("contour through a saddle", "or a degenerate equilibrium"), 1.2)
    yield Entry(("dark: low, light: high",))


def _marker(kind: str, further: float = 0.0) -> dict[str, Any]:
    """How equilibria of a kind are marked, so many points larger than others."""
    marker, size, face = _MARKERS[kind]
    return {"marker": marker, "markersize": size + further, "markerfacecolor": face, "markeredgecolor": INK,
            "markeredgewidth": 1.0, "linestyle": "none"}  # fmt: skip
