"""Random slices: classified, verified, and compared with exact counts at a hundred points of each
window.

The points lie anywhere in the window, on simple fractions of it, 10^-40 of its size from a wall and
from its edge, and exactly on the variety where it has rational points. The counts come from
`oracle`, which shares no code with the engine; where it declines, from signatures of Hermite forms.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction

import pytest
from flint import fmpz_poly
from support import oracle
from support.counting import system_of
from support.random_slices import NUMBERS, REFUSED, Draw, drawn
from support.signatures import count_by_signature
from support.structure import check_structure

from ptmcad import RegionMap, classify, slice_from_mapping, verify
from ptmcad.algebra.polynomials import from_plane
from ptmcad.algebra.real_roots import isolate, refine, squarefree_part
from ptmcad.answer.regionmap import Status
from ptmcad.errors import ConfigError, HypothesisError
from ptmcad.exact.cad.projection import curve
from ptmcad.exact.point_system import DegeneratePoint
from ptmcad.text.flint_numbers import from_fraction, to_fraction

POINTS = 100
TINY = Fraction(1, 10**40)

Point = tuple[Fraction, Fraction]


def true_counts(result: RegionMap, at: Point) -> tuple[int, ...] | None:
    """Minima, saddles and maxima at a point; None when an equilibrium there is singular."""
    values = {name: e.evaluate(*at) for name, e in result.slice.parameters.items()}
    try:
        return oracle.count(values)
    except oracle.Degenerate:
        return None
    except oracle.Untreated:
        try:
            exact = {name: from_fraction(v) for name, v in values.items()}
            return count_by_signature(system_of(result.slice.mechanism), exact).index
        except DegeneratePoint:
            return None


# ------------------------------------------------------------------------------------------------------------- points


def inside(result: RegionMap, at: Point) -> bool:
    return all(axis.low < v < axis.high for axis, v in zip(result.slice.axes, at, strict=True))


def anywhere(dice: random.Random, result: RegionMap) -> Iterator[Point]:
    """Uniform, on fractions of the window with small denominators, and close to the edge."""
    while True:
        style, at = dice.random(), []
        for axis in result.slice.axes:
            if style < 1 / 2:
                share = Fraction(dice.randint(1, 10**6 - 1), 10**6)
            elif style < 9 / 10:
                whole = dice.randint(2, 12)
                share = Fraction(dice.randint(1, whole - 1), whole)
            else:
                share = dice.choice(
                    [TINY, 1 - TINY, Fraction(1, 2), Fraction(dice.randint(1, 99), 100)]
                )
            at.append(axis.low + share * (axis.high - axis.low))
        yield at[0], at[1]


def at_the_variety(
    dice: random.Random, result: RegionMap, lines: int
) -> Iterator[tuple[Point, bool]]:
    """Points on lines across the window: next to each curve, and on it (True) where it has a
    rational root.
    """
    names = (0, 1)
    for _ in range(lines):
        base = dice.choice(names)
        along, across = result.slice.axes[base], result.slice.axes[1 - base]
        whole = dice.choice([2, 3, 7, 10, 997])
        u = along.low + (along.high - along.low) * Fraction(dice.randint(1, whole - 1), whole)
        low, high = from_fraction(across.low), from_fraction(across.high)
        gap = TINY * (across.high - across.low)
        for number, component in enumerate(result.components):
            if component.left_out or component.polynomial.degrees[1 - base] == 0:
                continue
            fibre = curve(number, from_plane(component.polynomial), base).polynomial_over(
                from_fraction(u)
            )
            if not fibre:
                continue  # the line is the component
            for root in isolate(squarefree_part(fibre), low, high):
                close = refine(root, from_fraction(gap / 4))
                for v in (to_fraction(close.low) - gap, to_fraction(close.high) + gap):
                    yield ((u, v) if base == 0 else (v, u)), False
            for v in rational_roots(fibre):
                yield ((u, v) if base == 0 else (v, u)), True


def rational_roots(p: fmpz_poly) -> list[Fraction]:
    linear = (f for f, _ in fmpz_poly([int(c) for c in p.coeffs()]).factor()[1] if f.degree() == 1)
    return [-Fraction(int(f[0]), int(f[1])) for f in linear]


def check_point(result: RegionMap, at: Point) -> Status:
    """The answer at a point of the window is the truth, and its region's counts are the point's."""
    found = result.locate(**dict(zip(result.slice.axis_names, at, strict=True)))
    expected = true_counts(result, at)
    if found.status is Status.ON_VARIETY:
        assert (found.region, found.cell, found.total, found.stable, found.index) == (None,) * 5
        assert any(c.polynomial(*at) == 0 for c in result.components), at
        return found.status
    assert found.status is Status.EXACT, at
    assert expected is not None, f"{at} has a singular equilibrium, but locate gives {found}"
    assert found.index == expected, at
    assert (found.total, found.stable) == (sum(expected), expected[0])
    assert found.region is not None
    region = result.regions[found.region]
    assert region.index in (expected, None)
    assert region.total in (sum(expected), None)
    assert region.stable in (expected[0], None)
    return found.status


def check_points(
    draw: Draw, result: RegionMap, seed: int, number: int = POINTS
) -> dict[Status, int]:
    """`number` points, a third of them at the variety where it crosses the window; the anchor is
    always among them.
    """
    dice = random.Random(seed)
    answers = dict.fromkeys(Status, 0)
    if draw.anchor:
        x, y = (draw.anchor[name] for name in result.slice.axis_names)
        assert true_counts(result, (x, y)) is None
        assert check_point(result, (x, y)) is Status.ON_VARIETY
        answers[Status.ON_VARIETY] += 1
        for axis in (0, 1):
            for step in (TINY, -TINY):
                width = result.slice.axes[axis].high - result.slice.axes[axis].low
                answers[
                    check_point(
                        result, (x + step * width, y) if axis == 0 else (x, y + step * width)
                    )
                ] += 1
    near = [(at, on) for at, on in at_the_variety(dice, result, 8) if inside(result, at)]
    dice.shuffle(near)
    for at, on in near[: number // 3]:
        status = check_point(result, at)
        assert not on or status is Status.ON_VARIETY, at
        answers[status] += 1
    others = anywhere(dice, result)
    while sum(answers.values()) < number:
        answers[check_point(result, next(others))] += 1
    return answers


# -------------------------------------------------------------------------------------------------------------- tests


def classified(number: int) -> tuple[Draw, RegionMap]:
    """The first attempt that is not refused; the ones before it are refused as `REFUSED` says."""
    refused = REFUSED.get(number, ())
    for attempt, name in enumerate(refused):
        with pytest.raises((ConfigError, HypothesisError)) as error:
            classify(slice_from_mapping(drawn(number, attempt).record))
        assert type(error.value).__name__ == name
        assert len(str(error.value)) > 20
    draw = drawn(number, len(refused))
    return draw, classify(slice_from_mapping(draw.record))


def test_a_record_depends_on_its_number_alone() -> None:
    for number in (0, 70, 150, len(NUMBERS) - 1):
        assert drawn(number) == drawn(number)
        assert drawn(number).record != drawn(number, 1).record


@pytest.mark.slow
@pytest.mark.parametrize(
    "number", NUMBERS, ids=lambda n: f"{n:03d}-{drawn(n).role}-{'-'.join(drawn(n).axes)}"
)
def test_random_slice(number: int) -> None:
    draw, result = classified(number)
    check_structure(result)
    assert RegionMap.from_json(result.to_json()) == result
    for cell in result.cells:
        assert cell.index == true_counts(result, (cell.sample[0], cell.sample[1]))
    answers = check_points(draw, result, number)
    assert sum(answers.values()) >= POINTS
    report = verify(result)
    assert report.ok, report.violation
