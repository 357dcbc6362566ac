"""Contour lines of a quantity over a map."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from support.maps import shipped

from ptmcad.show.render.field import MIN_LINE, field_figure


def test_contours_have_their_values_at_the_scale_and_are_no_tiny_rings() -> None:
    result = shipped("fig4")
    field = result.field("energy", columns=60)
    rows, columns = np.indices(field.values.shape)
    ridge = 1.02 - ((rows - 30) / 30) ** 2 + 0.05 * np.cos(columns * 1.5)
    field = replace(field, values=ridge, region=np.zeros_like(field.region))
    figure = field_figure(result, field, (), 8, 100)
    axes: Any = figure.axes[0]
    lines = [c for c in axes.collections if isinstance(c, LineCollection)]
    assert lines
    for segment in (s for c in lines for s in c.get_segments()):
        assert np.hypot(*np.diff(segment / (2 / 60), axis=0).T).sum() >= MIN_LINE - 1e-6
    marks = next(c for c in figure.axes[1].collections if c.get_gid() == "levels")
    values = [s[0][1] for s in marks.get_segments()]
    assert len(values) == len([c for c in lines if c.get_segments()])
    np.testing.assert_allclose(figure.axes[1].get_yticks(), values)
