"""Checks of the solutions: each stored box contains a solution that counts, with the stored signs.

In each box Newton's method is started from the center; around the point it reaches, a smaller box X within the stored
one is proved to contain a solution by the interval Newton operator: m - F'(X)^-1 F(m) inside X (Moore; Krawczyk). The
signs of the Hessian's leading minors, of inequalities and of conditions for stability are then certain on X, or
precision is doubled. Where that finds nothing, as in a box much larger than the distance over which the equations bend,
nothing is said yet: trace forms count the solutions in the box, and tell the signs.

Guarantee: boxes that pass are disjoint and contain at least one solution each. As their number is the total that the
signatures of `ptmcad.verification.counts` give, each contains exactly one and together they contain all. No box has a
real solution that does not count: inequalities hold in all of it, or trace forms count one real solution in it; where
neither tells, that is listed as not checked. Conditions for stability that are said to be zero are so: trace forms give
the number of solutions at which one is, and in the other boxes it is not. A box is refused on such a count alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, islice, product

from flint import arb, arb_mat, ctx, fmpq_mpoly

from ptmcad.answer.regionmap import Cell, Solution
from ptmcad.model import Model
from ptmcad.text.balls import ball_of
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.numerals import approximate_text
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import Derivation
from ptmcad.verification.inertia import bases, leading_minors, negative_eigenvalues
from ptmcad.verification.report import Unchecked, Violation

BITS = (64, 128, 256, 512, 1024, 2048, 4096)
_ATTEMPTS = 3
"""Precisions with which Newton's method looks for a solution, before trace forms count those in the box."""
_STEPS = 8


def check_solutions(claims: Claims) -> str:
    """Every solution of every cell."""
    number = undecided = 0
    for n, cell in enumerate(claims.result.cells):
        if len(cell.solutions) != cell.total:
            raise Violation(f"cell {n} has {len(cell.solutions)} boxes of solutions, but {cell.total} equilibria")
        check_disjoint(n, cell, claims.model)
        for k, solution in enumerate(cell.solutions):
            try:
                _check_signs(claims, cell, solution)
                undecided += not _is_alone(claims, cell, solution)
            except Violation as violation:
                center = ", ".join(map(approximate_text, solution.center))
                radius = approximate_text(solution.radius)
                raise Violation(f"box {k} of cell {n} around ({center}), radius {radius}: {violation}") from None
            number += 1
        _check_zeros(claims, n, cell)
        if claims.describes_equilibria:
            _check_index(claims, n, cell)
    if undecided:
        return Unchecked(
            f"{undecided} of {number} boxes may hold solutions at which an inequality's polynomial is zero"
        )
    return f"{number} boxes"


def _check_signs(claims: Claims, cell: Cell, solution: Solution) -> None:
    """The box holds a solution that counts with these signs.

    Raises
    ------
    Violation
    """
    true = signs_of(claims, cell, solution)
    if true != solution.signs:
        what = "Hessian" if claims.describes_equilibria else "list of conditions for stability"
        are = "eigenvalues of signs" if claims.describes_equilibria else "the signs"
        raise Violation(f"the {what} at the solution in it has {are} {true!r}, not {solution.signs[:10]!r}")


def signs_of(claims: Claims, cell: Cell, solution: Solution) -> str:
    """The signs at the one solution that counts in a box: by Newton's method, else by trace forms.

    Raises
    ------
    Violation
        When there is none, or several.
    """
    tried = product(range(1 + 2 * len(claims.model.unknowns)), _precisions(solution)[:_ATTEMPTS])
    fibre = claims.fibre_at(*cell.sample)
    found = (_signs(fibre.point, solution, bits, start) for start, bits in tried)
    if (signs := next((signs for signs in found if signs is not None), None)) is not None:
        return signs
    number, place = fibre.within(solution.center, solution.radius, counted=True)
    if number != 1:
        raise Violation(f"{number or 'no'} solution{'s' * (number > 1)} found in it")
    return fibre.signs(place)


