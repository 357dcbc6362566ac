"""What a worker computes for the page: a map, the solutions at a point, the record of a figure, its
files; as the JSON data that the page draws and shows.

Guarantee: counts are exact or certified, and are those that `ptmcad classify` and `ptmcad solve`
give. A map that is superseded is given up at the next step of its computation.
"""

from __future__ import annotations

import json
import os
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.answer.words import stable_of
from ptmcad.ask.classification import region_map
from ptmcad.ask.members import Common, in_common, member_map
from ptmcad.ask.solving import poses_at
from ptmcad.errors import ConfigError, LimitReached, Place, PtmcadError
from ptmcad.model import Model
from ptmcad.model.work import loads_at
from ptmcad.options import Options, Progress, is_certified
from ptmcad.process.output import Writer, check_writable, text_writer, write_files
from ptmcad.question.config import file_name
from ptmcad.question.config.familyquestion import family_of
from ptmcad.question.slice import Slice
from ptmcad.show.posetable import kind_of
from ptmcad.show.render.axes import symbol
from ptmcad.show.render.colours import fill_of
from ptmcad.show.render.outline import TOLERANCE, outline, shapes
from ptmcad.show.report.mapsvg import (
    SIDE,
    counts_text,
    frame,
    hatch_id,
    pattern_defs,
    region_labels,
    region_outlines,
    wall_lines,
)
from ptmcad.show.report.reproduction import reproduction
from ptmcad.show.table import area_digits, count_text
from ptmcad.text.entry import Scalar, Sequence
from ptmcad.text.expressions import values_at
from ptmcad.text.numerals import Numbers, approximate_text, text_of
from ptmcad.workbench.explore.panel import SliderPanel, number_within
from ptmcad.workbench.worker import Cancelled

EXACT_SECONDS = 50.0
"""For one exact map."""
CERTIFIED_SECONDS, FINE_SECONDS = 40.0, 3.0
"""For a certified map at most; and after which the next one on the way is good enough where the
hand rests.
"""
PICTURES = ("png", "svg", "pdf")
POSE_DIGITS, DIGITS = 10, 7
"""To which solutions at a point are computed, and how many are shown."""
COARSE = 5e-4
"""How far a chord may miss its curve while the map is dragged, as a share of the window: a third of
a pixel.
"""


REMEMBERED = 4
"""Families whose variety is kept: one is left and come back to when another parameter is dragged to
and fro.
"""


Job = Mapping[str, Any]
Reply = tuple[str, bytes]
"""How a job ended (``done``, ``refused``, ``superseded``, ``lost``), and the JSON for the page."""
SUPERSEDED = ("superseded", b"{}")


