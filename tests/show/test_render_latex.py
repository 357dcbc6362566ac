"""PGF as LaTeX sees it: pictures of every kind go through TeX without an error, as large as they are meant to be.

Where there is no TeX, what can be read without one is: that braces and environments are balanced, and all is ASCII.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from fractions import Fraction
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from support.certified_maps import circle
from support.maps import heavier_fig4, shipped
from support.programs import needs_latex
from test_render import bands

import ptmcad
from ptmcad.show.render import draw
from ptmcad.show.render.comparing import draw_comparison
from ptmcad.show.render.pgf import _GREEK, _SPECIAL, _SUBSCRIPTS, _SUPERSCRIPTS, escaped
from ptmcad.show.render.plotting import draw_with_poses
from ptmcad.show.style import styled

DOCUMENT = r"""
\documentclass{article}
\usepackage{fix-cm}
\usepackage{pgf}
\begin{document}
\setbox0=\hbox{%s}
\typeout{SIZE \the\wd0 \space \the\ht0 \space \the\dp0}
\tracinglostchars=2
\box0
\end{document}
"""


def exact(path: Path, style: str, **options: str) -> None:
    draw(shipped("fig4"), path, style=styled(style, **options))


def hostile(path: Path) -> None:
    title = "100 % of $x_1^2$ & \\alpha{ρ} #~ \"θ₁\" 'ü' 1 → 2, 3 µm"
    draw(bands([], title=title), path, style=styled(size="6x4in"))


def certified(path: Path) -> None:
    draw(circle(7), path, style=styled("elsevier"))


def with_poses(path: Path) -> None:
    at = (Fraction(1), Fraction(3, 2))
    poses = ptmcad.solve(rho=at[0], L2=at[1], F3=-10, F4=-10)
    draw_with_poses(shipped("fig4"), ((at, poses),), path, 150, styled(size="7x4in", font_size="8"), ())


def compared(path: Path) -> None:
    found = shipped("fig4").compare(heavier_fig4())
    draw_comparison(found, path, 150, styled(size="7x4in", font_size="8"))


INCHES: dict[str, tuple[Callable[[Path], None], tuple[float, float]]] = {
    "exact-ieee": (partial(exact, style="ieee"), (3.5, 2.6)),
    "exact-elsevier": (partial(exact, style="elsevier"), (90 / 25.4, 68 / 25.4)),
    "exact-grey": (partial(exact, style="ieee", palette="grey", thin_lines="dotted"), (3.5, 2.6)),
    "certified-elsevier": (certified, (90 / 25.4, 68 / 25.4)),
    "hostile": (hostile, (6.0, 4.0)),
    "with-poses": (with_poses, (7.0, 4.0)),
    "compared": (compared, (7.0, 4.0)),
}


@cache
def text_of(name: str) -> str:
    """The picture, drawn once."""
    with TemporaryDirectory() as folder:
        INCHES[name][0](Path(folder) / "map.pgf")
        return (Path(folder) / "map.pgf").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", INCHES)
@pytest.mark.slow_cases("exact-elsevier", "hostile", "with-poses")
def test_a_picture_can_be_read_without_tex(name: str) -> None:
    text = text_of(name)
    commands = "\n".join(line for line in text.splitlines() if not line.startswith("%"))
    for kind in ("pgfscope", "pgfpicture"):
        assert commands.count(rf"\begin{{{kind}}}") == commands.count(rf"\end{{{kind}}}") > 0
    assert not re.findall(r"[^\x00-\x7f]", commands.replace("ü", ""))
    depth = 0
    for c in re.sub(r"\\[\\{}]", "", commands):
        depth += (c == "{") - (c == "}")
        assert depth >= 0
    assert depth == 0


def typeset(folder: Path, body: str) -> tuple[list[float], str]:
    """Width, height and depth in inches of what LaTeX makes of a horizontal box, and what it says."""
    (folder / "document.tex").write_text(DOCUMENT % body, encoding="utf-8")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "-no-shell-escape", "document.tex"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace", check=False)
    assert done.returncode == 0, done.stdout[-2000:]
    log = (folder / "document.log").read_text(encoding="utf-8", errors="replace")
    sides = re.search(r"SIZE ([\d.]+)pt\s+([\d.]+)pt\s+([\d.]+)pt", log)
    assert sides is not None
    return [float(side) / 72.27 for side in sides.groups()], log


@needs_latex
@pytest.mark.parametrize("name", INCHES)
@pytest.mark.fast_cases("hostile")
def test_latex_sets_a_picture_at_its_size(name: str, tmp_path: Path) -> None:
    (tmp_path / "map.pgf").write_text(text_of(name), encoding="utf-8")
    sides, log = typeset(tmp_path, r"\input{map.pgf}")
    assert sides == pytest.approx([*INCHES[name][1], 0.0], abs=1e-3)
    assert "Missing character" not in log
    assert "Output written on document.pdf (1 page" in log


@needs_latex
def test_latex_has_every_letter_that_pictures_have(tmp_path: Path) -> None:
    letters = [*_SPECIAL, *_GREEK, *_SUBSCRIPTS, *_SUPERSCRIPTS]
    sides, log = typeset(tmp_path, " ".join(map(escaped, letters)))
    assert sides[0] > 0.05 * len(letters) and "Missing character" not in log
