"""Checks of the solutions: each stored box contains an equilibrium, with a Hessian of the stored signs.

In each box Newton's method is started from the center; around the point it reaches, a smaller box X within the stored
one is proved to contain a solution by the interval Newton operator: m - F'(X)^-1 F(m) inside X (Moore; Krawczyk). The
signs of det H and tr H are then certain on X, or precision is doubled.

Guarantee: boxes that pass are disjoint and contain at least one solution each. As their number is the total that the
signatures of `ptmcad.verification.counts` give, each contains exactly one and together they contain all.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import combinations

from flint import arb, arb_mat, ctx

from ptmcad.answer.regionmap import Cell, Solution
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import ANGLES, PARAMETERS, Configuration, potential, rational
from ptmcad.verification.jets import circle
from ptmcad.verification.report import Violation

BITS = (64, 128, 256, 512, 1024, 2048, 4096)
_STEPS = 8


def check_solutions(claims: Claims) -> str:
    """Every solution of every cell."""
    number = 0
    for n, cell in enumerate(claims.result.cells):
        if len(cell.solutions) != cell.total:
            raise Violation(f"cell {n} has {len(cell.solutions)} boxes of solutions, but {cell.total} equilibria")
        _check_disjoint(n, cell)
        values = claims.parameters_at(*cell.sample)
        signs = []
        for k, solution in enumerate(cell.solutions):
            true = _signs(values, solution)
            if true is None:
                raise Violation(f"cell {n}: no solution was found in the box {k} around {_center(solution)}, "
                                f"radius {float(solution.radius):.1e}")  # fmt: skip
            if true != solution.signs:
                raise Violation(f"cell {n}: the Hessian at the solution near {_center(solution)} has eigenvalues of "
                                f"signs {true}, not {solution.signs[:10]}")  # fmt: skip
            signs.append(true)
            number += 1
        index = (signs.count("++"), signs.count("+-"), signs.count("--"))
        if index != cell.index:
            raise Violation(f"cell {n}: the solutions have index {index}, the cell {cell.index}")
    return f"{number} boxes"


def _center(solution: Solution) -> str:
    return "(" + ", ".join(f"{float(x):.6g}" for x in solution.center) + ")"


def _check_disjoint(n: int, cell: Cell) -> None:
    for k, s in enumerate(cell.solutions):
        if len(s.center) != 4 or s.radius <= 0 or s.radius > 1 or any(abs(x) > 2 for x in s.center):
            raise Violation(f"cell {n}: box {k} is not a box around a point of the torus")
    for (j, a), (k, b) in combinations(enumerate(cell.solutions), 2):
        if all(abs(x - y) <= a.radius + b.radius for x, y in zip(a.center, b.center, strict=True)):
            raise Violation(f"cell {n}: the boxes {j} and {k} of its solutions meet")


class _Energy:
    """Gradient and Hessian of the potential in balls, by jets of what the description lists."""

    def __init__(self, values: Mapping[str, Fraction]):
        self.parameters = {name: arb(rational(values[name])) for name in PARAMETERS}

    def __call__(self, x: list[arb]) -> tuple[list[arb], list[list[arb]]]:
        angles = range(len(ANGLES))
        circles = {angle: circle(k, x[2 * k], x[2 * k + 1]) for k, angle in enumerate(ANGLES)}
        energy = potential(Configuration(self.parameters, circles))
        zero = arb(0)
        return (
            [energy.slopes.get(i, zero) for i in angles],
            [[energy.bends.get((min(i, j), max(i, j)), zero) for j in angles] for i in angles],
        )


def _signs(values: Mapping[str, Fraction], solution: Solution) -> str | None:
    """The signs of the Hessian's eigenvalues at a solution that is proved to be in the box; None when none is found."""
    for bits in BITS:
        with ctx.workprec(bits):
            proved = _proved(values, solution)
            if proved is None:
                continue
            _, ((h11, h12), (_, h22)) = _Energy(values)(proved)
            determinant, trace = h11 * h22 - h12 * h12, h11 + h22
            if determinant < 0:
                return "+-"
            if determinant > 0 and trace > 0:
                return "++"
            if determinant > 0 and trace < 0:
                return "--"
    return None


def _proved(values: Mapping[str, Fraction], solution: Solution) -> list[arb] | None:
    """Balls for the unknowns, within the box, that contain a solution.

    The unknowns are moved along the circles: turned by an angle a, the point (c, s) that Newton's method has reached
    becomes (c cos a - s sin a, s cos a + c sin a), so that c^2 + s^2 = 1 holds by construction.
    """
    energy = _Energy(values)
    c1, s1, c2, s2 = (arb(rational(x)) for x in solution.center)
    point = [*_normal(c1, s1), *_normal(c2, s2)]
    step = arb(1)
    for _ in range(_STEPS + ctx.prec.bit_length()):
        gradient, hessian = energy(point)
        step_by = _solve(hessian, gradient)
        if step_by is None:
            return None
        point = [x.mid() for x in _turned(point, [-a.mid() for a in step_by])]
        point = [*_normal(point[0], point[1]), *_normal(point[2], point[3])]
        step = max(abs(a.mid()) for a in step_by)
        if step < arb(2) ** (8 - ctx.prec):
            break
    # the point now has exact circles up to rounding, which its balls contain
    # wide against rounding, narrow against the distance over which the Hessian varies
    radius = (step * 8 + arb(2) ** (-2 * ctx.prec // 3)).mid()
    spread = [arb(0).union(radius).union(-radius) for _ in (0, 1)]
    around = _turned(point, spread)
    gradient, _ = energy(point)
    _, hessian = energy(around)
    image = _solve(hessian, gradient)
    if image is None or not all(abs(a) < radius for a in image):
        return None
    inside = all(
        abs(x - rational(center)) <= rational(solution.radius)
        for x, center in zip(around, solution.center, strict=True)
    )
    return around if inside else None


def _normal(c: arb, s: arb) -> tuple[arb, arb]:
    """The point of the unit circle in the direction (c, s), in balls that contain it."""
    length = (c * c + s * s).sqrt()
    return c / length, s / length


def _turned(point: list[arb], by: list[arb]) -> list[arb]:
    turned = []
    for k, angle in enumerate(by):
        c, s = point[2 * k], point[2 * k + 1]
        turned += [c * angle.cos() - s * angle.sin(), s * angle.cos() + c * angle.sin()]
    return turned


def _solve(matrix: list[list[arb]], right: list[arb]) -> list[arb] | None:
    """The solutions of a linear system for every matrix in the balls; None when some of them may be singular."""
    try:
        x = arb_mat(matrix).solve(arb_mat([[r] for r in right]))
    except ZeroDivisionError:
        return None
    return [x[0, 0], x[1, 0]]
