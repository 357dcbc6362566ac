"""Pictures of operation ranges over another axis."""

from __future__ import annotations

from typing import Any

import numpy as np
from support.maps import CONFIGS

import ptmcad
from ptmcad.show.render.rangepicture import draw_widths


def test_nothing_is_drawn_between_the_rows() -> None:
    slice = ptmcad.load(CONFIGS / "fig4.yaml")
    found = ptmcad.operation_widths(slice, "rho", rows=3)
    figure = draw_widths(slice, found)
    upper: Any = figure.axes[0]
    assert [len(c.get_segments()) for c in upper.collections] == [3]
    for segment in upper.collections[0].get_segments():
        assert segment[0][0] == segment[1][0]
        assert segment[0][1] < segment[1][1]
    for line in upper.lines:
        assert line.get_linestyle() == "None"
    places = [segment[0][0] for segment in upper.collections[0].get_segments()]
    np.testing.assert_allclose(places, [0.5, 1.0, 1.5])
    assert "nothing is drawn" in " ".join(text.get_text() for text in figure.texts)
