"""The whole paper in one folder: equations, figures, region maps, and a verdict on every claim, as
pages and JSON.

Guarantee: verdicts and maps are computed in this run; nothing is read from a file of earlier
results. All files are written together or none is. The HTML is self-contained (pictures are inside,
nothing is loaded) and every text in it is escaped. What stands between the texts is data,
``pages.yaml``.

The paper's equations are corrected, as text and LaTeX: every expression is derived from the
potential of the model by differentiation, substitution of half angles and elimination
(`ptmcad.studies.paper.statements`), or is a curve of a computed discriminant variety, and not taken
from the paper. Which they are is data, ``expressions.yaml``.
"""

from __future__ import annotations

import json
import re
from base64 import b64encode
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from fractions import Fraction
from functools import cache, partial
from html import escape
from itertools import groupby
from pathlib import Path
from time import perf_counter
from typing import Any

import sympy as sp

from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.solving import solve
from ptmcad.options import Progress
from ptmcad.process.output import check_writable, write_files
from ptmcad.studies.paper.claim import Claim, Verdict, judge, texts
from ptmcad.studies.paper.maps import FIGURES, POINTS, curves, region_map
from ptmcad.studies.paper.statements import (
    F3,
    F4,
    HORIZONTAL,
    TEXTS,
    Expr,
    c1,
    c2,
    expression,
    k,
    s1,
    s2,
)
from ptmcad.studies.texts import page, texts_beside
from ptmcad.text.numerals import equalities
from ptmcad.version import __version__

_OVER_K = {force: k * sp.Symbol(str(force).lower()) for force in (F3, F4, *HORIZONTAL)}
_THETA1, _THETA2 = sp.symbols("theta_1 theta_2", real=True)
_ANGLES = {c1: sp.cos(_THETA1), s1: sp.sin(_THETA1), c2: sp.cos(_THETA2), s2: sp.sin(_THETA2)}
_LATEX = {"cos(theta_1)": r"\cos\theta_1", "cos(theta_2)": r"\cos\theta_2", "det(H)": r"\det H"}

_NAMES = {sp.Symbol(f"f{n}x"): f"f_{{{n}x}}" for n in (3, 4)}
INTRODUCTION: str = TEXTS["introduction"].strip()


Equation = Mapping[str, str]
"""An equation: its ``number`` in the paper, ``what`` it is, and both sides as ``text`` and
``latex``.
"""


@cache
def equations() -> tuple[Equation, ...]:
    """The equations of the paper in their order, corrected."""
    # of the two curves of fig. 3 the one through the origin is first
    found = sorted(
        (c.polynomial for c in curves("fig3")),
        key=lambda p: any(i == j == 0 for i, j, _ in p.terms),
    )
    boundaries = {f"curve {n}": p.to_sympy(("rho", "F4")) for n, p in enumerate(found)}
    result = []
    for entry in TEXTS["equations"]:
        number, left, text = entry["number"], entry["left"], entry["right"]
        right = boundaries[text] if text in boundaries else expression(text)
        if number.startswith("q"):
            right = right.subs(_OVER_K).subs(k, 1)
        elif "forces" not in entry:
            right = sp.expand(right.subs(_OVER_K))
        shown = _shown(right)
        result.append(
            {
                "number": number,
                "what": entry["what"],
                "text": f"{left} = {sp.sstr(shown).replace('**', '^')}",
                "latex": f"{_LATEX.get(left, sp.latex(sp.Symbol(left)))} = {sp.latex(shown, symbol_names=_NAMES)}",
            }
        )
    return tuple(result)


def _shown(expression: Expr) -> Expr:
    """With the angles, and products of their cosines and sines as those of their sum."""
    total = _THETA1 + _THETA2
    compact = sp.expand(expression).subs(c1 * c2, sp.cos(total) + s1 * s2).expand()
    compact = compact.subs(s1 * c2, sp.sin(total) - c1 * s2).expand()
    return (compact if compact.has(total) else expression).subs(_ANGLES)


def equations_markdown() -> str:
    """The equations as a page of text."""
    blocks = [
        text for e in equations() for text in ("{number}: {what}".format_map(e), f"    {e['text']}")
    ]
    return page("# The paper's equations, corrected", INTRODUCTION, *blocks)


