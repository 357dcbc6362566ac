"""What members have in common, against members alone: stored surfaces, and that false ones are
rejected.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import Any

import pytest
import yaml
from support.replacing import replace

import ptmcad
from ptmcad.answer.family import FamilyMap
from ptmcad.answer.regionmap import RegionMap
from ptmcad.errors import DegenerateSliceError
from ptmcad.question.config import member_like
from ptmcad.verification import verify_surfaces

LOADS = yaml.safe_load("""
mechanism: ptm
parameters: {F3: F, F4: F}
axes: {rho: [0, 2], L2: [0, 2]}
free: {F: [-40, 0]}
members: 2
""")
BOWL = yaml.safe_load("""
system: {unknowns: {u: real}, equations: [u^2 - c + a^2 + b^2]}
axes: {a: [-1, 1], b: [-1, 1]}
free: {c: [-1, 3]}
members: 2
""")
LINES = {**BOWL, "system": {"unknowns": {"u": "real"}, "equations": ["(u^2 - a + c)*(u - b - 9)"]}}


@cache
def family(name: str) -> FamilyMap:
    record: dict[str, Any] = {"loads": LOADS, "bowl": BOWL, "lines": LINES}[name]
    return ptmcad.family(record, areas=False)


def map_of(found: FamilyMap, value: Fraction) -> RegionMap:
    slice = member_like(found.members[0].slice, found.text, found.free.name, value, False)
    return ptmcad.classify(slice, areas=False)


@pytest.mark.parametrize("name", ["loads", "bowl", "lines"])
@pytest.mark.slow_cases("loads")
def test_surfaces_cut_at_a_value_are_the_curves_of_the_member(name: str) -> None:
    found = family(name)
    assert found.surfaces
    check = verify_surfaces(found, lambda value: map_of(found, value), seed=1)
    assert check.passed is True, check.detail


@pytest.mark.parametrize("change", ["a term less", "one that is none", "one less"])
def test_false_surfaces_are_rejected(change: str) -> None:
    found = family("lines")
    first, *others = found.surfaces
    surfaces = {
        "a term less": (first[1:], *others), "one that is none": (*found.surfaces, (((1, 0, 0), 1), ((0, 0, 1), 7))),
        "one less": tuple(others),
    }[change]  # fmt: skip
    false = replace(found, surfaces=surfaces)
    check = verify_surfaces(false, lambda value: map_of(found, value), seed=1)
    assert check.passed is False
    assert "the member at c = " in check.detail


def test_where_no_member_has_a_map_nothing_is_said() -> None:
    def refused(_value: Fraction) -> RegionMap:
        raise DegenerateSliceError("no")

    check = verify_surfaces(family("bowl"), refused)
    assert check.passed is None
    assert verify_surfaces(replace(family("bowl"), surfaces=()), refused).passed is None
