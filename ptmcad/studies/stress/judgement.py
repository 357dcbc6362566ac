"""Whether an answer to a stress case is right, and what double precision makes of the same question.

Guarantee: an answer is judged by what is known beforehand and by a second method; nothing of it is taken on trust.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from flint import arb

from ptmcad.answer.intervals import CountIntervals, lower, upper
from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.mechanism import ptm
from ptmcad.question.slice import Slice
from ptmcad.studies.equilibria import IndexedPose, angle_error, scale
from ptmcad.studies.stress.case import Case, LineAnswer, MapAnswer, PointAnswer, PointQuestion, SliceQuestion
from ptmcad.studies.stress.doubles import double_poses
from ptmcad.studies.stress.measure import Verdict, as_float
from ptmcad.studies.stress.reference import newton_pose, sextic_poses
from ptmcad.text.balls import exact
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.flint_numbers import from_fraction

GRID = 16
"""Points along each axis of a map at which double precision is asked."""
STEPS = 200
"""Points along a line."""


def judge(case: Case, found: Any) -> Verdict:
    """The verdict on an answer to the case."""
    if isinstance(case.question, PointQuestion) and isinstance(case.expected, PointAnswer):
        return _judge_point(case.question, case.expected, found)
    if isinstance(case.question, SliceQuestion) and isinstance(case.expected, LineAnswer) and case.question.along:
        return _judge_line(case.expected, found)
    if isinstance(case.question, SliceQuestion) and isinstance(case.expected, MapAnswer):
        return _judge_map(case.question, case.expected, found)
    raise TypeError(f"{case.name}: the expected answer is of another kind than the question")


def _counts(poses: Sequence[IndexedPose]) -> tuple[int, int]:
    """How many poses there are, and how many stable ones."""
    return len(poses), sum(pose.index == 0 for pose in poses)


def counts_text(total: int | None, stable: int | None) -> str:
    """Such as ``6/2``: equilibria and stable ones."""
    return f"{'?' if total is None else total}/{'?' if stable is None else stable}"


# ----------------------------------------------------------------------------------------------------------- points


def _judge_point(question: PointQuestion, expected: PointAnswer, found: Poses) -> Verdict:
    parameters = dict(question.parameters)
    double = double_poses(parameters)
    reference = _reference(parameters, found, double or ())
    total, stable = len(found.equilibria), found.stable
    known, seen = _counts(reference), _counts(double or ())
    remarks = []
    if found.status not in (Status.EXACT, Status.CERTIFIED):
        remarks.append(f"status {found.status.value}: {found.remark}")
    if (total, stable) != known:
        remarks.append(f"the second method finds {counts_text(*known)}")
    for name, mine, its in (("total", total, expected.total), ("stable", stable, expected.stable)):
        if its is not None and mine != its:
            remarks.append(f"{name} {mine}, but {its} by construction")
    error = Fraction(0)
    matched = _matched(found.equilibria, reference)
    if matched is None:
        remarks.append("an enclosure does not contain the reference to 100 digits")
    else:
        error = max((_distance(p, r) for p, r in matched), default=Fraction(0))
    if expected.pose is not None and not any(_holds(pose, expected.pose) for pose in found.equilibria):
        remarks.append("no pose is the one that was constructed")
    return Verdict(
        expected=counts_text(*(known if expected.total is None else (expected.total, expected.stable))),
        found=counts_text(total, stable) if found.equilibria else "undecided",
        double="none" if double is None else counts_text(*seen),
        remarks=tuple(remarks),
        double_right=double is not None and seen == known,
        error=as_float(error),
        double_error=_double_error(double or (), reference),
        condition=_condition(parameters, found.equilibria),
        bits=found.bits,
    )


def _reference(parameters: dict[str, Fraction], found: Poses, double: Sequence[IndexedPose]) -> tuple[IndexedPose, ...]:
    """The equilibria to 100 digits; with free lengths those from the starts of either method, each proved anew."""
    if not any(parameters.get(name) for name in ptm().free_lengths):
        return sextic_poses(parameters)
    starts = [(pose.th1, pose.th2) for pose in double]
    starts += [(float(pose.angles[0]), float(pose.angles[1])) for pose in found.equilibria]
    known: list[IndexedPose] = []
    for start in starts:
        pose = newton_pose(parameters, start)
        if pose is not None and not any(_overlap(pose, other) for other in known):
            known.append(pose)
    return tuple(known)


def _overlap(a: IndexedPose, b: IndexedPose) -> bool:
    turn = 2 * arb.pi()
    return all(
        any(bool((x - y + n * turn).contains(0)) for n in (-1, 0, 1)) for x, y in ((a.th1, b.th1), (a.th2, b.th2))
    )


def _matched(poses: Sequence[Pose], reference: Sequence[IndexedPose]) -> list[tuple[Pose, IndexedPose]] | None:
    """Each pose with the reference that lies in its enclosures and has its index; None when some has none."""
    left = list(reference)
    pairs = []
    for pose in poses:
        inside = [r for r in left if r.index == pose.index and _contains(pose.angles[0], r.th1)
                  and _contains(pose.angles[1], r.th2)]  # fmt: skip
        if not inside:
            return None
        left.remove(inside[0])
        pairs.append((pose, inside[0]))
    return None if left else pairs


def _contains(enclosure: Enclosure, angle: arb) -> bool:
    """Whether the enclosure meets the ball, which is narrower by tens of digits, modulo full turns."""
    return any(
        not (moved < from_fraction(enclosure.low) or moved > from_fraction(enclosure.high))
        for moved in (angle + n * 2 * arb.pi() for n in (-1, 0, 1))
    )


def _distance(pose: Pose, reference: IndexedPose) -> Fraction:
    """The largest error of an angle, between the enclosure's middle and the reference."""
    turn = exact((2 * arb.pi()).mid())
    return max(
        min(abs(enclosure.center - exact(angle.mid()) + n * turn) for n in (-1, 0, 1))
        for enclosure, angle in zip(pose.angles, (reference.th1, reference.th2), strict=True)
    )


