r"""PGF: a figure as commands of LaTeX, which sets its text in the document's own font.

Guarantee: no TeX is needed to write it, and LaTeX's plain font encodings suffice to set what ptmcad itself writes
(Greek letters, indices, powers, minus signs); other letters of a title are left as they are, for XeLaTeX and LuaLaTeX.

Not guaranteed: that the text is as wide as in other formats. It is placed by its left end, middle or right end,
whichever it was aligned by, so that another font moves nothing.
"""

from __future__ import annotations

from io import StringIO
from math import cos, radians, sin
from typing import Any

from matplotlib.backends.backend_pgf import RendererPgf
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

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
    "|": r"\ensuremath{|}", '"': r"\textquotedbl{}",
    "\N{NO-BREAK SPACE}": "~", "−": r"\ensuremath{-}", "…": r"\ldots{}", "·": r"\ensuremath{\cdot}",
    "×": r"\ensuremath{\times}", "≈": r"\ensuremath{\approx}", "°": r"\ensuremath{^\circ}", "–": "--",
}  # fmt: skip
_GREEK = {
    "α": "alpha", "β": "beta", "γ": "gamma", "δ": "delta", "θ": "theta", "κ": "kappa", "λ": "lambda", "μ": "mu",
    "ρ": "rho", "φ": "varphi",
}  # fmt: skip
_SUBSCRIPTS = dict(zip("₀₁₂₃₄₅₆₇₈₉ₓ", "0123456789x", strict=True))
_SUPERSCRIPTS = dict(zip("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789", strict=True))


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
    text.write("\\end{pgfpicture}\n\\makeatother\n\\endgroup\n")
    return text.getvalue()


def escaped(text: str) -> str:
    r"""A text for LaTeX.

    >>> print(escaped("L₂ / 10⁻³ & 50 %"))
    L\textsubscript{2} / 10\ensuremath{^{-3}} \& 50 \%
    """
    parts: list[str] = []
    run, kind = "", ""
    for c in [*text, ""]:
        of = "sub" if c and c in _SUBSCRIPTS else "super" if c and c in _SUPERSCRIPTS else ""
        if of != kind and run:
            parts.append(rf"\textsubscript{{{run}}}" if kind == "sub" else rf"\ensuremath{{^{{{run}}}}}")
            run = ""
        kind = of
        if of:
            run += _SUBSCRIPTS[c] if of == "sub" else _SUPERSCRIPTS[c]
        elif c in _GREEK:
            parts.append(rf"\ensuremath{{\{_GREEK[c]}}}")
        else:
            parts.append(_SPECIAL.get(c, c))
    return "".join(parts)


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
        strong = r"\bfseries" if prop.get_weight() in ("bold", "heavy", "semibold") else ""
        red, green, blue = tuple(gc.get_rgb())[:3]
        write = self.fh.write
        write(f"\\begin{{pgfscope}}\n\\definecolor{{textcolor}}{{rgb}}{{{red:f},{green:f},{blue:f}}}\n")
        write("\\pgfsetstrokecolor{textcolor}\n\\pgfsetfillcolor{textcolor}\n")
        font = f"\\color{{textcolor}}\\fontsize{{{size:f}}}{{{1.2 * size:f}}}{strong}\\selectfont"
        write(f"\\pgftext[{','.join(options)}]{{{font} {escaped(s)}}}\n\\end{{pgfscope}}\n")
