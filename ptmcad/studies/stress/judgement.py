"""Whether an answer to a stress case is right, and what double precision makes of the same
question.

Guarantee: an answer is judged by what is known beforehand and by a second method; nothing of it is
taken on trust. ``right`` means that the counts are those expected, that the second method found the
same, and that every enclosed angle contains the one to 100 digits.

The condition number of an equilibrium is S |H^-1|, the largest summand S of the gradient (a moment
of a spring or a load about a joint) over the smallest modulus of an eigenvalue of the Hessian H:
when every summand changes by a small share e, the pose turns by at most about 2 e S |H^-1| radians.
A point's is the largest of its equilibria.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import groupby, product
from math import isfinite
from typing import Any

from flint import ctx

from ptmcad.answer.intervals import CountIntervals, lower, upper
from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.question.slice import Point
from ptmcad.studies.byhand import scale
from ptmcad.studies.stress.case import Case, free_lengths
from ptmcad.studies.stress.doubleprecision import (
    IndexedPose,
    apart,
    double_poses,
    proved_poses,
    sextic_poses,
)
from ptmcad.text.balls import ball_of, ball_over, exact
from ptmcad.text.expressions import Expression, values_at

GRID = 16
"""Points along each axis of a map at which double precision is asked."""
STEPS = 200
"""Points along a line."""
_BITS = 512
DECIDED = (Status.EXACT, Status.CERTIFIED)

Expressions = Mapping[str, Expression]
"""Of parameters, over a map's axes or along a line."""

Row = dict[str, Any]
"""What came out of a case.

- ``expected``, ``found``, ``double``: the answers as text.
- ``right``: whether ptmcad's answer is, by all checks; a decided wrong one is as wrong as an
  undecided one.
- ``remarks``: what is not right of it.
- ``double_right``: whether the double-precision method's answer is right.
- ``error``: largest error of ptmcad's angles (the middles of its enclosures) in radians; for lines,
  of the ends relative to the window. None where nothing is compared.
- ``double_error``: the same of the double-precision method, over the poses that it has; for maps
  the share of the grid's points with a wrong count.
- ``condition``: see the module; None for maps and lines.
- ``bits``: of precision that ptmcad needed; the largest over its stages.
"""


def judge(case: Case, found: Any) -> Row:
    """The verdict on an answer to the case, without its cost."""
    judgements: dict[str, Callable[[Case, Any], tuple[Checks, Row]]]
    judgements = {"point": _point, "line": _line}
    with ctx.workprec(_BITS):
        checks, row = judgements.get(case.question.kind, _map)(case, found)
    remarks = [remark for holds, remark in checks if not holds]
    known = {"expected": case.expected, "right": not remarks, "remarks": remarks}
    for name, x in row.items():
        if isinstance(x, float) and not isfinite(x):
            row[name] = None
    return {**known, "error": None, "condition": None, "bits": 0, **row}


Checks = list[tuple[bool, str]]
"""What has to hold, and what is remarked where it does not."""


def _stable(poses: Sequence[IndexedPose] | None) -> int:
    """How many poses are stable; -1 where there is no answer."""
    return -1 if poses is None else sum(index == 0 for *_, index in poses)


def counts_text(poses: Sequence[IndexedPose] | None) -> str:
    """How many poses there are, and how many stable ones."""
    return "none" if poses is None else f"{len(poses)}/{_stable(poses)}"


def _text(counts: Iterable[object]) -> str:
    return " ".join(map(str, counts))


# ----------------------------------------------------------------------------------------------------------- points


def _point(case: Case, found: Poses) -> tuple[Checks, Row]:
    parameters = case.question.parameters
    double = double_poses(parameters)
    ours = [_boxed(pose) for pose in found.equilibria]
    if free_lengths(parameters):
        known = proved_poses(parameters, [pose[:2] for pose in (*(double or ()), *ours)])
    else:
        known = sextic_poses(parameters)
    text, other, error = f"{len(ours)}/{found.stable}", counts_text(known), _error(ours, known)
    checks = [
        (found.status in DECIDED, f"status {found.status.value}: {found.remark}"),
        (text == other, f"the second method finds {other}"),
        (
            case.expected in ("", text),
            f"{text} equilibria and stable ones, but {case.expected} by construction",
        ),
        (error is not None, "an enclosure does not contain the reference to 100 digits"),
    ]
    errors = [min(float(apart(p, r).mid()) for r in known) for p in double or () if known]
    smallest = min(
        (abs(e.center) for p in found.equilibria for e in p.eigenvalues), default=Fraction(0)
    )
    largest = Fraction(scale({name: float(value) for name, value in parameters.items()}))
    return checks, {
        "expected": case.expected or other,
        "found": text if ours else "undecided",
        "double": counts_text(double),
        "double_right": counts_text(double) == other,
        "error": float(ball_of(error or Fraction(0))),
        "double_error": max(errors, default=None),
        "condition": float(ball_of(largest / smallest)) if smallest else None,
        "bits": found.bits,
    }


def _boxed(pose: Pose) -> IndexedPose:
    """A pose of ptmcad's with balls that hold its enclosures."""
    first, second = (ball_over(angle.low, angle.high) for angle in pose.angles)
    return first, second, -1 if pose.index is None else pose.index


