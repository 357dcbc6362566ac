"""A study's picture: its curves handed to `ptmcad.show.render`.

Guarantee: every measurement with a time and an error is in it.
"""

from __future__ import annotations

from pathlib import Path

from ptmcad.show.render.printing import save
from ptmcad.studies.bench.errortime import Curve, Spot, draw_error_time
from ptmcad.studies.bench.study import Study
from ptmcad.studies.bench.words import curves, sentences

DPI = 110


def draw(study: Study, path: Path) -> None:
    """Draw a study with at least one measurement to a file whose suffix gives the format."""
    drawn = tuple(
        Curve(
            name,
            tuple(
                Spot((m.seconds.median, m.seconds.minimum, m.seconds.maximum), error, label)
                for m, error, label in points
                if m.seconds is not None
            ),
            style,
        )
        for name, style, points in curves(study)
    )
    save(draw_error_time(f"{study.slice}: {study.heading}", sentences(study), drawn), path, dpi=DPI)
