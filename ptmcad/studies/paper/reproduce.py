"""The whole paper in one folder: its equations, figures, region maps, and a verdict on every claim.

Guarantee: verdicts and maps are computed in this run; nothing is read from a file of earlier results. All files are
written together or none is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

from ptmcad.ask.solving import solve
from ptmcad.process.output import check_writable, write_files
from ptmcad.studies.paper import equations, pages
from ptmcad.studies.paper.claim import Claim, Verdict, judged, texts
from ptmcad.studies.paper.maps import FIGURES, POINTS, region_map

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
    """What was computed: every claim with its verdict, and the seconds by part."""

    claims: tuple[Claim, ...]
    seconds: Mapping[str, float]

    def number(self, verdict: Verdict) -> int:
        """How many claims have a verdict."""
        return sum(claim.verdict is verdict for claim in self.claims)

    def table(self) -> str:
        """The summary for the terminal: numbers of verdicts, what was not confirmed, and the time."""
        lines = [pages.summary(self.claims)]
        for c in sorted(self.claims, key=lambda c: [*pages.NOT_AS_PRINTED, c.verdict].index(c.verdict)):
            if c.verdict in pages.NOT_AS_PRINTED:
                lines.append(f"{c.verdict.value:10} {c.name}: {c.right or c.witness or c.reason}")
        parts = ", ".join(f"{part} {seconds:.1f} s" for part, seconds in self.seconds.items())
        return "\n".join([*lines, f"time       {sum(self.seconds.values()):.1f} s: {parts}"])


def reproduce(folder: Path, progress: Progress = lambda _part, _done, _total: None) -> Reproduction:
    """Compute everything and write it into a folder, which is made if it is missing.

    Raises
    ------
    OutputError
        When a file cannot be written; then none is.
    """
    check_writable(folder, FILES)
    started, seconds = perf_counter(), dict[str, float]()

    def done(part: str) -> None:
        seconds[part] = perf_counter() - started - sum(seconds.values())

    maps = {figure: region_map(figure) for figure in FIGURES}
    done("maps")
    claims: list[Claim] = []
    for claim in judged(texts()):
        claims.append(claim)
        progress("claims", len(claims), len(texts()))
    done("claims")
    files = {"equations.md": equations.as_markdown(), "equations.tex": equations.as_latex()}
    done("equations")
    pictures: dict[str, bytes] = {}
    for number, figure in enumerate(FIGURES):
        progress("figures", number, len(FIGURES))
        pictures |= _pictures(figure)
    done("figures")
    figures = [pages.figure_html(figure, result, pictures) for figure, result in maps.items()]
    files |= {f"{figure}.json": result.to_json(timings=False) for figure, result in maps.items()}
    files |= {
        "claims.md": pages.claims_markdown(claims), "claims.html": pages.claims_html(claims),
        "claims.json": pages.claims_json(claims),
        "index.html": pages.index_html(claims, figures, equations.equations()),
    }  # fmt: skip
    contents = pictures | {name: text.encode() for name, text in files.items()}
    write_files(folder, {name: partial(_write, contents[name]) for name in FILES})
    done("files")
    return Reproduction(tuple(claims), seconds)


def _pictures(figure: str) -> dict[str, bytes]:
    """Names, such as ``fig4.png`` (the map beside the stable poses) and ``fig4-poses.svg``, and contents."""
    from ptmcad.show.render.figure import draw_figure
    from ptmcad.show.render.poses import draw_poses
    from ptmcad.show.render.printing import content

    at: dict[str, Any] = dict(POINTS[figure][1])
    poses = solve(figure, **at)
    drawn = {figure: draw_figure(region_map(figure), poses), f"{figure}-poses": draw_poses(poses)}
    return {f"{name}.{kind}": content(picture, kind) for name, picture in drawn.items() for kind in PICTURES}


def _write(data: bytes, path: Path) -> None:
    path.write_bytes(data)
