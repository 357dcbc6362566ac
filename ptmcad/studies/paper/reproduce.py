"""The whole paper in one folder: its equations, figures, region maps, and a verdict on every claim.

Guarantee: verdicts and maps are computed in this run; nothing is read from a file of earlier results. All files are
written together or none is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.solving import solve
from ptmcad.process.output import Writer, check_writable, text_writer, write_files
from ptmcad.studies.paper import equations, pages
from ptmcad.studies.paper.claim import Judged, Verdict, all_claims, judged
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
    """What was computed: every claim with its outcome, and the seconds by part."""

    judged: tuple[Judged, ...]
    seconds: Mapping[str, float]

    def number(self, verdict: Verdict) -> int:
        """How many claims have a verdict."""
        return sum(outcome.verdict is verdict for _, outcome in self.judged)

    def table(self) -> str:
        """The summary for the terminal: numbers of verdicts, what was not confirmed, and the time."""
        lines = [pages.summary(self.judged)]
        for verdict in pages.NOT_AS_PRINTED:
            for claim, outcome in self.judged:
                if outcome.verdict is verdict:
                    what = outcome.witness if verdict is Verdict.REFUTED else outcome.right or outcome.reason
                    lines.append(f"{verdict.value:10} {claim.name}: {what}")
        parts = ", ".join(f"{part} {seconds:.1f} s" for part, seconds in self.seconds.items())
        return "\n".join([*lines, f"time       {sum(self.seconds.values()):.1f} s: {parts}"])


def reproduce(folder: Path, progress: Progress | None = None) -> Reproduction:
    """Compute everything and write it into a folder, which is made if it is missing.

    Raises
    ------
    OutputError
        When a file cannot be written; then none is.
    """
    check_writable(folder, FILES)
    times = [("", perf_counter())]

    def done(part: str) -> None:
        times.append((part, perf_counter()))

    maps = {figure: region_map(figure) for figure in FIGURES}
    done("maps")
    claims, found = all_claims(), []
    for number, one in enumerate(judged(claims)):
        found.append(one)
        if progress is not None:
            progress("claims", number + 1, len(claims))
    done("claims")
    texts = {"equations.md": equations.as_markdown(), "equations.tex": equations.as_latex()}
    done("equations")
    pictures: dict[str, bytes] = {}
    for number, figure in enumerate(FIGURES):
        if progress is not None:
            progress("figures", number, len(FIGURES))
        at: dict[str, Any] = dict(POINTS[figure][1])
        pictures |= _pictures(figure, maps[figure], solve(figure, **at))
    done("figures")
    figures = [
        pages.Illustration(figure, maps[figure].slice.heading, *POINTS[figure], pictures[f"{figure}.png"],
                           pictures[f"{figure}-poses.png"], maps[figure].table())
        for figure in FIGURES
    ]  # fmt: skip
    texts |= {f"{figure}.json": maps[figure].to_json(timings=False) for figure in FIGURES}
    texts["claims.md"] = pages.claims_markdown(found)
    texts["claims.html"] = pages.claims_html(found)
    texts["claims.json"] = pages.claims_json(found)
    texts["index.html"] = pages.index_html(found, figures, equations.equations())
    writers: dict[str, Writer] = {name: text_writer(text) for name, text in texts.items()}
    writers |= {name: partial(_write_bytes, data) for name, data in pictures.items()}
    write_files(folder, {name: writers[name] for name in FILES})
    done("files")
    seconds = {part: after - before for (_, before), (part, after) in pairwise(times)}
    return Reproduction(tuple(found), seconds)


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
