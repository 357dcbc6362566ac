"""The picture of the energy over the torus of the two angles, as contours, with all equilibria marked by their kind.

Guarantee: every equilibrium is marked, at both edges where an angle is 180 degrees, with its number in the picture of
`ptmcad.show.render.poses.draw_poses`. Contours pass through saddles and degenerate equilibria, also where the energy is
large and its differences are small, because its constant part is taken out exactly before anything is rounded.

Not guaranteed: anything that only the picture shows. It is drawn in floating point from the exact poses.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import hypot
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from ptmcad.algebra.polynomials import from_fraction, to_fraction
from ptmcad.answer.poses import Pose, Poses
from ptmcad.exact.models.potential import squared_lengths, system_from
from ptmcad.exact.models.system import polynomial_at
from ptmcad.mechanism import ptm
from ptmcad.mechanism.evaluate import value_at
from ptmcad.show.render.axes import Scale, scale_of
from ptmcad.show.render.clearance import Box, Label, Stroke, place
from ptmcad.show.render.legend import INK, SWATCH, Entry, Mark, draw_legend
from ptmcad.show.render.poses import TITLE_LINE, describe, empty, heading, in_order, kind, titled
from ptmcad.show.render.printing import settings
from ptmcad.text.numerals import magnitude

SIDE, LEFT, BOTTOM, BAR, KEY, MARGIN = 4.6, 0.85, 0.65, 1.25, 2.2, 0.15
"""In inches: the square's side, the space at its left and below, the colour bar, the legend, the rim."""
_GRID, _FINE = 145, 433
"""Points along a side for all contours, and for those through saddles, which are narrow crosses near a fold."""
_EVEN, _LEAST = 16, 4
"""Intervals of contours in all, and at least between two neighbouring critical energies."""
_COLOURS = ("#16324f", "#3d6b8c", "#7fa6b5", "#c3d2c5", "#f3edd3")
"""From low to high energy, rising in lightness."""
_MARKERS = {
    "stable (minimum)": ("o", 8.5, "white"),
    "saddle": ("X", 9.0, "#f0b429"),
    "maximum": ("^", 9.0, "#d35c37"),
    "degenerate": ("*", 13.0, "#e9a7c4"),
}

_RING = 5.0
"""Points by which a marker is larger for each other one on its place."""

Floats = NDArray[np.float64]


Terms = tuple[tuple[tuple[int, ...], float], ...]


def _sum(terms: Terms, bases: Sequence[Floats], shape: tuple[int, ...]) -> Floats:
    total = np.zeros(shape)
    for powers, coefficient in terms:
        term = np.full_like(total, coefficient)
        for base, power in zip(bases, powers, strict=True):
            term = term * base**power
        total += term
    return total


@dataclass(frozen=True, slots=True)
class Energy:
    """The energy as (U - offset) / unit: coefficients of cosines and sines, exponents of c1, s1, c2, s2; and for each
    spring with a free length -k l0 with the terms of its length squared, whose root it multiplies."""

    offset: Fraction
    unit: Fraction
    terms: Terms
    roots: tuple[tuple[float, Terms], ...] = ()

    def __call__(self, *angles: Floats) -> Floats:
        """Over arrays of angles in radians."""
        bases = [function(angle) for angle in angles for function in (np.cos, np.sin)]
        shape = np.broadcast(*angles).shape
        total = _sum(self.terms, bases, shape)
        for factor, square in self.roots:
            total += factor * np.sqrt(np.maximum(_sum(square, bases, shape), 0.0))
        return total

    def scaled(self, value: Fraction) -> float:
        """An energy in the picture's unit."""
        return float((value - self.offset) / self.unit)


def energy_of(parameters: Mapping[str, Fraction]) -> Energy:
    """The energy at these parameters, its constant part taken out and its size made about 1."""
    mechanism = ptm()
    system = system_from(mechanism)
    values = {name: from_fraction(parameters[name]) for name in system.ring.parameters}
    assert system.potential is not None
    exact = {m: to_fraction(c) for m, c in polynomial_at(system, system.potential, values).items()}
    offset = exact.pop((0,) * 2 * system.dimension, Fraction(0))
    unit = Fraction(10) ** magnitude(max(map(abs, exact.values()), default=Fraction(1)))
    roots = []
    for spring, square in zip(mechanism.springs, squared_lengths(mechanism), strict=True):
        free = value_at(spring.free, dict.fromkeys(mechanism.free_lengths, Fraction(0)) | dict(parameters))
        pull = value_at(spring.stiffness, parameters) * free
        if pull:
            offset += pull * free / 2
            terms = polynomial_at(system, square, values)
            roots.append((float(-pull / unit), tuple((m, float(to_fraction(c))) for m, c in terms.items())))
    return Energy(offset, unit, tuple((m, float(c / unit)) for m, c in sorted(exact.items())), tuple(roots))


