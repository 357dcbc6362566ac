"""The whole paper in one folder: its equations, figures, region maps, and a verdict on every claim.

Guarantee: verdicts and maps are computed in this run; nothing is read from a file of earlier results. All files are
written together or none is.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import TYPE_CHECKING, Any

from ptmcad.process.output import Writer, check_writable, text_writer, write_files
from ptmcad.studies.paper import equations
from ptmcad.studies.paper.claim import Claim, Verdict
from ptmcad.studies.paper.claims import all_claims
from ptmcad.studies.paper.pages import Illustration, Judged, claims_html, claims_markdown, index_html
from ptmcad.studies.paper.slices import FIGURES, POINTS, parameters_at, region_map
from ptmcad.version import __version__

if TYPE_CHECKING:
    from ptmcad.answer.poses import Poses
    from ptmcad.answer.regionmap import RegionMap

Progress = Callable[[str, int, int], None]

PICTURES = ("png", "svg")
FILES = (
    *(f"{figure}{part}.{suffix}" for figure in FIGURES for part in ("", "-poses") for suffix in PICTURES),
    *(f"{figure}.json" for figure in FIGURES),
    "equations.md", "equations.tex", "claims.md", "claims.html", "claims.json", "index.html",
)  # fmt: skip
"""What a reproduction writes; the last one vouches for the others."""


@dataclass(frozen=True, slots=True)
class Reproduction:
    """What was computed: every claim with its outcome, and the seconds by part."""

    judged: tuple[Judged, ...]
    seconds: Mapping[str, float]

    def number(self, verdict: Verdict) -> int:
        """How many claims have a verdict."""
        return sum(outcome.verdict is verdict for _, outcome in self.judged)

    def table(self) -> str:
        """The summary for the terminal: numbers of verdicts, what was not confirmed, and the time."""
        counts = ", ".join(f"{self.number(v)} {v.value}" for v in Verdict if self.number(v))
        lines = [f"{len(self.judged)} claims: {counts}"]
        for verdict in (Verdict.REFUTED, Verdict.CORRECTED, Verdict.UNDECIDED):
            for claim, outcome in self.judged:
                if outcome.verdict is verdict:
                    what = outcome.witness if verdict is Verdict.REFUTED else outcome.right or outcome.reason
                    lines.append(f"{verdict.value:10} {claim.name}: {what}")
        parts = ", ".join(f"{part} {seconds:.1f} s" for part, seconds in self.seconds.items())
        return "\n".join([*lines, f"time       {sum(self.seconds.values()):.1f} s: {parts}"])


def judge_all(claims: Sequence[Claim] | None = None, progress: Progress | None = None) -> tuple[Judged, ...]:
    """Every claim with the outcome of its check."""
    claims = all_claims() if claims is None else tuple(claims)
    judged = []
    for number, claim in enumerate(claims):
        if progress is not None:
            progress("claims", number, len(claims))
        judged.append((claim, claim.check()))
    return tuple(judged)


def poses_of(figure: str) -> Poses:
    """All equilibria at the point of a figure whose poses the paper shows, or at one of its two-solution region."""
    from ptmcad.ask.solving import solve

    _, at = POINTS[figure]
    values: dict[str, Any] = {n: v for n, v in parameters_at(figure, at).items() if n != "k"}
    return solve(**values)


def reproduce(folder: Path, progress: Progress | None = None) -> Reproduction:
    """Compute everything and write it into a folder, which is made if it is missing.

    Raises
    ------
    OutputError
        When a file cannot be written; then none is.
    """
    check_writable(folder, FILES)
    seconds: dict[str, float] = {}
    last = perf_counter()

    def done(part: str) -> None:
        nonlocal last
        now = perf_counter()
        seconds[part] = now - last
        last = now

    writers: dict[str, Writer] = {}
    maps = {figure: region_map(figure) for figure in FIGURES}
    done("maps")
    judged = judge_all(progress=progress)
    done("claims")
    texts = {"equations.md": equations.as_markdown(), "equations.tex": equations.as_latex()}
    done("equations")
    pictures: dict[str, bytes] = {}
    for number, figure in enumerate(FIGURES):
        if progress is not None:
            progress("figures", number, len(FIGURES))
        pictures |= _pictures(figure, maps[figure], poses_of(figure))
    done("figures")
    illustrations = [
        Illustration(figure, maps[figure].slice.heading, POINTS[figure][0], POINTS[figure][1],
                     pictures[f"{figure}.png"], pictures[f"{figure}-poses.png"], maps[figure].table())
        for figure in FIGURES
    ]  # fmt: skip
    for name, data in pictures.items():
        writers[name] = partial(_write_bytes, data)
    for figure in FIGURES:
        writers[f"{figure}.json"] = text_writer(maps[figure].to_json(timings=False))
    texts["claims.md"] = claims_markdown(judged)
    texts["claims.html"] = claims_html(judged)
    texts["claims.json"] = claims_json(judged)
    texts["index.html"] = index_html(judged, illustrations, equations.equations())
    writers |= {name: text_writer(text) for name, text in texts.items()}
    write_files(folder, {name: writers[name] for name in FILES})
    done("files")
    return Reproduction(judged, seconds)


def _pictures(figure: str, result: RegionMap, poses: Poses) -> dict[str, bytes]:
    """Names, such as ``fig4.png`` (the map beside the stable poses) and ``fig4-poses.svg``, and contents."""
    from ptmcad.show.render.figure import draw_figure
    from ptmcad.show.render.poses import draw_poses
    from ptmcad.show.render.printing import save

    found = {}
    with TemporaryDirectory() as folder:
        for suffix in PICTURES:
            for part, draw in (("", partial(draw_figure, result, poses)), ("-poses", partial(draw_poses, poses))):
                path = Path(folder) / f"{figure}{part}.{suffix}"
                save(draw(), path)
                found[path.name] = path.read_bytes()
    return found


def _write_bytes(data: bytes, path: Path) -> None:
    path.write_bytes(data)


def claims_json(judged: Sequence[Judged]) -> str:
    """Claims and outcomes as a JSON document; exact numbers that are not integers are text."""
    entries = [
        {
            "number": number,
            "name": claim.name,
            "section": claim.section,
            "quotation": claim.quotation,
            "statement": claim.statement,
            "verdict": outcome.verdict.value,
            "right": outcome.right,
            "witness": outcome.witness,
            "reason": outcome.reason,
            "evidence": list(outcome.evidence),
            "facts": {name: _plain(value) for name, value in outcome.facts.items()},
        }
        for number, (claim, outcome) in enumerate(judged, 1)
    ]
    document = {"document": "ptmcad paper claims", "version": __version__, "claims": entries}
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def _plain(value: object) -> object:
    if isinstance(value, tuple):
        return [_plain(v) for v in value]
    return str(value) if isinstance(value, Fraction) else value
