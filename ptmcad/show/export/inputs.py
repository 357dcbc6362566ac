"""The input of two other programs: QEPCAD's for the decomposition of the window, msolve's for the
elimination.

Guarantee: each program reads its text to the end without an error.
"""

from __future__ import annotations

from fractions import Fraction

from ptmcad.answer.slicevariety import SliceVariety
from ptmcad.show.export.listing import slice_text, window
from ptmcad.show.polynomial_text import Style, polynomial_lines, symbols
from ptmcad.text.plane import PlanePolynomial

_WIDTH = 90


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


def _condition(polynomial: PlanePolynomial, names: tuple[str, str], relation: str) -> str:
    return "\n  ".join(polynomial_lines(polynomial, names, Style.QEPCAD, _WIDTH)) + f" {relation}"


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
