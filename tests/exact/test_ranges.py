"""Intervals of constant count along a line: known answers, the map's walls, and an independent
count.
"""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from flint import fmpz_poly
from support import oracle
from support.random_slices import drawn

import ptmcad
from ptmcad.algebra.real_roots import compare, refined
from ptmcad.answer.counts import Counts
from ptmcad.answer.intervals import CountIntervals, Event, lower, upper
from ptmcad.errors import ConfigError, DegenerateSliceError, GeometryError, InfiniteSolutionsError
from ptmcad.exact.ranges.exactline import intervals
from ptmcad.question.slice import Count, Slice
from ptmcad.show.ranges.endtext import end_text, width_text
from ptmcad.show.ranges.linetable import table
from ptmcad.show.ranges.rangedocument import document, part
from ptmcad.text.enclosure import AlgebraicNumber

ROOT = Path(__file__).resolve().parents[2]
CONFIGS = sorted((ROOT / "configs").glob("*.yaml"))
SCHEMA = json.loads((ROOT / "docs" / "range.schema.json").read_text(encoding="utf-8"))


@cache
def record(name: str) -> Slice:
    return ptmcad.load(ROOT / "configs" / f"{name}.yaml")


def published() -> Iterator[Any]:
    for path in CONFIGS:
        for number, entry in enumerate(ptmcad.load(path).reference.get("intervals", [])):
            yield pytest.param(
                path.stem, entry, id=f"{path.stem}-{number}-{'-'.join(map(str, entry['ends']))}"
            )


def ends(found: CountIntervals, count: Count) -> list[AlgebraicNumber]:
    """The critical values where this count changes."""

    def key(counts: Counts | None) -> object:
        assert counts is not None
        return counts.number(count)

    return [
        c.at
        for c in found.changes
        if isinstance(c.at, AlgebraicNumber) and key(c.before) != key(c.after)
    ]


@pytest.mark.parametrize(("name", "entry"), list(published()))
def test_the_records_answers(name: str, entry: dict[str, Any]) -> None:
    """Ends rounded to the digits that the record has; REFERENCE.md and the paper are their sources."""
    slice = record(name)
    found = intervals(slice, entry["along"], {n: str(v) for n, v in entry["at"].items()})
    computed = ends(found, Count(entry["count"]) if "count" in entry else slice.count)
    assert len(computed) == len(entry["ends"])
    for number, text in zip(computed, entry["ends"], strict=True):
        value = Fraction(text)
        if "." not in text:
            assert number.exact == value
        else:
            half = Fraction(1, 2 * 10 ** len(text.partition(".")[2]))
            assert compare(number, value - half) > 0 > compare(number, value + half)


@cache
def region_map(name: str) -> ptmcad.RegionMap:
    return ptmcad.classify(record(name), area_tolerance=Fraction(1, 10))


CUTS = [
    *(("fig2", "rho", v) for v in ("1/3", "1", "7/5", "3")),
    *(("fig2", "L2", v) for v in ("1/5", "2")),
    *(("fig3", "rho", v) for v in ("-19/2", "-7/3", "-1/9")),
    *(("fig3", "F", v) for v in ("1/10", "17/20")),
    *(("fig4", "rho", v) for v in ("3/2", "1/2", "1", "19/20")),
    *(("fig4", "L2", v) for v in ("7/10", "1/2")),
    *(("fig5-text", "rho", v) for v in ("-20", "-7")),
    *(("fig5-text", "F4", v) for v in ("3/5",)),
    *(("fig5-caption", "rho", v) for v in ("-29", "-30/7")),
    *(("forces", "F3", v) for v in ("-20", "55")),
    *(("rods", "L1", v) for v in ("3/2", "9/4")),
    *(("horizontal", "rho", v) for v in ("3/2", "5/4")),
    *(("stiffness", "k", v) for v in ("1", "7/10")),
    *(("stiffness", "rho", v) for v in ("100",)),
    *(("unequal-springs", "rho", v) for v in ("3/2", "5/4")),
]


FAST = ("fig2", "fig3", "fig4", "rods")


