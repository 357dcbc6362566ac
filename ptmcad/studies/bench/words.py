"""What a study says, in words: the terminal's table, the sentences on grids, the page of all slices, curves to draw.

Guarantee: nothing is computed here but ratios of figures of the study.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ptmcad.studies import tables
from ptmcad.studies.bench.harness import Times
from ptmcad.studies.bench.methods import RIVALS, Method
from ptmcad.studies.bench.study import SEEN_SHARE, Figures, Measurement, Study, grids, main_figures, smallest_grid
from ptmcad.studies.tables import columns, markdown

_NAMES = {"stable": "stable equilibria", "total": "equilibria", "index": "index"}
CURVE_FORMAT = "ptmcad-error-time/1"
"""What ``ptmcad report`` reads."""


def sentences(study: Study) -> tuple[str, ...]:
    """Which grid is the first to see every region, and where the exact engine is beside the grids."""
    found = []
    measured = grids(study, Method.COMPANION.value)
    if measured:
        for count, name in _NAMES.items():
            first, whole = (smallest_grid(study, Method.COMPANION.value, count, seen) for seen in (False, True))
            upto = f"none up to {measured[-1]} x {measured[-1]}"
            found.append(
                f"Regions by {name}: the smallest grid with a pixel in each is {_grid(first, upto)}; with at least "
                f"{SEEN_SHARE:.0%} of each, {_grid(whole, upto)}."
            )
    ours, theirs = _fastest_exact(study), _at(study, 400)
    if ours and theirs and ours.seconds and theirs.seconds:
        found.append(
            f"The exact engine has no error after {ours.seconds.median:.2f} s; the 400 x 400 grid has "
            f"{theirs.seconds.median / ours.seconds.median:.1f} times that time and "
            f"{_share(main_figures(theirs))} of the window wrong."
        )
    return tuple(found)


def _grid(n: int | None, otherwise: str) -> str:
    return otherwise if n is None else f"{n} x {n}"


def _fastest_exact(study: Study) -> Measurement | None:
    done = [m for m in study.measurements if m.method == Method.EXACT.value and m.seconds]
    return min(done, key=lambda m: m.seconds.median if m.seconds else 0.0, default=None)


def _at(study: Study, n: int) -> Measurement | None:
    return next(
        (m for m in study.measurements if m.method == Method.COMPANION.value and m.grid == n and m.seconds), None
    )


_HEADER = ("method", "setting", "seconds (least-largest)", "wrong or undetermined", "regions missed", "faintest region",
           "boundary off by", "area bounds apart")  # fmt: skip


def rows(study: Study) -> Iterator[tuple[str, ...]]:
    """The cells of the table, one row for each measurement, for the finest count that the method gives."""
    for m in study.measurements:
        if m.seconds is None:
            yield (m.method, m.setting or "-", m.reason, *("-",) * 5)
            continue
        f = main_figures(m)
        spread = f" ({m.seconds.minimum:.2f}-{m.seconds.maximum:.2f})" if m.seconds.runs > 1 else ""
        yield (
            m.method,
            m.setting,
            f"{m.seconds.median:.2f}{spread}",
            _share(f) + " *" * bool(m.note),
            "-" if f is None or f.missed is None else f"{f.missed} of {f.regions}",
            "-" if f is None or f.faintest is None else f"{f.faintest[0]:.2%}",
            "-" if f is None or f.distance is None else _about(f.distance),
            "-" if m.area_width is None else f"{m.area_width:.1e}",
        )


def _share(f: Figures | None) -> str:
    return "-" if f is None else _about(f.wrong)


def _about(bounds: tuple[float, float]) -> str:
    """Bounds as one number where two digits agree."""
    low, high = (f"{x:.1e}" if x else "0" for x in bounds)
    return low if low == high else f"{low} to {high}" if high != "0" else "0"


def terminal(study: Study) -> str:
    """The table in columns, and the sentences."""
    cells = [_HEADER, *rows(study)]
    # a reason stands in a column of times, and may be long
    lines = columns(cells, [row[3] == row[5] == "-" for row in cells])
    return "\n".join([*lines, *notes(study), "", *sentences(study)])


def notes(study: Study) -> tuple[str, ...]:
    """What the errors with a star rest on."""
    return tuple(dict.fromkeys(f"* {m.method}: {m.note}" for m in study.measurements if m.note and m.seconds))


WIDTH_STYLE = len(Method)
"""Of the width of area bounds, which is another kind of error; each method has its own style."""


class Spot(NamedTuple):
    """A point to draw: median, least and largest seconds, the error's bounds, and a short label, which may be empty."""

    seconds: Times
    error: tuple[float, float]
    label: str = ""


