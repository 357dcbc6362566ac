"""The plot of a stress campaign: the error of double precision against what is extreme, family by
family.

Guarantee: every point that has an error is drawn; where the count of double precision is wrong it
is drawn as such, also where no error exists.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from matplotlib.figure import Figure

from ptmcad.studies.picture import Curve, Mark, draw
from ptmcad.studies.stress.judgement import Row

MIN_DRAWN_ERROR = 1e-20
"""Errors below are drawn here: enclosures of 12 digits have middles about 1e-19 off."""
NOTE = "Of poses in radians, of lines relative to the window. At 1e-20: none or less; at the top: no pose found."
NO_POSE = 10.0
"""Where it is drawn that there is none, which is as bad as can be."""
TITLE = "Error of double precision against what is extreme"
MARKS = (
    ("double precision, count right", "double_error", True, "o", "#385880"),
    ("double precision, count wrong", "double_error", False, "X", "#c1440e"),
    ("ptmcad, middle of the enclosure", "error", None, "_", "#45917d"),
)
"""What is drawn: label, number, of which rows by whether the double's count is right, mark and
colour.
"""


def draw_stress(outcomes: Sequence[Row]) -> Figure:
    """One small plot for each family of points; the figure's label is its description."""
    points = [o for o in outcomes if o["condition"] is not None or o["error"] is not None]
    double, ours = (sum(not o[key] for o in points) for key in ("double_right", "right"))
    found = f"{len(points)} cases; the count of double precision is wrong in {double}, ptmcad's in {ours}."
    panels: dict[str, list[Curve]] = {o["family"]: [] for o in points}
    for family, curves in panels.items():
        for label, key, right, marker, color in MARKS:
            drawn = [
                o for o in points if o["family"] == family and right in (None, o["double_right"])
            ]
            places = [float(Fraction(o["stiffness"])) for o in drawn]
            heights = [NO_POSE if o[key] is None else max(o[key], MIN_DRAWN_ERROR) for o in drawn]
            marks = [Mark(x, y, x, x) for x, y in zip(places, heights, strict=True)]
            curves.append(
                Curve(label, {"marker": marker, "color": color, "linestyle": "none"}, marks)
            )
    return draw(TITLE, "", "error", panels, (NOTE, found))
