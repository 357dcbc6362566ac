"""Polynomials as code: each language's text, read back by a reader that shares nothing with the
writer.
"""

from __future__ import annotations

import re
from fractions import Fraction

import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st
from support.programs import monomials
from sympy.parsing.mathematica import parse_mathematica

from ptmcad.show.polynomial_text import Style, polynomial_lines, polynomial_text, symbols
from ptmcad.text.numerals import integer_of
from ptmcad.text.plane import PlanePolynomial

NAMES = ("rho", "L2")
HARD = st.sampled_from((1, -1, 2, -3, 10**30, -(10**40) - 7))
POLYNOMIALS = st.dictionaries(
    st.tuples(st.integers(0, 24), st.integers(0, 12)), HARD, max_size=12
).map(lambda terms: PlanePolynomial.of((i, j, c) for (i, j), c in terms.items()))
AXES = st.sampled_from(
    (
        "rho",
        "L2",
        "L_2",
        "l0_1",
        "F",
        "F3x",
        "lambda",
        "if",
        "I",
        "E",
        "D",
        "Pi",
        "gamma",
        "Log10",
        "a_b",
        "sympy",
        "N1",
    )
)


def of_sympy(expression: sympy.Expr, names: tuple[str, str]) -> PlanePolynomial:
    poly = sympy.Poly(expression, *map(sympy.Symbol, names))
    return PlanePolynomial.of((i, j, int(c)) for (i, j), c in poly.terms())


def read_maple(text: str, names: tuple[str, str]) -> PlanePolynomial:
    """A reader of the part of Maple's grammar that sums of products of powers need."""
    tokens = re.findall(r"\d+|[A-Za-z_]\w*|[-+*^]", text)
    assert "".join(tokens) == text.replace(" ", "")
    tokens.reverse()
    terms: list[tuple[int, int, int]] = []
    while tokens:
        coefficient, exponents = 1, [0, 0]
        if tokens[-1] in "+-":
            coefficient = -1 if tokens.pop() == "-" else 1
        else:
            assert not terms, "two terms without a sign"
        times = "*"
        while times == "*":
            factor = tokens.pop()
            if factor.isdigit():
                coefficient *= integer_of(factor)
            else:
                power = bool(tokens) and tokens[-1] == "^" and bool(tokens.pop())
                exponents[names.index(factor)] += int(tokens.pop()) if power else 1
            times = tokens.pop() if tokens and tokens[-1] == "*" else ""
        terms.append((exponents[0], exponents[1], coefficient))
    return PlanePolynomial.of(terms)


def read_latex(text: str, names: tuple[str, str]) -> PlanePolynomial:
    """Each monomial, its braces taken away."""
    assert text.count("{") == text.count("}")
    for k, name in enumerate(names):
        text = text.replace(name, f"x{k}")
    text = re.sub(r"\^\{(\d+)\}", r"^\1", text)
    assert not set(text) & set("{}\\")
    return PlanePolynomial.of(
        (e[0], e[1], int(c)) for e, c in monomials(text, ("x0", "x1")).items()
    )


def read_back(text: str, names: tuple[str, str], style: Style) -> PlanePolynomial:
    spelled = symbols(names, style)
    assert len(set(spelled)) == 2
    pair = (spelled[0], spelled[1])
    if style is Style.SYMPY:
        return of_sympy(
            sympy.sympify(
                text, locals={name: sympy.Symbol(name) for name in pair}, convert_xor=False
            ),
            pair,
        )
    if style is Style.MATHEMATICA:  # SymPy's reader takes some names for Python's or its own
        for k, name in enumerate(pair):
            text = re.sub(rf"(?<![\w$]){re.escape(name)}(?![\w$])", f"z{k}", text)
        return of_sympy(parse_mathematica(text), ("z0", "z1"))
    if style is Style.MAPLE:
        return read_maple(text, pair)
    if style is Style.LATEX:
        return read_latex(text, pair)
    return PlanePolynomial.of((e[0], e[1], int(c)) for e, c in monomials(text, pair).items())


@pytest.mark.parametrize("style", Style)
@given(polynomial=POLYNOMIALS.filter(lambda p: bool(p.terms)))
@pytest.mark.slow_cases("Style.TEXT", "Style.SYMPY", "Style.MATHEMATICA")
def test_what_is_written_is_the_polynomial(style: Style, polynomial: PlanePolynomial) -> None:
    assert read_back(polynomial_text(polynomial, NAMES, style), NAMES, style) == polynomial


@pytest.mark.parametrize("style", Style)
@given(polynomial=POLYNOMIALS, width=st.integers(0, 130))
def test_broken_lines_are_the_same_text(
    style: Style, polynomial: PlanePolynomial, width: int
) -> None:
    lines = polynomial_lines(polynomial, NAMES, style, width)
    assert " ".join(lines) == polynomial_text(polynomial, NAMES, style)
    for line in lines:
        assert len(line) <= width or len(re.findall(r" [+-] ", line)) == 0


@pytest.mark.parametrize("style", [s for s in Style if s is not Style.LATEX])
@given(names=st.lists(AXES, min_size=2, max_size=2, unique=True))
def test_reserved_names_are_spelled_apart(style: Style, names: list[str]) -> None:
    """Python, Maple and Mathematica have names of their own; the polynomial keeps two variables."""
    polynomial = PlanePolynomial.of(((2, 0, 3), (1, 1, -1), (0, 1, 5), (0, 0, -7)))
    pair = (names[0], names[1])
    assert read_back(polynomial_text(polynomial, pair, style), pair, style) == polynomial


def test_mathematica_constants_are_not_taken_for_variables() -> None:
    """The reader would read E and I as numbers, as the program does."""
    assert parse_mathematica("E^2 - I") == sympy.E**2 - sympy.I
    assert symbols(("E", "I"), Style.MATHEMATICA) == ("E$", "I$")


@pytest.mark.parametrize("style", Style)
def test_coefficients_of_any_length(style: Style) -> None:
    """Python refuses decimal numbers of more than 4300 digits."""
    large = 7**6000
    text = polynomial_text(PlanePolynomial.of(((1, 0, large), (0, 0, -2))), NAMES, style)
    if style is Style.SYMPY:
        (coefficient,) = (term for term in re.findall(r"0x[0-9a-f]+", text))
        assert int(coefficient, 16) == large
        assert eval(text, {"rho": Fraction(2, large)}) == 0
    elif style is Style.MATHEMATICA:  # SymPy's reader of it converts by int()
        assert integer_of(text.partition("*")[0]) == large
    else:
        with_blank = text.replace(symbols(NAMES, style)[0], "").rstrip(" -2").rstrip("*")
        assert integer_of(with_blank) == large


def test_unknown_style() -> None:
    with pytest.raises(ValueError, match="fortran"):
        polynomial_text(PlanePolynomial.of(((1, 0, 1),)), NAMES, "fortran")