@pytest.mark.parametrize(
    ("name", "along", "value"),
    [c if c[0] in FAST else pytest.param(*c, marks=pytest.mark.slow) for c in CUTS],
    ids=lambda v: v,
)
@pytest.mark.slow_cases("fig3-rho--19/2", "fig4-rho-3/2", "rods-L1-3/2")
def test_the_ends_are_the_walls_of_the_map(name: str, along: str, value: str) -> None:
    """The same algebraic numbers: factors of the walls' polynomials on the line, and each wall that
    changes a count.

    The two come by different ways: the range's from a computation in one parameter, the map's from
    one in two.
    """
    slice, result, fixed = record(name), region_map(name), Fraction(value)
    axis = slice.axis_names.index(along)
    other = slice.axis_names[1 - axis]
    found = intervals(slice, along, {other: value})
    walls = []
    for component in result.components:
        if component.left_out:
            continue
        terms: dict[int, Fraction] = {}
        for i, j, c in component.polynomial.terms:
            power, rest = (i, j) if axis == 0 else (j, i)
            terms[power] = terms.get(power, Fraction(0)) + c * fixed**rest
        scale = fixed.denominator ** max(component.polynomial.degrees)
        p = fmpz_poly([int(terms.get(k, Fraction(0)) * scale) for k in range(max(terms) + 1)])
        walls.append(p)
    for change in found.changes:
        assert any(divides(change.at.polynomial, p) for p in walls), (
            "an end is no root of a wall's polynomial"
        )
    # between neighbouring critical values of both kinds the map and the range give the same counts
    for k, change in enumerate(found.changes):
        low = upper(found.changes[k - 1].at) if k else slice.axes[axis].low
        high = (
            lower(found.changes[k + 1].at) if k + 1 < len(found.changes) else slice.axes[axis].high
        )
        gap = min(change.at.low - low, high - change.at.high) / 10**6
        for at, index in (
            (change.at.low - gap, change.before.index),
            (change.at.high + gap, change.after.index),
        ):
            assert result.locate(**{along: at, other: value}).index == index
    # and no root of the walls' polynomials elsewhere changes a count
    known = {change.at.polynomial for change in found.changes}
    for p in walls:
        for factor, _ in p.factor()[1]:
            if tuple(int(c) for c in factor.coeffs()) in known or factor.degree() < 1:
                continue
            for root, _ in real_parts(factor):
                if slice.axes[axis].low < root < slice.axes[axis].high:
                    gap = Fraction(1, 10**7)
                    sides = [
                        result.locate(**{along: root + s * gap, other: value}).index
                        for s in (-1, 1)
                    ]
                    assert sides[0] == sides[1]


def divides(polynomial: tuple[int, ...], p: fmpz_poly) -> bool:
    return p.gcd(fmpz_poly(list(polynomial))).degree() == len(polynomial) - 1


def real_parts(p: fmpz_poly) -> list[tuple[Fraction, int]]:
    """Approximations of the real roots."""
    return [(Fraction(float(z.real)), m) for z, m in p.complex_roots() if z.imag == 0]  # type: ignore[misc, has-type]


@pytest.mark.parametrize("number", [3, 27, 58, 83, 118])
@pytest.mark.fast_cases("83", "118")
def test_random_slices_against_a_count_that_shares_no_code(number: int) -> None:
    draw = drawn(number)
    slice = ptmcad.slice_from_mapping(draw.record)
    dice = random.Random(number)
    axis = dice.randrange(2)
    along, over = slice.axes[axis], slice.axes[1 - axis]
    value = over.low + (over.high - over.low) * Fraction(dice.randint(1, 96), 97)
    found = intervals(slice, along.name, {over.name: value})
    for interval in found.intervals:
        low, high = upper(interval.low), lower(interval.high)
        for _ in range(2):
            at = low + (high - low) * Fraction(dice.randint(1, 1000), 1001)
            point = (at, value) if axis == 0 else (value, at)
            parameters = {name: e.evaluate(*point) for name, e in slice.parameters.items()}
            assert oracle.count(parameters) == interval.index


def test_the_unloaded_ends_are_rational() -> None:
    """|L2 - 1| < 2 rho < L2 + 1 (the paper's section 4.1)."""
    for text in ("1/3", "1", "8/5", "3"):
        length = Fraction(text)
        found = intervals(record("fig2"), "rho", {"L2": text})
        (only,) = found.operation
        high = only.high
        assert isinstance(high, AlgebraicNumber) and high.exact == (length + 1) / 2
        if length == 1:
            assert only.low == Fraction(0)
        else:
            assert isinstance(only.low, AlgebraicNumber) and only.low.exact == abs(length - 1) / 2


def test_a_line_inside_the_variety_is_named() -> None:
    slice = ptmcad.slice_from_mapping(
        {"axes": {"rho": ["1", "2"], "t": ["0", "1/2"]}, "parameters": {"L2": "2*rho-1+t"}}
    )
    with pytest.raises(
        DegenerateSliceError, match="line t = 0 lies inside the discriminant variety"
    ):
        intervals(slice, "rho", {"t": 0})
    assert intervals(slice, "t", {"rho": "3/2"}).intervals


def test_a_line_with_infinitely_many_equilibria_is_named() -> None:
    with pytest.raises(InfiniteSolutionsError, match="line L2 = 0"):
        intervals(record("fig4"), "rho", {"L2": 0})


def test_a_line_outside_the_geometry_is_refused() -> None:
    with pytest.raises(GeometryError, match="L2 = -1"):
        intervals(record("fig4"), "rho", {"L2": -1})


