"""Specks of a cover: those that no curve enters are taken away, and nothing of a curve is."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

pytest.importorskip("numba")

from ptmcad.certified import covering
from ptmcad.certified.branchandprune import Boxes
from ptmcad.certified.covering import Lattice, box_rectangles, thinning, without_specks
from ptmcad.certified.equationsystem import system
from ptmcad.certified.refinement import CriticalCurve, CurveEnclosure, begin, refine
from ptmcad.cover import components
from ptmcad.cover.rectangles import Cover
from ptmcad.formulas.graph import Graph

LATTICE = Lattice(((Fraction(-2), Fraction(2)), (Fraction(-2), Fraction(2))), 2**20)
AREA = 16 * 4.0**-9
SMALL, AT = 0.01, 0.2
"""Radius and place of a circle as small as a speck: 2e-5 of the window."""
EMPTY = np.array([[0.5, 0.5, 0.501, 0.51], [-0.3, 0.1, -0.299, 0.1001], [1.5, -2.0, 1.501, -1.99]])
"""Boxes in which there is nothing; the last one is at the window's edge."""


def curves() -> list[CurveEnclosure]:
    """The unit circle with the small one, and a line, all of them enclosed; with boxes that hold
    nothing.
    """
    graph = Graph()
    x, y = graph.variable(0), graph.variable(1)

    def circle(at: float, radius: float) -> Any:
        middle, square = graph.constant(at), graph.constant(radius * radius)
        return (x - middle).squared() + (y - middle).squared() - square

    both = circle(0.0, 1.0) * circle(AT, SMALL)
    line = x - graph.constant(1.75)
    made = [
        CriticalCurve(name, "", system([f], (0, 1)), (), np.ones(2))
        for name, f in (("circles", both), ("line", line))
    ]
    found = begin(made, np.array([[-2.0, -2.0, 2.0, 2.0]]))
    assert refine(found, AREA, 1)
    for enclosure in found:
        enclosure.small = [*enclosure.small, EMPTY]
    return found


def points() -> np.ndarray:
    angles = np.linspace(0, 2 * np.pi, 500)
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    upright = np.stack([np.full(500, 1.75), np.linspace(-1.999, 1.999, 500)], axis=1)
    return np.concatenate([around, AT + SMALL * around, upright])


def covered(cover: Cover, at: np.ndarray) -> np.ndarray:
    """Which points lie in a rectangle; points are a hundredth of a lattice step off at worst."""
    steps = (at + 2) / 4 * cover.steps
    low, high = (np.array(cover.rectangles)[:, k] for k in ([0, 2], [1, 3]))
    inside = (low[None] <= steps[:, None] + 0.01) & (steps[:, None] - 0.01 <= high[None])
    return np.asarray(inside.all(axis=2).any(axis=1))


def middles(boxes: Boxes) -> np.ndarray:
    return np.asarray((boxes[:, :2] + boxes[:, 2:]) / 2)


@pytest.mark.parametrize("thin", [False, True])
def test_what_no_curve_enters_is_taken_away_and_nothing_else(thin: bool) -> None:
    enclosures = curves()
    cover = LATTICE.cover(box_rectangles(enclosures))
    if thin:
        strips = thinning(enclosures, LATTICE, 1).cover(0.01)
        cover = Cover(
            cover.steps, tuple(sorted({*strips.rectangles, *LATTICE.cover(EMPTY).rectangles}))
        )
    assert covered(cover, points()).all() and covered(cover, middles(EMPTY)).all()
    found = without_specks(components(cover), enclosures, LATTICE, AREA).cover
    assert covered(found, points()).all()
    assert not covered(found, middles(EMPTY)).any()
    assert set(found.rectangles) < set(cover.rectangles)
    assert len(found.rectangles) >= len(cover.rectangles) - len(EMPTY)


def test_where_the_budget_ends_all_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    enclosures = curves()
    cover = LATTICE.cover(box_rectangles(enclosures))
    for name, value in (("BUDGET", 0), ("MAX_PAIRS", 0), ("MAX_SHARE", Fraction(0))):
        with monkeypatch.context() as patched:
            patched.setattr(covering, name, value)
            assert without_specks(components(cover), enclosures, LATTICE, AREA).cover == cover


def test_a_cover_without_rectangles_stays() -> None:
    empty = Cover(LATTICE.steps, ())
    assert without_specks(components(empty), curves(), LATTICE, AREA).cover == empty