class Tasks:
    """The tasks of one worker, with what it remembers between them.

    Parameters
    ----------
    folder : where files go.
    """

    def __init__(self, panel: SliderPanel, folder: Path) -> None:
        self.panel, self.folder = panel, folder
        self.families: OrderedDict[tuple[Fraction, ...], Common] = OrderedDict()
        self.last: RegionMap | None = None

    def answer(self, job: Job, check: Callable[[], None]) -> Reply:
        """The answer to a job.

        Parameters
        ----------
        check : called often; raises when the job is no longer wanted.
        """
        try:
            ended, found = "done", self.found(job, check)
        except Cancelled:
            return SUPERSEDED
        except PtmcadError as error:
            ended, found = "refused", {"error": str(error)}
        return ended, json.dumps(found, separators=(",", ":"), allow_nan=False).encode()

    def found(self, job: Job, check: Callable[[], None] = lambda: None) -> dict[str, Any]:
        """What a job asks for, whose ``kind`` names one of these tasks.

        Raises
        ------
        PtmcadError
            Where there is none, in words for the page.
        """
        self.check = check
        do = {"map": self._map, "point": self._point, "record": self._record, "save": self._save}[
            job["kind"]
        ]
        return do(self.panel.values(job["values"]), job)

    def _map(self, values: Numbers, job: Job) -> dict[str, Any]:
        fine = bool(job["fine"])
        slice = self.panel.slice(values)
        if is_certified(slice, "auto"):
            result = self._certified(slice, fine)
        else:
            result = self._exact(slice, values, areas=fine, sparing=True)
        return _map_view(result, fine=fine, framed=bool(job["framed"]))

    def _exact(self, slice: Slice, values: Numbers, *, areas: bool, sparing: bool) -> RegionMap:
        """The exact map; by the family's variety, where there is a family."""
        options = Options(
            timeout=EXACT_SECONDS, progress=self._progress, areas=areas, sparing=sparing
        )
        free = self.panel.record.free
        if free is None:
            return region_map(slice, options)
        return member_map(self.common(values, options), values[free[0]], options)

    def common(self, values: Numbers, options: Options) -> Common:
        """What the members have in common of the family that the values are in; its only stated
        member is the one at the free value.
        """
        others = tuple(values[slider.name] for slider in self.panel.sliders if not slider.free)
        if others not in self.families:
            record = self.panel.record_at(values)
            assert record.free is not None
            place = Place("members")
            stated = Sequence((Scalar(text_of(values[record.free[0]]), place),), place)
            family = family_of(record._replace(members=stated))
            self.families[others] = in_common(family, options)
            if len(self.families) > REMEMBERED:
                self.families.popitem(last=False)
        self.families.move_to_end(others)
        return self.families[others]

    def _certified(self, slice: Slice, fine: bool) -> RegionMap:
        """The first certified map there is, or from where the last one of this slice was some
        seconds further.
        """
        last, self.last = self.last, None
        resume = (
            last
            if last is not None and replace(last.slice, name="") == replace(slice, name="")
            else None
        )
        started, seconds = perf_counter(), FINE_SECONDS if fine else 0

        def handed(found: RegionMap) -> None:
            if perf_counter() - started >= seconds:
                raise LimitReached("the map is good enough for now", found)

        try:
            options = Options(
                timeout=CERTIFIED_SECONDS, progress=self._progress, partial=handed, resume=resume
            )
            self.last = region_map(slice, options)
        except LimitReached as stop:
            if not isinstance(stop.partial, RegionMap):
                raise
            self.last = stop.partial
        assert self.last is not None
        return self.last

    @property
    def _progress(self) -> Progress:
        return lambda _stage, _done, _total: self.check()

    def _point(self, values: Numbers, job: Job) -> dict[str, Any]:
        slice = self.panel.slice(values)
        axes = {axis.name: axis for axis in slice.axes}
        if set(job["at"]) != set(axes):
            raise ConfigError(f"a point has {' and '.join(axes)}")
        at = {
            name: number_within(name, job["at"][name], axis.low, axis.high)
            for name, axis in axes.items()
        }
        parameters = values_at(slice.parameters, *at.values())
        for name, value in parameters.items():
            if slice.model.kind(name).excludes(value):
                raise ConfigError(f"{name} is {value} there, where the geometry ends")
        return _point_view(poses_at(slice.model, parameters, POSE_DIGITS), at)

    def _record(self, values: Numbers, _job: Job) -> dict[str, Any]:
        slice = self.panel.slice(values)
        record, command = _reproduction(slice)
        return {"name": slice.name, "record": record, "command": f"ptmcad classify {slice.name}.yaml",
                "alone": command or ""}  # fmt: skip

    def _save(self, values: Numbers, job: Job) -> dict[str, Any]:
        """The figure, its result and its record as files, all or none; nothing that is there is
        written over.
        """
        name = file_name(job["name"], "the name")
        slice = replace(self.panel.slice(values), name=name)
        record, _ = _reproduction(slice)
        names = [
            f"{name}.yaml",
            *(f"{name}.{kind}" for kind in PICTURES if kind in job["formats"]),
            f"{name}.json",
        ]
        for file in names:
            if os.path.lexists(self.folder / file):
                raise ConfigError(f"{file} is there already: choose another name")
        check_writable(self.folder, tuple(names))
        if is_certified(slice, "auto"):
            found = self._certified(self.panel.slice(values), fine=True)
        else:
            found = self._exact(slice, values, areas=True, sparing=False)
        result = replace(found, slice=slice)
        written = write_files(self.folder, _writers(result, record, names), new=True)
        return {"files": [path.name for path in written]}


def _reproduction(slice: Slice) -> tuple[str, str | None]:
    """The record that gives a slice, and a command that needs none."""
    record, command = reproduction(slice)
    if record is None:
        raise ConfigError("no problem record gives this slice")
    return record, command


def _writers(result: RegionMap, record: str, names: list[str]) -> dict[str, Writer]:
    """For each file what writes it; the JSON, which vouches for the others, comes last."""
    texts = {"yaml": lambda: record, "json": result.to_json}
    kinds = {file: file.rpartition(".")[2] for file in names}
    return {
        file: text_writer(texts[kind]()) if kind in texts else partial(_draw, result)
        for file, kind in kinds.items()
    }


def _draw(result: RegionMap, path: Path) -> None:
    from ptmcad.show.render import draw  # brings matplotlib

    draw(result, path)


def _map_view(result: RegionMap, *, fine: bool, framed: bool) -> dict[str, Any]:
    """A map as paths of a picture with sides of `SIDE`, and its counts in words.

    Parameters
    ----------
    fine : whether curves are as smooth as in other pictures, and areas are known.
    framed : whether the axes with their ticks are wanted.
    """
    seen = (
        shapes(result)
        if result.cover is not None
        else outline(result, None, TOLERANCE if fine else COARSE)
    )
    slice, certified = result.slice, result.cover is not None
    known = fine or certified
    around = zip(("view", "place", "svg"), frame(seen, detail=False), strict=True)
    fills = [fill_of(region, slice.count) for region in result.regions]
    drawn, lines = dict(region_outlines(seen, known)), wall_lines(seen, known)
    return {
        "regions": [
            {
                "d": drawn.get(number, ""),
                "face": fills[number].face,
                "hatch": hatch_id(fills[number].hatch) if fills[number].hatch else "",
                "words": counts_text(region, slice.model),
                "area": area_digits(result, region.area) if known else "",
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
        "frame": dict(around) if framed else None,
        "certified": certified,
        "undetermined": approximate_text(100 * result.undetermined) if certified else "",
        "settled": result.status is not Status.PARTIAL,
        "cells": len(result.cells),
        # enough for a test to recognise the map
        "digest": [[r.stable, r.total, len(r.cells)] for r in result.regions],
    }


def _point_view(poses: Poses, at: Numbers) -> dict[str, Any]:
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
        "loads": [list(map(float, force)) for _, force in loads],
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
