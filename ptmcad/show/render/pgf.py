r"""PGF: a figure as commands of LaTeX, which sets its text in the document's own font.

Guarantee: no TeX is needed to write it, and LaTeX's plain font encodings suffice to set what ptmcad itself writes
(Greek letters, indices, powers, minus signs); other letters of a title are left as they are, for XeLaTeX and LuaLaTeX.

Not guaranteed: that the text is as wide as in other formats. It is placed by its left end, middle or right end,
whichever it was aligned by, so that another font moves nothing.
"""

from __future__ import annotations

import re
from io import StringIO
from math import cos, radians, sin
from typing import Any

from matplotlib.backends.backend_pgf import RendererPgf
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

from ptmcad.text.numerals import SUPERSCRIPTS

_HEAD = r"""%% A figure of ptmcad: {title}
%%
%% In the preamble:  \usepackage{{pgf}}   (and \usepackage{{lmodern}} or \usepackage{{fix-cm}} for text of any size)
%% In the document:  \input{{NAME.pgf}}
%%
%% It is {width:.2f} in wide and {height:.2f} in high; do not scale it, or its text is scaled too.
"""
_SPECIAL = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "_": r"\_", "%": r"\%",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": r"\ensuremath{<}", ">": r"\ensuremath{>}",
    "|": r"\ensuremath{|}", '"': r"\symbol{34}",  # a name of its own for it is not in each encoding
    "\N{NO-BREAK SPACE}": "~", "−": r"\ensuremath{-}", "…": r"\ldots{}", "·": r"\ensuremath{\cdot}",
    "×": r"\ensuremath{\times}", "≈": r"\ensuremath{\approx}", "°": r"\ensuremath{^\circ}", "–": "--", "—": "---",
    "→": r"\ensuremath{\rightarrow}", "±": r"\ensuremath{\pm}", "≤": r"\ensuremath{\leq}", "≥": r"\ensuremath{\geq}",
    "≠": r"\ensuremath{\neq}", "∞": r"\ensuremath{\infty}", "√": r"\ensuremath{\surd}",
    "\N{MICRO SIGN}": r"\ensuremath{\mu}",
}  # fmt: skip
_GREEK = {
    "α": "alpha", "β": "beta", "γ": "gamma", "δ": "delta", "ε": "varepsilon", "ζ": "zeta", "η": "eta", "θ": "theta",
    "ι": "iota", "κ": "kappa", "λ": "lambda", "μ": "mu", "ν": "nu", "ξ": "xi", "π": "pi", "ρ": "rho", "σ": "sigma",
    "τ": "tau", "υ": "upsilon", "φ": "varphi", "χ": "chi", "ψ": "psi", "ω": "omega", "Γ": "Gamma", "Δ": "Delta",
    "Θ": "Theta", "Λ": "Lambda", "Ξ": "Xi", "Π": "Pi", "Σ": "Sigma", "Υ": "Upsilon", "Φ": "Phi", "Ψ": "Psi",
    "Ω": "Omega",
}  # fmt: skip
_SUBSCRIPTS = dict(zip("₀₁₂₃₄₅₆₇₈₉ₓ", "0123456789x", strict=True))
_SUPERSCRIPTS = {above: plain for plain, above in SUPERSCRIPTS.items()}
_INDICES = "".join(_SUBSCRIPTS)
_PIECES = re.compile(
    rf"((?<![^\W\d_])[A-Za-z{''.join(_GREEK)}])?([{_INDICES}]+)|([{''.join(_SUPERSCRIPTS)}]+)|(.)", re.S
)
"""A letter with an index, an index, a power, or any character."""


