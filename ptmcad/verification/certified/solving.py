"""All solutions of any model in a box, for all parameters in balls at once: exclusion, Krawczyk's test, halving.

Guarantee: for every choice of the parameters in the balls of the `Field`, each of the solutions that are returned
exists, exactly once in its box, and there is no further one in the boxes of the start; when only minima are asked for,
none that is a minimum or degenerate without a negative eigenvalue. What cannot be proved raises `Unproved`.

The test: with C near the inverse of the Jacobian at the middle m of a box X of half widths r, Krawczyk's image is
m - C f(m) + (I - C f'(X)) (X - m). It has all zeros that X has; if it lies inside of X, there is exactly one.
`ptmcad.verification.certified.equilibria` is the same for the paper's mechanism, with formulas of its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from math import isfinite, pi
from operator import gt

from flint import arb, arb_mat

from ptmcad.verification.certified.equilibria import MIN_HALF_WIDTH, Unproved
from ptmcad.verification.certified.field import Field, Jet, Matrix, square

Floats = tuple[float, ...]
"""A number for each unknown."""
Box = tuple[Floats, Floats]
"""Middle and half widths."""
_SHRINKINGS = (1, 0, -1, -2, -3, -4, -5, -6, -8, -10, -12, -15, -18, -22, -26, -30, -34, -38, -42, -46)
"""Powers of two times the shape of the box in which a solution is proved to be alone."""
_MAX_TURN = 3.0
"""Half the width of the widest box of an angle in which a solution is proved to be alone."""
_NEWTON_STEPS = 12
_CLOSE = 2.0**-20
"""Of a box's width: where Newton's method does not come closer to rest, nothing is to be proved."""
_NARROWING = 40
_NEAR = 4.0
"""Balances are looked at where a spring may be shorter than so many times what it changes by in the box."""
_PROMISING = 1.0
"""The width of Krawczyk's image, as a share of the box's, below which Newton's method is tried."""
_WORTH = 0.6
"""A box is replaced by Krawczyk's image when that has less than this share of it."""


class Spent(Unproved):
    """The boxes that a search may look at were not enough."""


@dataclass(frozen=True, slots=True)
class Zero:
    """The only solution within ``alone`` of ``center``, and it is within ``radii``; for each choice of parameters.

    ``signs`` are those of the Hessian's eigenvalues, positive ones first; empty where the equations are no gradient.
    """

    center: Floats
    radii: Floats
    alone: Floats
    signs: str

    @property
    def within(self) -> tuple[arb, ...]:
        """Balls of the unknowns."""
        return tuple(map(arb, self.center, self.radii))


def zeros(
    field: Field,
    minima: bool,
    start: Iterable[Box],
    budget: int,
    smallest: float = MIN_HALF_WIDTH,
    near: Iterable[Zero] = (),
) -> tuple[list[Zero], int]:
    """The solutions in the boxes, and how many boxes were looked at.

    Parameters
    ----------
    minima : whether only minima of a potential are asked for; others may then be missing.
    budget : number of boxes after which the search gives up.
    smallest : share of the first boxes' widths below which one is not halved again.
    near : solutions for one choice of the parameters; those near them are proved first, which saves a hopeless search.

    Raises
    ------
    Unproved
        When a solution is degenerate or nearly so for some parameters, or the budget was spent.
    """
    circles = field.form.is_circle
    waiting = list(start)
    whole = waiting[0][1]
    least = [smallest * w for w in whole]
    found = [_persisting(field, zero, whole) for zero in near]
    if not all(disjoint(one, two, circles) for one, two in combinations(found, 2)):
        raise Unproved("two solutions may meet")
    used = 0
    while waiting:
        box = waiting.pop()
        used += 1
        if used > budget:
            raise Spent(f"{budget} boxes were not enough")
        jet = field(_balls(box))
        if _excluded(jet, box, minima) or any(_inside(box, zero, circles) for zero in found):
            continue
        image = None if jet.short else _krawczyk(field, box, jet)
        if image is not None:
            if any(abs(step) > r for step, r in zip(image, box[1], strict=True)):
                continue
            new = _settled(field, box, found, whole) if _contracts(box, image) else None
            if new is not None and all(disjoint(new, zero, circles) for zero in found):
                found.append(new)
                if _inside(box, new, circles):
                    continue
            narrower = _met(box, image)
            if narrower is not None and all(map(gt, narrower[1], least)):
                waiting.append(narrower)
                continue
        halves = _halves(box, _widest(jet, box, whole), least)
        if halves is None:
            where = ", ".join(f"{x:.6g}" for x in box[0])
            raise Unproved(f"a solution near ({where}) may be degenerate")
        waiting += halves
    return found, used


