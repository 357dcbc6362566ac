"""Pages of a reproduction: claims as Markdown and HTML, and an index with figures and equations.

Guarantee: the HTML is self-contained (pictures are inside, nothing is loaded) and every text in it is escaped.
"""

from __future__ import annotations

from base64 import b64encode
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from ptmcad.studies.paper.claim import Claim, Outcome, Verdict
from ptmcad.studies.paper.equations import Equation
from ptmcad.studies.tables import page

Judged = tuple[Claim, Outcome]
PAPER = "P. Wenger and D. Chablat, Kinetostatic Analysis and Solution Classification of a Planar Tensegrity Mechanism"
_SIGNS = {
    Verdict.CONFIRMED: "✓",
    Verdict.CORRECTED: "≠",
    Verdict.REFUTED: "✗",
    Verdict.NOT_CHECKED: "–",
    Verdict.UNDECIDED: "?",
}
_STYLE = Path(__file__).with_suffix(".css")


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


def _title(section: str) -> str:
    return f"Section {section}" if section[0].isdigit() else section.capitalize()


def _sections(judged: Sequence[Judged]) -> list[tuple[str, list[tuple[int, Claim, Outcome]]]]:
    grouped: dict[str, list[tuple[int, Claim, Outcome]]] = {}
    for number, (claim, outcome) in enumerate(judged, 1):
        grouped.setdefault(claim.section, []).append((number, claim, outcome))
    return list(grouped.items())


def summary(judged: Sequence[Judged]) -> str:
    """The numbers of claims by verdict, in one line."""
    counts = Counter(outcome.verdict for _, outcome in judged)
    return f"{len(judged)} claims: " + ", ".join(f"{counts[v]} {v.value}" for v in Verdict if counts[v])


def claims_markdown(judged: Sequence[Judged]) -> str:
    """All claims as a page of Markdown."""
    blocks: list[str | list[str]] = []
    for section, entries in _sections(judged):
        blocks.append(f"## {_title(section)}")
        for number, claim, outcome in entries:
            told = (("Right", outcome.right), ("Witness", outcome.witness), ("Reason", outcome.reason))
            points = [f"- **{name}:** {_plain(text)}" for name, text in told if text]
            points += [f"- {_plain(sentence)}" for sentence in outcome.evidence]
            heading = f"### {number}. {claim.name}: {outcome.verdict.value}"
            blocks += [heading, f'{claim.statement} ("{claim.quotation}")', points]
    return page("# The claims of the paper", f"{PAPER}.", f"{summary(judged)}.", *blocks)


def _plain(text: str) -> str:
    return text.replace("*", r"\*").replace("_", r"\_").replace("|", r"\|").replace("<", "&lt;")


def _page(title: str, body: Sequence[str]) -> str:
    style = _STYLE.read_text(encoding="utf-8")
    head = (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>\n{style}</style>\n</head>\n<body>\n<main>\n"
    )
    return head + "\n".join(body) + "\n</main>\n</body>\n</html>\n"


def _verdict(outcome: Outcome) -> str:
    kind = outcome.verdict.value.replace(" ", "-")
    return f'<span class="verdict {kind}">{_SIGNS[outcome.verdict]} {escape(outcome.verdict.value)}</span>'


def claims_html(judged: Sequence[Judged]) -> str:
    """All claims as a self-contained page."""
    body = [
        "<h1>The claims of the paper</h1>",
        f"<p>{escape(PAPER)}.</p>",
        f"<p>{escape(summary(judged))}. Every verdict was computed by this run of ptmcad.</p>",
    ]
    for section, entries in _sections(judged):
        body.append(f"<h2>{escape(_title(section))}</h2>")
        for number, claim, outcome in entries:
            body += [
                f'<article id="{escape(claim.name)}">',
                f"<h3>{number}. {escape(claim.statement)} {_verdict(outcome)}</h3>",
                f"<p><q>{escape(claim.quotation)}</q></p>",
            ]
            for name, text in (("Right", outcome.right), ("Witness", outcome.witness), ("Reason", outcome.reason)):
                if text:
                    body.append(f'<p class="right"><b>{name}:</b> {escape(text)}</p>')
            if outcome.evidence:
                body.append("<ul>" + "".join(f"<li>{escape(e)}</li>" for e in outcome.evidence) + "</ul>")
            body.append("</article>")
    return _page("The claims of the paper", body)


def _image(data: bytes, text: str) -> str:
    return f'<img alt="{escape(text)}" src="data:image/png;base64,{b64encode(data).decode("ascii")}">'


def index_html(judged: Sequence[Judged], figures: Sequence[Illustration], equations: Sequence[Equation]) -> str:
    """The first page: what is in the folder, the verdicts that are not plain confirmations, figures and equations."""
    body = [
        "<h1>The paper, reproduced</h1>",
        f"<p>{escape(PAPER)}.</p>",
        f'<p>{escape(summary(judged))}: <a href="claims.html">all of them with their evidence</a> '
        '(<a href="claims.md">Markdown</a>, <a href="claims.json">JSON</a>). '
        '<a href="#figures">Figures</a>; <a href="#equations">equations</a> '
        '(<a href="equations.md">text</a>, <a href="equations.tex">LaTeX</a>).</p>',
        "<h2>What is not as printed</h2>",
        '<div class="wide"><table><thead>',
        "<tr><th>Place</th><th>Claim</th><th>Verdict</th><th>Right, or where it fails</th></tr></thead><tbody>",
    ]
    for claim, outcome in judged:
        if outcome.verdict in (Verdict.CORRECTED, Verdict.REFUTED, Verdict.UNDECIDED):
            text = outcome.right or outcome.witness or outcome.reason
            link = f'<a href="claims.html#{escape(claim.name)}">{escape(claim.statement)}</a>'
            cells = (_title(claim.section), link, _verdict(outcome), escape(text))
            body.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    body += ["</tbody></table></div>", '<h2 id="figures">Figures</h2>']
    for f in figures:
        at = ", ".join(f"{name} = {value}" for name, value in f.at.items())
        body += [
            f'<figure id="{escape(f.figure)}">',
            f'<figcaption><b>{escape(f.figure)}.</b> {escape(f.title)} (<a href="{f.figure}.svg">SVG</a>, '
            f'<a href="{f.figure}-poses.svg">poses as SVG</a>, <a href="{f.figure}.json">result</a>)</figcaption>',
            _image(f.map, f"Region map and stable poses: {f.title}"),
            f"<p>All equilibria at {escape(at)} ({escape(f.source)}):</p>",
            _image(f.poses, f"All equilibria at {at}"),
            f"<pre>{escape(f.table)}</pre>",
            "</figure>",
        ]
    body += [
        '<h2 id="equations">Equations</h2>',
        "<p>Derived from the model's potential. f3 = F3/k, f4 = F4/k, f3x = F3x/k, f4x = F4x/k; t1, t2 are tangents "
        "of the half angles; in (10) to (13) L1 is the length of both rods.</p>",
    ]
    for e in equations:
        body += [f"<p>{escape(e.number)}: {escape(e.what)}</p>", f'<pre class="equation">{escape(e.text)}</pre>']
    return _page("The paper, reproduced", body)