def _error(found: Sequence[IndexedPose], reference: Sequence[IndexedPose]) -> Fraction | None:
    """The largest error of an angle; None unless each pose encloses one of the references, with its
    index.
    """
    left, largest = list(reference), Fraction(0)
    for pose in found:
        inside = [r for r in left if r[2] == pose[2] and apart(pose, r).contains(0)]
        if not inside:
            return None
        left.remove(inside[0])
        middle = pose[0].mid(), pose[1].mid(), pose[2]
        largest = max(largest, exact(apart(middle, inside[0]).mid()))
    return None if left else largest


# ------------------------------------------------------------------------------------------------------ maps, lines


def _map(case: Case, found: RegionMap) -> tuple[Checks, Row]:
    tolerance, parameters = case.question.tolerance, found.slice.parameters
    counts = [r.stable for r in found.regions]
    # what a certified map leaves open may part a region, and belong to any
    stable = sorted(counts if tolerance is None else set(counts), key=str)
    (a, b), (c, d) = case.question.axes.values()
    left = found.undetermined * (b - a) * (d - c)
    area = [sum((r.area[k] for r in found.regions if r.stable == 2), k * left) for k in (0, 1)]
    checks = [
        (found.status in DECIDED, f"status {found.status.value}"),
        (found.undetermined <= (tolerance or 0), "more is undetermined than was allowed"),
        *_expected(case, stable, [area] * len(case.bounds)),
    ]
    if tolerance is None:
        checks += [_confirmed(parameters, r.sample, r.stable) for r in found.regions]
    places = product(_middles(a, b), _middles(c, d))
    pairs = [
        (_double(parameters, at), found.locate(Point(found.slice.axis_names, *at)).stable)
        for at in places
    ]
    decided = [count == truth for count, truth in pairs if truth is not None]
    seen = sorted({count for count, truth in pairs if truth is not None})
    return checks, {
        "found": _text(stable),
        "double": _text(seen),
        "double_right": all(decided) and seen == sorted(set(stable), key=str),
        "double_error": decided.count(False) / max(len(decided), 1),
        "bits": max(found.precision.values(), default=0),
    }


def _line(case: Case, found: CountIntervals) -> tuple[Checks, Row]:
    parameters, low, high = found.parameters, found.along.low, found.along.high
    # neighbours that differ in the total alone are one interval of stable counts
    runs = [next(group) for _, group in groupby(found.intervals, lambda interval: interval.stable)]
    stable, ends = [i.stable for i in runs], [(lower(i.low), upper(i.low)) for i in runs[1:]]
    checks = [*_expected(case, stable, ends)]
    checks += [
        _confirmed(parameters, (i.sample, Fraction(0)), i.stable, i.total) for i in found.intervals
    ]
    counts = [(_double(parameters, (x, Fraction(0))), x) for x in _middles(low, high, STEPS)]
    changes = [next(group) for _, group in groupby(counts, lambda pair: pair[0])]
    double = [count for count, _ in changes]
    # a change is half a step before the first place behind it
    errors = [
        abs(x - (high - low) / STEPS / 2 - (a + b) / 2)
        for (_, x), (a, b) in zip(changes[1:], ends, strict=False)
    ]
    return checks, {
        "found": _text(stable),
        "double": _text(double),
        "double_right": double == stable,
        "error": float(max(((b - a) / 2 for a, b in ends), default=Fraction(0)) / (high - low)),
        "double_error": float(max(errors, default=Fraction(0)) / (high - low))
        if len(double) == len(runs)
        else None,
    }


def _expected(
    case: Case, stable: Sequence[int | None], numbers: Sequence[Sequence[Fraction]]
) -> Checks:
    """The counts and the enclosed numbers against those that are known."""
    met = len(numbers) == len(case.bounds) and all(
        low <= most and high >= least
        for (low, high), (least, most) in zip(numbers, case.bounds, strict=True)
    )
    shown = "; ".join(
        f"{float(ball_of(low)):.10g} to {float(ball_of(high)):.10g}" for low, high in numbers
    )
    text, expected = _text(stable), case.expected
    return [
        (text == expected, f"stable counts {text}, but {expected} are expected"),
        (
            met,
            f"the ends, or the area on which two are stable, are not where they should be: {shown}",
        ),
    ]


def _confirmed(
    parameters: Expressions, at: Sequence[Fraction], stable: int | None, total: int | None = None
) -> tuple[bool, str]:
    """Whether the second method finds as many at a sample; a total is compared where it is given."""
    known = sextic_poses(values_at(parameters, *at))
    right = stable == _stable(known) and total in (None, len(known))
    return right, f"the second method finds {counts_text(known)} at a sample"


def _double(parameters: Expressions, at: Sequence[Fraction]) -> int:
    """The stable count of double precision at a place."""
    return _stable(double_poses(values_at(parameters, *at)))


def _middles(low: Fraction, high: Fraction, number: int = GRID) -> list[Fraction]:
    """The middles of so many equal parts."""
    return [low + (high - low) * Fraction(2 * k + 1, 2 * number) for k in range(number)]