def _holds(pose: Pose, known: Sequence[Fraction]) -> bool:
    return all(e.low <= value <= e.high for e, value in zip(pose.cosines_sines, known, strict=True))


def _double_error(double: Sequence[IndexedPose], reference: Sequence[IndexedPose]) -> float | None:
    """The largest distance of a pose in double precision to the nearest equilibrium; None without any."""
    angles = [(float(r.th1.mid()), float(r.th2.mid())) for r in reference]
    if not double or not angles:
        return None
    return max(min(max(angle_error(p.th1, a), angle_error(p.th2, b)) for a, b in angles) for p in double)


def _condition(parameters: dict[str, Fraction], poses: Sequence[Pose]) -> float | None:
    """The largest condition number, as the module `ptmcad.studies.stress.measure` defines it."""
    largest = Fraction(scale({name: float(value) for name, value in parameters.items()}))
    smallest = min((abs(e.center) for pose in poses for e in pose.eigenvalues), default=Fraction(0))
    return as_float(largest / smallest) if smallest else None


# ------------------------------------------------------------------------------------------------------ maps, lines


def _judge_map(question: SliceQuestion, expected: MapAnswer, found: RegionMap) -> Verdict:
    certified = question.tolerance is not None
    stable = sorted(r.stable for r in found.regions if r.stable is not None)
    remarks = []
    if found.status not in (Status.EXACT, Status.CERTIFIED):
        remarks.append(f"status {found.status.value}")
    same = set(stable) == set(expected.stable) if certified else tuple(stable) == expected.stable
    if not same or len(stable) != len(found.regions):
        remarks.append(f"regions with {stable} stable equilibria, but {list(expected.stable)} are expected")
    if certified and found.undetermined > (question.tolerance or 0):
        remarks.append("more is undetermined than was allowed")
    low, high = (sum((r.area[k] for r in found.regions if r.stable == 2), Fraction(0)) for k in (0, 1))
    if certified:  # what is left open may belong to any region
        (a, b), (c, d) = question.axes.values()
        high += found.undetermined * (b - a) * (d - c)
    if expected.area_of_two and not (low <= expected.area_of_two[1] and high >= expected.area_of_two[0]):
        remarks.append(f"two are stable on an area of {as_float(low):.10g} to {as_float(high):.10g}")
    for region in found.regions if not certified else ():
        known = _counts_of(found.slice, region.sample)
        if known[1] != region.stable:
            remarks.append(f"the second method finds {known[1]} stable at a region's sample")
    wrong, seen = _double_on_grid(found)
    return Verdict(
        expected=" ".join(map(str, expected.stable)),
        found=" ".join(map(str, stable)) if not certified else " ".join(map(str, sorted(set(stable)))),
        double=" ".join(map(str, sorted(seen))),
        remarks=tuple(remarks),
        double_right=wrong == 0 and seen == set(stable),
        double_error=wrong,
        bits=max(found.precision.values(), default=0),
    )


