"""Krawczyk's test of boxes of the unknowns, and all solutions in boxes that it proves, for all
parameters in balls at once.

Guarantee: with C near the inverse of the Jacobian at the middle m of a box X, Krawczyk's image is
m - C f(m) + (I - C f'(X)) (X - m). It has all zeros that X has; if it lies inside of X, there is
exactly one. For every choice of the parameters in the balls of the field, each of the `zeros`
exists, exactly once in its box, and there is no further one in the boxes of the start at which no
condition of the field is violated. What cannot be proved raises `Unproved`.

The boxes of the start are those that the exclusion leaves (`ptmcad.verification.exclusion.places`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations, product
from math import inf
from operator import lt

from flint import arb, arb_mat

from ptmcad.verification.certified.ballequations import BallEquations, BallJet, Matrix
from ptmcad.verification.normalform.boxes import (
    MIN_HALF_WIDTH,
    Box,
    Floats,
    Unproved,
    Zero,
    disjoint,
    halves,
    in_words,
    inside,
    within,
)
from ptmcad.verification.principalminors import inertia

_SHRINKINGS = (*range(1, -7, -1), *range(-8, -13, -2), -15, *range(-18, -47, -4))
"""Powers of two times the shape of the box in which a solution is proved to be alone."""
_MAX_TURN = 3.0
"""Half the width of the widest box of an angle in which a solution is proved to be alone."""
_NEWTON_STEPS = 12
_CLOSE = 2.0**-20
"""Of a box's width: where Newton's method does not come closer to rest, nothing is to be proved."""
_ROUNDING = 2.0**-50
_STEEP = 2.0**16
"""So many times as steep in one unknown as in another: a box is to be narrower in it, not in both.
"""
_NARROWING, _WORTHWHILE = 40, 0.999
"""Steps by which a box is made narrower at most, while one makes it so much narrower."""


def inverse_of(jacobian: Matrix) -> arb_mat | None:
    """An approximate inverse of the middle of a matrix, of exact numbers."""
    n = len(jacobian)
    try:
        inverse = arb_mat(n, n, [x.mid() for row in jacobian for x in row]).inv()
    except ZeroDivisionError:
        return None
    entries = [x.mid() for x in inverse.entries()]
    return arb_mat(n, n, entries) if all(x.is_finite() for x in entries) else None


def image(values: Sequence[arb], jacobian: Matrix, reach: Sequence[arb]) -> list[arb] | None:
    """Krawczyk's image of a box, less its middle; None where the middle of the derivatives is
    singular.

    Parameters
    ----------
    values : at the middle.
    jacobian : over the box.
    reach : half widths of the box.
    """
    inverse = inverse_of(jacobian)
    if inverse is None:
        return None
    balls = [arb(0, r) for r in reach]
    n, whole = len(jacobian), (inverse * arb_mat(jacobian)).entries()
    return [
        sum((((i == j) - whole[i * n + j]) * x for j, x in enumerate(balls)), arb(0)) - step
        for i, step in enumerate(_steps(values, inverse))
    ]


def _steps(values: Sequence[arb], inverse: arb_mat) -> list[arb]:
    """C f"""
    steps: list[arb] = (inverse * arb_mat(len(values), 1, list(values))).entries()
    return steps


def _inverse_at(field: BallEquations, center: Sequence[float]) -> tuple[BallJet, arb_mat] | None:
    """The equations at a point, and the inverse of their Jacobian; None where it is not known."""
    jet = field([arb(x) for x in center])
    inverse = inverse_of(jet.jacobian)
    return None if inverse is None else (jet, inverse)


def newton(field: BallEquations, box: Box) -> Floats | None:
    """Where Newton's method comes to rest from a box's middle, near the box; None when it does not."""
    x, share = list(box[0]), 1.0
    for _ in range(_NEWTON_STEPS):
        if (found := _inverse_at(field, x)) is None:
            return None
        steps = [float(s.mid()) for s in _steps(found[0].values, found[1])]
        x = [c - s for c, s in zip(x, steps, strict=True)]
        if not all(abs(c - m) <= 2 * r for c, m, r in zip(x, *box, strict=True)):
            return None
        # what doubles of that size do not tell apart is no step
        shares = (
            abs(s) / r if abs(s) > _ROUNDING * abs(c) else 0.0
            for s, r, c in zip(steps, box[1], x, strict=True)
        )
        before, share = share, max(shares)
        if share == 0 or (share < _CLOSE and share >= before / 2):
            break
    return tuple(x) if share < _CLOSE else None


def proved(field: BallEquations, center: Floats, shapes: Iterable[Floats]) -> Zero | None:
    """The solution around a point that is alone in a box of some shape; None when it is not proved,
    nor its signs.
    """
    if (found := _inverse_at(field, center)) is None:
        return None
    jet, values = found[0], found[0].values
    least = [step.abs_upper() for step in _steps(values, found[1])]
    for shape, power in product(_with_steep(jet.jacobian, shapes), _SHRINKINGS):
        sizes = tuple(r * 2.0**power for r in shape)
        if any(
            circle and r > _MAX_TURN for circle, r in zip(field.form.is_circle, sizes, strict=True)
        ):
            continue
        # nearly what is left of the image as the box becomes a point
        if not all(map(lt, least, sizes)):
            continue
        reaches = _reaches(field, center, values, sizes)
        if reaches is None or not all(map(lt, reaches, sizes)):
            continue
        radii = _narrowed(field, center, values, sizes, least)
        near = field(list(map(arb, center, radii)))
        signs = inertia(near.jacobian) if field.form.is_gradient else ""
        return None if signs is None else Zero(center, radii, sizes, signs)
    return None


def _with_steep(jacobian: Matrix, shapes: Iterable[Floats]) -> Iterator[Floats]:
    """Shapes, and one that is narrower where the equations are steeper, as next to a place where a
    spring is short.
    """
    first, *others = shapes
    steep = [float(abs(row[k]).mid()) for k, row in enumerate(jacobian)]
    known = all(0 < s < inf for s in steep)
    narrow = [tuple(r * min(steep) / s for r, s in zip(first, steep, strict=True))] if known else []
    if known and max(steep) > _STEEP * min(steep):
        yield from narrow
    yield from (first, *others, *narrow)


def _narrowed(
    field: BallEquations, center: Floats, values: Sequence[arb], radii: Floats, least: Sequence[arb]
) -> Floats:
    """A smaller box that has the only solution of a box, too: its image, and that of that, while it
    gets narrower.

    Parameters
    ----------
    values : of the equations at the center.
    least : half widths that the image of a point would have: a little more of them is tried at
        first.
    """
    near = tuple(min(r, 2 * _above(x)) for r, x in zip(radii, least, strict=True))
    reaches = _reaches(field, center, values, near)
    if reaches is not None and all(map(lt, reaches, near)):
        radii = near
    for _ in range(_NARROWING):
        reaches = _reaches(field, center, values, radii)
        if reaches is None:
            break
        before = radii
        radii = tuple(min(r, _above(x)) for r, x in zip(radii, reaches, strict=True))
        if all(r > _WORTHWHILE * b for r, b in zip(radii, before, strict=True)):
            break
    return radii


def _above(reach: arb) -> float:
    """A double above a half width."""
    return float(reach.upper()) * 1.0001 + 2.0**-1000


def _reaches(
    field: BallEquations, center: Floats, values: Sequence[arb], radii: Floats
) -> list[arb] | None:
    """Half widths of Krawczyk's image of a box; None where the Jacobian is not known, or near a
    singular one.
    """
    jet = field(list(map(arb, center, radii)))
    found = image(values, jet.jacobian, list(map(arb, radii)))
    return None if found is None else [step.abs_upper() for step in found]


_PROMISING = 1.0
"""The width of Krawczyk's image, as a share of the box's, below which Newton's method is tried."""
_FIRST_SHARE = 2.0**-5
"""Of the start's widths: the first box that is tried around a solution is not narrower."""


