"""Theorem 5 of the reference: in other units, mirrored, or with its rods exchanged, a mechanism has
the same map.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import Phase, assume, given, settings
from hypothesis import strategies as st
from support.structure import check_structure

from ptmcad import RegionMap, classify, slice_from_mapping
from ptmcad.errors import HypothesisError

Record = dict[str, Any]
LENGTHS, SPRINGS = ("L1", "L2", "rho"), ("k1", "k2", "k3")
FORCES = ("F3", "F4", "F3x", "F4x")
EXCHANGED = {
    "L1": "L2",
    "L2": "L1",
    "F3": "F4",
    "F4": "F3",
    "F3x": "F4x",
    "F4x": "F3x",
    "k1": "k2",
    "k2": "k1",
}
"""Names in the mirror image in a vertical line, where F3x and F4x change their signs too."""


def numbers(*texts: str) -> st.SearchStrategy[Fraction]:
    return st.sampled_from([Fraction(t) for t in texts])


VALUES = {
    "L1": numbers("1", "1", "3/2", "2/3"),
    "L2": numbers("1", "3/2", "1/2", "7/5"),
    "rho": numbers("1/2", "3/4", "1"),
    "F3": numbers("0", "-10", "-20", "7"),
    "F4": numbers("-10", "0", "15", "-5"),
    "F3x": numbers("0", "0", "5", "-8"),
    "F4x": numbers("0", "0", "10", "-3"),
}
LOWS = {
    **{n: numbers("0", "0", "1/4") for n in LENGTHS},
    **{n: numbers("-30", "-10", "0", "-7/2") for n in FORCES},
}  # fmt: skip
WIDTHS = {
    **{n: numbers("1", "2", "5/2") for n in LENGTHS},
    **{n: numbers("10", "30") for n in FORCES},
}


@st.composite
def records(draw: st.DrawFn) -> Record:
    """Any two of lengths and forces as axes, the others simple numbers; unequal springs in some."""
    axes = draw(st.lists(st.sampled_from(LENGTHS + FORCES), min_size=2, max_size=2, unique=True))
    parameters = {n: draw(VALUES[n]) for n in LENGTHS + FORCES if n not in axes}
    parameters |= dict.fromkeys(SPRINGS, Fraction(100))
    if draw(st.booleans()):
        parameters |= {"k2": Fraction(150), "k3": Fraction(80)}
    windows = {}
    for n in axes:
        low = draw(LOWS[n])
        windows[n] = [low, low + draw(WIDTHS[n])]
    count = draw(st.sampled_from(["stable", "total", "index"]))
    return {"name": "random", "parameters": parameters, "axes": windows, "count": count}


def region_map(record: Record) -> RegionMap:
    texts = {n: str(v) for n, v in record["parameters"].items()}
    axes = {n: [str(low), str(high)] for n, (low, high) in record["axes"].items()}
    return classify(
        slice_from_mapping({**record, "parameters": texts, "axes": axes}), area_tolerance="1/20"
    )


def scaled(record: Record, factors: dict[str, Fraction]) -> Record:
    """Parameters and windows multiplied; a negative factor turns a window round."""
    parameters = {n: v * factors.get(n, 1) for n, v in record["parameters"].items()}
    axes = {
        n: sorted(v * factors.get(n, 1) for v in window) for n, window in record["axes"].items()
    }
    return {**record, "parameters": parameters, "axes": axes}


Image = tuple[Record, Callable[[dict[str, Fraction]], dict[str, Fraction]]]


def by_factors(record: Record, factors: dict[str, Fraction]) -> Image:
    return scaled(record, factors), lambda at: {n: v * factors.get(n, 1) for n, v in at.items()}


def axes_swapped(record: Record, factor: Fraction) -> Image:
    return {**record, "axes": dict(reversed(record["axes"].items()))}, lambda at: at


def stiffness_and_force_scaled(record: Record, factor: Fraction) -> Image:
    return by_factors(record, dict.fromkeys(SPRINGS + FORCES, factor))


def lengths_scaled(record: Record, factor: Fraction) -> Image:
    return by_factors(record, dict.fromkeys(LENGTHS + FORCES, factor))


def reflected(record: Record, factor: Fraction) -> Image:
    """Upside down: vertical loads change their signs."""
    return by_factors(record, dict.fromkeys(("F3", "F4"), Fraction(-1)))


def rods_exchanged(record: Record, factor: Fraction) -> Image:
    """The mirror image in a vertical line."""
    turned, _ = by_factors(record, dict.fromkeys(("F3x", "F4x"), Fraction(-1)))
    parameters = {EXCHANGED.get(n, n): v for n, v in turned["parameters"].items()}
    axes = {EXCHANGED.get(n, n): v for n, v in turned["axes"].items()}
    return {**turned, "parameters": parameters, "axes": axes}, lambda at: {
        EXCHANGED.get(n, n): -v if n in ("F3x", "F4x") else v for n, v in at.items()
    }


SYMMETRIES = [axes_swapped, stiffness_and_force_scaled, lengths_scaled, reflected, rods_exchanged]


def check_same(
    record: Record, symmetry: Callable[[Record, Fraction], Image], factor: Fraction
) -> None:
    image, carry = symmetry(record, factor)
    try:
        ours = region_map(record)
    except HypothesisError as error:
        with pytest.raises(type(error)):
            region_map(image)
        assume(False)
    theirs = region_map(image)
    check_structure(ours)
    check_structure(theirs)
    assert len(ours.regions) == len(theirs.regions)
    assert ours.complex_solutions == theirs.complex_solutions

    # the image's window in units of ours
    unit = Fraction(1)
    for name, (low, high) in record["axes"].items():
        ends = [carry({name: v}) for v in (low, high)]
        a, b = (next(iter(end.values())) for end in ends)
        unit *= abs(a - b) / (high - low)
    generator = random.Random(f"{record}{factor}")
    partner: dict[int, int] = {}
    x, y = ours.slice.axes
    samples = [dict(cell.sample) for cell in ours.cells]
    samples += [
        {
            a.name: a.low + (a.high - a.low) * Fraction(generator.randint(1, 996), 997)
            for a in (x, y)
        }
        for _ in range(10)
    ]
    for at in samples:
        one, other = ours.locate(**at), theirs.locate(**carry(at))
        assert one.status is other.status
        assert (one.total, one.stable, one.index) == (other.total, other.stable, other.index)
        if one.region is not None:
            assert partner.setdefault(one.region, other.region) == other.region  # type: ignore[arg-type]
    assert sorted(partner.values()) == list(range(len(theirs.regions))), (
        "each region has one partner"
    )
    for n, m in partner.items():
        one_region, other_region = ours.regions[n], theirs.regions[m]
        assert (one_region.stable, one_region.total, one_region.index) == (
            other_region.stable,
            other_region.total,
            other_region.index,
        )
        assert one_region.area[0] * unit <= other_region.area[1]
        assert other_region.area[0] <= one_region.area[1] * unit


factors = st.sampled_from([Fraction(f) for f in ("2", "1/3", "7/5", "1000", "1/1000")])


@pytest.mark.parametrize("symmetry", SYMMETRIES, ids=lambda s: s.__name__)
@given(record=records(), factor=factors)
@settings(max_examples=2, phases=[Phase.generate])
@pytest.mark.slow_cases("axes_swapped", "lengths_scaled", "stiffness_and_force_scaled")
def test_symmetry(
    symmetry: Callable[[Record, Fraction], Image], record: Record, factor: Fraction
) -> None:
    check_same(record, symmetry, factor)
