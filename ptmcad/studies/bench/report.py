"""What a study says: the terminal's table, sentences on grids, curves to draw, and the files.

Guarantee: nothing is computed here but ratios of figures of the study. A study's files are written
all or none; the JSON, which vouches for the others, last.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from ptmcad.process.output import Writer, text_writer, write_files
from ptmcad.show.render.printing import save as save_figure
from ptmcad.studies import tables
from ptmcad.studies.bench.error import Figures
from ptmcad.studies.bench.harness import Row
from ptmcad.studies.bench.methods import GRIDS, RIVALS, Method
from ptmcad.studies.bench.picture import DPI, Curve, Spot, draw
from ptmcad.studies.bench.study import (
    SEEN_SHARE,
    grid_of,
    main_figures,
    read_study,
    smallest_grid,
    write_study,
    write_table,
)

SUFFIXES = ("bench.csv", "bench.svg", "bench.png", "error-time.json", "bench.json")
PAGE = "error-time.md"
CURVE_FORMAT = "ptmcad-error-time/1"
"""What ``ptmcad report`` reads."""
WIDTH_STYLE = len(Method)
"""Of the width of area bounds, which is another kind of error; each method has its own style."""
_NAMES = {"stable": "stable equilibria", "total": "equilibria", "index": "index"}
_HEADER = ("method", "setting", "seconds (least-largest)", "wrong or undetermined", "regions missed",
           "faintest region", "boundary off by", "area bounds apart")  # fmt: skip


def sentences(study: Row) -> tuple[str, ...]:
    """Which grid is the first to see every region, and where the exact engine is beside the grids."""
    found = []
    grid = Method.COMPANION.value
    done = [m for m in study["measurements"] if m["seconds"]]
    measured = [m for m in done if m["method"] == grid and m["figures"]]
    largest = max((grid_of(m) or 0 for m in measured), default=0)
    if largest:
        for count, name in _NAMES.items():
            first, whole = (
                f"{n} x {n}" if n else f"none up to {largest} x {largest}"
                for n in (smallest_grid(study, grid, count, seen) for seen in (False, True))
            )
            found.append(
                f"Regions by {name}: the smallest grid with a pixel in each is {first}; with at least "
                f"{SEEN_SHARE:.0%} of each, {whole}."
            )
    exact = [m["seconds"]["median"] for m in done if m["method"] == Method.EXACT.value]
    for m in measured:
        if exact and grid_of(m) == 400:
            times = m["seconds"]["median"] / min(exact)
            found.append(
                f"The exact engine has no error after {min(exact):.2f} s; the 400 x 400 grid has "
                f"{times:.1f} times that time and {_share(main_figures(m))} of the window wrong."
            )
    return tuple(found)


def rows(study: Row) -> Iterator[tuple[str, ...]]:
    """The cells of the table, one row for each measurement, for the finest count that the method gives."""
    for m in study["measurements"]:
        s, f = m["seconds"], main_figures(m)
        if s is None:
            yield (m["method"], m["setting"] or "-", m["reason"], *("-",) * 5)
            continue
        spread = f" ({s['minimum']:.2f}-{s['maximum']:.2f})" if s["runs"] > 1 else ""
        yield (
            m["method"],
            m["setting"],
            f"{s['median']:.2f}{spread}",
            _share(f) + " *" * bool(m["note"]),
            "-" if f is None or f["missed"] is None else f"{f['missed']} of {f['regions']}",
            "-" if f is None or f["faintest"] is None else f"{f['faintest'][0]:.2%}",
            "-" if f is None or f["distance"] is None else _about(f["distance"]),
            "-" if m["area_width"] is None else f"{m['area_width']:.1e}",
        )


def _share(f: Figures | None) -> str:
    return "-" if f is None else _about(f["wrong"])


def _about(bounds: tuple[float, float]) -> str:
    """Bounds as one number where two digits agree."""
    low, high = (f"{x:.1e}" if x else "0" for x in bounds)
    return low if low == high else f"{low} to {high}" if high != "0" else "0"


def terminal(study: Row) -> str:
    """The table in columns, and the sentences."""
    cells = [_HEADER, *rows(study)]
    # a reason stands in a column of times, and may be long
    lines = tables.columns(cells, [row[3] == row[5] == "-" for row in cells])
    return "\n".join([*lines, *_notes(study), "", *sentences(study)])


def _notes(study: Row) -> tuple[str, ...]:
    """What the errors with a star rest on."""
    noted = (m for m in study["measurements"] if m["note"] and m["seconds"])
    return tuple(dict.fromkeys(f"* {m['method']}: {m['note']}" for m in noted))


def curves(study: Row) -> tuple[Curve, ...]:
    """What can be drawn of a study: every measurement with a time and an error."""
    found = []
    for style, method in enumerate(Method):
        title = RIVALS[method].title
        spots, widths = [], []
        for m in study["measurements"]:
            s, f, width = m["seconds"], main_figures(m), m["area_width"]
            if m["method"] != method.value or s is None:
                continue
            x = (s["median"], s["minimum"], s["maximum"])
            if f:
                spots.append(Spot(x, f["wrong"], _label(m)))
            if method is Method.EXACT and width:
                widths.append(Spot(x, (width, width)))
        found += [Curve(title, spots, style), Curve(f"{title}: width of the area bounds", widths, WIDTH_STYLE)]
    return tuple(curve for curve in found if curve.spots)


def _label(m: Row) -> str:
    starts = {Method.QEPCAD.value: "where ", Method.CERTIFIED.value: "tolerance "}
    starts |= {method.value: "N = " for method in GRIDS}
    setting: str = m["setting"]
    return setting.removeprefix(starts.get(m["method"], setting))


def curve_file(study: Row) -> str:
    """The measurements for ``ptmcad report``, which draws positive errors only."""
    series = []
    for name, spots, _ in curves(study):
        shown = [[spot.x[0], sum(spot.y) / 2] for spot in spots if spot.y[1] > 0]
        if shown:
            series.append({"name": name, "points": shown})
    text = (
        "Share of the window that is wrong or undetermined; for the exact engine, where that is 0, the width of its "
        "area bounds."
    )
    return json.dumps({"format": CURVE_FORMAT, "error": text, "series": series}, indent=1) + "\n"


def save(study: Row, folder: Path) -> tuple[Path, ...]:
    """Write a study's files into a folder; pictures only when something was measured.

    Raises
    ------
    OutputError
        When one cannot be written.
    """
    name = study["slice"]
    writers: dict[str, Writer] = {f"{name}.bench.csv": text_writer(write_table(study))}
    drawn = curves(study)
    if drawn:
        title = f"{name}: {study['heading']}"
        x = "seconds of whole processes, start-up included: medians, least and largest"
        picture = partial(draw, title, x, "share of the window", drawn, sentences(study))
        for suffix in ("svg", "png"):
            writers[f"{name}.bench.{suffix}"] = lambda path: save_figure(picture(), path, dpi=DPI)
        writers[f"{name}.error-time.json"] = text_writer(curve_file(study))
    writers[f"{name}.bench.json"] = text_writer(write_study(study))
    return write_files(folder, writers)


def save_page(folder: Path) -> Path:
    """Write the page of all studies in a folder, at least one.

    Raises
    ------
    ConfigError
        When a stored study cannot be read.
    OutputError
        When the page cannot be written.
    """
    studies = [read_study(path) for path in sorted(folder.glob("*.bench.json"))]
    return write_files(folder, {PAGE: text_writer(page(studies))})[0]


def page(studies: Sequence[Row]) -> str:
    """All studies as one Markdown page with their pictures, which lie beside it."""
    blocks: list[str | list[str]] = []
    for study in studies:
        checked = "There is no exact map of it: errors are the undetermined share, as the certified engine reports it."
        if study["verified"] is not None:
            passed = "passed" if study["verified"] else "did NOT pass"
            checked = f"The exact map that errors are measured against {passed} `ptmcad verify`."
        blocks += [f"## {study['slice']}", f"{study['heading']}. {checked}"]
        if curves(study):
            blocks.append(f"![Error against seconds for {study['slice']}]({study['slice']}.bench.svg)")
        blocks += [[f"- {s}" for s in sentences(study)], tables.markdown(_HEADER, rows(study))]
        blocks.append([f"\\{note}  " for note in _notes(study)])
    first = studies[0]
    floor = "{median:g} s ({minimum:g}-{maximum:g})".format(**first["floor"])
    return tables.page(
        "# Error against run time",
        "Seconds are of whole processes, start-up included, medians of repeated runs that took turns.",
        *blocks,
        "## Machine",
        *(tables.listed(part) for part in (first["machine"], first["versions"])),
        f"Seed {first['seed']}; the reference job takes {floor}.",
    )
