"""Numbers of any length as text, and the table that shows them."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from conftest import shipped

from ptmcad.numerals import magnitude


def test_the_table_of_a_damaged_result_ends() -> None:
    """An area between 10^4298 and 2 once made the table look for the magnitude of a negative number for ever."""
    result = shipped("fig2")
    first, *others = result.regions
    damaged = replace(result, regions=(replace(first, area=(Fraction(10) ** 4298, Fraction(2))), *others))
    assert damaged.table().endswith("unknown")
    with pytest.raises(ValueError, match="magnitude"):
        magnitude(Fraction(-1))


@pytest.mark.parametrize("exponent", [0, 1, 17, 308, 4300, 100_000])
def test_magnitudes_of_any_size(exponent: int) -> None:
    """Exact at and just under each power of ten."""
    power = Fraction(10) ** exponent
    assert magnitude(power) == exponent
    assert magnitude(power - Fraction(1, 7)) == exponent - 1
    assert magnitude(1 / power) == -exponent
