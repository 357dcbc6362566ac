"""Which solutions meet where a branch ends: those in a region that no solution enters or leaves
meanwhile.

Guarantee: of the solutions on both sides of a critical value those that are bridged by one tube are
nondegenerate and meet none. A region of unknowns on whose boundary the equations vanish for no
value between the two sides keeps its solutions, so the sum of the signs of the Jacobian's
determinants in it is the same on both sides, and the same is true around each place where solutions
meet (the degree of a map). A grouping is proved where it is the only one that keeps this sum, and
that the symmetries of the equations leave alone.

Reference: Deimling, Nonlinear Functional Analysis, 1 (the degree; that it is the same along a
homotopy).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from flint import arb, arb_mat, ctx

from ptmcad.ask.lines.linesystem import LineSystem, coordinates_of, guess_of
from ptmcad.ask.lines.mirror import QUARTERS, Mirror, mirror_of
from ptmcad.exact.models.system import on_slice
from ptmcad.exact.ranges.exactline import system_on
from ptmcad.formulas.continuation import BITS, Reached, Vector, at_value, bridge
from ptmcad.model.involutions import involutions
from ptmcad.text.balls import ball_of, ball_over

Range = tuple[arb, arb]
"""The ends of what an unknown may be."""
_MAX_GROUP = 8
"""Solutions of which all groupings are looked through: of eight there are 4140."""
_MAX_PIECES = 4000
_MAX_DEPTH = 60
"""Into how many pieces, and how often, a region's boundary is cut."""


class PlacedSolution(NamedTuple):
    """A solution on one side of a critical value, as seen from a branch.

    Attributes
    ----------
    negative : the number of negative eigenvalues; without a potential 0 where it is stable, else 1.
    ahead : whether it is on the far side.
    shifted : the unknowns, angles less than a turn from the branch's.
    sign : of the Jacobian's determinant; 0 where it is not decided.
    """

    place: Reached
    negative: int
    ahead: bool
    shifted: Vector
    sign: int


class Meeting(NamedTuple):
    """What a branch meets.

    Attributes
    ----------
    meeting, leaving : as in `ptmcad.answer.paths.PathEnd`.
    among : whether the branch is proved to vanish with one or more of those, and not with which.
    beyond : all solutions on the far side.
    box : where there is a region that no solution enters or leaves meanwhile, what it holds of each
        unknown, angles as the branch has them; else None.
    fixed : the unknowns, by number, that a symmetry reflects which takes the solutions that meet to
        one another: there an angle is that of the line, or opposite, and an unknown on the line is
        zero.
    """

    meeting: tuple[int, ...]
    leaving: tuple[int, ...]
    among: bool
    beyond: tuple[PlacedSolution, ...]
    box: Vector | None = None
    fixed: Mapping[int, Mirror] = {}


_Symmetry = tuple[tuple[int, ...], Mapping[int, Mirror]]
"""How a change of the unknowns that leaves the equations alone permutes a group, and which unknowns
it reflects.
"""


def what_meets(family: LineSystem, current: Reached, after: Fraction) -> Meeting | None:
    """What a branch meets at the only critical value between its place and another value; None
    where not proved.
    """
    before, beyond = (_solutions(family, current, value) for value in (current.value, after))
    if before is None or beyond is None:
        return None
    unmatched = _unmatched(family, current, after, before, beyond)
    if unmatched is None or not all(m.sign for m in unmatched):
        return None
    region = _region(family, current, after, unmatched)
    if region is None:
        return _without_region(family, unmatched, tuple(beyond))
    group, box = region
    symmetries = _symmetries(family, group, after)
    classes = _own_classes(group, [images for images, _ in symmetries])
    if not classes:
        return None
    if len(classes) > 1 and any(group[k].ahead for c in classes for k in c):
        return None
    chosen = [group[k] for k in sorted(frozenset().union(*classes))]
    met, left = (
        tuple(sorted(m.negative for m in chosen if m.ahead is side)) for side in (False, True)
    )
    own = next(iter(classes)) if len(classes) == 1 else frozenset()
    kept = (lines for images, lines in symmetries if own and {images[k] for k in own} == own)
    fixed = {k: line for lines in kept for k, line in lines.items()}
    return Meeting(met, left, len(classes) > 1, tuple(beyond), box, fixed)