def equations_latex() -> str:
    """The equations as a LaTeX document; long ones are set by the breqn package, which breaks
    lines.
    """
    blocks = []
    for e in equations():
        title = (
            "{number}: {what}".format_map(e).replace("^", r"\textasciicircum{}").replace("_", r"\_")
        )
        blocks.append(
            rf"\noindent {title}" + "\n\\begin{dmath*}\n" + e["latex"] + "\n\\end{dmath*}"
        )
    names = re.sub(r"\b([fFLt])(\dx?)\b", r"$\1_{\2}$", INTRODUCTION)
    return "\n".join([TEXTS["latex"].rstrip(), rf"{names}\par", *blocks, "\\end{document}\n"])


PICTURES = ("png", "svg")
FILES = (
    *(f"{figure}{part}.{suffix}" for figure in FIGURES for part in ("", "-poses") for suffix in PICTURES),
    *(f"{figure}.json" for figure in FIGURES),
    "equations.md", "equations.tex", "claims.md", "claims.html", "claims.json", "index.html",
)  # fmt: skip
"""What a reproduction writes; the last one vouches for the others."""
PAPER = "P. Wenger and D. Chablat, Kinetostatic Analysis and Solution Classification of a Planar Tensegrity Mechanism"
FORMS = texts_beside(__file__, "pages.yaml")
_SIGNS = dict(zip(Verdict, "✓≠✗–?", strict=True))
NOT_AS_PRINTED = (Verdict.REFUTED, Verdict.CORRECTED, Verdict.UNDECIDED)


def summary(claims: Sequence[Claim]) -> str:
    """The numbers of claims by verdict, in one line."""
    counts = Counter(claim.verdict for claim in claims)
    return f"{len(claims)} claims: " + ", ".join(
        f"{counts[v]} {v.value}" for v in Verdict if counts[v]
    )


def table(claims: Sequence[Claim], seconds: float) -> str:
    """The summary for the terminal: numbers of verdicts, what was not confirmed, and the time."""
    lines = [summary(claims)]
    for verdict in NOT_AS_PRINTED:
        found = [c for c in claims if c.verdict is verdict]
        lines += [f"{verdict.value:10} {c.name}: {c.right or c.witness or c.reason}" for c in found]
    return "\n".join([*lines, f"time       {seconds:.1f} s"])


def claims_json(claims: Sequence[Claim]) -> str:
    """Claims as a JSON document; exact numbers that are not integers are text."""
    entries = [
        {"number": number, **asdict(c), "verdict": c.verdict.value}
        for number, c in enumerate(claims, 1)
    ]
    document = {"document": "ptmcad paper claims", "version": __version__, "claims": entries}
    return json.dumps(document, indent=1, ensure_ascii=False, default=str) + "\n"


def claims_markdown(claims: Sequence[Claim]) -> str:
    """All claims as a page of Markdown."""
    written = _written(claims, "markdown", _markdown)
    return page("# The claims of the paper", f"{PAPER}.", f"{summary(claims)}.", *written)


def claims_html(claims: Sequence[Claim]) -> str:
    """All claims as a self-contained page."""
    first = f"<p>{escape(summary(claims))}. Every verdict was computed by this run of ptmcad.</p>"
    return _page("The claims of the paper", [first, *_written(claims, "html", escape)])


def _markdown(text: str) -> str:
    return text.replace("*", r"\*").replace("_", r"\_").replace("|", r"\|").replace("<", "&lt;")


def _written(claims: Sequence[Claim], form: str, text: Callable[[str], str]) -> Iterator[str]:
    """Sections with their claims in a form, which a function makes any text fit for."""
    parts = FORMS[form]
    for section, members in groupby(enumerate(claims, 1), lambda member: member[1].section):
        yield parts["section"].format(_title(section))
        for number, c in members:
            yield parts["claim"].format(
                number=number,
                said="".join(parts["said"].format(name, text(said)) for name, said in _said(c)),
                evidence="".join(
                    parts["evidence"].format(text(sentence)) for sentence in c.evidence
                ),
                **_fields(c, text),
            )


def _fields(c: Claim, text: Callable[[str], str]) -> dict[str, str]:
    """What a claim and its verdict are called."""
    found = {name: text(getattr(c, name)) for name in ("name", "quotation", "statement")}
    return found | {
        "verdict": c.verdict.value,
        "kind": c.verdict.value.replace(" ", "-"),
        "sign": _SIGNS[c.verdict],
    }


def _title(section: str) -> str:
    return f"Section {section}" if section[0].isdigit() else section.capitalize()


