"""Where the operation range is widest: the paper's claims, curves with known answers, and a plain
search on a grid.
"""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import jsonschema
import pytest
from flint import fmpq

import ptmcad
from ptmcad.algebra.polynomials import PLANE
from ptmcad.algebra.real_roots import RealRoot, isolate
from ptmcad.answer.widths import Maximum, Place
from ptmcad.ask.lines.along import operation_widths
from ptmcad.exact.cad.projection import curve
from ptmcad.exact.cad.stacks import BaseEnd
from ptmcad.exact.ranges.exactline import intervals
from ptmcad.exact.ranges.rangestrips import RangeEnd, RangeStrip, strips
from ptmcad.exact.ranges.width import largest
from ptmcad.question.config import slice_from_options
from ptmcad.show.ranges.linetable import width_table
from ptmcad.show.ranges.rangedocument import document, part

ROOT = Path(__file__).resolve().parents[2]
X, Y = PLANE.gens()
"""Base and fibre of the curves that are made by hand."""


def maximum(name: str, along: str) -> tuple[Maximum, ...]:
    return largest(strips(ptmcad.load(ROOT / "configs" / f"{name}.yaml"), along).found)


def test_paper_4_3_the_range_is_widest_at_l2_1_confirmed() -> None:
    """F3 = F4 = -10: at L2 = 1 exactly, where the range is that of fig. 3 at F = -10; nowhere else
    in the window.
    """
    (only,) = maximum("fig4", "rho")
    assert only.place is Place.CRITICAL and only.at.exact == 1
    assert only.width.text(12) == "0.588549830879"
    assert only.ends is not None
    (symmetric,) = intervals(
        ptmcad.load(ROOT / "configs" / "fig3.yaml"), "rho", {"F": -10}
    ).operation
    assert [e.polynomial for e in only.ends] == [
        symmetric.low.polynomial,
        symmetric.high.polynomial,
    ]  # type: ignore[union-attr]
    # and it is taken at L2 = 1 itself
    (there,) = intervals(ptmcad.load(ROOT / "configs" / "fig4.yaml"), "rho", {"L2": 1}).operation
    assert [e.polynomial for e in only.ends] == [there.low.polynomial, there.high.polynomial]  # type: ignore[union-attr]


def test_paper_4_2_the_range_tends_to_1_at_no_load_confirmed() -> None:
    (only,) = maximum("fig3", "rho")
    assert only.place is Place.EDGE and only.at.exact == 0 and only.ends is not None
    assert [e.exact for e in only.ends] == [0, 1]  # type: ignore[union-attr]
    assert only.width.low <= 1 <= only.width.high and only.width.high - only.width.low < Fraction(
        1, 10**30
    )


def test_paper_4_1_the_width_is_constant_above_l2_1_confirmed() -> None:
    (only,) = maximum("fig2", "rho")
    assert only.place is Place.PLATEAU and (only.at.low, only.at.high) == (1, 4)
    assert only.width.exact == 1


@pytest.mark.parametrize(
    ("name", "along"),
    [
        ("fig5-text", "rho"),
        pytest.param("rods", "L1", marks=pytest.mark.slow),
        pytest.param("forces", "F3", marks=pytest.mark.slow),
        pytest.param("unequal-springs", "rho", marks=pytest.mark.slow),
        pytest.param("horizontal", "rho", marks=pytest.mark.slow),
        pytest.param("stiffness", "k", marks=pytest.mark.slow),
    ],
)
def test_no_width_on_a_grid_is_larger(name: str, along: str) -> None:
    slice = ptmcad.load(ROOT / "configs" / f"{name}.yaml")
    found = largest(strips(slice, along).found)
    over = next(a for a in slice.axes if a.name != along)
    most = max(m.width.high for m in found)
    grid = [over.low + (over.high - over.low) * Fraction(k, 6) for k in range(1, 6)]
    near = [m.at.low + s * Fraction(1, 1000) for m in found for s in (-1, 1)]
    widths = []
    for value in (v for v in [*grid, *near] if over.low < v < over.high):
        for interval in intervals(slice, along, {over.name: value}).operation:
            assert interval.width.low <= most
            widths.append(interval.width.low)
    assert max(widths) > most * Fraction(9, 10)


def by_hand(low: object, high: object, left: int, right: int) -> RangeStrip:
    """A strip between the largest root of one curve and the smallest of another, over (left,
    right).
    """
    fibre = (fmpq(-10), fmpq(10))
    lower, upper = curve(0, low, 0), curve(1, high, 0)
    middle = fmpq(left + right, 2) + fmpq(1, 7)
    last = len(isolate(lower.polynomial_over(middle), *fibre)) - 1
    return RangeStrip(
        BaseEnd(RealRoot.of(fmpq(left)), None),
        BaseEnd(RealRoot.of(fmpq(right)), None),
        middle,
        RangeEnd(lower, last, fibre[0]),
        RangeEnd(upper, 0, fibre[1]),
        fibre,
    )


def test_a_smooth_maximum_is_found() -> None:
    """Between y = x^2 + x and y = 1 + x + x^3/5: w' = 3x^2/5 - 2x vanishes at 0 and is nowhere else
    in (-1, 1).
    """
    strip = by_hand(Y - X**2 - X, 5 * Y - 5 - 5 * X - X**3, -1, 1)
    (only,) = largest([strip])
    assert only.place is Place.SMOOTH
    assert only.at.low <= 0 <= only.at.high and only.at.high - only.at.low < Fraction(1, 10**12)
    assert only.width.low <= 1 <= only.width.high and only.width.high - only.width.low < Fraction(
        1, 10**12
    )


def test_two_equal_maxima_are_both_told() -> None:
    """The width is 1 - (x^2 - 1/4)^2, largest at -1/2 and 1/2."""
    strip = by_hand(16 * Y - (4 * X**2 - 1) ** 2, Y - 1, -1, 1)
    found = largest([strip])
    assert [m.place for m in found] == [Place.SMOOTH] * 2
    for m, value in zip(found, (Fraction(-1, 2), Fraction(1, 2)), strict=True):
        assert m.at.low <= value <= m.at.high and m.width.low <= 1 <= m.width.high


def test_table_and_document() -> None:
    schema = json.loads((ROOT / "docs" / "range.schema.json").read_text(encoding="utf-8"))
    slice = slice_from_options(None, "rho,L2", ranges=["rho=0:1", "L2=0:2"])
    found = operation_widths(slice, "rho", 3)
    text = width_table(found)
    assert (
        "0.5  0.25                  0.75  0.5" in text and "* the edge of the window of rho" in text
    )
    data = json.loads(document("x", "ptm", part(found, 8)))
    jsonschema.validate(data, schema, cls=jsonschema.Draft202012Validator)
    assert [row["value"] for row in data["over"]["rows"]] == ["1/2", "1", "3/2"]


def test_the_windows_edge_counts() -> None:
    """Unloaded, rho < 1: the upper end is the edge as soon as L2 > 1."""
    slice = slice_from_options(None, "rho,L2", ranges=["rho=0:1", "L2=1/2:2"])
    (only,) = largest(strips(slice, "rho").found)
    assert only.at.exact == 1 and only.width.exact == 1
    assert " *" in width_table(operation_widths(slice, "rho", 2))


def test_no_operation_range_at_all() -> None:
    slice = slice_from_options(None, "rho,L2", ranges=["rho=3:4", "L2=1/2:2"])
    found = operation_widths(slice, "rho", 1)
    assert found.maxima == () and "nowhere two stable equilibria" in width_table(found)
