"""A discriminant variety as code that defines the list ``variety`` in SymPy, Maple or Mathematica.

Guarantee: the code runs as it is, by itself; the list has the components in their order.
"""

from __future__ import annotations

from ptmcad.answer.slicevariety import SliceVariety
from ptmcad.show.export.listing import describe, slice_text, window
from ptmcad.show.polynomial_text import Style, polynomial_lines, symbols

_WIDTH = 100


_LANGUAGES = {
    Style.SYMPY: ("# {}", 'import sympy\n\n{}, {} = sympy.symbols("{} {}")\nvariety = [', "]"),
    Style.MAPLE: ("# {}", "variety := [", "]:"),
    Style.MATHEMATICA: ("(* {} *)", "variety = {{", "}};"),
}
"""Of each a comment, how the list begins, after the symbols where these have to be defined, and how
it ends.
"""


def code(variety: SliceVariety, style: Style) -> str:
    """A program that defines the list ``variety`` of expressions."""
    names = variety.slice.axis_names
    comment, start, end = _LANGUAGES[style]
    lines = [
        comment.format(f"Discriminant variety of the slice {slice_text(variety)}"),
        comment.format(f"over {window(variety)}"),
        start.format(*symbols(names, style), *names),
    ]
    last = len(variety.components)
    for k, component in enumerate(variety.components, start=1):
        lines.append("    " + comment.format(f"{k}: {describe(component, names)}"))
        lines += [
            f"    {line}" for line in polynomial_lines(component.polynomial, names, style, _WIDTH)
        ]
        lines[-1] += "," * (k < last)
    return "\n".join([*lines, end.format()]) + "\n"
