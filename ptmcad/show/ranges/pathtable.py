"""Paths of stable poses, and branches of solutions along a line, as text for the terminal.

Guarantee: every digit that is shown is right.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb, ctx

from ptmcad.answer.paths import (
    Branch,
    Branches,
    BranchPoint,
    Fate,
    PathEnd,
    PathPoint,
    PosePath,
    PosePaths,
    Target,
)
from ptmcad.answer.words import assignments, followed, listed, noun, with_article
from ptmcad.model import Model, built_in
from ptmcad.model.work import acting
from ptmcad.show.ranges.endtext import end_text, known, narrowly_known
from ptmcad.show.table import aligned
from ptmcad.show.units import with_unit
from ptmcad.text.balls import ball_over, enclosure_of
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import equalities, shortest_text

_ANGLE_DIGITS = 8
UNDECIDED = "undecided"
BRANCH_DIGITS = 6


def kind(branch: Branch, model: Model) -> str:
    """What the solutions of a branch are called: stable, saddle, maximum, unstable, or by the
    model's noun.
    """
    return model.criterion.kind(branch.stable, branch.index).replace("solution", noun(model, 1))


def branch_table(found: Branches) -> str:
    """One row for each branch: where it begins and ends, and the quantities there."""
    heads = [with_unit(*pair) for pair in zip(found.quantities, found.units, strict=True)]
    rows = [["from", "to", "kind", *heads]]
    for branch in found.branches:
        first, last = branch.points[0], branch.points[-1]
        numbers = zip(first.numbers, last.numbers, strict=True)
        changes = [f"{_text(a)} to {_text(b)}" for a, b in numbers]
        rows.append([_short(first), _short(last), kind(branch, found.model), *changes])
    where = f"{found.along.name} at {equalities(found.at, shortest_text)}"
    lines = [f"branches along {where}, without the last 1/100000 before critical values", ""]
    lines += aligned(rows)
    if found.undecided:
        lines += [
            "",
            f"not all solutions could be separated at {len(found.undecided)} of the values tried",
        ]
    return "\n".join(lines)


def _short(point: BranchPoint) -> str:
    return f"{float(point.value):.6g}"


def _text(number: Enclosure | None) -> str:
    return "-" if number is None else known(number, BRANCH_DIGITS)


def path_table(found: PosePaths, digits: int = _ANGLE_DIGITS) -> str:
    """What becomes of each pose in both directions."""
    name, model = found.along.name, found.model
    lines = []
    for path in found.paths:
        place = next(p for p in path.points if p.value == path.start)
        heights = _heights(model)
        side = f"; {_side(path, heights)} on the path" if heights else ""
        at = f"{name} = {shortest_text(path.start)}"
        lines.append(
            f"{model.nouns.pose} {path.number} at {at}: {_unknowns(place, model, digits)}{side}"
        )
        ends = (("down", path.low), ("up", path.high))
        lines += [f"  {direction}: {_end(e, found, digits)}" for direction, e in ends]
    return (
        "\n".join(lines)
        if lines
        else f"no {followed(model)} at {name} = {shortest_text(found.start)}"
    )


def _heights(model: Model) -> list[str]:
    """What the heights of the moving points are called, such as y3 of A3; none of a system."""
    own = model.name in built_in()  # whose points are numbered
    rising = () if model.drawable is None else model.drawable.rising
    return [f"y{name[1:]}" if own and name[1:].isdigit() else f"y of {name}" for name in rising]


def _side(path: PosePath, heights: Sequence[str]) -> str:
    if path.upright or path.reverse:
        return " and ".join(_signed(heights, ">" if path.upright else "<"))
    return (
        f"{', '.join(heights)} of mixed sign"
        if len(heights) > 1
        else f"{heights[0]} of either sign"
    )


def _signed(heights: Sequence[str], sign: str) -> list[str]:
    return [f"{y} {sign} 0" for y in heights]


def _end(end: PathEnd, found: PosePaths, digits: int) -> str:
    name, model = found.along.name, found.model
    at = f"{name} = {end_text(end.at, 10)}"
    if end.fate is Fate.WINDOW:
        return f"{model.criterion.adjective or 'goes on '}up to the window's edge {at}"
    if end.fate in (Fate.UNSTABLE, Fate.EXCLUDED):
        return f"{at}: {end.fate.value}"
    if end.fate is Fate.UNDECIDED:
        return f"could not be followed beyond {name} = {shortest_text(end.last.value)}, before {at}"
    what = f"{at}: {_event(end, model)}"
    if end.target is None:
        rests = (
            f"under the {acting(model, found.moved)} it may never come to rest: "
            if found.moved
            else ""
        )
        unsaid = model.criterion.no_target
        return f"{what}; {rests}{unsaid}" if unsaid else what
    target = _unknowns(end.target, model, digits)
    if end.fate is Fate.MERGE:
        return f"{what}; the pose goes on, without a snap, as {target}"
    drop = None
    if end.energy is not None and end.target_energy is not None:
        drop = Enclosure(
            end.energy.low - end.target_energy.high, end.energy.high - end.target_energy.low
        ).settled_text(5)
    heights = _heights(model)
    kind = f" ({_posture(end.target, heights)})" if heights else ""
    lower = drop or "an undecided amount"
    snaps = (
        f"{what}; {model.nouns.whole} snaps to {target}{kind}, where the energy is lower by {lower}"
    )
    chosen = ", which of several stable ones steepest descent in floating point chose"
    return snaps + chosen * end.fallen


def _event(end: PathEnd, model: Model) -> str:
    """What becomes of the pose that was followed, and of those that it meets."""
    what = f"the {followed(model)}"
    others = [_kind(k, model) for k in end.meeting[1:]]
    left = listed([_kind(k, model) for k in end.leaving]) or "nothing"
    if not others:
        return f"{what} goes on as {left}" if end.leaving else f"{what} vanishes alone"
    if end.among:
        return f"{what} meets one or more of {listed(others)} and vanishes"
    merges = f"{what} merges with {listed(others)}"
    if not end.leaving:
        return f"fold: {merges} and both vanish" if len(others) == 1 else f"{merges} and all vanish"
    return f"{merges}, which leaves {left}"


def _kind(negative: int, model: Model) -> str:
    """A solution by its Morse index; without a potential by whether it is stable."""
    return with_article(model.criterion.ranked(negative, noun(model, 1)))


def _posture(point: Target, heights: Sequence[str]) -> str:
    """The signs of the moving points' heights, such as y3 and y4."""
    if set(point.sides) == {1}:
        return ", ".join(_signed(heights, ">"))
    if set(point.sides) == {-1}:
        return "reverse: " + ", ".join(_signed(heights, "<"))
    return (
        f"{', '.join(heights)} of mixed sign or zero"
        if len(heights) > 1
        else f"{heights[0]} near zero"
    )


def _unknowns(point: PathPoint | Target, model: Model, digits: int) -> str:
    angles = (degrees(angle, digits) for angle in point.angles)
    reals = (narrowly_known(x, digits) or UNDECIDED for x in point.reals)
    return ", ".join(assignments(model, angles, reals))


def degrees(angle: Enclosure, digits: int) -> str:
    """An angle in degrees, with as many digits as are settled; zero where it cannot be
    distinguished from it.
    """
    with ctx.workprec(200):
        ball = ball_over(angle.low, angle.high) * 180 / arb.pi()
        text = narrowly_known(enclosure_of(ball), digits)
    return UNDECIDED if text is None else f"{text}°"
