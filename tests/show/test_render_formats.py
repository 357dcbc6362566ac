"""Formats for print: PGF that LaTeX can read, EPS without a date, PDF with TrueType fonts, SVG with real text."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from matplotlib.figure import Figure
from support.maps import shipped
from test_render import bands

from ptmcad.show.render import draw
from ptmcad.show.render.printing import save
from ptmcad.show.style import styled


def drawn(folder: Path, suffix: str, **options: object) -> bytes:
    result = bands([], title="100 % of $x_1^2$ & \\alpha{ρ} #~") if options.pop("hostile", False) else shipped("fig4")
    draw(result, folder / f"map.{suffix}", style=styled(**options))  # type: ignore[arg-type]
    return (folder / f"map.{suffix}").read_bytes()


def test_pgf_is_balanced_and_holds_all_text(tmp_path: Path) -> None:
    text = drawn(tmp_path, "pgf", hostile=True).decode()
    commands = "\n".join(line for line in text.splitlines() if not line.startswith("%"))
    for kind in ("pgfscope", "pgfpicture"):
        assert commands.count(rf"\begin{{{kind}}}") == commands.count(rf"\end{{{kind}}}") > 0
    bare = re.sub(r"\\[\\{}]", "", commands)
    depth = 0
    for c in bare:
        depth += (c == "{") - (c == "}")
        assert depth >= 0
    assert depth == 0
    title = r"100 \% of \$x\_1\textasciicircum{}2\$ \& \textbackslash{}alpha\{\ensuremath{\rho}\} \#\textasciitilde{}"
    assert title in commands
    assert r"\bfseries\boldmath\selectfont Stable equilibria" in commands
    assert commands.isascii()


def test_pgf_has_the_size_and_type_that_are_asked_for(tmp_path: Path) -> None:
    text = drawn(tmp_path, "pgf", name="ieee").decode()
    assert r"\pgfqpoint{3.500000in}{2.600000in}" in text
    sizes = [float(size) * 72 / 72.27 for size in re.findall(r"\\fontsize\{([\d.]+)\}", text)]
    assert min(sizes) >= 5.999 and max(sizes) == pytest.approx(8.4)
    places = re.findall(r"\\pgftext\[x=([\d.]+)in,y=([\d.]+)in,base", text)
    assert len(places) == len(sizes) > 10
    assert all(0 < float(x) < 3.5 and 0 < float(y) < 2.6 for x, y in places)


def test_pgf_needs_no_tex(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert drawn(tmp_path, "pgf")


@pytest.mark.parametrize(
    ("text", "tex"),
    [
        ("A−1", r"A\ensuremath{-}1"),
        ("F₃ₓ", r"\ensuremath{F_{3x}}"),
        ("θ₁ of AL₂", r"\ensuremath{\theta_{1}} of AL\textsubscript{2}"),
        ('2 → 1, "mm²"', r"2 \ensuremath{\rightarrow} 1, \symbol{34}mm\ensuremath{^{2}}\symbol{34}"),
        ("2·10⁻⁷", r"2\ensuremath{\cdot}10\ensuremath{^{-7}}"),
    ],
)
def test_what_ptmcad_writes_is_set_by_plain_latex(text: str, tex: str) -> None:
    from ptmcad.show.render.pgf import escaped

    assert escaped(text) == tex


@pytest.mark.parametrize("suffix", [pytest.param("eps", marks=pytest.mark.slow), "pgf"])
def test_the_same_bytes_twice(suffix: str, tmp_path: Path) -> None:
    assert drawn(tmp_path, suffix) == drawn(tmp_path, suffix)


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
    root = ElementTree.fromstring(drawn(tmp_path, "svg", name="ieee", title="a < b & 'DejaVu Sans'"))
    texts = list(root.iter("{http://www.w3.org/2000/svg}text"))
    said = [text.text for text in texts]
    assert {"equilibria", "area 3.2536", "0.5", "L₂ (length)", "a < b & 'DejaVu Sans'"} <= set(said)
    for text in texts:
        assert "'DejaVu Sans', 'Bitstream Vera Sans', Verdana" in text.attrib["style"]


def test_eps_is_silent_about_transparency(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    figure = Figure(figsize=(1, 1))
    figure.text(0.5, 0.5, "x", alpha=0.5)
    figure.set_label("title")
    save(figure, tmp_path / "x.eps")
    assert not caplog.records
