"""Formats for print: EPS without a date, PDF with TrueType fonts, SVG with real text."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest
from support.maps import shipped

from ptmcad.show.render import draw
from ptmcad.show.style import styled


def drawn(folder: Path, suffix: str, **options: object) -> bytes:
    draw(shipped("fig4"), folder / f"map.{suffix}", style=styled(**options))  # type: ignore[arg-type]
    return (folder / f"map.{suffix}").read_bytes()


@pytest.mark.slow
def test_eps_has_its_size_and_no_date(tmp_path: Path) -> None:
    data = drawn(tmp_path, "eps", size="3x2.5in")
    assert data.startswith(b"%!PS-Adobe-3.0 EPSF")
    assert b"%%HiResBoundingBox: 0.000000 0.000000 216.000000 180.000000" in data
    assert b"Date" not in data
    assert b"/FontType 42 def" in data
    # older versions of matplotlib write Type 3 behind it, for printers that do not know 42
    assert data.count(b"/FontType 3 def") == data.count(b"{42 /FontType resourcestatus")


def test_pdf_has_truetype_fonts(tmp_path: Path) -> None:
    data = drawn(tmp_path, "pdf")
    assert b"/CIDFontType2" in data or b"/TrueType" in data
    assert b"/Type3" not in data


def test_svg_has_text_that_can_be_searched_in_fonts_that_are_there(tmp_path: Path) -> None:
    root = ElementTree.fromstring(
        drawn(tmp_path, "svg", name="ieee", title="a < b & 'DejaVu Sans'")
    )
    texts = list(root.iter("{http://www.w3.org/2000/svg}text"))
    said = [text.text for text in texts]
    assert {"equilibria", "area 3.2536", "0.5", "L₂ (length)", "a < b & 'DejaVu Sans'"} <= set(said)
    for text in texts:
        assert "'DejaVu Sans', 'Bitstream Vera Sans', Verdana" in text.attrib["style"]
