"""A discriminant variety in the languages of other programs, as LaTeX, as JSON and as text.

Guarantee: every format has every component of the variety (the input for QEPCAD those that have a
point in the window), exactly; the program that a format is meant for reads the text as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

from ptmcad.answer.slicevariety import SliceVariety
from ptmcad.errors import ConfigError
from ptmcad.show.export.code import code
from ptmcad.show.export.document import FORMAT, document
from ptmcad.show.export.inputs import msolve, qepcad
from ptmcad.show.export.listing import latex, listing
from ptmcad.show.polynomial_text import Style
from ptmcad.text.syntax import did_you_mean

__all__ = ["FORMAT", "FORMATS", "variety_text"]

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
