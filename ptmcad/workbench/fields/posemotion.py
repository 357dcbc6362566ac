"""One pose followed along a path of a map, through the folds where it vanishes, to the poses to
which it falls.

Guarantee: the counts of a step are the map's at its point or, where a certified map leaves it open,
those of an exact solution there; a step that has them has as many different equilibria, and the
followed pose is one of them. A pose is said to vanish only where the map's cell changes or is not
known.

Not guaranteed: the rest, which is floating point. From one step to the next the pose is followed by
Newton's method in as many parts as keep it near itself; where it ends, the energy descends to the
next one (`ptmcad.ask.fields.descent`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np

from ptmcad.answer.boundaries import NONE
from ptmcad.answer.motion import Fall, Motion, Place, Step
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.ask.fields.descent import descent
from ptmcad.ask.fields.equations import Floats, apart, unknowns_of
from ptmcad.ask.fields.track import MIN_STEP, Track, corners_of, followed
from ptmcad.ask.location import locate
from ptmcad.errors import ConfigError, PtmcadError, expect
from ptmcad.options import Progress
from ptmcad.question.shipped import FIRST, SECOND
from ptmcad.question.slice import Point, within_doubles
from ptmcad.text.numerals import equalities
from ptmcad.workbench.fields.pixelsolver import filled
from ptmcad.workbench.fields.quantityfield import Choice, choice_of, complete, exact_at

FRAMES, MAX_FRAMES = 90, 600
MAX_FALLS = 20
SLIP = 0.05
"""A shorter fall is invisible: the pose goes on next to it, as where a symmetric one gives way to
two.
"""
SAME = 1e-6
_BESIDE = Fraction(1, 10**6)
"""Of the path, by which a step is moved that lies on a curve of the map."""


def motion_of(
    result: RegionMap,
    path: str | Mapping[str, Any],
    pose: str = "stable:1",
    frames: int = FRAMES,
    progress: Progress | None = None,
) -> Motion:
    """The motion of one pose along a path of the map, through the folds where it vanishes, in
    floating point.

    Every step is one of as many equilibria as the map counts there; steps of a fall, by steepest
    descent of the energy, say that they are none. `Motion.save` writes it as a GIF or, with ffmpeg,
    as MP4.

    Parameters
    ----------
    path : corners, as ``"rho=3/4:6/5,L2=3/2"`` or ``{"rho": ["3/4", "6/5"], "L2": "3/2"}``.
    pose : at its start, as of `field`.
    frames : number of steps along the path, besides those of falls, which are a third of that each.

    Raises
    ------
    ConfigError
        For a path or pose that has no meaning here, a number of frames that is none, or a map
        without cells.
    PtmcadError
        Where the map has the pose and it was not found.

    >>> import ptmcad
    >>> result = ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho"))
    >>> result.animate("L2=3/2:1/2,rho=1", "stable:2", frames=20)
    <Motion of stable:2 over slice-L2-rho: 20 steps, 0 falls>
    """
    expect(path, (str, Mapping), "path", f"corners, as '{FIRST}=3/4:6/5,{SECOND}=3/2'")
    expect(pose, str, "pose", "one of the poses as text, such as stable:1")
    if isinstance(frames, bool) or not isinstance(frames, int) or not 2 <= frames <= MAX_FRAMES:
        raise ConfigError(
            f"{frames!r} is not a number of frames from 2 to {MAX_FRAMES}", key="--frames"
        )
    if not result.cells:
        raise ConfigError(
            f"the map {result.slice.name} was stopped before it had cells: there is nothing to show"
        )
    choice = choice_of(pose, result.slice.model)
    corners = corners_of(result.slice, path)
    with within_doubles(result.slice):
        walk = Track(result.slice, corners)
        stops = _stops(result, walk, frames)
        start = _start(result, stops[0][1].at, choice)
        steps, falls, end = _walked(result, walk, stops, start, max(12, frames // 3), progress)
    return Motion(result, corners, str(choice), tuple(steps), tuple(falls), end)


_Stop = tuple[Fraction, Step, Floats | None]
"""A share of the path, the step before the pose is known, and all solutions there; None where they
are not known.
"""


def _cell(result: RegionMap, at: Place) -> int:
    """The number of the cell at a point; `NONE` on curves, and where the map leaves it open."""
    cell = locate(result, Point(result.slice.axis_names, *at)).cell
    return NONE if cell is None else cell


def _stops(result: RegionMap, walk: Track, frames: int) -> list[_Stop]:
    """The steps along the path with their counts and all solutions, each next to any curve on which
    it would lie.
    """
    points, cells, shares = [], [], []
    for k in range(frames):
        share = Fraction(k, frames - 1)
        inward = 1 if k < frames / 2 else -1
        for moved in (share + inward * n * _BESIDE for n in range(4)):
            point, cell = walk.place(moved), _cell(result, walk.place(moved))
            if cell != NONE:
                break
        else:
            moved, point = share, walk.place(share)
        shares.append(moved)
        points.append(point)
        cells.append(cell)
    x, y = (np.array([[float(point[k]) for point in points]]) for k in (0, 1))
    solver = filled(result, x, y, np.array([cells], dtype=np.int64))
    complete(solver, lambda _, column: points[column])
    stops: list[_Stop] = []
    for k, (share, point, number) in enumerate(zip(shares, points, cells, strict=True)):
        step = Step(float(share), point, (), None)
        if number == NONE:
            stops.append(_open(result, walk, share, step))
            continue
        counts, many = result.cells[number], int(solver.total[0, k])
        known = solver.at[:, 0, k, :many] if solver.done[0, k] and many >= 0 else None
        counted = replace(step, total=counts.total, stable=counts.stable)
        stops.append((share, _with_others(walk, counted, known), known))
    return stops


def _open(result: RegionMap, walk: Track, share: Fraction, step: Step) -> _Stop:
    """Where the map is silent: by an exact solution at the point."""
    poses = exact_at(result, *step.at)
    if poses.status not in (Status.EXACT, Status.CERTIFIED):
        return share, step, None
    found = (
        np.array([unknowns_of(p) for p in poses.equilibria]).reshape(-1, len(walk.model.unknowns)).T
    )
    counted = replace(step, total=len(poses.equilibria), stable=poses.known_stable)
    return share, _with_others(walk, counted, found), found


def _with_others(walk: Track, step: Step, known: Floats | None) -> Step:
    """The step with the heights of all solutions, where each has one."""
    if known is None or not known.shape[1]:
        return step
    state = walk.state(step.at, known)
    if state.energy is None or state.work is not None:
        return replace(step, others=tuple((np.nan, False) for _ in range(known.shape[1])))
    return replace(
        step, others=tuple(zip(state.energy.tolist(), (state.negatives == 0).tolist(), strict=True))
    )


def _start(result: RegionMap, at: Place, choice: Choice) -> Floats:
    """The chosen pose at the path's start, of the exact ones."""
    poses = exact_at(result, *at)
    found = choice.numbers(poses)
    if len(found) < choice.rank:
        where = equalities(dict(zip(result.slice.axis_names, at, strict=True)))
        raise ConfigError(
            f"there is no {choice} at the path's start, {where}: only {len(found)} of them",
            key="--pose",
        )
    return unknowns_of(poses.equilibria[found[choice.rank - 1]])


