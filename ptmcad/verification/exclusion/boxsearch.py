"""Boxes of the window and of configurations: which of them have no zero of a system outside of the
pieces. Compiled.

Guarantee: a box that is called `GONE` has none: no critical point, or no solution, as the system
has it. What is tried, in this order: the formulas' values; the mean value theorem; the linearised
equations, multiplied by a matrix that solves them in the middle of the box, of which each leaves an
interval for the variable that it is solved for (Hansen and Sengupta); whether the pieces hold the
rectangle around what is left; and whether they hold the strip that the row of one axis leaves next
to the other axis.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ptmcad.verification.exclusion.arithmetic import compiled, inlined
from ptmcad.verification.exclusion.forms import CENTER, ERROR, HIGH, LOW, WIDTH, evaluate
from ptmcad.verification.exclusion.holding import holds

GONE, HALVED, STUCK = range(3)
"""Of a box: it has no critical point outside of the pieces; its halves are to be looked at; it is
as small as is asked for."""
_ROUNDS = 3
_WORTHWHILE = 0.75
"""Another round is made where a side of the box became smaller than this share of it."""
_MAX_SLOPE = 1e100
_ROUNDING = 2.0**-49
_WIDTH_WEIGHT = 0.6
"""Weight of a side's width, against the change of the equations along it, in the choice of the
variable to bisect.
"""
_FLAT = 2.0**-60
"""Share of the window: a rectangle that is flatter, as those that are drawn to the window's edge,
is not halved.
"""
_MIN_RATIO = 0.5
"""Of a slope to the error of its row: rows with less are not solved."""
_MIN_SHARE = 0.1
"""Of a slope in all that a row has: variables with less are not narrowed by it."""


@compiled
def look(system: Any, pieces: Any, boxes: Any, outcome: Any, rest: Any, exclusions: Any) -> None:
    """Treat boxes one by one.

    Parameters
    ----------
    system : `ptmcad.verification.exclusion.systemtapes.Compiled`.
    boxes : (number, variables, 2), made smaller.
    outcome : (number,), as above.
    rest : (number, variables, 2), the second halves of those that are `HALVED`; `boxes` has the
        first ones.
    exclusions : (formulas), those that are zero and then those that are not negative: the number of
        boxes that each of them excludes is added.
    """
    room = _room(system, boxes.shape[1])
    for n in range(len(boxes)):
        box = boxes[n]
        outcome[n], k, half = _treated(system, pieces, box, room, exclusions)
        if outcome[n] == HALVED:
            rest[n] = box
            rest[n, k, 0] = half
            box[k, 1] = half


@compiled
def _room(system: Any, nv: int) -> Any:
    """Arrays for the forms of all operations, the rows of those that are asked for, and what these
    are solved for.
    """
    number = len(system.zero) + len(system.not_negative)
    return (
        np.empty((len(system.tape.code), WIDTH)),
        np.empty((number, nv + 2)),
        np.empty(number, dtype=np.int64),
    )


@compiled
def _treated(system: Any, pieces: Any, box: Any, room: Any, exclusions: Any) -> Any:
    """What becomes of one box; and if it is halved, the variable along which it is, and where."""
    outcome = _look_at(system, pieces, box, room, exclusions)
    if outcome != HALVED:
        return outcome, -1, 0.0
    k = _widest(system, room[0], box)
    half = 0.5 * (box[k, 0] + box[k, 1])
    return HALVED if k >= 0 and box[k, 0] < half < box[k, 1] else STUCK, k, half


@compiled
def isolate(system: Any, pieces: Any, boxes: Any, budget: int) -> int:
    """Look at one box and its parts, the youngest first, until none waits or so many were looked
    at.

    Parameters
    ----------
    boxes : (most, variables, 2), of which the first one is the box; at the end those that are left
        come first.

    Returns
    -------
    The number of boxes that are left. All solutions in the box are in them.
    """
    most, nv = boxes.shape[0], boxes.shape[1]
    room = _room(system, nv)
    exclusions, box = np.zeros(len(room[1])), np.empty((nv, 2))
    stuck, waiting = 0, 1  # those that are stuck come first, then those that wait
    for _ in range(budget):
        if waiting == 0 or stuck + waiting == most:
            break
        waiting -= 1
        box[:] = boxes[stuck + waiting]
        outcome, k, half = _treated(system, pieces, box, room, exclusions)
        if outcome == HALVED:
            for side in range(2):
                boxes[stuck + waiting] = box
                boxes[stuck + waiting, k, 1 - side] = half
                waiting += 1
        elif outcome == STUCK:
            boxes[stuck + waiting] = boxes[stuck]
            boxes[stuck] = box
            stuck += 1
    return stuck + waiting


@compiled
def _look_at(system: Any, pieces: Any, box: Any, room: Any, exclusions: Any) -> int:
    """What becomes of one box, if it can be halved."""
    forms, rows, solved_for = room
    nv, tape = box.shape[0], system.tape
    before = np.empty((nv, 2))
    for _ in range(_ROUNDS):
        evaluate(tape, box, forms, 0, system.first)
        if _excluding(system.zero[: system.early], forms, False) >= 0:
            return GONE
        evaluate(tape, box, forms, system.first, len(tape.code))
        excluding = _excluding(system.zero, forms, False)
        if excluding < 0:
            excluding = _excluding(system.not_negative, forms, True)
            excluding += len(system.zero) if excluding >= 0 else 0
        if excluding >= 0:
            exclusions[excluding] += 1
            return GONE
        before[:] = box
        number = _eliminated(system, forms, nv, rows, solved_for)
        gained = _narrowed(system, number, box, before, rows)
        if gained < 0:
            return GONE
        if gained > _WORTHWHILE:
            break
    if _rectangle_held(pieces, box):
        return GONE
    for row in range(len(system.zero)):
        if 0 <= solved_for[row] < 2 and _strip_held(
            pieces, box, before, rows[row], solved_for[row]
        ):
            return GONE
    if (
        system.halved == 0
        and min(box[0, 1] - box[0, 0], box[1, 1] - box[1, 0]) < _FLAT * pieces.steps
    ):
        return STUCK
    for j in range(nv):
        if not box[j, 1] - box[j, 0] < system.least[j]:
            return HALVED
    return STUCK


@compiled
def _excluding(which: Any, forms: Any, above: bool) -> int:
    """The first of some formulas that is not zero, or that is negative where it may be ``above``;
    -1 where none is.
    """
    for k in range(len(which)):
        n = which[k]
        if forms[n, HIGH] < 0 or (not above and forms[n, LOW] > 0):
            return k
    return -1


@compiled
def _eliminated(system: Any, forms: Any, nv: int, rows: Any, solved_for: Any) -> int:
    """Gauss and Jordan's elimination of the affine forms: of those that are zero first, of all
    others with them.

    At a critical point a form is zero for some error, and so is any combination of forms for some
    combination of the errors. The next row is the one with the largest slope as a share of its
    error. Rounding is added to errors.

    Returns
    -------
    The number of rows. Row k is solved for ``solved_for[k]``, -1 for none.
    """
    zeros, number = len(system.zero), len(system.zero) + len(system.not_negative)
    for i in range(number):
        n = system.zero[i] if i < zeros else system.not_negative[i - zeros]
        solved_for[i] = -1
        for j in range(nv):
            rows[i, j] = forms[n, j]
        rows[i, nv], rows[i, nv + 1] = forms[n, CENTER], forms[n, ERROR]
    for _ in range(nv - 1):
        row, column, best = -1, -1, _MIN_RATIO
        for i in range(zeros):
            if solved_for[i] < 0 and rows[i, nv + 1] < _MAX_SLOPE:
                for j in range(nv):
                    ratio = abs(rows[i, j]) / (rows[i, nv + 1] + 1e-100)
                    if ratio > best:
                        row, column, best = i, j, ratio
        if row < 0:
            break
        solved_for[row] = column
        for i in range(number):
            if i != row and rows[i, column] != 0.0 and rows[i, nv + 1] < _MAX_SLOPE:
                factor, size = rows[i, column] / rows[row, column], 0.0
                for j in range(nv + 1):
                    part = factor * rows[row, j]
                    size += abs(part) + abs(rows[i, j])
                    rows[i, j] -= part
                rows[i, nv + 1] += abs(factor) * rows[row, nv + 1]
                rows[i, nv + 1] = rows[i, nv + 1] * (1 + _ROUNDING) + size * _ROUNDING
    return number


@compiled
def _narrowed(system: Any, number: int, box: Any, before: Any, rows: Any) -> float:
    """The largest share to which a row has made a side smaller; -1 where nothing is left."""
    nv, zeros = box.shape[0], len(system.zero)
    low, high = np.full(nv, -1.0), np.full(nv, 1.0)
    for k in range(number):
        if not rows[k, nv + 1] < _MAX_SLOPE:
            continue
        total = rows[k, nv + 1]
        for j in range(nv):
            total += abs(rows[k, j])
        total = total * (1 + _ROUNDING) + _ROUNDING * abs(rows[k, nv])
        if rows[k, nv] + total < 0 or (k < zeros and rows[k, nv] - total > 0):
            return -1.0
        for j in range(nv):
            slope = rows[k, j]
            # what the others can do at most; where this variable alone can do as much, nothing is
            # gained
            rest = total - abs(slope)
            if not abs(slope) > _MIN_SHARE * total:
                continue
            center, reach = -rows[k, nv] / slope, rest / abs(slope) * (1 + _ROUNDING)
            reach += _ROUNDING * (1 + abs(center))
            if k < zeros or slope > 0:
                low[j] = max(low[j], center - reach)
            if k < zeros or slope < 0:
                high[j] = min(high[j], center + reach)
    gained = 1.0
    for j in range(nv):
        if low[j] > high[j]:
            return -1.0
        if high[j] - low[j] < 2.0:
            at, half = _middle_of(before[j])
            lost = _ROUNDING * (abs(at) + half)
            box[j, 0] = max(before[j, 0], at + half * low[j] - lost)
            box[j, 1] = min(before[j, 1], at + half * high[j] + lost)
            gained = min(gained, 0.5 * (high[j] - low[j]))
            if box[j, 0] > box[j, 1]:
                return -1.0
    return gained


@inlined
def _middle_of(side: Any) -> Any:
    """Of an interval, and half its width."""
    return 0.5 * (side[0] + side[1]), 0.5 * (side[1] - side[0])


@compiled
def _rectangle_held(pieces: Any, box: Any) -> bool:
    (left, right), (bottom, top) = box[0], box[1]
    return bool(
        holds(pieces, 0, np.array((left, right, left, bottom, 0.0, 0.0, top - bottom, bottom, top)))
    )


@compiled
def _strip_held(pieces: Any, box: Any, before: Any, row: Any, v: int) -> bool:
    """Whether the pieces hold the strip over one axis that a row, solved for the other one, leaves."""
    nv, u = box.shape[0], 1 - v
    pivot, reach = row[v], row[nv + 1]
    for j in range(2, nv):
        reach += abs(row[j])
    at_u, half_u = _middle_of(before[u])
    at_v, half_v = _middle_of(before[v])
    if not (half_u > 0 and abs(pivot) > 0):
        return False
    slope = -row[u] / pivot * (half_v / half_u)
    reach = reach / abs(pivot) * half_v * (1 + 8 * _ROUNDING) + 8 * _ROUNDING * half_v
    middle = at_v - row[nv] / pivot * half_v
    if not (reach < half_v and abs(slope) < _MAX_SLOPE):
        return False
    (a, b), (least, most) = box[u], box[v]
    return bool(holds(pieces, u, np.array((a, b, at_u, middle, slope, -reach, reach, least, most))))


@compiled
def _widest(system: Any, forms: Any, box: Any) -> int:
    """The variable whose side changes the equations most, as a share; -1 where no side can be
    halved.
    """
    nv, m = box.shape[0], len(system.measured)
    shares = np.zeros(nv)
    for n in system.measured:
        total = forms[n, ERROR]
        for j in range(nv):
            total += abs(forms[n, j])
        if 0 < total < _MAX_SLOPE:
            for j in range(nv):
                shares[j] += abs(forms[n, j]) / total
    best, most = -1, 0.0
    for j in range(system.halved, nv):
        share = (1 - _WIDTH_WEIGHT) * shares[j] / m + _WIDTH_WEIGHT * (
            box[j, 1] - box[j, 0]
        ) / system.units[j]
        if share > most:
            best, most = j, share
    return best


@compiled
def spread(boxes: Any, steps: float, grid: Any) -> None:
    """Add up in a grid of squares the areas of boxes' rectangles, as shares of the square."""
    side = grid.shape[0]
    scale = side / steps
    for n in range(len(boxes)):
        a, b, c, d = (
            boxes[n, 0, 0] * scale,
            boxes[n, 0, 1] * scale,
            boxes[n, 1, 0] * scale,
            boxes[n, 1, 1] * scale,
        )
        for i in range(int(max(a, 0.0)), int(min(b, side - 1.0)) + 1):
            for j in range(int(max(c, 0.0)), int(min(d, side - 1.0)) + 1):
                grid[i, j] += max(0.0, min(b, i + 1.0) - max(a, i)) * max(
                    0.0, min(d, j + 1.0) - max(c, j)
                )
