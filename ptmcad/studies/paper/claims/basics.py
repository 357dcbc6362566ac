"""The claims of section 2 (potential, equations) and of the opening of section 3 (half angles, elimination, stability).

Guarantee: verdicts follow from identities of polynomials in all parameters, and from exact counts at named points.
"""

from __future__ import annotations

import sympy as sp

from ptmcad.exact.models.potential import geometry_of
from ptmcad.mechanism import ptm
from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Claim, Outcome, judge, unchecked
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


def fixed_point() -> Outcome:
    at = geometry_of(ptm()).nodes
    moving = tuple(
        name for name in ("A1", "A2") if any(any(sum(e) for e in p.to_dict()) for p in at[name])
    )  # fmt: skip
    return judge(
        "A1" not in moving and "A2" not in moving,
        (f"of the two ends of the base, {' and '.join(moving)} depends on a parameter (rho)",),
        {"moving": moving},
        corrected=moving == ("A2",),
        right="point A1 is fixed; A2 moves along the x-axis",
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


def three_dof() -> Outcome:
    by_coordinates, by_constraints = degrees_of_freedom()
    at = coordinates()
    actuated = all(p.free_symbols <= {rho} for p in at["A2"]) and at["A2"][0] == rho
    return judge(
        by_coordinates == by_constraints == 3 and actuated,
        (
            "the nodes' positions have independent derivatives by rho, th1 and th2: their Gram determinant is "
            "L1^2 L2^2 (1 + cos^2 th2)",
            f"A2 on its axis, A3 and A4 have five coordinates, and the rods are two independent constraints: "
            f"{by_constraints} degrees of freedom",
            "A2, which the actuator moves, depends on rho alone",
        ),
        {"by coordinates": by_coordinates, "by constraints": by_constraints, "A2 by rho alone": actuated},
    )


def one_dof() -> Outcome:
    whole, _ = degrees_of_freedom()
    bound = len(sextic()) - 1
    _, only_there = when_infinite()
    return judge(
        whole == 1,
        (
            f"the rods and the slider leave {whole} degrees of freedom, as section 2 says",
            f"for a given rho there are at most {bound} equilibria (finitely many but for rho = 0 without loads): in "
            "equilibrium the input decides, up to a choice among finitely many poses",
        ),
        {"degrees of freedom": whole, "equilibria at most": bound, "finite": only_there},
        corrected=whole == 3 and bound == 6 and only_there,
        right="three degrees of freedom, one of them actuated; equilibrium leaves one, for it fixes the other two up "
        "to a choice among at most six poses (but for rho = 0 without loads)",
        witness="section 2 of the paper counts three",
    )


def potential_1() -> Outcome:
    x3, y3, x4, y4 = L1 * c1, L1 * s1, rho - L2 * c2, L2 * s2
    lengths = x4**2 + y4**2 + (x3 - rho) ** 2 + y3**2 + (x4 - x3) ** 2 + (y4 - y3) ** 2
    holds = equal(potential().subs(VERTICAL), k / 2 * lengths - F3 * y3 - F4 * y4)
    return judge(holds, ("the model's potential is (1) with the nodes' coordinates put in",), {"holds": holds})


def potential_2() -> Outcome:
    ours = potential().subs(VERTICAL)
    as_printed, without = equal(ours, printed.potential_2(rho)), equal(ours, printed.potential_2(sp.Integer(1)))
    return judge(
        as_printed,
        ("y3 = L1 sin th1 and y4 = L2 sin th2, so the work of the forces has no factor rho",),
        {"printed": as_printed, "without rho": without},
        corrected=without,
        right="... - F3 L1 sin th1 - F4 L2 sin th2",
    )


def _equation(number: int, printed_one: sp.Expr, right_one: sp.Expr, right: str) -> Outcome:
    length = (L1, L2)[number]
    ours = -gradient()[number].subs(VERTICAL) / length
    as_printed, corrected = equal(ours, printed_one), equal(ours, right_one)
    angle = number + 1
    return judge(
        as_printed,
        (f"-(1/(L{angle} k)) dU/dth{angle} was compared with the printed equation, as polynomials",),
        {"printed": as_printed, "right": corrected},
        corrected=corrected,
        right=right,
    )


def equation_3() -> Outcome:
    return _equation(1, printed.EQUATION_3, printed.EQUATION_3, "")


def equation_4() -> Outcome:
    right = "L2 sin(th2 + th1) - 2 rho sin th1 + F3' cos th1 = 0"
    return _equation(0, printed.EQUATION_4_PRINTED, printed.EQUATION_4, right)


def both_kinds() -> Outcome:
    found = [(c.total, c.stable) for f in ("fig2", "fig3", "fig4") for c in region_map(f).cells]
    mixed = all(total is not None and stable is not None and 0 < stable < total for total, stable in found)
    return judge(
        mixed,
        (f"in each of the {len(found)} cells of figs. 2 to 4 some equilibria are stable and some are not",),
        {"cells": len(found), "both kinds everywhere": mixed},
    )


def equation_5() -> Outcome:
    ours = half_angle_equations()[0].subs(VERTICAL) * k
    holds = bool(sp.expand(ours - printed.EQUATION_5) == 0)
    return judge(holds, ("(5) is dU/dth1 in half angles, divided by L1 k",), {"printed": holds})


def equation_6() -> Outcome:
    ours = half_angle_equations()[1].subs(VERTICAL) * k
    as_printed, right = (
        bool(sp.expand(ours - e) == 0) for e in (printed.EQUATION_6_PRINTED, printed.EQUATION_6)
    )  # fmt: skip
    agrees = bool(sp.expand(printed.EQUATION_6.subs({F3: F4, L2: L1}) - printed.EQUATION_11) == 0)
    return judge(
        as_printed,
        ("(6) is dU/dth2 in half angles, divided by L2 k", "the paper's own (11) has the right signs"),
        {"printed": as_printed, "right": right, "11 agrees with the right one": agrees},
        corrected=right,
        right="... - F4' t1^2 + F4' t2^2 ... in place of + F4' t1^2 - F4' t2^2",
    )


def degree_six() -> Outcome:
    first, second = (e.subs({**VERTICAL, k: 1}) for e in half_angle_equations())
    resultant, _, _ = quadratic_elimination(first, second, t1)
    polynomial = sp.Poly(resultant, t2)
    degree = polynomial.degree()
    coefficients = sextic()  # raises unless the factor 1 + t2^2 is there once
    left = len(coefficients) - 1
    in_t1 = bool(polynomial.has(t1))
    return judge(
        in_t1 and left == 6,
        (
            f"with all parameters symbolic, the resultant by t1 has degree {degree} in t2; "
            f"divided by 1 + t2^2, degree {left}",
            "when t1 is eliminated, t2 remains, so the factor is 1 + t2^2 and not 1 + t1^2",
        ),
        {"degree of the resultant": degree, "degree left": left, "contains t1": in_t1},
        corrected=left == 6 and degree == 8 and not in_t1,
        right="eliminating t1 leaves a polynomial of degree 6 in t2 after the factor 1 + t2^2 is cleared",
    )


def linear_back_solve() -> Outcome:
    first, second = (e.subs({**VERTICAL, k: 1}) for e in half_angle_equations())
    _, a, b = quadratic_elimination(first, second, t1)
    generic = a != 0
    fails = bool(sp.expand(a.subs(UNLOADED)) != 0) and all(
        sp.expand(p.subs(UNLOADED).subs(t2, 0)) == 0 for p in (a, b)
    )  # fmt: skip
    counted = equilibria_at(L2="3/2", rho=1)
    flat = sum(heights(e)[1] == 0 and e.center[2] > 0 for e in counted.solutions)
    return judge(
        generic and not fails,
        (
            "the combination of (5) and (6) without t1^2 is a t1 + b with a not identically zero, so t1 follows "
            "from t2",
            "where a and b both vanish it says nothing: without loads this is so at t2 = 0, "
            f"over which there are {flat} equilibria (th1 = 0 and th1 = pi)",
        ),
        {"generic": generic, "fails unloaded at t2 = 0": fails, "equilibria over t2 = 0": flat},
        corrected=generic,
        right="the linear equation gives t1 from t2 (t1 is what was eliminated), unless both its coefficients vanish",
        witness="F3 = F4 = 0, t2 = 0",
    )


def up_to_six() -> Outcome:
    counts = equilibria_at(L2="3/2", rho="7/10", F3=-10, F4=-10)
    bound = len(sextic()) - 1
    return judge(
        bound == 6 and counts.total == 6,
        (
            f"the eliminated polynomial has degree {bound}, and {counts.total} real equilibria are attained "
            "at L1 = 1, L2 = 3/2, rho = 7/10, F3 = F4 = -10, k = 100",
        ),
        {"bound": bound, "attained": counts.total},
    )


def sylvester() -> Outcome:
    h11, h12, h22 = hessian()
    completed = equal(h11 * (h11 * t1**2 + 2 * h12 * t1 + h22), (h11 * t1 + h12) ** 2 + h11 * h22 - h12**2)
    return judge(
        completed,
        ("h11 (h11 x^2 + 2 h12 x + h22) = (h11 x + h12)^2 + det H, so both signs positive is positive definite",),
        {"identity": completed},
    )


def large_minors() -> Outcome:
    h11 = sp.expand(hessian()[0].subs(VERTICAL))
    terms, whole = len(h11.args), len(sp.expand(determinant().subs(VERTICAL)).args)
    short = equal(h11, L1 * (2 * k * rho * c1 + F3 * s1 - k * L2 * printed.COS_SUM))
    numerator = sp.numer(sp.together(half_angles(determinant().subs(VERTICAL))))
    return unchecked(
        "how long an expression has to be to be large is no question of mathematics",
        f"as trigonometric polynomials H(1,1) has {terms} terms: L1 (2 k rho cos th1 + F3 sin th1 - k L2 "
        "cos(th1 + th2)) "
        f"({'checked' if short else 'NOT the case'}), det H has {whole}",
        f"in half angles the numerator of det H has {len(sp.Poly(numerator, t1, t2).terms())} terms in t1, t2",
    )()


def cleared_equations_agree() -> Outcome:
    holds = all(
        bool(sp.expand(cleared(g.subs(VERTICAL)) - e) == 0)
        for g, e in zip(gradient(), (L1 * printed.EQUATION_5, L2 * printed.EQUATION_6), strict=True)
    )
    return judge(
        holds,
        (
            "the substitution loses the angle pi: t is infinite there, and an equilibrium with th2 = pi is a root at "
            "infinity, where the degree drops",
        ),
        {"holds": holds},
    )


CLAIMS = (
    Claim("2-fixed-point", "2", "Point A1A2 is fixed", "A1 is fixed while A2 slides.", fixed_point),
    Claim("2-dof", "2", "This mechanism has three dof", "One actuated and two compliant degrees of freedom.",
          three_dof),
    Claim("a-one-dof", "abstract", "planar one-degree-of-freedom (dof) tensegrity mechanisms",
          "The mechanism has one degree of freedom.", one_dof),
    Claim("2-zero-free-length", "2", "equivalent zero free lengths springs can be designed",
          "Springs of free length zero can be built.", unchecked("a statement about hardware, taken from references")),
    Claim("2-eq1", "2", "U = k/2 sum l_i^2 - F3 y3 - F4 y4", "Equation (1), the potential.", potential_1),
    Claim("2-eq2", "2", "U can be shown to take the form", "Equation (2), the potential in the angles.", potential_2),
    Claim("2-eq3", "2", "Eq. (3)", "Equation (3), equilibrium of the second rod.", equation_3),
    Claim("2-eq4", "2", "Eq. (4)", "Equation (4), equilibrium of the first rod.", equation_4),
    Claim("2-both-kinds", "2", "both stable and unstable solutions will be obtained",
          "The equations have stable and unstable solutions.", both_kinds),
    Claim("3-half-angles", "3", "resorting to the tan-half-angle substitutions",
          "Equations (3), (4) become polynomials in t1, t2.", cleared_equations_agree),
    Claim("3-eq5", "3", "Eq. (5)", "Equation (5).", equation_5),
    Claim("3-eq6", "3", "Eq. (6)", "Equation (6).", equation_6),
    Claim("3-degree-6", "3", "a polynomial of degree 6 is obtained after clearing the factor",
          "Eliminating t1 gives degree 6 after a factor 1 + t1^2 is cleared.", degree_six),
    Claim("3-linear", "3", "t2 is then solved with a linear equation",
          "The other unknown follows from a linear equation.", linear_back_solve),
    Claim("3-up-to-6", "3", "the mechanism may have up to 6 solutions", "At most six equilibria, and six occur.",
          up_to_six),
    Claim("3-minors", "3", "if its leading principal minors are greater than zero",
          "Stable exactly when H(1,1) > 0 and det H > 0 (H nonsingular).", sylvester),
    Claim("3.3-large", "3.3", "Their expression is large", "The minors of H are long expressions.", large_minors),
)  # fmt: skip
