"""Pages of a reproduction: claims as Markdown, JSON and HTML, and an index with figures and equations.

Guarantee: the HTML is self-contained (pictures are inside, nothing is loaded) and every text in it is escaped.
"""

from __future__ import annotations

import json
from base64 import b64encode
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import groupby
from pathlib import Path
from typing import Any

from ptmcad.studies.paper.claim import Judged, Outcome, Verdict
from ptmcad.studies.paper.equations import Equation
from ptmcad.studies.tables import page
from ptmcad.version import __version__

PAPER = "P. Wenger and D. Chablat, Kinetostatic Analysis and Solution Classification of a Planar Tensegrity Mechanism"
_SIGNS = dict(zip(Verdict, "✓≠✗–?", strict=True))
_STYLE = Path(__file__).with_suffix(".css")
NOT_AS_PRINTED = (Verdict.REFUTED, Verdict.CORRECTED, Verdict.UNDECIDED)


@dataclass(frozen=True, slots=True)
class Illustration:
    """A figure of the paper: title, whose point the poses belong to, the pictures (PNG) and the map's table."""

    figure: str
    title: str
    source: str
    at: Mapping[str, str]
    map: bytes
    poses: bytes
    table: str


def summary(judged: Sequence[Judged]) -> str:
    """The numbers of claims by verdict, in one line."""
    counts = Counter(outcome.verdict for _, outcome in judged)
    return f"{len(judged)} claims: " + ", ".join(f"{counts[v]} {v.value}" for v in Verdict if counts[v])


def _sections(judged: Sequence[Judged]) -> Iterable[tuple[str, list[tuple[int, Judged]]]]:
    """The claims with their numbers, by the titles of sections."""
    for section, entries in groupby(enumerate(judged, 1), lambda entry: entry[1][0].section):
        yield _title(section), list(entries)


def _title(section: str) -> str:
    return f"Section {section}" if section[0].isdigit() else section.capitalize()


def _said(outcome: Outcome) -> list[tuple[str, str]]:
    """What is said beside the evidence, with what it is."""
    told = (("Right", outcome.right), ("Witness", outcome.witness), ("Reason", outcome.reason))
    return [(name, text) for name, text in told if text]


def claims_json(judged: Sequence[Judged]) -> str:
    """Claims and outcomes as a JSON document; exact numbers that are not integers are text."""
    entries: list[dict[str, Any]] = [
        {
            "number": number,
            **{name: getattr(claim, name) for name in ("name", "section", "quotation", "statement")},
            "verdict": outcome.verdict.value,
            **{name: getattr(outcome, name) for name in ("right", "witness", "reason", "evidence")},
            "facts": dict(outcome.facts or {}),
        }
        for number, (claim, outcome) in enumerate(judged, 1)
    ]
    document = {"document": "ptmcad paper claims", "version": __version__, "claims": entries}
    return json.dumps(document, indent=1, ensure_ascii=False, default=str) + "\n"


def claims_markdown(judged: Sequence[Judged]) -> str:
    """All claims as a page of Markdown."""
    blocks: list[str | list[str]] = []
    for title, entries in _sections(judged):
        blocks.append(f"## {title}")
        for number, (claim, outcome) in entries:
            points = [f"- **{name}:** {_plain(text)}" for name, text in _said(outcome)]
            points += [f"- {_plain(sentence)}" for sentence in outcome.evidence]
            heading = f"### {number}. {claim.name}: {outcome.verdict.value}"
            blocks += [heading, f'{claim.statement} ("{claim.quotation}")', points]
    return page("# The claims of the paper", f"{PAPER}.", f"{summary(judged)}.", *blocks)


def _plain(text: str) -> str:
    return text.replace("*", r"\*").replace("_", r"\_").replace("|", r"\|").replace("<", "&lt;")


# --------------------------------------------------------------------------------------------------------------- HTML