def _balls(box: Box) -> list[arb]:
    return list(map(arb, *box))


def _excluded(jet: Jet, box: Box, minima: bool) -> bool:
    """Whether no solution that is asked for lies in the box."""
    if any(v > 0 or v < 0 for v in jet.values):
        return True
    short = jet.short
    if minima and not short and _is_no_minimum(jet.jacobian):
        return True
    for s in jet.springs:
        change = sum((abs(a) + abs(b)).upper() * r for (a, b), r in zip(s.slopes, box[1], strict=True))
        if max(box[1]) < 1 and not s.length > _NEAR * change and any(not b.contains(0) for b in jet.balances(s)):
            return True
    return minima and len(short) == 1 and jet.bends_down(short[0])


def _is_no_minimum(h: Matrix) -> bool:
    """Whether a symmetric matrix has a negative eigenvalue, whatever it is within the balls."""
    if any(h[i][i] < 0 for i in range(len(h))):
        return True
    if any(h[i][i] * h[j][j] - square(h[i][j]) < 0 for i, j in combinations(range(len(h)), 2)):
        return True
    return len(h) == 3 and bool(_determinant(h) < 0)


def _determinant(h: Matrix) -> arb:
    (a, b, c), (d, e, f), (g, i, j) = h
    return a * (e * j - f * i) - b * (d * j - f * g) + c * (d * i - e * g)


def _inverse(jacobian: Matrix) -> arb_mat | None:
    """An approximate inverse of the middle of a matrix, of exact numbers."""
    n = len(jacobian)
    middle = [float(x.mid()) for row in jacobian for x in row]
    if not all(map(isfinite, middle)):
        return None
    try:
        inverse = arb_mat(n, n, middle).inv()
    except ZeroDivisionError:
        return None
    entries = [float(x.mid()) for x in inverse.entries()]
    return arb_mat(n, n, entries) if all(map(isfinite, entries)) else None


def _rest(jacobian: Matrix, inverse: arb_mat) -> Matrix:
    """I - C f'."""
    n = len(jacobian)
    whole = (inverse * arb_mat(jacobian)).entries()
    return [[(i == j) - whole[i * n + j] for j in range(n)] for i in range(n)]


def _steps(field: Field, center: Floats, inverse: arb_mat) -> list[arb]:
    """C f at a point."""
    values = field([arb(x) for x in center]).values
    steps: list[arb] = (inverse * arb_mat(len(values), 1, values)).entries()
    return steps


def _krawczyk(field: Field, box: Box, jet: Jet) -> list[arb] | None:
    """Krawczyk's image of a box, less its middle."""
    inverse = _inverse(jet.jacobian)
    if inverse is None:
        return None
    reach = [arb(0, r) for r in box[1]]
    return [
        sum((entry * x for entry, x in zip(row, reach, strict=True)), arb(0)) - step
        for row, step in zip(_rest(jet.jacobian, inverse), _steps(field, box[0], inverse), strict=True)
    ]


def _contracts(box: Box, image: Sequence[arb]) -> bool:
    """Whether Krawczyk's image of a box is not much wider, so that it is worth looking for a solution in it."""
    return all(step.rad() < _PROMISING * r for step, r in zip(image, box[1], strict=True))


def _met(box: Box, image: Sequence[arb]) -> Box | None:
    """What a box has in common with its image, if that is worth it; a little more than that."""
    middle, radii, share = [], [], 1.0
    for m, r, step in zip(*box, image, strict=True):
        slack = 2.0**-50 * (abs(m) + r)
        low = max(m - r, m + float(step.lower()) - slack)
        high = min(m + r, m + float(step.upper()) + slack)
        if not (isfinite(low) and isfinite(high)):
            return None
        center = (low + high) / 2
        radius = max(high - center, center - low) + slack
        middle.append(center)
        radii.append(radius)
        share *= radius / r
    return (tuple(middle), tuple(radii)) if share < _WORTH else None


def _settled(field: Field, box: Box, found: Sequence[Zero], whole: Floats) -> Zero | None:
    """A solution that Newton's method reaches from the box's middle, proved to be one; None when none is."""
    center = _newton(field, box)
    if center is None or any(_within(center, z.center, z.alone, field.form.is_circle) for z in found):
        return None
    return _proved(field, center, _shapes(box[1], whole))


