"""What the page draws and shows, as JSON data: the map of a slice, and the solutions at a point of
it.

Guarantee: every number that is shown comes from an exact or certified answer; outlines are lists of
points on the curves. Nothing here chooses or computes an answer.
"""

from __future__ import annotations

from typing import Any

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.answer.words import stable_of
from ptmcad.model import Model
from ptmcad.model.work import loads_at
from ptmcad.show.posetable import kind_of
from ptmcad.show.render.axes import symbol
from ptmcad.show.render.colours import fill_of
from ptmcad.show.render.outline import TOLERANCE, outline, shapes
from ptmcad.show.render.view import Shapes
from ptmcad.show.report.mapsvg import (
    SIDE,
    counts_text,
    frame,
    hatch_id,
    pattern_defs,
    region_labels,
    region_outlines,
    room,
    wall_lines,
)
from ptmcad.show.table import area_digits, count_text
from ptmcad.text.numerals import Numbers, approximate_text

COARSE = 5e-4
"""How far a chord may miss its curve while the map is dragged, as a share of the window: a third of
a pixel.
"""
DIGITS = 7
"""Of the numbers at a point."""


def map_view(result: RegionMap, *, fine: bool, framed: bool) -> dict[str, Any]:
    """A map as paths of a picture with sides of `SIDE`, and its counts in words.

    Parameters
    ----------
    fine : whether curves are as smooth as in other pictures, and areas are known.
    framed : whether the axes with their ticks are wanted.
    """
    seen: Shapes = (
        shapes(result)
        if result.cover is not None
        else outline(result, None, TOLERANCE if fine else COARSE)
    )
    slice = result.slice
    fills = [fill_of(region, slice.count) for region in result.regions]
    simpler = fine or result.cover is not None
    drawn, lines = dict(region_outlines(seen, simpler)), wall_lines(seen, simpler)
    return {
        "regions": [
            {
                "d": drawn.get(number, ""),
                "face": fills[number].face,
                "hatch": hatch_id(fills[number].hatch) if fills[number].hatch else "",
                "words": counts_text(region, slice.model),
                "area": area_digits(result, region.area)
                if fine or result.cover is not None
                else "",
            }
            for number, region in enumerate(result.regions)
        ],
        "strong": "".join(d for (separates, _), d in lines.items() if separates),
        "thin": "".join(d for (separates, _), d in lines.items() if not separates),
        "labels": [
            [
                count_text(result.regions[number], slice.count),
                round(x * SIDE, 1),
                round((1 - y) * SIDE, 1),
            ]
            for number, x, y in region_labels(seen)
        ],
        "patterns": pattern_defs(fills),
        "frame": _frame(seen) if framed else None,
        "certified": result.cover is not None,
        "undetermined": approximate_text(100 * result.undetermined)
        if result.cover is not None
        else "",
        "settled": result.status is not Status.PARTIAL,
        "cells": len(result.cells),
        "digest": _digest(result),
    }


def _frame(seen: Shapes) -> dict[str, Any]:
    """The axes, and how much room they need around the window."""
    around = room(seen, detail=False)
    return {"svg": "".join(frame(seen, around)), "view": around.view, "place": around.place}


def _digest(result: RegionMap) -> list[list[Any]]:
    """Counts and numbers of cells of every region: enough for a test to recognise the map."""
    return [[region.stable, region.total, len(region.cells)] for region in result.regions]


def point_view(poses: Poses, at: Numbers) -> dict[str, Any]:
    """The solutions at a point: in numbers, and as `mechanism.js` draws them.

    Parameters
    ----------
    at : the axes' values there.
    """
    model = poses.model
    loads = () if model.drawable is None else loads_at(model.drawable, poses.parameters)
    total = len(poses.equilibria)
    decided = poses.status is not Status.UNDECIDED
    return {
        "at": [[symbol(name), approximate_text(value)] for name, value in at.items()],
        "words": stable_of(model, poses.known_stable, total) if decided else "not decided",
        "stable": poses.stable,
        "total": total,
        "status": poses.status.value,
        "remark": poses.remark,
        "loads": [list(map(float, load.force)) for load in loads],
        "equilibria": [_pose_view(pose, model) for pose in poses.equilibria],
    }


def _pose_view(pose: Pose, model: Model) -> dict[str, Any]:
    return {
        "kind": kind_of(pose, model),
        "unknowns": [f"{d.text(DIGITS)}°" for d in pose.degrees]
        + [r.text(DIGITS) for r in pose.reals],
        "energy": "" if pose.energy is None else pose.energy.text(DIGITS),
        "nodes": [[float(x), float(y)] for x, y in pose.nodes.values()],
    }