def _solutions(
    family: LineSystem, current: Reached, value: Fraction
) -> list[PlacedSolution] | None:
    """All solutions at a value; None when they are not all known, or one was not enclosed."""
    if (poses := family.solutions.at(value)) is None:
        return None
    found = []
    for pose in poses:
        place = at_value(family.branches, value, guess_of(pose))
        if place is None:
            return None
        rank = int(pose.stable is not True) if pose.index is None else pose.index
        reached = Reached(value, place, place)
        with ctx.workprec(BITS):
            shifted = []
            for k, (a, b) in enumerate(zip(reached.point, current.point, strict=True)):
                turns = round(float(((b - a) / (2 * arb.pi())).mid())) if k < family.angles else 0
                shifted.append(a + 2 * turns * arb.pi())
            column = arb_mat(len(shifted), 1, reached.point)
            det = family.branches.jacobian(ball_of(value), column).det()
        ahead, sign = value != current.value, 1 if det > 0 else -1 if det < 0 else 0
        found.append(PlacedSolution(reached, rank, ahead, tuple(shifted), sign))
    return found


def _unmatched(
    family: LineSystem,
    current: Reached,
    after: Fraction,
    before: Sequence[PlacedSolution],
    beyond: Sequence[PlacedSolution],
) -> list[PlacedSolution] | None:
    """The solutions that no tube leads across, the branch's own first."""
    own = [s for s in before if _close(family, s.place.point, current.point)]
    if len(own) != 1:
        return None
    left, lost = list(beyond), own
    for solution in before:
        if solution is lost[0]:
            continue
        across = bridge(family.branches, solution.place, after)
        if across is None:
            lost.append(solution)
            continue
        images = [
            k for k, image in enumerate(left) if _close(family, across.point, image.place.point)
        ]
        if len(images) == 1:
            del left[images[0]]
        elif images or not any(
            p < 0 for p in family.values_at(family.formulas.inequalities, across)
        ):
            return None
    return lost + left


def _close(family: LineSystem, first: Vector, second: Vector) -> bool:
    """Whether the boxes overlap, whole turns apart."""
    with ctx.workprec(BITS):
        apart = [a - b for a, b in zip(first, second, strict=True)]
        turned = [(d / 2).sin() for d in apart[: family.angles]]
        return all(d.contains(0) for d in (*turned, *apart[family.angles :]))


def _without_region(
    family: LineSystem,
    unmatched: Sequence[PlacedSolution],
    beyond: tuple[PlacedSolution, ...],
) -> Meeting | None:
    """What can be said without a region: a branch vanishes where nothing is left that it may have
    become.
    """
    excluded = family.formulas.inequalities or family.lengths
    if excluded or any(s.ahead for s in unmatched):
        return None
    if len(unmatched) > 1 and not family.is_on_torus:
        return None  # some may go to infinity
    return Meeting(tuple(sorted(s.negative for s in unmatched)), (), len(unmatched) > 2, beyond)


def _region(
    family: LineSystem, current: Reached, after: Fraction, members: Sequence[PlacedSolution]
) -> tuple[list[PlacedSolution], Vector] | None:
    """The fewest solutions around the branch's own, the first, in a region that none enters or
    leaves.
    """
    with ctx.workprec(BITS):
        own = members[0]

        def distance(m: PlacedSolution) -> float:
            return max(float(abs(a - b).mid()) for a, b in zip(m.shifted, own.shifted, strict=True))

        ordered = sorted(members, key=distance)
        for k in range(1, min(len(ordered), _MAX_GROUP) + 1):
            group = ordered[:k]
            if sum(m.sign for m in group if m.ahead) != sum(m.sign for m in group if not m.ahead):
                continue
            extent = distance(group[-1])
            room = (distance(ordered[k]) - extent) / 2 if k < len(ordered) else max(3 * extent, 0.1)
            for margin in (m for m in (2 * extent, extent / 2, room / 4, room) if 0 < m <= room):
                box = [
                    _hull([m.shifted[i] for m in group], margin) for i in range(len(own.shifted))
                ]
                if _isolates(family, box, current.value, after, group, ordered[k:]):
                    return group, tuple(low.union(high) for low, high in box)
    return None


def _hull(balls: Sequence[arb], margin: float) -> Range:
    """The ends, exact numbers, of a span around balls."""
    low = min(b.lower() for b in balls) - margin
    high = max(b.upper() for b in balls) + margin
    return low.mid(), high.mid()


def _isolates(
    family: LineSystem,
    box: Sequence[Range],
    start: Fraction,
    end: Fraction,
    group: Sequence[PlacedSolution],
    others: Sequence[PlacedSolution],
) -> bool:
    """Whether a box holds the group and none of the others, and its boundary no solution from one
    value to another.
    """
    if not all(high - low < 6 for low, high in box[: family.angles]):
        return False
    held = all(low < x < high for m in group for x, (low, high) in zip(m.shifted, box, strict=True))
    if not held or not all(_outside(family, m.shifted, box) for m in others):
        return False
    low, high = sorted((start, end))
    at, size = ball_over(low, high), len(box)
    whole = tuple(a.union(b) for a, b in box)
    positive = (*family.formulas.inequalities, *family.lengths)
    if not all(p > 0 for p in family.values(positive, low, high, whole)):
        return False
    faces = [(*whole[:i], side, *whole[i + 1 :]) for i, sides in enumerate(box) for side in sides]
    stack, pieces = [(face, 0) for face in faces], 0
    while stack:
        piece, depth = stack.pop()
        pieces += 1
        if any(
            not f.contains(0)
            for f in family.branches.residuals(at, arb_mat(size, 1, piece)).entries()
        ):
            continue
        if depth == _MAX_DEPTH or pieces > _MAX_PIECES:
            return False
        widest = max(range(len(piece)), key=lambda i: float(piece[i].rad()))
        if piece[widest].rad() == 0:
            return False
        middle = piece[widest].mid()
        for part in (piece[widest].lower().union(middle), middle.union(piece[widest].upper())):
            stack.append(((*piece[:widest], part, *piece[widest + 1 :]), depth + 1))
    return True