def _newton(field: Field, box: Box) -> Floats | None:
    x, share = list(box[0]), 1.0
    for _ in range(_NEWTON_STEPS):
        jet = field([arb(c) for c in x])
        inverse = None if jet.short else _inverse(jet.jacobian)
        if inverse is None:
            return None
        steps = [float(s.mid()) for s in (inverse * arb_mat(len(x), 1, jet.values)).entries()]
        x = [c - s for c, s in zip(x, steps, strict=True)]
        if not all(abs(c - m) <= 2 * r for c, m, r in zip(x, *box, strict=True)):
            return None
        before, share = share, max(abs(s) / r for s, r in zip(steps, box[1], strict=True))
        if share == 0 or (share < _CLOSE and share >= before / 2):
            break
    return tuple(x) if share < _CLOSE else None


def _persisting(field: Field, zero: Zero, whole: Floats) -> Zero:
    """The solution for all parameters that one for some parameters belongs to."""
    persisting = _proved(field, zero.center, _shapes(zero.alone, whole))
    if persisting is None:
        where = ", ".join(f"{x:.6g}" for x in zero.center)
        raise Unproved(f"the solution near ({where}) may not persist")
    return persisting


def _shapes(radii: Floats, whole: Floats) -> tuple[Floats, Floats]:
    """Half widths of boxes that are tried around a solution: of the start's shape, which a box in it need not have."""
    share = max(r / w for r, w in zip(radii, whole, strict=True))
    return tuple(share * w for w in whole), radii


def _proved(field: Field, center: Floats, shapes: Iterable[Floats]) -> Zero | None:
    """The solution around a point that is alone in a box of some shape; None when it is not proved, nor its signs."""
    for shape, power in product(shapes, _SHRINKINGS):
        sizes = tuple(r * 2.0**power for r in shape)
        if any(circle and r > _MAX_TURN for circle, r in zip(field.form.is_circle, sizes, strict=True)):
            continue
        jet = field(list(map(arb, center, sizes)))
        inverse = None if jet.short else _inverse(jet.jacobian)
        if inverse is None:
            continue
        rest = [[x.abs_upper() for x in row] for row in _rest(jet.jacobian, inverse)]
        off = [s.abs_upper() for s in _steps(field, center, inverse)]
        if not all(reach < r for reach, r in zip(_image(sizes, rest, off), sizes, strict=True)):
            continue
        radii = _narrowed(field, center, sizes)
        near = field(list(map(arb, center, radii)))
        signs = "" if not field.form.is_gradient else None if near.short else inertia(near.jacobian)
        return None if signs is None else Zero(center, radii, sizes, signs)
    return None


def _narrowed(field: Field, center: Floats, radii: Floats) -> Floats:
    """A smaller box that has the only solution of a box, too: its image, and that of that, while it gets narrower."""
    for _ in range(_NARROWING):
        jet = field(list(map(arb, center, radii)))
        inverse = None if jet.short else _inverse(jet.jacobian)
        if inverse is None:
            break
        rest = [[x.abs_upper() for x in row] for row in _rest(jet.jacobian, inverse)]
        off = [s.abs_upper() for s in _steps(field, center, inverse)]
        reaches = [float(reach.upper()) * 1.0001 + 2.0**-1000 for reach in _image(radii, rest, off)]
        before, radii = radii, tuple(map(min, radii, reaches))
        if all(r > 0.999 * b for r, b in zip(radii, before, strict=True)):
            break
    return radii


def _image(radii: Sequence[float], rest: Matrix, off: Sequence[arb]) -> list[arb]:
    """Half widths of Krawczyk's image of a box."""
    return [
        step + sum((entry * r for entry, r in zip(row, radii, strict=True)), arb(0))
        for step, row in zip(off, rest, strict=True)
    ]


