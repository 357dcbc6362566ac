"""The unloaded mechanism's mirror: formulas next to flat configurations, their pitchforks, and all
other folds.
"""

from __future__ import annotations

import pytest

pytest.importorskip("numba")

from support.replacing import replace

from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.mirrors import mirrors
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.statement import beforehand
from ptmcad.model.involutions import Involution
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Count, Slice

REFLECTION = Involution((0, 1), (-1, -1), (0, 0))
UNLOADED = {
    "L1": "4/5",
    "k1": "90",
    "k2": "110",
    "k3": "70",
    "l0_1": "1/4",
    "l0_2": "1/5",
    "l0_3": "3/10",
}


def slice_of(**changes: str) -> Slice:
    given = {name: value for name, value in (UNLOADED | changes).items() if value}
    return slice_from_mapping(
        {"name": "s", "parameters": given, "axes": {"rho": ["1/20", "2"], "L2": ["1/10", "2"]}}
    )


def has_flat_mirror(slice: Slice) -> bool:
    return REFLECTION in mirrors(slice, problem_of(slice))


def test_which_slices_have_the_mirror() -> None:
    assert has_flat_mirror(slice_of())
    assert has_flat_mirror(slice_of(l0_1="0", l0_3="0"))
    assert has_flat_mirror(slice_of(l0_2="rho"))
    assert has_flat_mirror(slice_of(F3="0"))
    assert has_flat_mirror(slice_of(l0_3="L2 + rho"))
    for name, value in (("F3", "1"), ("F4", "rho")):
        assert not has_flat_mirror(slice_of(**{name: value})), name


def test_the_plan_says_what_is_saved() -> None:
    def steps(without: frozenset[str] = frozenset(), count: Count = Count.STABLE) -> list[str]:
        return [step.saving for step in beforehand(replace(slice_of(), count=count), without)]

    assert "mirror-images" in steps()
    assert "mirror-images" in steps(count=Count.TOTAL)
    assert len(curves(slice_of(), Count.STABLE, frozenset({"mirror-images"}))) == 2