def _values(slice: Slice, x: Fraction, y: Fraction) -> dict[str, Fraction]:
    return {name: expression.evaluate(x, y) for name, expression in slice.parameters.items()}


def _counts_of(slice: Slice, at: Sequence[Fraction]) -> tuple[int, int]:
    return _counts(sextic_poses(_values(slice, at[0], at[1])))


def _double_on_grid(found: RegionMap) -> tuple[float, set[int]]:
    """The share of a grid's decided points with another stable count in double precision, and the counts it has."""
    x, y = found.slice.axes
    wrong = decided = 0
    seen: set[int] = set()
    for i in range(GRID):
        for k in range(GRID):
            at = (x.low + (x.high - x.low) * Fraction(2 * i + 1, 2 * GRID),
                  y.low + (y.high - y.low) * Fraction(2 * k + 1, 2 * GRID))  # fmt: skip
            truth = found.locate(**dict(zip(found.slice.axis_names, at, strict=True)))
            if truth.stable is None:
                continue
            double = double_poses(_values(found.slice, *at))
            count = -1 if double is None else _counts(double)[1]
            seen.add(count)
            decided += 1
            wrong += count != truth.stable
    return wrong / max(decided, 1), seen


def _judge_line(expected: LineAnswer, found: CountIntervals) -> Verdict:
    remarks = []
    # neighbours that differ in the total alone are one interval of stable counts
    joined = [found.intervals[0]]
    ends = []
    for interval in found.intervals[1:]:
        if interval.stable != joined[-1].stable:
            ends.append(interval.low)
            joined.append(interval)
    stable = tuple(interval.stable for interval in joined)
    if stable != expected.stable:
        remarks.append(f"stable counts {stable}")
    elif not all(lower(e) <= high and upper(e) >= low for e, (low, high) in zip(ends, expected.ends, strict=True)):
        remarks.append("an end is not where it should be")
    width = found.along.high - found.along.low
    for interval in found.intervals:
        values = {name: e.evaluate(interval.sample, Fraction(0)) for name, e in found.parameters.items()}
        if _counts(sextic_poses(values)) != (interval.total, interval.stable):
            remarks.append("the second method finds other counts at an interval's sample")
    double, changes = _double_on_line(found)
    middles = [(lower(e) + upper(e)) / 2 for e in ends]
    double_error = None
    if len(changes) == len(middles):
        double_error = max((as_float(abs(a - b) / width) for a, b in zip(changes, middles, strict=True)), default=0.0)
    error = max((as_float((upper(e) - lower(e)) / 2 / width) for e in ends), default=0.0)
    return Verdict(
        expected=" ".join(map(str, expected.stable)),
        found=" ".join(map(str, stable)),
        double=" ".join(map(str, double)),
        remarks=tuple(remarks),
        double_right=double == stable,
        error=error,
        double_error=double_error,
    )


def _double_on_line(found: CountIntervals) -> tuple[tuple[int, ...], list[Fraction]]:
    """Stable counts that double precision sees along a line in their order, and where they change, half a step off."""
    along = found.along
    step = (along.high - along.low) / STEPS
    counts: list[int] = []
    changes = []
    for k in range(STEPS):
        at = along.low + step * Fraction(2 * k + 1, 2)
        poses = double_poses({name: e.evaluate(at, Fraction(0)) for name, e in found.parameters.items()})
        count = -1 if poses is None else _counts(poses)[1]
        if counts and counts[-1] == count:
            continue
        if counts:
            changes.append(at - step / 2)
        counts.append(count)
    return tuple(counts), changes