def _page(title: str, body: Iterable[str]) -> str:
    style = _STYLE.read_text(encoding="utf-8")
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>\n{style}</style>\n</head>\n<body>\n<main>\n"
        f"<h1>{escape(title)}</h1>\n<p>{escape(PAPER)}.</p>\n" + "\n".join(body) + "\n</main>\n</body>\n</html>\n"
    )


def _verdict(outcome: Outcome) -> str:
    kind = outcome.verdict.value.replace(" ", "-")
    return f'<span class="verdict {kind}">{_SIGNS[outcome.verdict]} {escape(outcome.verdict.value)}</span>'


def claims_html(judged: Sequence[Judged]) -> str:
    """All claims as a self-contained page."""
    body = [f"<p>{escape(summary(judged))}. Every verdict was computed by this run of ptmcad.</p>"]
    for title, entries in _sections(judged):
        body.append(f"<h2>{escape(title)}</h2>")
        for number, (claim, outcome) in entries:
            body += [
                f'<article id="{escape(claim.name)}">',
                f"<h3>{number}. {escape(claim.statement)} {_verdict(outcome)}</h3>",
                f"<p><q>{escape(claim.quotation)}</q></p>",
                *(f'<p class="right"><b>{name}:</b> {escape(text)}</p>' for name, text in _said(outcome)),
                "<ul>" + "".join(f"<li>{escape(e)}</li>" for e in outcome.evidence) + "</ul>",
                "</article>",
            ]
    return _page("The claims of the paper", body)


_CONTENTS = """<p>{}: <a href="claims.html">all of them with their evidence</a> (<a href="claims.md">Markdown</a>,
<a href="claims.json">JSON</a>). <a href="#figures">Figures</a>; <a href="#equations">equations</a>
(<a href="equations.md">text</a>, <a href="equations.tex">LaTeX</a>).</p>
<h2>What is not as printed</h2>
<div class="wide"><table><thead>
<tr><th>Place</th><th>Claim</th><th>Verdict</th><th>Right, or where it fails</th></tr></thead><tbody>"""
_EQUATIONS = """<h2 id="equations">Equations</h2>
<p>Derived from the model's potential. f3 = F3/k, f4 = F4/k, f3x = F3x/k, f4x = F4x/k; t1, t2 are tangents of the half
angles; in (10) to (13) L1 is the length of both rods.</p>"""


def index_html(judged: Sequence[Judged], figures: Sequence[Illustration], equations: Sequence[Equation]) -> str:
    """The first page: what is in the folder, the verdicts that are not plain confirmations, figures and equations."""
    body = [_CONTENTS.format(escape(summary(judged)))]
    for claim, outcome in judged:
        if outcome.verdict in NOT_AS_PRINTED:
            link = f'<a href="claims.html#{escape(claim.name)}">{escape(claim.statement)}</a>'
            cells = (_title(claim.section), link, _verdict(outcome), escape(_said(outcome)[0][1]))
            body.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    body += ["</tbody></table></div>", '<h2 id="figures">Figures</h2>', *map(_figure, figures), _EQUATIONS]
    for e in equations:
        body += [f"<p>{escape(e.number)}: {escape(e.what)}</p>", f'<pre class="equation">{escape(e.text)}</pre>']
    return _page("The paper, reproduced", body)


def _figure(f: Illustration) -> str:
    at = ", ".join(f"{name} = {value}" for name, value in f.at.items())
    title, name = escape(f.title), f.figure
    return f"""<figure id="{name}">
<figcaption><b>{name}.</b> {title} (<a href="{name}.svg">SVG</a>, <a href="{name}-poses.svg">poses as SVG</a>,
<a href="{name}.json">result</a>)</figcaption>
{_image(f.map, f"Region map and stable poses: {f.title}")}
<p>All equilibria at {escape(at)} ({escape(f.source)}):</p>
{_image(f.poses, f"All equilibria at {at}")}
<pre>{escape(f.table)}</pre>
</figure>"""


def _image(data: bytes, text: str) -> str:
    return f'<img alt="{escape(text)}" src="data:image/png;base64,{b64encode(data).decode("ascii")}">'