def _walked(
    result: RegionMap,
    walk: Track,
    stops: list[_Stop],
    start: Floats,
    fall_frames: int,
    progress: Progress | None,
) -> tuple[list[Step], list[Fall], str]:
    """All steps; where the pose vanishes those of its fall, as far as it goes."""
    at, own = start, int(walk.state(stops[0][1].at, start[:, None]).negatives[0])
    steps = [_taken(walk, stops[0], at)]
    falls: list[Fall] = []
    for number, (last, stop) in enumerate(pairwise(stops), 1):
        if progress is not None:
            progress("motion: step", number, len(stops))
        done, until = float(last[0]), float(stop[0])
        while True:
            at, done, leaves = followed(walk, at, done, until, own)
            if done >= until:
                break
            where = f"at {_where(walk, done)}"
            if leaves:
                return steps, falls, f"{where} the pose leaves what the inequalities allow"
            beyond = min(done + MIN_STEP, until)
            before, after = (_cell(result, walk.place(share)) for share in (done, beyond))
            if before == after != NONE:
                raise PtmcadError(
                    f"the pose was lost at {100 * done:.6g} % of the path, in the middle of a region"
                )
            why = walk.model.criterion.no_descent
            if own and not why:
                why = "the pose, which was not stable, vanishes or becomes one of another kind"
            if why:  # nothing is said about where it goes
                return steps, falls, f"{where} {why}"
            way = descent(lambda point, share=beyond: walk.at(share, point), at)  # type: ignore[misc]
            if (
                way is None
                or len(falls) == MAX_FALLS
                or not walk.at(beyond, way[-1][:, None]).counts.all()
            ):
                return (
                    steps,
                    falls,
                    f"{where} the pose vanishes, and no other was reached from there",
                )
            if (lengths := _lengths(way))[-1] > SLIP:
                fallen = _fallen(walk, beyond, way, np.linspace(0.0, lengths[-1], fall_frames))
                falls.append(_fall(beyond, fallen[0], fallen[-1]))
                steps += fallen
            at, done = way[-1], beyond
        steps.append(_taken(walk, stop, at))
    return steps, falls, ""


def _where(walk: Track, share: float) -> str:
    at = map(float, walk.place(share))
    return equalities(dict(zip(walk.slice.axis_names, at, strict=True)), "{:.6g}".format)


def _taken(walk: Track, stop: _Stop, at: Floats) -> Step:
    """The step with the pose, which has to be one of the solutions there."""
    share, step, solutions = stop
    if solutions is not None:
        gap = apart(solutions, at[:, None], len(walk.model.angles))
        if not np.abs(gap).max(axis=0).min(initial=np.inf) < SAME * (1 + np.abs(at).max()):
            raise PtmcadError(
                f"at {_where(walk, float(share))} the followed pose is none of those that are counted"
            )
    return _seen(walk, step, at)


def _seen(walk: Track, step: Step, at: Floats) -> Step:
    """The step with unknowns, and with what follows from them."""
    state = walk.state(step.at, at[:, None])
    height = None if state.height is None else float(state.height[0])
    points = tuple((float(x[0]), float(y[0])) for x, y in state.points.values())
    return replace(step, unknowns=tuple(map(float, at)), height=height, points=points)


def _lengths(way: Floats) -> Floats:
    """Of a way up to each of its points."""
    return np.append(0.0, np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1)))


def _fallen(walk: Track, share: float, way: Floats, places: Floats) -> list[Step]:
    """The steps of a fall, at these distances from its start."""
    point = walk.place(share)
    taken = np.array([np.interp(places, _lengths(way), along) for along in way.T]).T
    return [_seen(walk, Step(share, point, (), None, True), at) for at in taken]


def _fall(share: float, first: Step, last: Step) -> Fall:
    """A fall by its first step and its last one."""
    deep = (first.height or 0.0) - (last.height or 0.0)
    x, y = map(float, first.at)
    return Fall(share, (x, y), first.unknowns, last.unknowns, deep)
