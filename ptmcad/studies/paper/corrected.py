"""The paper's equations, corrected, as text and LaTeX, derived from the model and not from the
paper.

Guarantee: every expression is derived from the potential of the model by differentiation,
substitution of half angles and elimination (`ptmcad.studies.paper.statements`), or is a curve of a
computed discriminant variety. Which they are is data, ``expressions.yaml``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache

import sympy as sp

from ptmcad.studies.paper.maps import curves
from ptmcad.studies.paper.statements import (
    F3,
    F4,
    HORIZONTAL,
    TEXTS,
    Expr,
    c1,
    c2,
    expression,
    k,
    s1,
    s2,
)
from ptmcad.studies.texts import page

_OVER_K = {force: k * sp.Symbol(str(force).lower()) for force in (F3, F4, *HORIZONTAL)}
_THETA1, _THETA2 = sp.symbols("theta_1 theta_2", real=True)
_ANGLES = {c1: sp.cos(_THETA1), s1: sp.sin(_THETA1), c2: sp.cos(_THETA2), s2: sp.sin(_THETA2)}
_LATEX = {"cos(theta_1)": r"\cos\theta_1", "cos(theta_2)": r"\cos\theta_2", "det(H)": r"\det H"}

_NAMES = {sp.Symbol(f"f{n}x"): f"f_{{{n}x}}" for n in (3, 4)}
INTRODUCTION: str = TEXTS["introduction"].strip()


Equation = Mapping[str, str]
"""An equation: its ``number`` in the paper, ``what`` it is, and both sides as ``text`` and
``latex``.
"""


@cache
def equations() -> tuple[Equation, ...]:
    """The equations of the paper in their order, corrected."""
    # of the two curves of fig. 3 the one through the origin is first
    found = sorted(
        (c.polynomial for c in curves("fig3")),
        key=lambda p: any(i == j == 0 for i, j, _ in p.terms),
    )
    boundaries = {f"curve {n}": p.to_sympy(("rho", "F4")) for n, p in enumerate(found)}
    result = []
    for entry in TEXTS["equations"]:
        number, left, text = entry["number"], entry["left"], entry["right"]
        right = boundaries[text] if text in boundaries else expression(text)
        if number.startswith("q"):
            right = right.subs(_OVER_K).subs(k, 1)
        elif "forces" not in entry:
            right = sp.expand(right.subs(_OVER_K))
        shown = _shown(right)
        result.append(
            {
                "number": number,
                "what": entry["what"],
                "text": f"{left} = {sp.sstr(shown).replace('**', '^')}",
                "latex": f"{_LATEX.get(left, sp.latex(sp.Symbol(left)))} = {sp.latex(shown, symbol_names=_NAMES)}",
            }
        )
    return tuple(result)


def _shown(expression: Expr) -> Expr:
    """With the angles, and products of their cosines and sines as those of their sum."""
    total = _THETA1 + _THETA2
    compact = sp.expand(expression).subs(c1 * c2, sp.cos(total) + s1 * s2).expand()
    compact = compact.subs(s1 * c2, sp.sin(total) - c1 * s2).expand()
    return (compact if compact.has(total) else expression).subs(_ANGLES)


def as_markdown() -> str:
    """The equations as a page of text."""
    blocks = [
        text for e in equations() for text in ("{number}: {what}".format_map(e), f"    {e['text']}")
    ]
    return page("# The paper's equations, corrected", INTRODUCTION, *blocks)


def as_latex() -> str:
    """The equations as a LaTeX document; long ones are set by the breqn package, which breaks
    lines.
    """
    blocks = []
    for e in equations():
        title = (
            "{number}: {what}".format_map(e).replace("^", r"\textasciicircum{}").replace("_", r"\_")
        )
        blocks.append(
            rf"\noindent {title}" + "\n\\begin{dmath*}\n" + e["latex"] + "\n\\end{dmath*}"
        )
    names = re.sub(r"\b([fFLt])(\dx?)\b", r"$\1_{\2}$", INTRODUCTION)
    return "\n".join([TEXTS["latex"].rstrip(), rf"{names}\par", *blocks, "\\end{document}\n"])
