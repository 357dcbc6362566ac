"""A discriminant variety for reading: as text for the terminal and as LaTeX.

Guarantee: every component with its kind, degrees and number of terms, and whole, on as many lines
as it needs.
"""

from __future__ import annotations

from ptmcad.answer.regionmap import Component
from ptmcad.answer.slicevariety import SliceVariety
from ptmcad.answer.words import several
from ptmcad.show.polynomial_text import Style, polynomial_lines, symbols
from ptmcad.text.numerals import text_of

_WIDTH = 96
_MAX_VALUE = 60
_LATEX_WIDTH = 70
"""What fills a line of an article in two-column landscape or in one column at 10 pt, with room for
the number.
"""


def fixed_parameters(variety: SliceVariety) -> str:
    """What the slice fixes, such as ``L1 = 1, k = 100``: one line in which a long expression is
    cut.

    Loads that are zero and parameters that are axes are not named.
    """
    names = variety.slice.axis_names
    values = {name: value.to_text(names) for name, value in variety.slice.parameters.items()}
    mechanism = variety.slice.model
    for shorthand, own_names in mechanism.shorthands.items():
        own = {name: values.pop(name) for name in own_names if name in values}
        if len(set(own.values())) == 1:
            values[shorthand] = next(iter(own.values()))
        else:
            values.pop(shorthand, None)
            values |= own
    return ", ".join(
        f"{name} = {value if len(value) <= _MAX_VALUE else value[:_MAX_VALUE] + '...'}"
        for name, value in values.items()
        if value != name and not (name in mechanism.forces and value == "0")
    )


def window(variety: SliceVariety) -> str:
    """The window, such as ``0 < rho < 2, 0 < L2 < 2``."""
    return ", ".join(f"{text_of(a.low)} < {a.name} < {text_of(a.high)}" for a in variety.slice.axes)


def describe(component: Component, names: tuple[str, str]) -> str:
    """Kind, degree, degrees in the axes and number of terms of a component, and why it is left out
    if it is.
    """
    polynomial = component.polynomial
    i, j = polynomial.degrees
    text = (
        f"{component.kind.value}, degree {polynomial.total_degree} ({i} in {names[0]}, {j} in {names[1]}), "
        f"{several(len(polynomial.terms), 'term')}"
    )
    return f"{text}; {component.left_out}" if component.left_out else text


def slice_text(variety: SliceVariety) -> str:
    """The slice's name and, where any are, the parameters that are fixed on it."""
    return ": ".join(filter(None, (variety.slice.name, fixed_parameters(variety))))


def listing(variety: SliceVariety) -> str:
    """The variety as text."""
    names = variety.slice.axis_names
    lines = [
        f"slice     {slice_text(variety)}",
        f"window    {window(variety)}",
        f"variety   {several(len(variety.components), 'component')}; "
        f"{several(variety.complex_solutions, 'complex solution')} off them",
    ]
    for k, component in enumerate(variety.components, start=1):
        lines += ["", f"{k:<10}{describe(component, names)}"]
        lines += [
            f"{'':10}{line}"
            for line in polynomial_lines(component.polynomial, names, Style.TEXT, _WIDTH)
        ]
    return "\n".join(lines) + "\n"


def latex(variety: SliceVariety) -> str:
    """The variety as displayed equations; they need the package amsmath."""
    names = variety.slice.axis_names
    x, y = symbols(names, Style.LATEX)
    fixed = fixed_parameters(variety)
    lines = [
        f"% Discriminant variety of the slice {variety.slice.name}"
        + (f" ({fixed})" if fixed else ""),
        f"% over {window(variety)}: the union of the curves on which a V_k vanishes.",
        r"% Needs \usepackage{amsmath}; put \allowdisplaybreaks before it where a polynomial is longer than a page.",
    ]
    for k, component in enumerate(variety.components, start=1):
        first, *others = polynomial_lines(component.polynomial, names, Style.LATEX, _LATEX_WIDTH)
        rows = [
            f"V_{{{k}}}({x}, {y}) ={{}} & {first}",
            *(rf"& \quad {{}} {line}" for line in others),
        ]
        lines += [f"% {k}: {describe(component, names)}", r"\begin{align*}"]
        lines += [f"  {row} \\\\" for row in rows[:-1]]
        lines += [f"  {rows[-1]}", r"\end{align*}"]
    return "\n".join(lines) + "\n"
