"""A discriminant variety in the languages of other programs, as LaTeX, as JSON and as text.

Guarantee: every format has every component of the variety, in their order (the input for QEPCAD
those that have a point in the window), exactly; the program that a format is meant for reads the
text as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial
from operator import attrgetter
from typing import Any

from ptmcad.answer.regionmap import Component
from ptmcad.answer.slicevariety import EliminationSystem, SliceVariety
from ptmcad.answer.words import several
from ptmcad.errors import ConfigError
from ptmcad.question.slice import Slice, merged
from ptmcad.show.document.slicedocument import polynomial_over, slice_over
from ptmcad.show.polynomial_text import Style, polynomial_lines, symbols
from ptmcad.text.codec import NATURAL, POSITIVE, TEXT, Codec, derived, listed, named, record_of
from ptmcad.text.documents import document_text
from ptmcad.text.numerals import text_of
from ptmcad.text.plane import Names, PlanePolynomial
from ptmcad.text.syntax import did_you_mean

_CODE_WIDTH, _QEPCAD_WIDTH, _TEXT_WIDTH = 100, 90, 96
"""Characters of a line."""


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
            f"    {line}"
            for line in polynomial_lines(component.polynomial, names, style, _CODE_WIDTH)
        ]
        lines[-1] += "," * (k < last)
    return "\n".join([*lines, end.format()]) + "\n"


def qepcad(variety: SliceVariety) -> str:
    """A session of QEPCAD that decomposes the window by the components that have a point in it.

    The formula says that no component vanishes, the assumption that the point lies in the window;
    with ``measure-zero-error`` QEPCAD lifts over open cells only. At the end it prints its
    projection factors and all cells with their samples: those whose truth value is T are the open
    cells of the window.
    """
    names = variety.slice.axis_names
    used = [c.polynomial for c in variety.components if not c.left_out]
    conditions = [_condition(p, names, "/= 0") for p in used] or ["0 = 0"]
    bounds = [
        _condition(_edge(k, end), names, relation)
        for k, axis in enumerate(variety.slice.axes)
        for end, relation in ((axis.low, "> 0"), (axis.high, "< 0"))
    ]
    about = f"ptmcad variety, slice {slice_text(variety)}; {window(variety)}"
    commands = (
        "measure-zero-error",
        "go",
        "go",
        "go",
        "d-proj-factors",
        "d-all-cells-in-subtree ()",
        "quit",
    )
    return "\n".join(
        (
            f"[ {about} ]",
            f"({', '.join(symbols(names, Style.QEPCAD))})",
            "2",
            "[ " + " /\\\n  ".join(conditions) + " ].",
            "assume [ " + r" /\ ".join(bounds) + " ]",
            *commands,
            "",
        )
    )


def _condition(polynomial: PlanePolynomial, names: Names, relation: str) -> str:
    return (
        "\n  ".join(polynomial_lines(polynomial, names, Style.QEPCAD, _QEPCAD_WIDTH))
        + f" {relation}"
    )


def _edge(axis: int, end: Fraction) -> PlanePolynomial:
    """q x - p, which is positive where x > p/q."""
    exponents = (1, 0) if axis == 0 else (0, 1)
    return PlanePolynomial.of(((*exponents, end.denominator), (0, 0, -end.numerator)))


def msolve(variety: SliceVariety) -> str:
    """The elimination system with the unknowns before the axes, over Q.

    With n unknowns, inverses among them, ``msolve -e n -g 2`` prints the ideal of the polynomials
    in the two axes alone that vanish where an equilibrium is singular; the CRITICAL components are
    the factors of its generator.
    """
    names = symbols((*variety.system.unknowns, *variety.system.axes), Style.MSOLVE)
    polynomials = (text.replace(" ", "") for text in variety.system.texts(names))
    return f"{','.join(names)}\n0\n" + ",\n".join(polynomials) + "\n"


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
    model = variety.slice.model
    texts = {name: value.to_text(names) for name, value in variety.slice.parameters.items()}
    values = merged(texts, model)
    return ", ".join(
        f"{name} = {value if len(value) <= _MAX_VALUE else value[:_MAX_VALUE] + '...'}"
        for name, value in values.items()
        if value != name and not (name in model.forces and value == "0")
    )


def window(variety: SliceVariety) -> str:
    """The window, such as ``0 < rho < 2, 0 < L2 < 2``."""
    return ", ".join(f"{text_of(a.low)} < {a.name} < {text_of(a.high)}" for a in variety.slice.axes)


def describe(component: Component, names: Names) -> str:
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
            for line in polynomial_lines(component.polynomial, names, Style.TEXT, _TEXT_WIDTH)
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


FORMAT = "ptmcad-variety/1"


def document(variety: SliceVariety) -> str:
    """The variety as JSON text, one component a line."""
    return document_text(FORMAT, variety_codec(variety.slice.axis_names).write(variety))


def variety_codec(names: Names) -> Codec[SliceVariety]:
    """The codec of a variety over axes of these names."""
    whole: dict[Any, Codec[Any]] = {PlanePolynomial: polynomial_over(names)}
    whole[Component] = record_of(
        Component, whole, separates=None, continuum=None,
        degree=derived(attrgetter("polynomial.total_degree"), POSITIVE),
        degrees=derived(lambda c: dict(zip(names, c.polynomial.degrees, strict=True)), named(NATURAL)),
        terms=derived(lambda c: len(c.polynomial.terms), POSITIVE),
    )  # fmt: skip
    whole[EliminationSystem] = record_of(
        EliminationSystem,
        axes=None,
        polynomials=derived(lambda system: system.texts(), listed(TEXT)),
    )
    left_out = dict.fromkeys(("title", "text", "count", "reference", "units", "model"))
    whole[Slice] = slice_over(names, **left_out, mechanism=derived(attrgetter("mechanism")))
    return record_of(SliceVariety, whole)


FORMATS: Mapping[str, Callable[[SliceVariety], str]] = {
    "text": listing,
    "json": document,
    **{
        style.value: partial(code, style=style)
        for style in (Style.SYMPY, Style.MAPLE, Style.MATHEMATICA)
    },
    "qepcad": qepcad,
    "msolve": msolve,
    "latex": latex,
}


def variety_text(variety: SliceVariety, format: str = "text") -> str:
    """The variety in one of `FORMATS`, with a line feed at the end.

    Raises
    ------
    ConfigError
        For an unknown format.
    """
    if format not in FORMATS:
        raise ConfigError(
            f"the format {format!r} is not among {', '.join(FORMATS)}{did_you_mean(format, FORMATS)}"
        )
    return FORMATS[format](variety)
