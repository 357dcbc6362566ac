"""Printing: a figure as the content of a PNG, SVG, PDF or EPS file, for screen readers with a title
and a description where the format has room for them.

Guarantee: the same figure gives the same bytes with the same matplotlib, whatever the user's
settings, the date and the machine. Global state of matplotlib is neither used nor changed.
"""

from __future__ import annotations

import logging
import re
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from html import escape
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, fontManager

from ptmcad.errors import ConfigError
from ptmcad.show.style import DEFAULT, PictureStyle

FORMATS = ("png", "svg", "pdf", "eps")

_SETTINGS: dict[str, Any] = {
    "font.family": ["DejaVu Sans"],  # comes with matplotlib
    "text.parse_math": False,
    "text.usetex": False,
    "axes.unicode_minus": True,
    "axes.linewidth": 0.8,
    "hatch.linewidth": 0.6,
    "path.simplify": False,
    "path.snap": True,
    "savefig.bbox": None,
    "svg.fonttype": "none",  # text that can be searched and copied
    "svg.hashsalt": "ptmcad",
    "svg.image_inline": True,
    "pdf.compression": 6,
    "pdf.fonttype": 42,  # TrueType, which journals ask for and editors of drawings read
    "ps.fonttype": 42,
}
_CHANGING = re.compile(rb"^%%CreationDate:.*\n", re.MULTILINE)
_TEXT_STYLE = re.compile(r"""(?<=<text style=")[^"<>]*'DejaVu Sans'""")
_SIMILAR = "'Bitstream Vera Sans', Verdana, Geneva, sans-serif"
"""Fonts about as wide as the one that SVG text was measured in, for where that is not installed."""
_UNDATED: dict[str, dict[str, str | None]] = {
    "svg": {"Date": None, "Creator": "ptmcad"},
    "pdf": {"CreationDate": None, "Creator": "ptmcad", "Producer": None},
    "eps": {"Creator": "ptmcad"},
    "png": {"Software": None},
}
"""What is written of the making of a picture."""
_KEPT = ("backend", "backend_fallback", "interactive", "toolbar", "timezone")


@contextmanager
def settings(style: PictureStyle = DEFAULT) -> Iterator[None]:
    """Matplotlib's own defaults and the project's fonts, not a user's matplotlibrc; for drawing and
    for printing.

    A style's font comes first; letters that it lacks are taken from the one that comes with
    matplotlib.
    """
    own: Any = {k: v for k, v in matplotlib.rcParamsDefault.items() if k not in _KEPT} | _SETTINGS
    if style.font_family:
        own["font.family"] = [*style.font_family, *_SETTINGS["font.family"]]
    with matplotlib.rc_context(own), warnings.catch_warnings():
        # a title in a script that the font lacks is shown with boxes; SVG's title and the JSON keep
        # it
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        yield


def save(figure: Figure, path: Path, *, dpi: int = 150, style: PictureStyle = DEFAULT) -> None:
    """Write a figure whose label is its title and, on further lines, its description.

    Parameters
    ----------
    path : its suffix gives the format, one of `FORMATS`.
    dpi : resolution of a PNG.
    style : with which it was drawn.

    Raises
    ------
    ValueError
        For another suffix.
    OSError
        When the file cannot be written.
    """
    suffix = path.suffix.lower().removeprefix(".")
    if suffix not in FORMATS:
        raise ValueError(f"{path.name}: the format {suffix!r} is not among {', '.join(FORMATS)}")
    path.write_bytes(content(figure, suffix, dpi=dpi, style=style))


def content(figure: Figure, suffix: str, *, dpi: int = 150, style: PictureStyle = DEFAULT) -> bytes:
    """What `save` writes."""
    title, _, description = str(figure.get_label()).partition("\n")
    with settings(style):
        return printed(figure, suffix, dpi, title, description)


def printed(figure: Figure, suffix: str, dpi: int, title: str, description: str) -> bytes:
    """The picture as a file's content, without dates and versions; to be called within `settings`."""
    data = BytesIO()
    metadata = {
        **_UNDATED[suffix],
        "Title": title.encode("ascii", "replace").decode() if suffix == "eps" else title,
    }
    with _opaque():
        figure.savefig(data, format=suffix, dpi=dpi, metadata=metadata)
    if suffix == "eps":
        return _CHANGING.sub(b"", data.getvalue())
    if suffix != "svg":
        return data.getvalue()
    head = f"<title>{escape(title, quote=False)}</title>"
    described = f"{head}\n <desc>{escape(description, quote=False)}</desc>"
    content = _TEXT_STYLE.sub(rf"\g<0>, {_SIMILAR}", data.getvalue().decode())
    return content.replace(head, described, 1).replace("<svg ", '<svg role="img" ', 1).encode()


@contextmanager
def _opaque() -> Iterator[None]:
    """PostScript knows no transparency; that the little there is becomes opaque is nothing to log."""

    def other(record: logging.LogRecord) -> bool:
        return "transparency" not in record.getMessage()

    log = logging.getLogger("matplotlib.backends.backend_ps")
    log.addFilter(other)
    try:
        yield
    finally:
        log.removeFilter(other)


_GENERIC = ("serif", "sans-serif", "monospace", "cursive", "fantasy")
_SHOWN = 12


def check_families(families: Sequence[str]) -> None:
    """Refuse families of which none is installed.

    Raises
    ------
    ConfigError
        With those that are.
    """
    for family in families:
        if family.lower() in _GENERIC:
            continue
        try:
            fontManager.findfont(FontProperties(family=[family]), fallback_to_default=False)
        except ValueError as error:
            names = sorted(
                {
                    font.name
                    for font in fontManager.ttflist
                    if not font.name.startswith((".", "STIX", "cm"))
                }
            )
            more = "" if len(names) <= _SHOWN else f" and {len(names) - _SHOWN} more"
            raise ConfigError(
                f"no font of the family {family!r} is installed; there are {', '.join(names[:_SHOWN])}{more}, "
                "serif, sans-serif and monospace",
                key="font_family",
            ) from error