def _said(c: Claim) -> list[tuple[str, str]]:
    """The remarks on the evidence, each with its kind."""
    return [
        (name.capitalize(), text)
        for name in ("right", "witness", "reason")
        if (text := getattr(c, name))
    ]


def _page(title: str, body: Iterable[str]) -> str:
    style = Path(__file__).with_suffix(".css").read_text(encoding="utf-8")
    return str(FORMS["page"]).format(
        title=escape(title), style=style, paper=escape(PAPER), body="\n".join(body)
    )


def index_html(
    claims: Sequence[Claim], figures: Sequence[str], formulas: Sequence[Equation]
) -> str:
    """The first page: what is in the folder, the verdicts that are not plain confirmations, figures
    and equations.
    """
    rows = [
        FORMS["row"].format(
            place=_title(c.section), said=escape(_said(c)[0][1]), **_fields(c, escape)
        )
        for c in claims
        if c.verdict in NOT_AS_PRINTED
    ]
    texts = [
        FORMS["equation"].format_map({key: escape(said) for key, said in e.items()})
        for e in formulas
    ]
    body = FORMS["index"].format(
        summary=escape(summary(claims)),
        rows="\n".join(rows),
        figures="\n".join(figures),
        introduction=escape(INTRODUCTION),
        equations="\n".join(texts),
    )
    return _page("The paper, reproduced", [body])


def figure_html(name: str, result: RegionMap, pictures: Mapping[str, bytes]) -> str:
    """A figure of the paper: its map, and the poses at its point with the map's table.

    Parameters
    ----------
    pictures : the files that are shown, PNG, by their names.
    """
    source, point = POINTS[name]
    shown = {"map": pictures[f"{name}.png"], "poses": pictures[f"{name}-poses.png"]}
    return str(FORMS["figure"]).format(
        name=name,
        title=escape(result.slice.heading),
        at=escape(equalities(point)),
        source=escape(source),
        table=escape(result.table()),
        **{key: b64encode(data).decode("ascii") for key, data in shown.items()},
    )


# ---------------------------------------------------------------------------------------------------------- everything


def reproduce(
    folder: Path, progress: Progress = lambda _part, _done, _total: None
) -> tuple[tuple[Claim, ...], float]:
    """Compute everything and write it into a folder, which is made if it is missing: the claims,
    and the seconds.

    Raises
    ------
    OutputError
        When a file cannot be written; then none is.
    """
    check_writable(folder, FILES)
    started = perf_counter()
    maps = {figure: region_map(figure) for figure in FIGURES}
    claims: list[Claim] = []
    for name, text in texts().items():
        claims.append(judge(name, text))
        progress("claims", len(claims), len(texts()))
    pictures: dict[str, bytes] = {}
    for number, figure in enumerate(FIGURES):
        progress("figures", number, len(FIGURES))
        pictures |= _pictures(figure)
    figures = [figure_html(figure, result, pictures) for figure, result in maps.items()]
    files = {f"{figure}.json": result.to_json(timings=False) for figure, result in maps.items()} | {
        "equations.md": equations_markdown(),
        "equations.tex": equations_latex(),
        "claims.md": claims_markdown(claims),
        "claims.html": claims_html(claims),
        "claims.json": claims_json(claims),
        "index.html": index_html(claims, figures, equations()),
    }
    contents = pictures | {name: text.encode() for name, text in files.items()}
    write_files(folder, {name: partial(Path.write_bytes, data=contents[name]) for name in FILES})
    return tuple(claims), perf_counter() - started


def _pictures(figure: str) -> dict[str, bytes]:
    """Names, such as ``fig4.png`` (the map beside the stable poses) and ``fig4-poses.svg``, and
    contents.
    """
    from ptmcad.show.render.plotting import with_poses
    from ptmcad.show.render.posepicture import draw_poses
    from ptmcad.show.render.printing import content

    at: dict[str, Any] = dict(POINTS[figure][1])
    result, poses = region_map(figure), solve(figure, **at)
    first, second = (Fraction(at[name]) for name in result.slice.axis_names)
    drawn = {
        figure: with_poses(result, [((first, second), poses)])[0],
        f"{figure}-poses": draw_poses(poses),
    }
    return {
        f"{name}.{kind}": content(picture, kind)
        for name, picture in drawn.items()
        for kind in PICTURES
    }