def draw_landscape(poses: Poses) -> Figure:
    """The energy over the torus as contours, with the equilibria; takes and returns what `draw_poses` does."""
    shown = in_order(poses)
    if not shown:
        return empty(poses)
    energy = energy_of(poses.parameters)
    degrees, heights = _sampled(energy, _GRID)
    critical = sorted({energy.scaled(pose.known_energy.center) for pose in shown})
    levels = contour_levels(critical, float(heights.min()), float(heights.max()))
    title = heading(poses, 90)
    size = (LEFT + SIDE + BAR + KEY + MARGIN, BOTTOM + SIDE + TITLE_LINE * len(title) + 3 * MARGIN)
    with settings():
        figure = titled(title, size, LEFT)
        figure.set_label(f"{' '.join(title)}\nEnergy over the two angles as contours. {describe(poses)}")
        axes = figure.add_axes((LEFT / size[0], BOTTOM / size[1], SIDE / size[0], SIDE / size[1]))
        axes.set_gid("landscape")
        colours = LinearSegmentedColormap.from_list("energy", _COLOURS, N=256)
        norm = BoundaryNorm(levels, colours.N)
        clipped = np.clip(heights, levels[0], levels[-1])
        filled = axes.contourf(degrees, degrees, clipped, levels=levels, cmap=colours, norm=norm)
        axes.contour(
            degrees, degrees, heights, levels=levels[1:-1], colors="white", linewidths=0.35, linestyles="solid"
        )
        through = sorted({energy.scaled(p.known_energy.center) for p in shown if p.index in (1, None)})
        finer, fine_heights = _sampled(energy, _FINE)
        axes.contour(finer, finer, fine_heights, levels=through, colors=INK, linewidths=1.2, linestyles="solid")
        _decorate(axes)
        _mark(axes, shown)
        scale = _energy_scale(energy, levels)
        bar = figure.add_axes(((LEFT + SIDE + 0.2) / size[0], BOTTOM / size[1], 0.16 / size[0], SIDE / size[1]))
        _colour_bar(bar, filled, scale, energy, levels, through)
        left = LEFT + SIDE + BAR + 0.1
        draw_legend(figure, tuple(_legend(shown)), left, BOTTOM + SIDE)
    return figure


def _sampled(energy: Energy, number: int) -> tuple[Floats, Floats]:
    """Angles in degrees along a side, and the energy over the square, shape (number, number), th1 along rows."""
    degrees = np.linspace(-180.0, 180.0, number)
    radians = np.radians(degrees)
    return degrees, energy(radians[None, :], radians[:, None])


def contour_levels(critical: Sequence[float], low: float, high: float) -> list[float]:
    """Increasing levels from the least to the largest energy, all critical ones and some between any two."""
    marks = [low]
    for value in [*critical, high]:
        # energies nearer than what floats distinguish are one
        if value - marks[-1] > 1e-9 * (high - low):
            marks.append(value)
    levels = [marks[0]]
    for first, last in pairwise(marks):
        steps = max(_LEAST, round(_EVEN * (last - first) / (high - low)))
        levels += [first + (last - first) * k / steps for k in range(1, steps)] + [last]
    return levels


def _decorate(axes: Any) -> None:
    axes.set(xlim=(-180, 180), ylim=(-180, 180), aspect="equal")
    ticks = range(-180, 181, 60)
    axes.set_xticks(ticks)
    axes.set_yticks(ticks)
    axes.tick_params(labelsize=9, direction="out", length=3.5)
    axes.set_xlabel("θ₁ (degrees)", fontsize=11)
    axes.set_ylabel("θ₂ (degrees)", fontsize=11)


def _mark(axes: Any, shown: Sequence[Pose]) -> None:
    """A marker for each equilibrium, again at the opposite edge, and its number once."""
    points = SIDE * 72 / 360
    boxes: list[Box] = []
    for number, pose in enumerate(shown, 1):
        marker, size, face = _MARKERS[_kind(pose)]
        own = first_copy(pose)
        # what is drawn later on the same place would hide it: it stands out around that
        size += _RING * sum(
            hypot(*(a - b for a, b in zip(own, first_copy(p), strict=True))) < 5 for p in shown[number:]
        )
        for x in copies(float(pose.degrees[0])):
            for y in copies(float(pose.degrees[1])):
                axes.add_artist(
                    Line2D(
                        (x,), (y,), marker=marker, markersize=size, markerfacecolor=face, markeredgecolor=INK,
                        markeredgewidth=1.0, linestyle="none", clip_on=False, zorder=6,
                        gid=f"equilibrium-{number}" if (x, y) == own else None,
                    )
                )  # fmt: skip
                u, v, half = (x + 180) * points, (y + 180) * points, size / 2 + 1
                boxes.append((u - half, v - half, u + half, v + half))
    side = SIDE * 72
    labels = []
    for number, pose in enumerate(shown, 1):
        at = tuple((c + 180) * points for c in first_copy(pose))
        towards = (side / 2 - at[0] or 1.0, side / 2 - at[1] or 1.0)
        labels.append(Label(str(number), (at[0], at[1]), (3.4 * len(str(number)) + 2, 6.2), towards))
    none: Iterable[Stroke] = ()
    for placed in place(labels, none, boxes, (3.0, 3.0, side - 3, side - 3)):
        x, y = (c / points - 180 for c in placed.center)
        if placed.leader is not None:
            ends = [placed.label.at, placed.leader]
            line = [(u / points - 180, v / points - 180) for u, v in ends]
            axes.add_collection(LineCollection([line], colors=INK, linewidths=0.6, zorder=5), autolim=False)
        axes.text(
            x, y, placed.label.text, fontsize=9, fontweight="bold", color=INK, ha="center", va="center", zorder=7,
            bbox={"boxstyle": "round,pad=0.12", "facecolor": "white", "edgecolor": "none", "alpha": 0.85},
            gid=f"number-{placed.label.text}",
        )  # fmt: skip


