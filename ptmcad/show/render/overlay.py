"""Points of a caller's own, such as measured ones, drawn on a map.

Guarantee: a point with a count of its own is marked by whether the map has the same count there;
kinds of marks differ in shape or lightness, not in hue alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import Any

from ptmcad.answer.words import several
from ptmcad.show.render.colours import INK
from ptmcad.show.render.legend import Entry, point_mark
from ptmcad.show.render.view import Point, View


class Agreement(Enum):
    """Whether the map says of a point what its own count says."""

    UNTOLD = "measured point"
    SAME = "measured, count as in the map"
    OTHER = "measured, another count"


_SHAPES: dict[Agreement, dict[str, Any]] = {
    Agreement.UNTOLD: {"marker": "o", "markerfacecolor": "white", "markersize": 4.5},
    Agreement.SAME: {"marker": "o", "markerfacecolor": INK, "markersize": 4.5},
    Agreement.OTHER: {"marker": "X", "markerfacecolor": "#d81b3c", "markersize": 7.0},
}


Measured = tuple[Point, str, Agreement]
"""A point in the axes' order, with a label that may be empty."""
Overlay = Sequence[Measured]


def overlay_entries(overlay: Overlay) -> tuple[Entry, ...]:
    """What the marks mean, with their numbers."""
    found = []
    for kind in Agreement:
        number = sum(agreement is kind for _, _, agreement in overlay)
        if number:
            found.append(
                Entry((kind.value, several(number, "point")), point_mark(**_style(kind, 1.0)))
            )
    return tuple(found)


def _style(kind: Agreement, scale: float) -> dict[str, Any]:
    shape = dict(_SHAPES[kind])
    shape["markersize"] *= scale
    return {**shape, "linestyle": "none", "markeredgecolor": "white" if kind is Agreement.OTHER else INK,
            "markeredgewidth": 0.8 * scale}  # fmt: skip


def draw_overlay(axes: Any, view: View, overlay: Overlay, scale: float, size: float) -> None:
    """The points and their labels, in axes of a picture's own.

    Parameters
    ----------
    scale : of marks, against a picture in 9 points.
    size : of the labels' text, in points.
    """
    for kind in Agreement:
        at = [view.approximate_position(point) for point, _, own in overlay if own is kind]
        if at:
            x, y = zip(*at, strict=True)
            axes.plot(
                x, y, transform=axes.transAxes, zorder=6.5, clip_on=False, gid=f"measured-{kind.name.lower()}",
                **_style(kind, scale),
            )  # fmt: skip
    for point, label, _ in overlay:
        if not label:
            continue
        place = view.approximate_position(point)
        right, high = place[0] < 0.8, place[1] > 0.9
        away = ((4 if right else -4) * scale, (-4 if high else 4) * scale)
        axes.annotate(
            label, xy=place, xycoords="axes fraction", xytext=away, textcoords="offset points",
            ha="left" if right else "right", va="top" if high else "bottom", fontsize=size, color=INK,
            zorder=6.4, annotation_clip=False,
            bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none"},
        )  # fmt: skip
