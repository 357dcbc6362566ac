"""The paper's equations, corrected, as text and LaTeX, written from the model and not from the paper.

Guarantee: every expression is derived from the potential of the model by differentiation, substitution of half angles
and elimination, or is a factor of a computed discriminant variety.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from ptmcad.studies.paper.claims.symmetric import OTHER, eliminated_12, on_unequal
from ptmcad.studies.paper.claims.symmetric import equations as symmetric_equations
from ptmcad.studies.paper.claims.unloaded import COS1, COS2
from ptmcad.studies.paper.slices import curves
from ptmcad.studies.paper.symbolic import (
    F3,
    F4,
    L1,
    L2,
    UNLOADED,
    VERTICAL,
    Expr,
    F3x,
    F4x,
    c1,
    c2,
    determinant,
    gradient,
    half_angle_equations,
    hessian,
    k,
    potential,
    rho,
    s1,
    s2,
    sextic,
    t1,
    t2,
)
from ptmcad.studies.tables import page
from ptmcad.text.plane import PlanePolynomial

_THETA1, _THETA2 = sp.symbols("theta_1 theta_2", real=True)
_REDUCED = {F3: k * sp.Symbol("f3"), F4: k * sp.Symbol("f4"), F3x: k * sp.Symbol("f3x"), F4x: k * sp.Symbol("f4x")}
_LATEX_NAMES = {
    L1: "L_1", L2: "L_2", rho: r"\rho", t1: "t_1", t2: "t_2", F3: "F_3", F4: "F_4",
    **{sp.Symbol(n): t for n, t in (("f3", "f_3"), ("f4", "f_4"), ("f3x", "f_{3x}"), ("f4x", "f_{4x}"))},
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Equation:
    """One equation: its number in the paper, what it is, and both sides as text and LaTeX."""

    number: str
    what: str
    text: str
    latex: str


def _shown(expression: Expr) -> Expr:
    total = _THETA1 + _THETA2
    compact = sp.expand(expression).subs(c1 * c2, sp.cos(total) + s1 * s2).expand()
    compact = compact.subs(s1 * c2, sp.sin(total) - c1 * s2).expand()
    expression = compact if compact.has(total) else expression
    angles = {c1: sp.cos(_THETA1), s1: sp.sin(_THETA1), c2: sp.cos(_THETA2), s2: sp.sin(_THETA2)}
    return expression.subs(angles)


def _equation(number: str, what: str, left: str, left_latex: str, right: Expr) -> Equation:
    shown = _shown(right)
    latex = sp.latex(shown, symbol_names=_LATEX_NAMES)
    return Equation(number, what, f"{left} = {sp.sstr(shown).replace('**', '^')}", f"{left_latex} = {latex}")


@lru_cache(maxsize=1)
def equations() -> tuple[Equation, ...]:
    """The equations of the paper in their order, corrected."""
    first, second = (sp.expand(g.subs(_REDUCED) / k) for g in gradient())
    e3 = sp.expand(-second.subs({sp.Symbol("f4x"): 0}) / L2)
    e4 = sp.expand(-first.subs({sp.Symbol("f3x"): 0}) / L1)
    e5, e6 = (sp.expand(e.subs(_REDUCED)) for e in half_angle_equations())
    still = {sp.Symbol("f3x"): 0, sp.Symbol("f4x"): 0}
    h11, h12, h22 = (h.subs(VERTICAL) for h in hessian())
    tenth = sp.factor(sp.expand(sum(s * e for s, e in zip((1, -1), symmetric_equations(), strict=True)) / 2))
    found = [
        _equation("(2)", "potential", "U", "U", sp.expand(potential().subs(VERTICAL))),
        _equation("(3)", "-(1/(L2 k)) dU/dth2", "0", "0", e3),
        _equation("(4)", "-(1/(L1 k)) dU/dth1", "0", "0", e4),
        _equation("(5)", "(4) in half angles, times -1", "0", "0", e5.subs(still)),
        _equation("(6)", "(3) in half angles, times -1", "0", "0", e6.subs(still)),
        _equation("H(1,1)", "Hessian", "H(1,1)", "H(1,1)", h11),
        _equation("H(1,2)", "Hessian", "H(1,2)", "H(1,2)", h12),
        _equation("H(2,2)", "Hessian", "H(2,2)", "H(2,2)", h22),
        _equation("(7)", "(3) unloaded", "0", "0", sp.expand(-gradient()[1].subs(UNLOADED) / (L2 * k))),
        _equation("(8)", "(4) unloaded", "0", "0", sp.expand(-gradient()[0].subs(UNLOADED) / (L1 * k))),
        _equation("(9)", "non-flat equilibria, unloaded; sin th1 and sin th2 have one sign", "cos(theta_1)",
                  r"\cos\theta_1", COS1),
        _equation("(9)", "the same", "cos(theta_2)", r"\cos\theta_2", COS2),
        _equation("(10)", "equal rods and forces: k/2 times the difference of (5) and (6)", "0", "0", tenth),
        _equation("(11)", "equal rods and forces: k times (6)", "0", "0", symmetric_equations()[1]),
        _equation("(10')", "t1 from the second factor of (10)", "t1", "t_1", OTHER),
        _equation("(12)", "t2 where th1 and th2 differ", "0", "0", eliminated_12()),
        _equation("(13)", "where th1 and th2 differ", "det(H)", r"\det H", on_unequal(determinant())),
    ]  # fmt: skip
    base, force = sp.symbols("rho F")
    for number, component in zip(("(15)", "(16)"), _rose_first(), strict=True):
        polynomial = component.to_sympy(("rho", "F")).subs({base: rho, force: F4})
        found.append(_equation(number, "boundary of fig. 3, L1 = L2 = 1, k = 100", "0", "0", polynomial))
    found.append(_equation("(5), horizontal forces", "section 5.1", "0", "0", e5))
    found.append(_equation("(6), horizontal forces", "section 5.1", "0", "0", e6))
    unit = {F3: sp.Symbol("f3"), F4: sp.Symbol("f4")}
    for power, coefficient in zip(range(6, -1, -1), sextic(), strict=True):
        name = f"q{power}"
        what = f"coefficient of t2^{power} in the polynomial of degree 6 that elimination of t1 leaves"
        found.append(_equation(name, what, name, f"q_{power}", coefficient.subs(unit)))
    return tuple(found)


def _rose_first() -> list[PlanePolynomial]:
    """The two curves of fig. 3: the one through the origin first."""
    return sorted((c.polynomial for c in curves("fig3")), key=lambda p: any(i == j == 0 for i, j, _ in p.terms))


_INTRODUCTION = """
Derived from the potential of the model. Here f3 = F3/k (the paper's F3'), f4 = F4/k, f3x = F3x/k, f4x = F4x/k;
t1 and t2 are the tangents of the half angles; L1 stands for the common rod length L in (10) to (13).
"""


def as_markdown() -> str:
    """The equations as a page of text."""
    blocks = [text for e in equations() for text in (f"{e.number}: {e.what}", f"    {e.text}")]
    return page("# The paper's equations, corrected", _INTRODUCTION, *blocks)


def as_latex() -> str:
    """The equations as a LaTeX document; long ones are set by the breqn package, which breaks lines."""
    lines = [
        r"\documentclass{article}",
        r"\usepackage[a4paper,margin=2cm]{geometry}",
        r"\usepackage{amsmath,breqn}",
        r"\begin{document}",
        r"\section*{The equations of the planar tensegrity mechanism, corrected}",
        r"Here $f_3 = F_3/k$, $f_4 = F_4/k$, $f_{3x} = F_{3x}/k$, $f_{4x} = F_{4x}/k$; in (10) to (13) $L_1$ is the",
        r"length of both rods.\par",
    ]
    for e in equations():
        lines += [
            r"\noindent " + _escaped(f"{e.number}: {e.what}"),
            r"\begin{dmath*}",
            e.latex,
            r"\end{dmath*}",
        ]
    return "\n".join([*lines, r"\end{document}"]) + "\n"


def _escaped(text: str) -> str:
    return text.replace("^", r"\textasciicircum{}").replace("_", r"\_")