@pytest.mark.parametrize(
    ("along", "at", "message"),
    [
        ("F3", {"L2": 1}, "F3 is not an axis"),
        ("rho", {}, "needs a value of L2"),
        ("rho", {"L2": 1, "k": 3}, "needs a value of L2 and of nothing else"),
        ("rho", {"L2": "x"}, "at L2"),
        ("rho", {"rho": 1}, "not of rho"),
    ],
)
def test_bad_lines(along: str, at: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        intervals(record("fig4"), along, at)


def test_intervals_cover_the_window_and_neighbours_differ() -> None:
    found = intervals(record("fig5-text"), "rho", {"F4": -7})
    assert found.intervals[0].low == 0 and found.intervals[-1].high == 2
    for left, right in zip(found.intervals, found.intervals[1:], strict=False):
        assert left.high == right.low and left.index != right.index
    # a critical value where nothing changes stays listed
    assert [c.event for c in found.changes].count(Event.UNCHANGED) == len(found.changes) + 1 - len(
        found.intervals
    )


def test_numbers_compare_exactly() -> None:
    two = AlgebraicNumber((-2, 0, 1), Fraction(1), Fraction(2))
    fine = refined(two, Fraction(1, 2**200))
    other = AlgebraicNumber((-3, 0, 1), Fraction(1), Fraction(2))
    assert compare(two, fine) == 0 and compare(fine, two) == 0
    assert compare(two, other) == -1 and compare(other, two) == 1
    assert compare(two, AlgebraicNumber((-2, 0, 1), Fraction(-2), Fraction(-1))) == 1
    assert compare(fine, fine.low) == 1 and compare(fine, fine.high) == -1
    third = AlgebraicNumber((-1, 3), Fraction(1, 3), Fraction(1, 3))
    assert compare(third, Fraction(1, 3)) == 0 and compare(third, third) == 0


def test_texts_round_to_nearest() -> None:
    root = AlgebraicNumber((-2, 0, 1), Fraction(1), Fraction(2))
    assert end_text(root, 30) == "1.41421356237309504880168872421"
    found = intervals(record("fig4"), "rho", {"L2": "3/2"})
    (only,) = found.operation
    assert width_text(only, 40).startswith("0.54330193460501")
    assert Fraction(width_text(only, 20)) == round(Fraction(width_text(only, 60)), 20)


def test_the_document_follows_its_schema_and_repeats() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    found = intervals(record("fig3"), "rho", {"F": -10})
    text = document("fig3", "ptm", part(found, 10))
    jsonschema.validate(json.loads(text), SCHEMA, cls=jsonschema.Draft202012Validator)
    again = intervals(record("fig3"), "rho", {"F": -10})
    assert document("fig3", "ptm", part(again, 10)) == text
    high = json.loads(text)["line"]["intervals"][0]["high"]
    p = fmpz_poly([int(c) for c in high["polynomial"]])
    values = [Fraction(high[k]) for k in ("low", "high")]
    signs = [sum(int(c) * v**k for k, c in enumerate(p.coeffs())) > 0 for v in values]
    assert signs[0] != signs[1] and p.factor()[1][0][1] == 1 and len(p.factor()[1]) == 1


def test_the_table_names_what_happens() -> None:
    text = table(intervals(record("fig3"), "rho", {"F": -10}))
    assert "0.2149411958    0.8034910267    6      2" in text
    assert "loses one saddle and one maximum" in text
    assert "operation range: 0.2149411958 to 0.8034910267, width 0.5885498309" in text


def test_a_tangent_joins_the_intervals_and_stays_listed() -> None:
    """L2 = 3/2 + s^2 touches the wall 2 rho = L2 + 1 at s = 0, rho = 5/4, from one side."""
    slice = ptmcad.slice_from_mapping(
        {"axes": {"s": ["-1/2", "1/2"], "rho": ["1", "2"]}, "parameters": {"L2": "3/2+s^2"}}
    )
    found = intervals(slice, "s", {"rho": "5/4"})
    (change,) = found.changes
    assert (
        change.event is Event.UNCHANGED
        and change.at.exact == 0
        and change.text == "the counts do not change"
    )
    (only,) = found.intervals
    assert only.low == Fraction(-1, 2) and only.high == Fraction(1, 2) and only.stable == 2


def test_pairs_are_told_from_solutions_that_come_from_infinity() -> None:
    """b x^4/4 - (1 + b) x^2/2 - x/7: two minima come from infinity at b = 0; without the last term
    both are pairs.
    """

    def on_line(potential: str, *, low: str, high: str) -> list[str]:
        system = {"unknowns": {"x": "real"}, "potential": potential}
        slice = ptmcad.slice_from_mapping(
            {"system": system, "axes": {"b": [low, high], "a": [0, 1]}}
        )
        return [change.text for change in intervals(slice, "b", {"a": "1/2"}).changes]

    assert on_line("b*x^4/4 - x^2/2*(1+b) - x/7", low="-1", high="3") == ["gains several solutions"]
    two_folds = "(x^2 - 1)^3/6 - (x^2 - 1)*b/2"  # x = 0, and x^2 = 1 +- sqrt(b)
    assert on_line(two_folds, low="-1/2", high="1/2") == ["gains several pairs"]