class Spent(Unproved):
    """The boxes that a search may look at were not enough."""


def zeros(
    field: BallEquations,
    start: Iterable[Box],
    whole: Floats,
    budget: int,
    smallest: float = MIN_HALF_WIDTH,
    near: Iterable[Zero] = (),
) -> list[Zero]:
    """The solutions in the boxes.

    Parameters
    ----------
    whole : half the width of the box that those of the start are parts of.
    budget : number of boxes after which the search gives up.
    smallest : share of the whole box's widths below which one is not halved again.
    near : solutions for one choice of the parameters; those near them are proved first, before any
        box of the start is asked for, which saves a hopeless search.

    Raises
    ------
    Unproved
        When a solution is degenerate or nearly so for some parameters, or the budget was spent.
    """
    circles = field.circles
    found = [_persisting(field, zero, whole) for zero in near]
    least = [smallest * w for w in whole]
    if not all(disjoint(one, two, circles) for one, two in combinations(found, 2)):
        raise Unproved("two solutions may meet")
    waiting, used = list(start), 0
    while waiting:
        box = waiting.pop()
        used += 1
        if used > budget:
            raise Spent(f"{budget} boxes were not enough")
        if any(inside(box, zero, circles) for zero in found):
            continue
        jet = field(list(map(arb, *box)))
        if any(v > 0 or v < 0 for v in jet.values) or any(c < 0 for c in jet.conditions):
            continue
        steps = None
        if not jet.short:
            steps = image(field(list(map(arb, box[0]))).values, jet.jacobian, [*map(arb, box[1])])
        if steps is not None:
            if any(abs(step) > r for step, r in zip(steps, box[1], strict=True)):
                continue
            # an image not much wider than its box makes it worth looking for a solution
            is_promising = all(
                step.rad() < _PROMISING * r for step, r in zip(steps, box[1], strict=True)
            )
            new = _settled(field, box, found, whole) if is_promising else None
            if new is not None and all(disjoint(new, zero, circles) for zero in found):
                found.append(new)
                if inside(box, new, circles):
                    continue
        parts = halves(box, _widest(box, whole), least)
        if parts is None:
            raise Unproved(f"a solution near ({in_words(box[0])}) may be degenerate")
        waiting += parts
    return found


