"""Whether an answer to a stress case is right, and what double precision makes of the same question.

Guarantee: an answer is judged by what is known beforehand and by a second method; nothing of it is taken on trust.
``right`` means that the counts are those expected, that the second method found the same, and that every enclosed angle
contains the one to 100 digits.

The condition number of an equilibrium is S |H^-1|, the largest summand S of the gradient (a moment of a spring or a
load about a joint) over the smallest modulus of an eigenvalue of the Hessian H: when every summand changes by a small
share e, the pose turns by at most about 2 e S |H^-1| radians. A point's is the largest of its equilibria.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import groupby
from typing import Any

from flint import arb, ctx

from ptmcad.answer.intervals import CountIntervals, lower, upper
from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.studies.equilibria import IndexedPose, angle_error, scale
from ptmcad.studies.stress.case import Case, Question
from ptmcad.studies.stress.doubles import double_poses
from ptmcad.studies.stress.reference import newton_pose, sextic_poses
from ptmcad.text.balls import ball_of, exact
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.expressions import Expression

GRID = 16
"""Points along each axis of a map at which double precision is asked."""
STEPS = 200
"""Points along a line."""
_BITS = 512

Row = dict[str, Any]


def verdict(
    expected: str,
    found: str,
    double: str,
    remarks: Sequence[str],
    double_right: bool,
    error: float | None = None,
    double_error: float | None = None,
    condition: float | None = None,
    bits: int = 0,
) -> Row:
    """What came out of a case, without its cost; ``right`` says whether ptmcad's answer is, by all checks.

    Parameters
    ----------
    expected, found, double : the answers as text.
    remarks : what is not right of ptmcad's answer; a decided wrong one is as wrong as an undecided one.
    double_right : whether the double-precision method's answer is right.
    error : largest error of ptmcad's angles (the middles of its enclosures) in radians; for lines, of the ends relative
        to the window. None where nothing is compared.
    double_error : the same of the double-precision method, over the poses that it has; for maps the share of the
        grid's points with a wrong count.
    condition : see the module; None for maps and lines.
    bits : of precision that ptmcad needed; the largest over its stages.
    """
    return {
        "expected": expected, "found": found, "right": not remarks, "remarks": list(remarks), "double": double,
        "double_right": double_right, "error": error, "double_error": double_error, "condition": condition,
        "bits": bits,
    }  # fmt: skip


def judge(case: Case, found: Any) -> Row:
    """The verdict on an answer to the case.

    Raises
    ------
    TypeError
        When the answer is of another kind than the question.
    """
    kind = case.question.kind
    with ctx.workprec(_BITS):
        if kind == "point" and isinstance(found, Poses):
            return _judge_point(case, found)
        if kind == "line" and isinstance(found, CountIntervals):
            return _judge_line(case, found)
        if kind.endswith("map") and isinstance(found, RegionMap):
            return _judge_map(case, found)
    raise TypeError(f"{case.name}: the answer is of another kind than the question")


def _counts(poses: Sequence[Any] | None) -> tuple[int, int]:
    """How many poses there are, and how many stable ones; -1 where there is no answer."""
    return (-1, -1) if poses is None else (len(poses), sum(pose.index == 0 for pose in poses))


def _text(counts: Sequence[object]) -> str:
    return " ".join(map(str, counts))


def as_float(value: Fraction) -> float:
    """A rational as a float; infinite or zero beyond a float's range."""
    try:
        return float(value)
    except OverflowError:
        return float("inf") if value > 0 else float("-inf")


# ----------------------------------------------------------------------------------------------------------- points


