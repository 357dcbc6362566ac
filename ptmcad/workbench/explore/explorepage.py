"""The page's parts: its HTML, filled with the panel, and the scripts and style sheets that it
shares with the report.

Guarantee: the data cannot end the element they stand in, and nothing of the record is taken for
markup.
"""

from __future__ import annotations

from functools import cache
from html import escape
from importlib.resources import files
from string import Template
from typing import Any

from ptmcad.question.config.scalars import number_of
from ptmcad.show.render.axes import symbol
from ptmcad.show.render.polylines import GRID
from ptmcad.show.report.mapsvg import CORE_WIDTH, RIM_WIDTH, SIDE
from ptmcad.show.report.reportpage import drawing_of, harmless
from ptmcad.text.numerals import shortest_text, text_of
from ptmcad.version import __version__
from ptmcad.workbench.explore.panel import SliderPanel

_STYLE, _SCRIPT = "text/css", "text/javascript"
ASSETS = {
    "page.css": ("ptmcad.show.report", _STYLE),
    "explore.css": ("ptmcad.workbench.explore", _STYLE),
    "theme.js": ("ptmcad.show.report", _SCRIPT),
    "mechanism.js": ("ptmcad.show.report", _SCRIPT),
    "ask.js": ("ptmcad.workbench.explore", _SCRIPT),
    "explore.js": ("ptmcad.workbench.explore", _SCRIPT),
}
"""Files by their names, each with its package and its type."""


@cache
def asset(name: str) -> str:
    """The text of one of `ASSETS`."""
    return (files(ASSETS[name][0]) / name).read_text(encoding="utf-8")


def page(panel: SliderPanel, secret: str) -> str:
    """The page as HTML text.

    Parameters
    ----------
    secret : what the page shows the server with every question.
    """
    record = panel.record
    return Template(
        (files("ptmcad.workbench.explore") / "explore.html").read_text(encoding="utf-8")
    ).substitute(
        title=escape(record.title or record.name),
        name=escape(record.name),
        side=SIDE,
        shrunk=f"scale({1 / GRID:g})",
        window=escape(" and ".join(record.axes)),
        version=escape(__version__),
        data=harmless(_data(panel, secret)),
    )


def _data(panel: SliderPanel, secret: str) -> dict[str, Any]:
    record, model = panel.record, panel.model
    ends = {name: (number_of(w.low), number_of(w.high)) for name, w in record.axes.items()}
    return {
        "secret": secret,
        "side": SIDE,
        "grid": GRID,
        "rim": RIM_WIDTH * GRID,
        "core": CORE_WIDTH * GRID,
        "cells": [],
        "name": record.name,
        "title": record.title or record.name,
        "drawable": model.drawable is not None,
        "told": model.criterion.is_told,
        "mechanism": drawing_of(model),
        "axes": [
            {"name": name, "symbol": symbol(name), "low": float(low), "high": float(high)}
            for name, (low, high) in ends.items()
        ],
        "sliders": [
            {
                "name": slider.name,
                "symbol": symbol(slider.name),
                "low": float(slider.low),
                "high": float(slider.high),
                "ends": [text_of(slider.low), text_of(slider.high)],
                "step": shortest_text(slider.step),
                "value": text_of(slider.value),
                "free": slider.free,
            }
            for slider in panel.sliders
        ],
    }


def refusal(status: int, reason: str) -> str:
    """A page that says why there is none."""
    return (
        f'<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>{status}</title>'
        f"<h1>{status}</h1><p>{escape(reason)}</p></html>\n"
    )
