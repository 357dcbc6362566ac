"""The section of the boundary curves, with each formula in the forms that programs read.

Guarantee: the formulas are the result's polynomials exactly (`ptmcad.show.polynomial_text`).
"""

from __future__ import annotations

from html import escape

from ptmcad.answer.regionmap import Component, RegionMap
from ptmcad.answer.words import several
from ptmcad.show.polynomial_text import Style, polynomial_text, symbols
from ptmcad.show.report.sections import copied
from ptmcad.text.numerals import integer_text

MAX_FORMULA = 100_000
"""Characters of a formula that the page holds in all its forms."""
_PROGRAMS = {
    Style.TEXT: "text",
    Style.SYMPY: "SymPy",
    Style.MAPLE: "Maple",
    Style.MATHEMATICA: "Mathematica",
    Style.LATEX: "LaTeX",
}


def curves(result: RegionMap) -> str:
    """Every curve that the decomposition uses, with its formula in the forms that programs read."""
    used = [(n, c) for n, c in enumerate(result.components) if not c.left_out]
    if not used:
        return "<p>There is no boundary curve in the window.</p>"
    known = bool(result.cells)
    return "".join(_curve(n, c, result.slice.axis_names, known) for n, c in used)


def _curve(number: int, component: Component, names: tuple[str, str], known: bool) -> str:
    p = component.polynomial
    role = "separates regions" if component.separates else "separates nothing"
    if not known:
        role = "what it separates was not computed"
    title = (
        f"Curve {number}: {component.kind.value}, degree {p.degrees[0]} in {names[0]}, {p.degrees[1]} in {names[1]}, "
        f"{p.total_degree} in all, {several(len(p.terms), 'term')}; {role}"
    )
    return f"<details><summary>{escape(title)}</summary>{_formula(component, names)}</details>"


def _formula(component: Component, names: tuple[str, str]) -> str:
    p = component.polynomial
    if sum(len(integer_text(c)) + 20 for _, _, c in p.terms) > MAX_FORMULA:
        return "<p>The formula is too long for this page; the result has it.</p>"
    parts = ["<p>The curve is where this polynomial is zero.</p>"]
    for style, program in _PROGRAMS.items():
        text = polynomial_text(p, names, style)
        if style is Style.SYMPY:
            x, y = symbols(names, style)
            text = f'import sympy\n\n{x}, {y} = sympy.symbols("{names[0]} {names[1]}")\np = {text}'
        parts.append(copied(text, f"as {program}"))
    return "".join(parts)