def _is_alone(claims: Claims, cell: Cell, solution: Solution) -> bool:
    """Whether a box that holds a solution that counts is proved to hold no other real one.

    Raises
    ------
    Violation
        When it does.
    """
    fibre = claims.fibre_at(*cell.sample)
    if not fibre.point.inequalities:
        return True  # all real solutions count, and have as many boxes that do not meet
    with ctx.workprec(_precisions(solution)[0]):
        around = [ball_of(x) + arb(0, ball_of(solution.radius)) for x in solution.center]
        if all(p > 0 for p in _values(fibre.point.inequalities, around)):
            return True
    number, _ = fibre.within(solution.center, solution.radius, counted=False)
    if number > 1:
        raise Violation(f"{number} real solutions are in it")
    return not fibre.saturated


def _precisions(solution: Solution) -> list[int]:
    """Precisions with which more is known than that a solution is in a box."""
    return [bits for bits in BITS if bits > int(1 / solution.radius).bit_length() * 3 // 2] or [BITS[-1]]


def _check_index(claims: Claims, n: int, cell: Cell) -> None:
    size = len(claims.model.unknowns)
    negative = [solution.signs.count("-") for solution in cell.solutions]
    index = tuple(negative.count(k) for k in range(size + 1))
    if index != cell.index:
        raise Violation(f"cell {n}: the solutions have index {index}, the cell {cell.index}")


def _check_zeros(claims: Claims, n: int, cell: Cell) -> None:
    """As many solutions as trace forms tell have a condition for stability that is zero."""
    if not any("0" in solution.signs for solution in cell.solutions):
        return
    fibre = claims.fibre_at(*cell.sample)
    for k, p in enumerate(fibre.point.stability):
        stored = sum(solution.signs[k] == "0" for solution in cell.solutions)
        if (true := fibre.number_of_zeros(p)) != stored:
            raise Violation(
                f"cell {n}: condition {k} for stability is said to be zero at {stored} solutions, but it is at {true}"
            )


def check_disjoint(n: int, cell: Cell, model: Model) -> None:
    turning = 2 * len(model.angles)
    for k, s in enumerate(cell.solutions):
        far = any(abs(x) > 2 for x in s.center[:turning])
        if len(s.center) != turning + len(model.reals) or s.radius <= 0 or s.radius > 1 or far:
            raise Violation(f"cell {n}: box {k} is not a box around a point of the torus")
    for (j, a), (k, b) in combinations(enumerate(cell.solutions), 2):
        if all(abs(x - y) <= a.radius + b.radius for x, y in zip(a.center, b.center, strict=True)):
            raise Violation(f"cell {n}: the boxes {j} and {k} of its solutions meet")


def _values(polynomials: Sequence[fmpq_mpoly], x: Sequence[arb]) -> list[arb]:
    """Values in balls at coordinates."""
    powers = [[arb(1)] for _ in x]
    found = []
    for p in polynomials:
        total = arb(0)
        for exponents, c in p.terms():
            term = arb(c)
            for known, coordinate, e in zip(powers, x, exponents, strict=True):
                while len(known) <= e:
                    known.append(known[-1] * coordinate)
                if e:
                    term = term * known[int(e)]
            total = total + term
        found.append(total)
    return found


def _jacobian(p: Derivation, x: Sequence[arb]) -> list[list[arb]]:
    """The derivatives of the equations; where solutions are critical points a Hessian."""
    return [_values(row, x) for row in p.jacobian]


def _signs(point: Derivation, solution: Solution, bits: int, start: int) -> str | None:
    """The signs at a solution that counts and is proved to be in the box; None when none is found from a start.

    Those of the Hessian's eigenvalues, or of the conditions for stability; where one of these is said to be zero it is
    left to `_check_zeros`.
    """
    with ctx.workprec(bits):
        found = _proved(point, solution, start)
        if found is None or not all(p > 0 for p in _values(point.inequalities, found)):
            return None
        if point.has_index:
            return _of_hessian(_jacobian(point, found), BITS.index(bits))
        return _of_conditions(_values(point.stability, found), solution.signs)


def _of_hessian(hessian: list[list[arb]], attempt: int) -> str | None:
    """The signs of a symmetric matrix's eigenvalues, positive ones first; None when they are not certain."""
    size = len(hessian)
    basis = next(islice(bases(size), attempt, None))
    minors = leading_minors(hessian, basis, size)
    if any(m.contains(0) for m in minors):
        return None
    negative = negative_eigenvalues(1 if m > 0 else -1 for m in minors)
    return "+" * (size - negative) + "-" * negative


def _of_conditions(conditions: list[arb], stored: str) -> str | None:
    """The conditions' signs, 0 where that is stored and not refuted; None when one is not certain."""
    if len(stored) != len(conditions):
        stored = " " * len(conditions)
    signs = ""
    for value, sign in zip(conditions, stored, strict=True):
        if value.contains(0):
            if sign != "0":
                return None
            signs += "0"
        else:
            signs += "+" if value > 0 else "-"
    return signs


def _proved(model: Derivation, solution: Solution, start: int) -> list[arb] | None:
    """A box within the stored one that is proved to contain a solution.

    Angles are moved along the circles: turned by an angle a, the point (c, s) that Newton's method has reached becomes
    (c cos a - s sin a, s cos a + c sin a), so that c^2 + s^2 = 1 holds by construction.

    Parameters
    ----------
    start : 0 at the box's center; other numbers half way to one of its sides.
    """
    turning = 2 * len(model.ring.angles)
    center = _normal([ball_of(x) for x in solution.center], turning)
    # the Jacobian may be singular at the center itself, as at a cusp whose coordinates the box has
    step = arb(from_fraction(solution.radius) / (-2 if start % 2 else 2))
    aside = [step if start and k == (start - 1) // 2 else arb(0) for k in range(len(model.unknowns))]
    reached = _iterated(model, _normal(_moved(center, aside, turning), turning))
    if reached is None:
        return None
    point, step = reached
    # the point now has exact circles up to rounding, which its balls contain
    # wide against rounding, narrow against the distance over which the Jacobian varies
    radius = (step * 8 + arb(2) ** (-2 * ctx.prec // 3)).mid()
    around = _moved(point, [arb(0).union(radius).union(-radius)] * len(model.unknowns), turning)
    image = _solve(_jacobian(model, around), _values(model.equations, point))
    if image is None or not all(abs(a) < radius for a in image):
        return None
    inside = all(
        abs(x - from_fraction(center)) <= from_fraction(solution.radius)
        for x, center in zip(around, solution.center, strict=True)
    )
    return around if inside else None


def _iterated(model: Derivation, point: list[arb]) -> tuple[list[arb], arb] | None:
    """The point that Newton's method reaches, and the length of its last step; None at a singular Jacobian."""
    turning, step = 2 * len(model.ring.angles), arb(1)
    for _ in range(_STEPS + ctx.prec.bit_length()):
        step_by = _solve(_jacobian(model, point), _values(model.equations, point))
        if step_by is None:
            return None
        point = [x.mid() for x in _moved(point, [-a.mid() for a in step_by], turning)]
        point = _normal(point, turning)
        step = max(abs(a.mid()) for a in step_by)
        if step < arb(2) ** (8 - ctx.prec):
            break
    return point, step


def _normal(point: list[arb], turning: int) -> list[arb]:
    """The coordinates with those of angles on the unit circle in their direction, in balls that contain it."""
    found = []
    for c, s in zip(point[:turning:2], point[1:turning:2], strict=True):
        length = (c * c + s * s).sqrt()
        found += [c / length, s / length]
    return found + point[turning:]


def _moved(point: list[arb], by: list[arb], turning: int) -> list[arb]:
    """The coordinates after a step of each unknown."""
    moved = []
    for k, angle in enumerate(by[: turning // 2]):
        c, s = point[2 * k], point[2 * k + 1]
        moved += [c * angle.cos() - s * angle.sin(), s * angle.cos() + c * angle.sin()]
    return moved + [x + step for x, step in zip(point[turning:], by[turning // 2 :], strict=True)]


def _solve(matrix: list[list[arb]], right: list[arb]) -> list[arb] | None:
    """The solutions of a linear system for every matrix in the balls; None when some of them may be singular."""
    try:
        x = arb_mat(matrix).solve(arb_mat([[r] for r in right]))
    except ZeroDivisionError:
        return None
    return [x[i, 0] for i in range(len(right))]