def _settled(field: BallEquations, box: Box, found: Sequence[Zero], whole: Floats) -> Zero | None:
    """A solution that Newton's method reaches from the box's middle, proved to be one; None when
    none is.
    """
    center = newton(field, box)
    if center is None or any(within(center, z.center, z.alone, field.circles) for z in found):
        return None
    return proved(field, center, _shapes(box[1], whole))


def _persisting(field: BallEquations, zero: Zero, whole: Floats) -> Zero:
    """The solution for all parameters that one for some parameters belongs to."""
    persisting = proved(field, zero.center, _shapes(zero.alone, whole))
    if persisting is None:
        raise Unproved(f"the solution near ({in_words(zero.center)}) may not persist")
    return persisting


def _shapes(radii: Floats, whole: Floats) -> tuple[Floats, Floats]:
    """Half widths of boxes that are tried around a solution: of the start's shape, which a box in
    it need not have.
    """
    share = max(_FIRST_SHARE, *(r / w for r, w in zip(radii, whole, strict=True)))
    return tuple(share * w for w in whole), radii


def _widest(box: Box, whole: Floats) -> list[int]:
    """The unknowns in the order of the box's widths, as shares of the whole ones."""
    shares = [r / w for r, w in zip(box[1], whole, strict=True)]
    return sorted(range(len(shares)), key=lambda k: shares[k], reverse=True)