class Curve(NamedTuple):
    """A method's points in order, and the number of its style."""

    name: str
    spots: Sequence[Spot]
    style: int


def curves(study: Study) -> tuple[Curve, ...]:
    """What can be drawn of a study: every measurement with a time and an error."""
    found = []
    for style, method in enumerate(Method):
        done = [(m, m.seconds) for m in study.measurements if m.method == method.value and m.seconds]
        spots = [Spot(seconds, f.wrong, _label(m)) for m, seconds in done if (f := main_figures(m))]
        found.append(Curve(RIVALS[method].title, spots, style))
        if method is Method.EXACT:
            widths = [Spot(seconds, (m.area_width, m.area_width)) for m, seconds in done if m.area_width]
            found.append(Curve(f"{RIVALS[method].title}: width of the area bounds", widths, WIDTH_STYLE))
    return tuple(curve for curve in found if curve.spots)


def _label(m: Measurement) -> str:
    if m.grid is not None:
        return str(m.grid)
    if m.method == Method.QEPCAD.value:
        return m.setting.replace("where ", "")
    return m.setting.removeprefix("tolerance ") if m.setting.startswith("tolerance ") else ""


def curve_file(study: Study) -> str:
    """The measurements for ``ptmcad report``, which draws positive errors only."""
    series = []
    for name, spots, _ in curves(study):
        shown = [[spot.seconds.median, sum(spot.error) / 2] for spot in spots if spot.error[1] > 0]
        if shown:
            series.append({"name": name, "points": shown})
    text = (
        "Share of the window that is wrong or undetermined; for the exact engine, where that is 0, the width of its "
        "area bounds."
    )
    return json.dumps({"format": CURVE_FORMAT, "error": text, "series": series}, indent=1) + "\n"


_INTRODUCTION = """
What the errors are is defined in [Error](../error.md). Seconds are of whole processes, start-up included,
medians of repeated runs that took turns; a run of more than 1.25 seconds was not repeated. Written by
`make bench`, as are the CSV and JSON files of each slice beside this page.
"""


def page(studies: Sequence[Study]) -> str:
    """All studies as one Markdown page with their pictures, which lie beside it."""
    first = studies[0]
    blocks: list[str | list[str]] = []
    for study in studies:
        blocks += [f"## {study.slice}", f"{study.heading}. {_checked(study)}"]
        if any(m.seconds for m in study.measurements):
            blocks.append(f"![Error against seconds for {study.slice}]({study.slice}.bench.svg)")
        blocks += [[f"- {s}" for s in sentences(study)], markdown(_HEADER, rows(study))]
        blocks.append([f"\\{note}  " for note in notes(study)])
    floor = f"{first.floor.median:g} s ({first.floor.minimum:g}-{first.floor.maximum:g})"
    return tables.page(
        "# Error against run time",
        _INTRODUCTION,
        *blocks,
        "## Machine",
        tables.listed(first.machine),
        tables.listed(first.versions),
        f"Seed {first.seed}; the reference job takes {floor}.",
    )


def _checked(study: Study) -> str:
    if study.verified is None:
        return "There is no exact map of it: errors are the undetermined share, as the certified engine reports it."
    passed = "passed" if study.verified else "did NOT pass"
    return f"The exact map that errors are measured against {passed} `ptmcad verify`."