def pgf_text(figure: Figure, title: str) -> str:
    """The figure as the content of a PGF file; within `ptmcad.show.render.printing.settings`."""
    figure.set_dpi(72)
    width, height = (float(side) for side in figure.get_size_inches())
    text = StringIO()
    text.write(_HEAD.format(title=" ".join(title.split()), width=width, height=height))
    text.write("\\begingroup\n\\makeatletter\n\\begin{pgfpicture}\n")
    text.write(f"\\pgfpathrectangle{{\\pgfpointorigin}}{{\\pgfqpoint{{{width:f}in}}{{{height:f}in}}}}\n")
    text.write("\\pgfusepath{use as bounding box, clip}\n")
    make: Any = _Renderer
    figure.draw(make(figure, text))
    text.write("\\end{pgfpicture}%\n\\makeatother\n\\endgroup\n")  # without a space after the picture
    return text.getvalue()


def escaped(text: str) -> str:
    r"""A text for LaTeX; a letter with an index is a symbol of mathematics, as Greek letters are.

    >>> print(escaped("L₂ / 10⁻³ & 50 %"))
    \ensuremath{L_{2}} / 10\ensuremath{^{-3}} \& 50 \%
    """
    return "".join(_set(*match.groups()) for match in _PIECES.finditer(text))


def _set(letter: str | None, index: str | None, power: str | None, other: str | None) -> str:
    if other is not None:
        return rf"\ensuremath{{\{_GREEK[other]}}}" if other in _GREEK else _SPECIAL.get(other, other)
    if power is not None:
        return rf"\ensuremath{{^{{{''.join(_SUPERSCRIPTS[c] for c in power)}}}}}"
    below = "".join(_SUBSCRIPTS[c] for c in index or "")
    if letter is None:
        return rf"\textsubscript{{{below}}}"
    symbol = "\\" + _GREEK[letter] if letter in _GREEK else letter
    return rf"\ensuremath{{{symbol}_{{{below}}}}}"


class _Renderer(RendererPgf):  # type: ignore[misc, no-any-unimported, unused-ignore]
    """Matplotlib's, but for text: it would start a TeX to measure each."""

    def get_text_width_height_descent(self, s: str, prop: FontProperties, ismath: Any) -> tuple[float, float, float]:
        width, height, descent = text_to_path.get_text_width_height_descent(s, prop, False)
        scale = self.dpi / 72
        return float(width) * scale, float(height) * scale, float(descent) * scale

    def draw_text(
        self, gc: Any, x: float, y: float, s: str, prop: FontProperties, angle: float, ismath: Any = False,
        mtext: Any = None,
    ) -> None:  # fmt: skip
        align = "left" if mtext is None else mtext.get_horizontalalignment()
        width = self.get_text_width_height_descent(s, prop, ismath)[0]
        along = {"left": 0.0, "center": 0.5, "right": 1.0}[align] * width
        # of several lines each is given by its left end
        if mtext is not None and "\n" in mtext.get_text():
            align, along = "left", 0.0
        x, y = x + along * cos(radians(angle)), y + along * sin(radians(angle))
        options = [f"x={x / self.dpi:f}in", f"y={y / self.dpi:f}in", "base", *([] if align == "center" else [align])]
        options += [f"rotate={angle:f}"] if angle else []
        size = prop.get_size_in_points() * 72.27 / 72  # a point of TeX is smaller
        strong = r"\bfseries\boldmath" if prop.get_weight() in ("bold", "heavy", "semibold") else ""
        red, green, blue = tuple(gc.get_rgb())[:3]
        write = self.fh.write
        write(f"\\begin{{pgfscope}}\n\\definecolor{{textcolor}}{{rgb}}{{{red:f},{green:f},{blue:f}}}\n")
        write("\\pgfsetstrokecolor{textcolor}\n\\pgfsetfillcolor{textcolor}\n")
        font = f"\\color{{textcolor}}\\fontsize{{{size:f}}}{{{1.2 * size:f}}}{strong}\\selectfont"
        write(f"\\pgftext[{','.join(options)}]{{{font} {escaped(s)}}}\n\\end{{pgfscope}}\n")
