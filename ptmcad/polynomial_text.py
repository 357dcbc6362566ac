"""A polynomial in the two axes as text for other programs.

Guarantee: the text is the polynomial exactly, with integer coefficients. A name that means something else to the
program (``I``, ``D``, ``lambda``) is written so that it does not.
"""

from __future__ import annotations

import keyword
import re

from ptmcad.numerals import integer_text
from ptmcad.plane import PlanePolynomial

STYLES = ("text", "sympy", "maple", "mathematica", "latex")

_WORDS = {
    "maple": """and assuming break by catch description do done elif else end error evalf export fi finally for from
        global if implies in intersect local minus mod module next not od option options or proc quit read return save
        stop subset then to true false FAIL try union use while xor I D O Pi gamma Gamma Beta Zeta Catalan infinity
        Digits""",
    "mathematica": "C D E I K N O Pi Degree Infinity Catalan Gamma Beta Zeta True False Null All None",
    "latex": """alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon phi
        chi psi omega""",
}
_KNOWN = {style: frozenset(words.split()) for style, words in _WORDS.items()}
"""Words that mean something to the program: constants and keywords; for LaTeX, the names of Greek letters."""


def polynomial_text(p: PlanePolynomial, names: tuple[str, str], style: str) -> str:
    """The polynomial in the axes of these names.

    Parameters
    ----------
    style : one of `STYLES`.

    >>> p = PlanePolynomial.of([(2, 1, 3), (0, 0, -1)])
    >>> for style in STYLES:
    ...     polynomial_text(p, ("rho", "F3"), style)
    '3*rho^2*F3 - 1'
    '3*rho**2*F3 - 1'
    '3*rho^2*F3 - 1'
    '3*rho^2*F3 - 1'
    '3 \\\\rho^{2} F_{3} - 1'

    Raises
    ------
    ValueError
        For another style.
    """
    if style not in STYLES:
        raise ValueError(f"{style!r} is not among {', '.join(STYLES)}")
    if style == "latex":
        return _latex(p, names)
    return p.text(symbols(names, style), "**" if style == "sympy" else "^")


def symbols(names: tuple[str, str], style: str) -> tuple[str, str]:
    """The names as they are written in a style; different names stay different."""
    first, second = (_symbol(name, style) for name in names)
    return (first, second) if first != second else (first, f"{second}{second[-1]}")


def _symbol(name: str, style: str) -> str:
    match style:
        case "sympy":
            return f"{name}_" if keyword.iskeyword(name) or keyword.issoftkeyword(name) else name
        case "maple":
            return f"{name}_" if name in _KNOWN[style] else name
        case "mathematica":
            name = name.replace("_", "$")
            return f"{name}$" if name in _KNOWN[style] else name
        case "latex":
            match = re.fullmatch(r"([A-Za-z]+?)_?(\d+[a-z]*)?", name)
            if match is None:
                return rf"\mathrm{{{name.replace('_', chr(92) + '_')}}}"
            letters, below = match[1], f"_{{{match[2]}}}" if match[2] else ""
            if letters in _KNOWN[style]:
                return f"\\{letters}{below}"
            return (letters if len(letters) == 1 else rf"\mathrm{{{letters}}}") + below
    return name


def _latex(p: PlanePolynomial, names: tuple[str, str]) -> str:
    written = symbols(names, "latex")
    text = ""
    for i, j, c in p.terms:
        factors = [f"{n}^{{{e}}}" if e > 1 else n for n, e in zip(written, (i, j), strict=True) if e]
        if abs(c) != 1 or not factors:
            factors.insert(0, integer_text(abs(c)))
        text += (("-" if c < 0 else "") if not text else (" - " if c < 0 else " + ")) + " ".join(factors)
    return text or "0"
