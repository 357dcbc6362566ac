"""What a study says: the terminal's table, sentences on grids, points to draw, and the files.

Guarantee: nothing is computed here but ratios of figures of the study. A study's files are written
all or none; the JSON, which vouches for the others, last.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from ptmcad.process.output import text_writer, write_files
from ptmcad.show.render.printing import save as save_figure
from ptmcad.show.table import aligned
from ptmcad.studies import texts as tables
from ptmcad.studies.bench.harness import Row
from ptmcad.studies.bench.stored import finest, frame, read_study, write_study, write_table
from ptmcad.studies.bench.study import RIVALS
from ptmcad.studies.picture import DPI, STYLES, Curve, Mark, draw

SUFFIXES = ("bench.csv", "bench.svg", "bench.png", "error-time.json", "bench.json")
PAGE = "error-time.md"
SEEN_SHARE = 0.99
"""A grid sees a region when it shows this share of it, at least, with its count."""
CURVE_FORMAT = "ptmcad-error-time/1"
"""What ``ptmcad report`` reads."""
_NAMES = {"stable": "stable equilibria", "total": "equilibria", "index": "index"}
_LABELLED = {
    "certified": "tolerance ",
    "companion": "N = ",
    "multistart": "N = ",
    "qepcad": "where ",
}
"""Methods whose points have their setting beside them in the picture, without these words."""


def sentences(study: Row) -> list[str]:
    """Which grid is the first to see every region, and how the exact engine compares with the grids."""
    table = frame(study)
    grids = table[(table["method"] == "companion") & table["wrong_low"].notna()]
    sizes = grids["setting"].str.removeprefix("N = ").astype(int)
    found = []
    for count, name in _NAMES.items() if len(grids) else ():
        own = grids["count"] == count
        first, whole = (
            f"{n} x {n}"
            if (n := sizes[own & fit].min()) > 0
            else f"none up to {sizes.max()} x {sizes.max()}"
            for fit in (grids["missed"] == 0, grids["faintest_low"] >= SEEN_SHARE)
        )
        found.append(
            f"Regions by {name}: the smallest grid with a pixel in each is {first}; with at least "
            f"{SEEN_SHARE:.0%} of each, {whole}."
        )
    exact = table["seconds_median"][table["method"] == "exact"].min()
    for m in finest(study).to_dict("records"):
        if (m["method"], m["setting"]) == ("companion", "N = 400") and m[
            "seconds_median"
        ] / exact > 0:
            found.append(
                f"The exact engine has no error after {exact:.2f} s; the 400 x 400 grid has "
                f"{m['seconds_median'] / exact:.1f} times that time and {_about(m, 'wrong')} of the window wrong."
            )
    return found


def _cells(m: Mapping[Any, Any]) -> dict[str, str]:
    spread = " ({seconds_min:.2f}-{seconds_max:.2f})".format(**m) if m["runs"] > 1 else ""
    return {
        "method": m["method"],
        "setting": m["setting"],
        "seconds (least-largest)": f"{m['seconds_median']:.2f}{spread}",
        "wrong or undetermined": _about(m, "wrong") + (" *" if m["note"] else ""),
        "regions missed": "-" if pd.isna(m["missed"]) else f"{m['missed']} of {m['regions']}",
        "faintest region": "-" if pd.isna(m["faintest_low"]) else f"{m['faintest_low']:.2%}",
        "boundary off by": _about(m, "distance"),
        "area bounds apart": "-" if pd.isna(m["area_width"]) else f"{m['area_width']:.1e}",
    }


def _about(m: Mapping[Any, Any], name: str) -> str:
    """Bounds as one number where two digits agree."""
    low, high = m[f"{name}_low"], m[f"{name}_high"]
    if pd.isna(low):
        return "-"
    first, last = (f"{x:.1e}" if x else "0" for x in (low, high))
    return first if first == last else f"{first} to {last}"


def notes(study: Row) -> list[str]:
    """What the errors with a star rest on, and why there are none of other methods."""
    done = [
        f"* {m['method']}: {m['note']}" for m in study["measurements"] if m["note"] and m["seconds"]
    ]
    left = [
        f"{m['method']}, {m['setting']}: {m['reason']}"
        for m in study["measurements"]
        if not m["seconds"]
    ]
    return list(dict.fromkeys([*done, *(line.replace(", :", ":") for line in left)]))


def _lines(study: Row, written: Callable[[list[list[str]]], list[str]]) -> list[str]:
    """The table, one row for each method and setting that was run, with the finest count it gives."""
    found = [_cells(m) for m in finest(study).dropna(subset="seconds_median").to_dict("records")]
    return written([list(found[0]), *(list(row.values()) for row in found)]) if found else []


def terminal(study: Row) -> str:
    """The table in columns, the notes and the sentences."""
    return "\n".join([*_lines(study, aligned), *notes(study), "", *sentences(study)])


def curves(study: Row) -> list[Curve]:
    """What can be drawn of a study: every measurement with a time and an error, and widths of the
    exact maps' areas.
    """
    table = finest(study).dropna(subset="seconds_median")
    errors = {method: table[table["method"] == method] for method in RIVALS}
    found = [
        Curve(RIVALS[method]["title"], style, _marks(rows, "wrong_low", "wrong_high", method))
        for style, (method, rows) in zip(STYLES, errors.items(), strict=False)
    ]
    widths = errors["exact"][errors["exact"]["area_width"] > 0]  # another kind of error
    title = f"{RIVALS['exact']['title']}: width of the area bounds"
    marks = _marks(widths, "area_width", "area_width")
    found.insert(1, Curve(title, STYLES[len(RIVALS)], marks))
    return [curve for curve in found if curve.marks]


def _marks(rows: pd.DataFrame, low: str, high: str, method: str = "") -> list[Mark]:
    """The middles of bounds; settings stand beside them, without the words before these."""
    before = _LABELLED.get(method)
    return [
        (m["seconds_median"], (m[low] + m[high]) / 2, m["seconds_min"], m["seconds_max"],
         "" if before is None else m["setting"].removeprefix(before))
        for m in rows.dropna(subset=low).to_dict("records")
    ]  # fmt: skip


def curve_file(study: Row) -> str:
    """The measurements for ``ptmcad report``, which draws positive errors only."""
    series = [
        {"name": curve.name, "points": points}
        for curve in curves(study)
        if (points := [[x, y] for x, y, *_ in curve.marks if y > 0])
    ]
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
    name, drawn = study["slice"], curves(study)
    title = f"{name}: {study['heading']}"
    x = "seconds of whole processes, start-up included: medians, least and largest"

    def picture(path: Path) -> None:
        save_figure(
            draw(title, x, "share of the window", {"": drawn}, sentences(study)), path, dpi=DPI
        )

    writers = {f"{name}.bench.csv": text_writer(write_table(study))}
    if drawn:
        writers |= {f"{name}.bench.svg": picture, f"{name}.bench.png": picture}
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
            blocks.append(
                f"![Error against seconds for {study['slice']}]({study['slice']}.bench.svg)"
            )
        blocks += [[f"- {s}" for s in sentences(study)], _lines(study, tables.markdown)]
        blocks.append([f"- {note}".replace("- *", "- \\*") for note in notes(study)])
    first = studies[0]
    floor = "{median:g} s ({minimum:g}-{maximum:g})".format(**first["floor"])
    return tables.page(
        "# Error against run time",
        "Seconds are of whole processes, start-up included, medians of repeated runs that took turns.",
        *blocks,
        "## Machine",
        *("; ".join(map(" ".join, first[part].items())) + "." for part in ("machine", "versions")),
        f"Seed {first['seed']}; the reference job takes {floor}.",
    )