def _judge_point(case: Case, found: Poses) -> Row:
    parameters, poses = case.question.parameters, found.equilibria
    double = double_poses(parameters)
    reference = _reference(case.question, found, double or ())
    text, known = (f"{total}/{stable}" for total, stable in ((len(poses), found.stable), _counts(reference)))
    remarks = []
    if found.status not in (Status.EXACT, Status.CERTIFIED):
        remarks.append(f"status {found.status.value}: {found.remark}")
    if text != known:
        remarks.append(f"the second method finds {known}")
    if case.expected not in ("", text):
        remarks.append(f"{text} equilibria and stable ones, but {case.expected} by construction")
    error = _error(found, reference)
    if error is None:
        remarks.append("an enclosure does not contain the reference to 100 digits")
    pose = case.pose or ()
    if pose and not any(all(e.low <= x <= e.high for e, x in zip(p.cosines_sines, pose, strict=True)) for p in poses):
        remarks.append("no pose is the one that was constructed")
    angles = [(float(r.th1.mid()), float(r.th2.mid())) for r in reference]
    errors = [
        min(max(angle_error(p.th1, a), angle_error(p.th2, b)) for a, b in angles) for p in double or () if angles
    ]  # fmt: skip
    smallest = min((abs(e.center) for pose in poses for e in pose.eigenvalues), default=Fraction(0))
    largest = Fraction(scale({name: float(value) for name, value in parameters.items()}))
    return verdict(
        expected=case.expected or known,
        found=text if poses else "undecided",
        double="none" if double is None else "/".join(map(str, _counts(double))),
        remarks=remarks,
        double_right=_counts(double) == _counts(reference),
        error=0.0 if error is None else as_float(error),
        double_error=max(errors, default=None),
        condition=as_float(largest / smallest) if smallest else None,
        bits=found.bits,
    )


def _reference(question: Question, found: Poses, double: Sequence[IndexedPose]) -> tuple[IndexedPose, ...]:
    """The equilibria to 100 digits; with free lengths those from the starts of either method, each proved anew."""
    if not question.has_free_lengths:
        return sextic_poses(question.parameters)
    starts = [(pose.th1, pose.th2) for pose in double]
    starts += [(float(pose.angles[0]), float(pose.angles[1])) for pose in found.equilibria]
    known: list[IndexedPose] = []
    for start in starts:
        pose = newton_pose(question.parameters, start)
        if pose is not None and not any(_apart((pose.th1, pose.th2), other).contains(0) for other in known):
            known.append(pose)
    return tuple(known)


def _apart(angles: Sequence[arb], pose: IndexedPose) -> arb:
    """The larger of the distances of two angles, on the unit circle."""
    chords = [abs(2 * ((a - b) / 2).sin()) for a, b in zip(angles, (pose.th1, pose.th2), strict=True)]
    return arb(chords[0].max(chords[1]))


def _error(found: Poses, reference: Sequence[IndexedPose]) -> Fraction | None:
    """The largest error of an angle; None unless each pose encloses one of the references, with its index."""
    left, largest = list(reference), Fraction(0)
    for pose in found.equilibria:
        inside = [r for r in left if r.index == pose.index and _apart([_ball(a) for a in pose.angles], r).contains(0)]
        if not inside:
            return None
        left.remove(inside[0])
        middles = [ball_of(angle.center) for angle in pose.angles]
        largest = max(largest, exact(_apart(middles, inside[0]).mid()))
    return None if left else largest


def _ball(enclosure: Enclosure) -> arb:
    return ball_of(enclosure.low).union(ball_of(enclosure.high))


# ------------------------------------------------------------------------------------------------------ maps, lines


