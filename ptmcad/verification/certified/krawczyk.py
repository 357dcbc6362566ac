"""Krawczyk's test of boxes of the unknowns, and the solutions that it proves, for all parameters in
balls at once.

Guarantee: with C near the inverse of the Jacobian at the middle m of a box X, Krawczyk's image is
m - C f(m) + (I - C f'(X)) (X - m). It has all zeros that X has; if it lies inside of X, there is
exactly one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from math import inf
from operator import lt

from flint import arb, arb_mat

from ptmcad.verification.certified.boxes import Box, Floats, Zero
from ptmcad.verification.certified.field import BallEquations, BallJet, Matrix
from ptmcad.verification.principalminors import inertia

_SHRINKINGS = (
    1,
    0,
    -1,
    -2,
    -3,
    -4,
    -5,
    -6,
    -8,
    -10,
    -12,
    -15,
    -18,
    -22,
    -26,
    -30,
    -34,
    -38,
    -42,
    -46,
)
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
    values : at the middle; jacobian : over the box.
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


def image_of(field: BallEquations, box: Box, jet: BallJet) -> list[arb] | None:
    """Krawczyk's image of a box, less its middle."""
    return image(field(list(map(arb, box[0]))).values, jet.jacobian, list(map(arb, box[1])))


def newton(field: BallEquations, box: Box) -> Floats | None:
    """Where Newton's method comes to rest from a box's middle, near the box; None when it does not."""
    x, share = list(box[0]), 1.0
    for _ in range(_NEWTON_STEPS):
        jet = field([arb(c) for c in x])
        inverse = None if jet.short else inverse_of(jet.jacobian)
        if inverse is None:
            return None
        steps = [float(s.mid()) for s in _steps(jet.values, inverse)]
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
    jet = field([arb(x) for x in center])
    inverse = None if jet.short else inverse_of(jet.jacobian)
    if inverse is None:
        return None
    values = jet.values
    least = [step.abs_upper() for step in _steps(values, inverse)]
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
        signs = "" if not field.form.is_gradient else None if near.short else inertia(near.jacobian)
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
    found = None if jet.short else image(values, jet.jacobian, list(map(arb, radii)))
    return None if found is None else [step.abs_upper() for step in found]
