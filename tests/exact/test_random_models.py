"""Random mechanisms and random systems: counts at random points against Newton's method from many
starts.

The oracle (`tests/support/multistart.py`) shares no code with the package, and proves each of its
solutions.
"""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import pytest
from support.multistart import Found, model_of, solutions
from support.random_models import random_mechanism, random_system
from support.signatures import count_by_isolation, count_by_signature

import ptmcad
from ptmcad.answer.counts import Counts
from ptmcad.errors import HypothesisError
from ptmcad.exact.models import system_from
from ptmcad.text.flint_numbers import from_fraction

POINTS = 200
STARTS = 400
ROUNDS = 6
"""Each with four times as many starts as the one before, while the oracle has found fewer solutions
than there are.
"""


def agree(record: dict[str, Any], number: int, seed: int, by_signature: bool = False) -> int:
    """Compare at so many random points; the number that were not degenerate or on the slice's
    boundary.
    """
    slice = ptmcad.slice_from_mapping(record)
    system = system_from(slice.model)
    oracle = model_of(record)
    source = random.Random(seed)
    compared = 0
    for _ in range(number):
        axes = {
            a.name: a.low + (a.high - a.low) * Fraction(source.randint(1, 9972), 9973)
            for a in slice.axes
        }
        values = {name: e.evaluate(*axes.values()) for name, e in slice.parameters.items()}
        exact = {
            name: from_fraction(v) for name, v in values.items() if name in system.ring.parameters
        }
        try:
            counts = count_by_isolation(system, exact)
        except HypothesisError:
            continue
        if by_signature:
            assert count_by_signature(system, exact) == counts
        starts = STARTS
        for k in range(ROUNDS):
            found = solutions(oracle, values, starts, seed + k)
            if sum(f.counts for f in found) >= counts.total:
                break
            starts *= 4
        assert tally(found, counts) == counts, (
            record,
            axes,
            [tuple(map(float, f.at)) for f in found],
        )
        compared += 1
    return compared


def tally(found: list[Found], counts: Counts) -> Counts:
    """The oracle's counts, of the same kinds."""
    counted = [f for f in found if f.counts]
    if counts.index is None:
        return Counts(len(counted), None, None)
    index = tuple(sum(f.negative == k for f in counted) for k in range(len(counts.index)))
    return Counts(len(counted), index[0], index)


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow), 2, 3, 4, 5])
@pytest.mark.fast_cases("2", "4")
def test_random_systems_by_two_methods(seed: int) -> None:
    agree(random_system(seed), 2, seed, by_signature=True)


@pytest.mark.parametrize("seed", [0, 1, pytest.param(2, marks=pytest.mark.slow)])
@pytest.mark.slow_cases("1")
def test_random_mechanisms_by_two_methods(seed: int) -> None:
    assert agree(random_mechanism(seed), 1, seed, by_signature=seed < 2)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_counts_of_random_systems(seed: int) -> None:
    agree(random_system(seed), POINTS, seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_counts_of_random_mechanisms(seed: int) -> None:
    assert agree(random_mechanism(seed), POINTS, seed)
