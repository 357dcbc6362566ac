"""Pages of a reproduction: claims as Markdown, JSON and HTML, and an index with figures and equations.

Guarantee: the HTML is self-contained (pictures are inside, nothing is loaded) and every text in it is escaped.
"""

from __future__ import annotations

import json
from base64 import b64encode
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from html import escape
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from ptmcad.answer.regionmap import RegionMap
from ptmcad.studies.paper.claim import Claim, Verdict
from ptmcad.studies.paper.equations import INTRODUCTION, Equation
from ptmcad.studies.paper.maps import POINTS
from ptmcad.studies.tables import page
from ptmcad.version import __version__

PAPER = "P. Wenger and D. Chablat, Kinetostatic Analysis and Solution Classification of a Planar Tensegrity Mechanism"
_SIGNS = dict(zip(Verdict, "✓≠✗–?", strict=True))
NOT_AS_PRINTED = (Verdict.REFUTED, Verdict.CORRECTED, Verdict.UNDECIDED)


def summary(claims: Sequence[Claim]) -> str:
    """The numbers of claims by verdict, in one line."""
    counts = Counter(claim.verdict for claim in claims)
    return f"{len(claims)} claims: " + ", ".join(f"{counts[v]} {v.value}" for v in Verdict if counts[v])


def claims_json(claims: Sequence[Claim]) -> str:
    """Claims as a JSON document; exact numbers that are not integers are text."""
    entries = [{"number": number, **asdict(c), "verdict": c.verdict.value} for number, c in enumerate(claims, 1)]
    document = {"document": "ptmcad paper claims", "version": __version__, "claims": entries}
    return json.dumps(document, indent=1, ensure_ascii=False, default=str) + "\n"


class Form(NamedTuple):
    """How claims are written: a section's heading, a claim, what is said of it, its evidence, and any text in them."""

    section: str
    claim: str
    said: str
    evidence: str
    text: Callable[[str], str]


MARKDOWN = Form(
    "## {}",
    '### {number}. {name}: {verdict}\n\n{statement} ("{quotation}")\n\n{said}{evidence}',
    "- **{}:** {}\n",
    "- {}\n",
    lambda text: text.replace("*", r"\*").replace("_", r"\_").replace("|", r"\|").replace("<", "&lt;"),
)
_VERDICT = '<span class="verdict {kind}">{sign} {verdict}</span>'
HTML = Form(
    "<h2>{}</h2>",
    '<article id="{name}">\n<h3>{number}. {statement} ' + _VERDICT + "</h3>\n<p><q>{quotation}</q></p>\n"
    "{said}<ul>{evidence}</ul>\n</article>",
    '<p class="right"><b>{}:</b> {}</p>\n',
    "<li>{}</li>",
    escape,
)


def _written(claims: Sequence[Claim], form: Form) -> Iterator[str]:
    for section, members in groupby(enumerate(claims, 1), lambda member: member[1].section):
        yield form.section.format(_title(section))
        for number, c in members:
            yield form.claim.format(
                number=number,
                said="".join(form.said.format(name, form.text(text)) for name, text in _said(c)),
                evidence="".join(form.evidence.format(form.text(sentence)) for sentence in c.evidence),
                **_fields(c, form.text),
            )


def _fields(c: Claim, text: Callable[[str], str]) -> dict[str, str]:
    """What a claim and its verdict are called."""
    found = {name: text(getattr(c, name)) for name in ("name", "quotation", "statement")}
    return found | {"verdict": c.verdict.value, "kind": c.verdict.value.replace(" ", "-"), "sign": _SIGNS[c.verdict]}


def _title(section: str) -> str:
    return f"Section {section}" if section[0].isdigit() else section.capitalize()


def _said(c: Claim) -> list[tuple[str, str]]:
    """What is said beside the evidence, with what it is."""
    return [(name.capitalize(), text) for name in ("right", "witness", "reason") if (text := getattr(c, name))]


def claims_markdown(claims: Sequence[Claim]) -> str:
    """All claims as a page of Markdown."""
    return page("# The claims of the paper", f"{PAPER}.", f"{summary(claims)}.", *_written(claims, MARKDOWN))


def claims_html(claims: Sequence[Claim]) -> str:
    """All claims as a self-contained page."""
    first = f"<p>{escape(summary(claims))}. Every verdict was computed by this run of ptmcad.</p>"
    return _page("The claims of the paper", [first, *_written(claims, HTML)])


def _page(title: str, body: Iterable[str]) -> str:
    style = Path(__file__).with_suffix(".css").read_text(encoding="utf-8")
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>\n{style}</style>\n</head>\n<body>\n<main>\n"
        f"<h1>{escape(title)}</h1>\n<p>{escape(PAPER)}.</p>\n" + "\n".join(body) + "\n</main>\n</body>\n</html>\n"
    )


_CONTENTS = """<p>{}: <a href="claims.html">all of them with their evidence</a> (<a href="claims.md">Markdown</a>,
<a href="claims.json">JSON</a>). <a href="#figures">Figures</a>; <a href="#equations">equations</a>
(<a href="equations.md">text</a>, <a href="equations.tex">LaTeX</a>).</p>
<h2>What is not as printed</h2>
<div class="wide"><table><thead>
<tr><th>Place</th><th>Claim</th><th>Verdict</th><th>Right, or where it fails</th></tr></thead><tbody>"""
_ROW = (
    '<tr><td>{place}</td><td><a href="claims.html#{name}">{statement}</a></td><td>' + _VERDICT + "</td>"
    "<td>{said}</td></tr>"
)


def index_html(claims: Sequence[Claim], figures: Sequence[str], equations: Sequence[Equation]) -> str:
    """The first page: what is in the folder, the verdicts that are not plain confirmations, figures and equations."""
    rows = [
        _ROW.format(place=_title(c.section), said=escape(_said(c)[0][1]), **_fields(c, escape))
        for c in claims if c.verdict in NOT_AS_PRINTED
    ]  # fmt: skip
    texts = [
        f'<p>{escape(e.number)}: {escape(e.what)}</p>\n<pre class="equation">{escape(e.text)}</pre>' for e in equations
    ]
    return _page("The paper, reproduced", [
        _CONTENTS.format(escape(summary(claims))), *rows, "</tbody></table></div>",
        '<h2 id="figures">Figures</h2>', *figures,
        f'<h2 id="equations">Equations</h2>\n<p>{escape(INTRODUCTION)}</p>', *texts,
    ])  # fmt: skip


def figure_html(name: str, result: RegionMap, pictures: Mapping[str, bytes]) -> str:
    """A figure of the paper: its map, and the poses at its point with the map's table.

    Parameters
    ----------
    pictures : the files that are shown, PNG, by their names.
    """
    source, point = POINTS[name]
    at = escape(", ".join(f"{axis} = {value}" for axis, value in point.items()))
    title = escape(result.slice.heading)
    return f"""<figure id="{name}">
<figcaption><b>{name}.</b> {title} (<a href="{name}.svg">SVG</a>, <a href="{name}-poses.svg">poses as SVG</a>,
<a href="{name}.json">result</a>)</figcaption>
{_image(pictures[f"{name}.png"], f"Region map and stable poses: {title}")}
<p>All equilibria at {at} ({escape(source)}):</p>
{_image(pictures[f"{name}-poses.png"], f"All equilibria at {at}")}
<pre>{escape(result.table())}</pre>
</figure>"""


def _image(data: bytes, text: str) -> str:
    return f'<img alt="{text}" src="data:image/png;base64,{b64encode(data).decode("ascii")}">'
