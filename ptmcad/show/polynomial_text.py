"""A polynomial in the two axes as the code of a computer algebra system, as LaTeX, or as plain
text.

Guarantee: what is written stands for exactly the polynomial, term by term in its own order,
whatever the length of its coefficients; the axes' names are changed only where the language
reserves or cannot spell them, and two names stay different.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from enum import Enum
from functools import partial
from keyword import kwlist

from ptmcad.text.numerals import integer_text
from ptmcad.text.plane import Names, PlanePolynomial, signed_terms


class Style(Enum):
    """A language that polynomials can be written in."""

    TEXT = "text"
    SYMPY = "sympy"
    MAPLE = "maple"
    MATHEMATICA = "mathematica"
    QEPCAD = "qepcad"
    MSOLVE = "msolve"
    LATEX = "latex"


_POWERS = {Style.SYMPY: "{}**{}", Style.LATEX: "{}^{{{}}}"}
"""How a language writes powers, a format of base and exponent, where it is not as in others."""
_PRODUCTS = {Style.QEPCAD: " ", Style.LATEX: " "}

_MAX_PYTHON_NUMBER = 4000
"""Digits; Python refuses decimal numbers of more than 4300 digits in a program, but takes
hexadecimal ones.
"""
_PYTHON_TAKEN = re.compile("|".join((*kwlist, "sympy", "variety")))
_MAPLE_TAKEN = re.compile(
    "and|assuming|break|by|catch|description|do|done|elif|else|end|error|export|fi|finally|for|from|global|if|implies|in|"
    "intersect|local|minus|mod|module|next|not|od|option|options|or|proc|quit|read|return|save|stop|subset|then|to|try|"
    "union|use|uses|while|xor|"
    "Catalan|D|Digits|FAIL|I|NULL|O|Order|Pi|constants|false|gamma|infinity|lasterror|printlevel|true|undefined|variety"
)
"""Keywords, constants and variables of the system's own."""
_MATHEMATICA_TAKEN = re.compile(r"[CDEIKNO]|[A-Z][A-Za-z]+\d*|variety")
"""The system's own symbols start with a capital letter; those with one letter are seven."""
_QEPCAD_TAKEN = re.compile("true|false|TRUE|FALSE")
_GREEK = re.compile(
    "alpha|beta|gamma|delta|epsilon|zeta|eta|theta|iota|kappa|lambda|mu|nu|xi|pi|rho|sigma|tau|upsilon|phi|chi|psi|omega|"
    "Gamma|Delta|Theta|Lambda|Xi|Pi|Sigma|Upsilon|Phi|Psi|Omega"
)
_INDEXED = re.compile(r"([A-Za-z]+?)_?(\d[A-Za-z0-9_]*)?")


def symbols(names: Sequence[str], style: Style) -> tuple[str, ...]:
    """How a language spells names of the form ``[A-Za-z][A-Za-z0-9_]*``; different names stay different.

    >>> symbols(("rho", "lambda"), Style.SYMPY), symbols(("E", "L_2"), Style.MATHEMATICA)
    (('rho', 'lambda_'), ('E$', 'L$2'))
    >>> symbols(("rho", "L2"), Style.LATEX)
    ('\\\\rho', 'L_{2}')
    """
    spelled: list[str] = []
    for name in names:
        symbol = _SPELLINGS[style](name) if style in _SPELLINGS else name
        while symbol in spelled:
            symbol = rf"\bar{{{symbol}}}" if style is Style.LATEX else f"{symbol}1"
        spelled.append(symbol)
    return tuple(spelled)


def polynomial_text(polynomial: PlanePolynomial, names: Names, style: Style | str) -> str:
    """The polynomial on one line.

    Parameters
    ----------
    names : of the two axes; `symbols` shows how they are spelled.
    style : a `Style` or its value, such as ``"maple"``.

    Raises
    ------
    ValueError
        For an unknown style.

    >>> p = PlanePolynomial.of(((2, 0, 4), (0, 1, -1)))
    >>> polynomial_text(p, ("rho", "L2"), "sympy"), polynomial_text(p, ("rho", "L2"), "latex")
    ('4*rho**2 - L2', '4 \\\\rho^{2} - L_{2}')
    """
    return " ".join(polynomial_lines(polynomial, names, style, width=0)) or "0"


def polynomial_lines(
    polynomial: PlanePolynomial, names: Names, style: Style | str, width: int = 100
) -> list[str]:
    """The polynomial on lines of at most ``width`` characters, broken before the sign of a term.

    A term that is longer than that has a line of its own. Joined by blanks the lines are
    `polynomial_text`.
    """
    lines: list[str] = []
    for term in _terms(polynomial, symbols(names, Style(style)), Style(style)):
        if lines and len(lines[-1]) + 1 + len(term) <= width:
            lines[-1] += f" {term}"
        else:
            lines.append(term)
    return lines or ["0"]


def _terms(polynomial: PlanePolynomial, spelled: tuple[str, ...], style: Style) -> Iterator[str]:
    """Each term with its sign; the first one without when it is positive."""
    power, times = _POWERS.get(style, "{}^{}"), _PRODUCTS.get(style, "*")
    terms = (((i, j), c) for i, j, c in polynomial.terms)
    return signed_terms(terms, spelled, power, times, partial(_number, style=style))


def _number(natural: int, style: Style) -> str:
    digits = integer_text(natural)
    return hex(natural) if style is Style.SYMPY and len(digits) > _MAX_PYTHON_NUMBER else digits


def _spelled(name: str, underscore: str, taken: re.Pattern[str], end: str) -> str:
    """A name with another sign for its underscores, and one more at its end where the language has
    the name already.
    """
    symbol = name.replace("_", underscore)
    return f"{symbol}{end}" if taken.fullmatch(symbol) else symbol


def _latex(name: str) -> str:
    """``L2`` as a letter with an index, Greek letters by name, other words upright."""
    match = _INDEXED.fullmatch(name)
    word, index = match.groups() if match else (name, None)
    if _GREEK.fullmatch(word):
        symbol = f"\\{word}"
    elif len(word) == 1:
        symbol = word
    else:
        symbol = r"\mathrm{" + word.replace("_", r"\_") + "}"
    return symbol if index is None else f"{symbol}_{{{index.replace('_', ',')}}}"


_SPELLINGS: Mapping[Style, Callable[[str], str]] = {
    Style.SYMPY: partial(_spelled, underscore="_", taken=_PYTHON_TAKEN, end="_"),
    Style.MAPLE: partial(_spelled, underscore="_", taken=_MAPLE_TAKEN, end="_"),
    # an underscore is a pattern there
    Style.MATHEMATICA: partial(_spelled, underscore="$", taken=_MATHEMATICA_TAKEN, end="$"),
    # letters and digits only
    Style.QEPCAD: partial(_spelled, underscore="", taken=_QEPCAD_TAKEN, end="1"),
    Style.LATEX: _latex,
}
