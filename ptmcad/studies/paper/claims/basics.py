"""The claims of section 2 (potential, equations) and of the opening of section 3 (half angles, elimination, stability).

Guarantee: verdicts follow from identities of polynomials in all parameters, and from exact counts at named points.
"""

from __future__ import annotations

import sympy as sp

from ptmcad.exact.models.potential import geometry_of
from ptmcad.mechanism import ptm
from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Finding
from ptmcad.studies.paper.claims.overall import when_infinite
from ptmcad.studies.paper.slices import equilibria_at, heights, region_map
from ptmcad.studies.paper.symbolic import (
    F3,
    F4,
    L1,
    L2,
    UNLOADED,
    VERTICAL,
    by_angle,
    c1,
    c2,
    cleared,
    coordinates,
    determinant,
    equal,
    gradient,
    half_angle_equations,
    half_angles,
    hessian,
    k,
    potential,
    quadratic_elimination,
    rho,
    s1,
    s2,
    sextic,
    t1,
    t2,
    vanishes,
)


def fixed_point() -> Finding:
    at = geometry_of(ptm()).nodes
    moving = tuple(
        name for name in ("A1", "A2") if any(any(sum(e) for e in p.to_dict()) for p in at[name])
    )  # fmt: skip
    return Finding(
        "A1" not in moving and "A2" not in moving,
        {"moving": moving},
        corrected=moving == ("A2",),
        said={"which": " and ".join(moving)},
    )


def degrees_of_freedom() -> tuple[int, int]:
    """How many numbers the nodes' positions depend on, by coordinates and by constraints; both are exact.

    The nodes move with rho, th1 and th2, and the Gram determinant of their derivatives is L1^2 L2^2 (1 + c2^2) > 0, so
    positions are a manifold of dimension 3. A2 on the axis, A3 and A4 anywhere have five coordinates; the rods' lengths
    are two constraints, whose gradients are independent where both rods have a length.
    """
    at = coordinates()
    moving = [p for name in ("A2", "A3", "A4") for p in at[name]]
    columns = ([sp.diff(p, rho) for p in moving], [by_angle(p, 1) for p in moving], [by_angle(p, 2) for p in moving])
    gram = sp.Matrix(3, 3, lambda i, j: sum(p * q for p, q in zip(columns[i], columns[j], strict=True)))
    regular = vanishes(gram.det() - L1**2 * L2**2 * (1 + c2**2))
    (x1, y1), (x2, y2), (x3, y3), (x4, y4) = (at[name] for name in ("A1", "A2", "A3", "A4"))
    free = sp.symbols("x2 x3 y3 x4 y4")
    rods = ((free[1] - x1) ** 2 + (free[2] - y1) ** 2, (free[3] - free[0]) ** 2 + (free[4] - y2) ** 2)
    there = dict(zip(free, (x2, x3, y3, x4, y4), strict=True))
    rows = sp.Matrix(2, 5, lambda i, j: sp.diff(rods[i], free[j]).subs(there))
    independent = vanishes((rows[:, [1, 2]].row(0) * rows[:, [1, 2]].row(0).T)[0] - 4 * L1**2) and vanishes(
        (rows[:, [3, 4]].row(1) * rows[:, [3, 4]].row(1).T)[0] - 4 * L2**2
    )
    separate = rows[0, 3] == rows[0, 4] == rows[1, 1] == rows[1, 2] == 0
    return (3 if regular else -1, 5 - 2 if independent and separate else -1)


def three_dof() -> Finding:
    by_coordinates, by_constraints = degrees_of_freedom()
    at = coordinates()
    actuated = all(p.free_symbols <= {rho} for p in at["A2"]) and at["A2"][0] == rho
    return Finding(
        by_coordinates == by_constraints == 3 and actuated,
        {"by coordinates": by_coordinates, "by constraints": by_constraints, "A2 by rho alone": actuated},
    )


def one_dof() -> Finding:
    whole, _ = degrees_of_freedom()
    bound = len(sextic()) - 1
    _, only_there = when_infinite()
    return Finding(
        whole == 1,
        {"degrees of freedom": whole, "equilibria at most": bound, "finite": only_there},
        corrected=whole == 3 and bound == 6 and only_there,
    )


def potential_1() -> Finding:
    x3, y3, x4, y4 = L1 * c1, L1 * s1, rho - L2 * c2, L2 * s2
    lengths = x4**2 + y4**2 + (x3 - rho) ** 2 + y3**2 + (x4 - x3) ** 2 + (y4 - y3) ** 2
    holds = equal(potential().subs(VERTICAL), k / 2 * lengths - F3 * y3 - F4 * y4)
    return Finding(holds, {"holds": holds})


def potential_2() -> Finding:
    ours = potential().subs(VERTICAL)
    as_printed, without = equal(ours, printed.potential_2(rho)), equal(ours, printed.potential_2(sp.Integer(1)))
    return Finding(as_printed, {"printed": as_printed, "without rho": without}, corrected=without)