def copies(angle: float) -> tuple[float, ...]:
    """An angle in degrees, twice where it is at the edge (to what a marker's width shows)."""
    return (180.0, -180.0) if abs(angle) > 179.75 else (angle,)


def first_copy(pose: Pose) -> tuple[float, float]:
    """Where an equilibrium's number belongs."""
    return copies(float(pose.degrees[0]))[0], copies(float(pose.degrees[1]))[0]


def _kind(pose: Pose) -> str:
    return "degenerate" if pose.index is None else kind(pose)


def _energy_scale(energy: Energy, levels: Sequence[float]) -> Scale:
    low, high = (energy.offset + energy.unit * Fraction(v) for v in (levels[0], levels[-1]))
    return scale_of(low, high)


def _colour_bar(
    bar: Any, filled: Any, scale: Scale, energy: Energy, levels: Sequence[float], through: Sequence[float]
) -> None:
    """The colours with energies; lines at the energies of contours through saddles."""
    figure = bar.figure
    figure.colorbar(filled, cax=bar, spacing="proportional", drawedges=False, ticks=[])
    power = Fraction(10) ** scale.exponent

    def position(shown: float) -> float:
        return energy.scaled(Fraction(shown) * power + scale.offset)

    from matplotlib.ticker import MaxNLocator

    ticks = [
        t for t in MaxNLocator(nbins=7, steps=[1, 2, 2.5, 5, 10]).tick_values(scale.low, scale.high)
        if scale.low <= t <= scale.high
    ]  # fmt: skip
    bar.yaxis.set_ticks([position(t) for t in ticks], [f"{t:.6g}".replace("-", "−") for t in ticks])
    bar.minorticks_off()
    bar.tick_params(labelsize=9, direction="out", length=3.5)
    bar.set_ylabel(f"{scale.name('U')} (force · length)", fontsize=10)
    for value in through:
        bar.axhline(value, color=INK, linewidth=1.2)


def _legend(shown: Sequence[Pose]) -> Iterator[Entry]:
    yield Entry(("Equilibria",), strong=True)
    kinds = [_kind(pose) for pose in shown]
    for name, (marker, size, face) in _MARKERS.items():
        if name in kinds:
            several = "s" if kinds.count(name) > 1 else ""
            count = {"stable (minimum)": f"{kinds.count(name)} stable (minimum)"}.get(
                name, f"{kinds.count(name)} {name}{several if name == 'saddle' else ''}"
            )
            numbers = ", ".join(str(k) for k, other in enumerate(kinds, 1) if other == name)
            lines = [count, f"number {numbers}" if not several else f"numbers {numbers}"]
            if name == "degenerate":
                lines += [f"multiplicity {p.multiplicity}" for p in shown if p.index is None]
            yield Entry(tuple(lines), _marker_mark(marker, size, face))
    if any(c == (180.0, -180.0) for p in shown for c in map(copies, (float(p.degrees[0]), float(p.degrees[1])))):
        yield Entry(("at 180° marked at both edges,", "which are the same"))
    yield Entry(())
    yield Entry(("Energy",), strong=True)
    if any(p.index in (1, None) for p in shown):
        yield Entry(("contour through a saddle", "or a degenerate equilibrium"), 1.2)
    yield Entry(("dark: low, light: high",))


def _marker_mark(marker: str, size: float, face: str) -> Mark:
    def mark(figure: Any, left: float, middle: float) -> None:
        figure.add_artist(
            Line2D(
                (left + SWATCH / 2,), (middle,), transform=figure.dpi_scale_trans, marker=marker, markersize=size,
                markerfacecolor=face, markeredgecolor=INK, markeredgewidth=1.0, linestyle="none",
            )
        )  # fmt: skip

    return mark