def _outside(family: LineSystem, point: Vector, box: Sequence[Range]) -> bool:
    """Whether a point is certainly outside a box, by any number of whole turns."""
    turn = 2 * arb.pi()
    return any(
        all(y < low or y > high for y in ((x - turn, x, x + turn) if k < family.angles else (x,)))
        for k, (x, (low, high)) in enumerate(zip(point, box, strict=True))
    )


def _symmetries(
    family: LineSystem, group: Sequence[PlacedSolution], after: Fraction
) -> list[_Symmetry]:
    """How the involutions that keep all points of the line, and a reflection of all angles, permute
    the group.
    """
    if len(group) <= 2:
        return []
    with ctx.workprec(BITS):
        places = [coordinates_of(m.shifted, family.angles) for m in group]
        found = _reflections(family, group, places, after)
        model = family.line.model
        kinds = model.unknowns
        ordered = [list(kinds).index(name) for name in model.sorted_unknowns]
        for change in involutions(model, family.line.parameters):
            coordinates = change.coordinates(tuple(kinds.values()))
            images = _images(
                group, places, [[sign * place[k] for k, sign in coordinates] for place in places]
            )
            if images is not None:
                own = {
                    n: k
                    for n, k in enumerate(ordered)
                    if change.images[k] == k and change.signs[k] < 0
                }
                found.append((images, {n: QUARTERS[change.halves[k]] for n, k in own.items()}))
    return found


def _reflections(
    family: LineSystem,
    group: Sequence[PlacedSolution],
    places: Sequence[Sequence[arb]],
    after: Fraction,
) -> list[_Symmetry]:
    """How the reflection of all angles at once, whose line may turn with the parameter, permutes
    the group.
    """
    if family.line.model.reals or family.lengths:
        return []
    mirror = mirror_of(on_slice(*system_on(family.line)).equations, family.angles)
    values = [m.place.value for m in group]  # the first is the branch's own, on the near side
    if mirror is None or mirror.angle(min(values[0], after), max(values[0], after)) is None:
        return []
    moved = []
    for m, value in zip(group, values, strict=True):
        turned = mirror.angle(value, value)
        if turned is None:
            return []
        moved.append(coordinates_of(tuple(2 * turned - t for t in m.shifted), len(m.shifted)))
    images = _images(group, places, moved)
    return [] if images is None else [(images, dict.fromkeys(range(family.angles), mirror))]


def _images(
    group: Sequence[PlacedSolution], places: Sequence[Sequence[arb]], moved: Sequence[Sequence[arb]]
) -> tuple[int, ...] | None:
    """Which of the group is where each one is moved to; None where some are moved out of it, or it
    is not clear.
    """
    images = [
        [
            k
            for k, (other, place) in enumerate(zip(group, places, strict=True))
            if other.ahead is m.ahead
            and all(a.overlaps(b) for a, b in zip(image, place, strict=True))
        ]
        for m, image in zip(group, moved, strict=True)
    ]
    return tuple(i[0] for i in images) if all(len(i) == 1 for i in images) else None


def _own_classes(
    group: Sequence[PlacedSolution], symmetries: Sequence[Sequence[int]]
) -> set[frozenset[int]]:
    """With which of the group, by number, the first may be where it ends: by each grouping that is
    possible.
    """
    found = set()
    for grouping in _groupings(len(group)):
        sums = [
            sum(group[k].sign * (-1 if group[k].ahead else 1) for k in part) for part in grouping
        ]
        if any(sums):
            continue
        parts = {frozenset(part) for part in grouping}
        if all(frozenset(s[k] for k in part) in parts for s in symmetries for part in parts):
            found.add(next(part for part in parts if 0 in part))
    return found


def _groupings(size: int) -> Iterator[list[list[int]]]:
    """All partitions of the numbers below a size."""
    if size == 0:
        yield []
        return
    for smaller in _groupings(size - 1):
        for k in range(len(smaller)):
            yield [[*part, size - 1] if i == k else part for i, part in enumerate(smaller)]
        yield [*smaller, [size - 1]]