def _equation(number: int, as_printed: sp.Expr, right: sp.Expr) -> Finding:
    ours = -gradient()[number].subs(VERTICAL) / (L1, L2)[number]
    holds, corrected = equal(ours, as_printed), equal(ours, right)
    return Finding(holds, {"printed": holds, "right": corrected}, corrected=corrected, said={"angle": number + 1})


def equation_3() -> Finding:
    return _equation(1, printed.EQUATION_3, printed.EQUATION_3)


def equation_4() -> Finding:
    return _equation(0, printed.EQUATION_4_PRINTED, printed.EQUATION_4)


def both_kinds() -> Finding:
    found = [(c.total, c.stable) for f in ("fig2", "fig3", "fig4") for c in region_map(f).cells]
    mixed = all(total is not None and stable is not None and 0 < stable < total for total, stable in found)
    return Finding(mixed, {"cells": len(found), "both kinds everywhere": mixed})


def equation_5() -> Finding:
    ours = half_angle_equations()[0].subs(VERTICAL) * k
    holds = bool(sp.expand(ours - printed.EQUATION_5) == 0)
    return Finding(holds, {"printed": holds})


def equation_6() -> Finding:
    ours = half_angle_equations()[1].subs(VERTICAL) * k
    as_printed, right = (
        bool(sp.expand(ours - e) == 0) for e in (printed.EQUATION_6_PRINTED, printed.EQUATION_6)
    )  # fmt: skip
    agrees = bool(sp.expand(printed.EQUATION_6.subs({F3: F4, L2: L1}) - printed.EQUATION_11) == 0)
    return Finding(
        as_printed, {"printed": as_printed, "right": right, "11 agrees with the right one": agrees}, corrected=right
    )


def degree_six() -> Finding:
    first, second = (e.subs({**VERTICAL, k: 1}) for e in half_angle_equations())
    resultant, _, _ = quadratic_elimination(first, second, t1)
    polynomial = sp.Poly(resultant, t2)
    degree = polynomial.degree()
    coefficients = sextic()  # raises unless the factor 1 + t2^2 is there once
    left = len(coefficients) - 1
    in_t1 = bool(polynomial.has(t1))
    return Finding(
        in_t1 and left == 6,
        {"degree of the resultant": degree, "degree left": left, "contains t1": in_t1},
        corrected=left == 6 and degree == 8 and not in_t1,
    )


def linear_back_solve() -> Finding:
    first, second = (e.subs({**VERTICAL, k: 1}) for e in half_angle_equations())
    _, a, b = quadratic_elimination(first, second, t1)
    generic = a != 0
    fails = bool(sp.expand(a.subs(UNLOADED)) != 0) and all(
        sp.expand(p.subs(UNLOADED).subs(t2, 0)) == 0 for p in (a, b)
    )  # fmt: skip
    counted = equilibria_at(L2="3/2", rho=1)
    flat = sum(heights(e)[1] == 0 and e.center[2] > 0 for e in counted.solutions)
    return Finding(
        generic and not fails,
        {"generic": generic, "fails unloaded at t2 = 0": fails, "equilibria over t2 = 0": flat},
        corrected=generic,
    )


def up_to_six() -> Finding:
    counts = equilibria_at(L2="3/2", rho="7/10", F3=-10, F4=-10)
    bound = len(sextic()) - 1
    return Finding(bound == 6 and counts.total == 6, {"bound": bound, "attained": counts.total})


def sylvester() -> Finding:
    h11, h12, h22 = hessian()
    completed = equal(h11 * (h11 * t1**2 + 2 * h12 * t1 + h22), (h11 * t1 + h12) ** 2 + h11 * h22 - h12**2)
    return Finding(completed, {"identity": completed})


def large_minors() -> Finding:
    h11 = sp.expand(hessian()[0].subs(VERTICAL))
    terms, whole = len(h11.args), len(sp.expand(determinant().subs(VERTICAL)).args)
    short = equal(h11, L1 * (2 * k * rho * c1 + F3 * s1 - k * L2 * printed.COS_SUM))
    numerator = sp.Poly(sp.numer(sp.together(half_angles(determinant().subs(VERTICAL)))), t1, t2)
    checked = "checked" if short else "NOT the case"
    said = {"terms": terms, "checked": checked, "whole": whole, "numerator": len(numerator.terms())}
    return Finding(
        False, {}, said=said, missing="how long an expression has to be to be large is no question of mathematics"
    )


def cleared_equations_agree() -> Finding:
    holds = all(
        bool(sp.expand(cleared(g.subs(VERTICAL)) - e) == 0)
        for g, e in zip(gradient(), (L1 * printed.EQUATION_5, L2 * printed.EQUATION_6), strict=True)
    )
    return Finding(holds, {"holds": holds})
