"""The files of a study: JSON, CSV, pictures, the report's curve; and a page of all studies in a folder.

Guarantee: a study's files are written all or none; the JSON, which vouches for the others, last.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from ptmcad.process.output import Writer, text_writer, write_files
from ptmcad.studies.bench.document import read_study, write_study, write_table
from ptmcad.studies.bench.errortime import draw
from ptmcad.studies.bench.study import Study
from ptmcad.studies.bench.words import curve_file, page

SUFFIXES = ("bench.csv", "bench.svg", "bench.png", "error-time.json", "bench.json")
PAGE = "error-time.md"


def save(study: Study, folder: Path) -> tuple[Path, ...]:
    """Write a study's files into a folder; pictures only when something was measured.

    Raises
    ------
    OutputError
        When one cannot be written.
    """
    name = study.slice
    writers: dict[str, Writer] = {f"{name}.bench.csv": text_writer(write_table(study))}
    if any(m.seconds for m in study.measurements):
        writers |= {f"{name}.bench.{suffix}": partial(draw, study) for suffix in ("svg", "png")}
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
