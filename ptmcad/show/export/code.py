"""A discriminant variety as code that defines the list ``variety`` in SymPy, Maple or Mathematica.

Guarantee: the code runs as it is, by itself; the list has the components in their order.
"""

from __future__ import annotations

from collections.abc import Callable

from ptmcad.answer.slicevariety import SliceVariety
from ptmcad.show.export.listing import describe, slice_text, window
from ptmcad.show.polynomial_text import Style, polynomial_lines, symbols

_WIDTH = 100


def sympy(variety: SliceVariety) -> str:
    """A Python program that defines the symbols and the list ``variety`` of expressions."""
    names = variety.slice.axis_names
    x, y = symbols(names, Style.SYMPY)
    start = f'{x}, {y} = sympy.symbols("{names[0]} {names[1]}")\nvariety = ['
    return _code(variety, Style.SYMPY, "# {}".format, f"import sympy\n\n{start}", "]")


def maple(variety: SliceVariety) -> str:
    """Maple commands that define the list ``variety``."""
    return _code(variety, Style.MAPLE, "# {}".format, "variety := [", "]:")


def mathematica(variety: SliceVariety) -> str:
    """An expression in the Wolfram language that defines the list ``variety``."""
    return _code(variety, Style.MATHEMATICA, "(* {} *)".format, "variety = {", "};")


def _code(variety: SliceVariety, style: Style, comment: Callable[[str], str], start: str, end: str) -> str:
    names = variety.slice.axis_names
    lines = [
        comment(f"Discriminant variety of the slice {slice_text(variety)}"),
        comment(f"over {window(variety)}"),
        start,
    ]
    last = len(variety.components)
    for k, component in enumerate(variety.components, start=1):
        lines.append("    " + comment(f"{k}: {describe(component, names)}"))
        lines += [f"    {line}" for line in polynomial_lines(component.polynomial, names, style, _WIDTH)]
        lines[-1] += "," * (k < last)
    return "\n".join([*lines, end]) + "\n"