def _judge_map(case: Case, found: RegionMap) -> Row:
    certified = case.question.tolerance is not None
    regions = sorted(r.stable for r in found.regions if r.stable is not None)
    # what a certified map leaves open may part a region
    stable = sorted(set(regions)) if certified else regions
    remarks = []
    if found.status not in (Status.EXACT, Status.CERTIFIED):
        remarks.append(f"status {found.status.value}")
    if _text(stable) != case.expected or len(regions) != len(found.regions):
        remarks.append(f"regions with {regions} stable equilibria, but {case.expected} are expected")
    if found.undetermined > (case.question.tolerance or 0):
        remarks.append("more is undetermined than was allowed")
    low, high = (sum((r.area[k] for r in found.regions if r.stable == 2), Fraction(0)) for k in (0, 1))
    (a, b), (c, d) = case.question.axes.values()
    high += found.undetermined * (b - a) * (d - c)  # which may belong to any region
    if case.area is not None and not (low <= case.area[1] and high >= case.area[0]):
        remarks.append(f"two are stable on an area of {as_float(low):.10g} to {as_float(high):.10g}")
    parameters = found.slice.parameters
    remarks += _contradicted(parameters, () if certified else [(r.sample, None, r.stable) for r in found.regions])
    places = [(x, y) for x in _middles(a, b, GRID) for y in _middles(c, d, GRID)]
    truths = [found.locate(**dict(zip(found.slice.axis_names, at, strict=True))).stable for at in places]
    decided = [(at, truth) for at, truth in zip(places, truths, strict=True) if truth is not None]
    counts = _by_doubles(parameters, [at for at, _ in decided])
    wrong, seen = sum(count != truth for count, (_, truth) in zip(counts, decided, strict=True)), set(counts)
    return verdict(
        expected=case.expected,
        found=_text(stable),
        double=_text(sorted(seen)),
        remarks=remarks,
        double_right=wrong == 0 and seen == set(stable),
        double_error=wrong / max(len(decided), 1),
        bits=max(found.precision.values(), default=0),
    )


def _contradicted(
    parameters: Mapping[str, Expression], samples: Iterable[tuple[Sequence[Fraction], int | None, int | None]]
) -> Iterator[str]:
    """What the second method finds elsewise: each sample has its place, its total, None for any, and stable count."""
    for at, total, stable in samples:
        known = _counts(sextic_poses(_values(parameters, at)))
        if stable != known[1] or total not in (None, known[0]):
            yield "the second method finds {}/{} at a sample".format(*known)


def _by_doubles(parameters: Mapping[str, Expression], places: Iterable[Sequence[Fraction]]) -> list[int]:
    """The stable counts of double precision at each of the places."""
    return [_counts(double_poses(_values(parameters, at)))[1] for at in places]


def _values(parameters: Mapping[str, Expression], at: Sequence[Fraction]) -> Mapping[str, Fraction]:
    return {name: e.evaluate(at[0], at[1]) for name, e in parameters.items()}


def _middles(low: Fraction, high: Fraction, number: int) -> list[Fraction]:
    """The middles of so many equal parts."""
    return [low + (high - low) * Fraction(2 * k + 1, 2 * number) for k in range(number)]


def _judge_line(case: Case, found: CountIntervals) -> Row:
    remarks, zero = [], Fraction(0)
    # neighbours that differ in the total alone are one interval of stable counts
    groups = [list(group) for _, group in groupby(found.intervals, lambda interval: interval.stable)]
    stable, ends = [group[0].stable for group in groups], [group[0].low for group in groups[1:]]
    if _text(stable) != case.expected:
        remarks.append(f"stable counts {stable}")
    elif not all(lower(e) <= high and upper(e) >= low for e, (low, high) in zip(ends, case.ends, strict=True)):
        remarks.append("an end is not where it should be")

    remarks += _contradicted(found.parameters, [((i.sample, zero), i.total, i.stable) for i in found.intervals])
    width = found.along.high - found.along.low
    places = _middles(found.along.low, found.along.high, STEPS)
    counts = zip(_by_doubles(found.parameters, [(x, zero) for x in places]), places, strict=True)
    runs = [next(group) for _, group in groupby(counts, lambda pair: pair[0])]
    double, changes = [count for count, _ in runs], [x - width / STEPS / 2 for _, x in runs[1:]]
    double_error = None
    if len(changes) == len(ends):
        middles = [(lower(e) + upper(e)) / 2 for e in ends]
        double_error = max((as_float(abs(a - b) / width) for a, b in zip(changes, middles, strict=True)), default=0.0)
    return verdict(
        expected=case.expected,
        found=_text(stable),
        double=_text(double),
        remarks=remarks,
        double_right=double == stable,
        error=max((as_float((upper(e) - lower(e)) / 2 / width) for e in ends), default=0.0),
        double_error=double_error,
    )