def inertia(h: Matrix) -> str | None:
    """The signs of the eigenvalues of all symmetric matrices in the balls, positive ones first; None when undecided.

    The characteristic polynomial has real roots only, so that Descartes' rule counts them exactly: as many are positive
    as its coefficients, the elementary symmetric functions with alternating signs, change theirs.
    """
    n = len(h)
    if n == 1:
        return "+" if h[0][0] > 0 else "-" if h[0][0] < 0 else None
    trace = sum((h[i][i] for i in range(n)), arb(0))
    minors = sum((h[i][i] * h[j][j] - square(h[i][j]) for i, j in combinations(range(n), 2)), arb(0))
    if n == 2:
        if minors < 0:
            return "+-"
        return None if not minors > 0 else "++" if trace > 0 else "--" if trace < 0 else None
    determinant = _determinant(h)
    sign = 1 if determinant > 0 else -1 if determinant < 0 else 0
    if not sign:
        return None
    one, other = ("+", "-") if sign > 0 else ("-", "+")
    # one eigenvalue has the product's sign, and the other two have one sign: also that one, if the first and the second
    # symmetric function have the signs that they then have
    if sign * trace > 0 and minors > 0:
        return one * 3
    if sign * trace < 0 or minors < 0:
        return "".join(sorted([one, other, other], key="+-".index))
    return None


def _widest(jet: Jet, box: Box, whole: Floats) -> list[int]:
    """The unknowns in the order in which halving is worth most: those first that the equations vary with most."""

    def weight(k: int) -> float:
        if jet.short:
            change = sum(float((s.pull * (abs(s.slopes[k][0]) + abs(s.slopes[k][1]))).upper()) for s in jet.short)
        else:
            change = sum(float(row[k].abs_upper()) for row in jet.jacobian)
        return change * box[1][k] if isfinite(change) else box[1][k] / whole[k]

    weights = [weight(k) for k in range(len(whole))]
    shares = [r / w for r, w in zip(box[1], whole, strict=True)]
    largest = max(shares)
    # no unknown is left behind by far
    return sorted(range(len(whole)), key=lambda k: (shares[k] * 64 > largest, weights[k]), reverse=True)


def _halves(box: Box, order: Sequence[int], smallest: Sequence[float]) -> tuple[Box, Box] | None:
    """Two boxes that cover a box, halved in the first unknown in which it may be; None when it is too small."""
    for k in order:
        m, r = box[0][k], box[1][k]
        half, low, high = r / 2, m - r / 2, m + r / 2
        if m - low != half or high - m != half:
            # without this, doubles would leave a gap between the halves, or beside them
            half += 2.0**-51 * (abs(m) + r)
        if r >= smallest[k] and half <= 0.75 * r:
            return _with(box, k, low, half), _with(box, k, high, half)
    return None


def _with(box: Box, k: int, middle: float, half: float) -> Box:
    m, r = box
    return (*m[:k], middle, *m[k + 1 :]), (*r[:k], half, *r[k + 1 :])


def _difference(x: float, y: float, circle: bool) -> arb:
    """The difference of two numbers, less the whole turns that are next to it."""
    difference = arb(x) - arb(y)
    turns = round((x - y) / (2 * pi)) if circle else 0
    return difference - 2 * turns * arb.pi() if turns else difference


def _within(one: Floats, other: Floats, radii: Sequence[float], circles: Sequence[bool]) -> bool:
    """Whether two points are surely nearer than the radii in all unknowns."""
    return all(
        bool(abs(_difference(x, y, circle)) < radius)
        for x, y, radius, circle in zip(one, other, radii, circles, strict=True)
    )


def _inside(box: Box, zero: Zero, circles: Sequence[bool]) -> bool:
    """Whether the box is within that in which a solution is alone."""
    room = [(alone - r) * (1 - 2.0**-50) for alone, r in zip(zero.alone, box[1], strict=True)]
    return min(room) > 0 and _within(box[0], zero.center, room, circles)


def disjoint(one: Zero, two: Zero, circles: Sequence[bool]) -> bool:
    """Whether the boxes of two solutions are surely disjoint."""
    full = 2 * arb.pi()
    for x, y, r, s, circle in zip(one.center, two.center, one.radii, two.radii, circles, strict=True):
        difference, reach = _difference(x, y, circle), arb(r) + arb(s)
        if all(abs(difference + k * full) > reach for k in ((-1, 0, 1) if circle else (0,))):
            return True
    return False


def same(one: Zero, two: Zero, circles: Sequence[bool]) -> bool:
    """Whether a solution lies where another one is alone."""
    return all(
        bool(abs(_difference(x, y, circle)) + r < alone)
        for x, r, y, alone, circle in zip(one.center, one.radii, two.center, two.alone, circles, strict=True)
    )


__all__ = ["Box", "Floats", "Spent", "Zero", "disjoint", "inertia", "same", "zeros"]
