"""What Python's functions say of arguments of the wrong kind: what is expected, by the argument's
name.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support.maps import shipped

import ptmcad
from ptmcad.errors import ConfigError

SYSTEM = ptmcad.System(unknowns={"x": "real"}, equations=["x^3 - a*x + b"])


def slice_and_map() -> tuple[ptmcad.Slice, ptmcad.RegionMap]:
    result = shipped("fig4")
    return result.slice, result


def in_itself() -> dict[str, Any]:
    found: dict[str, Any] = {}
    found["axes"] = found
    return found


FIG4 = Path(__file__).resolve().parents[2] / "configs" / "fig4.yaml"
CALLS: dict[str, tuple[Callable[..., Any], str]] = {
    "solve a slice": (lambda s, r: ptmcad.solve(s, rho=1), "^L2: is an axis of the slice and has no value"),
    "solve a slice with other loads": (lambda s, r: ptmcad.solve(s, rho=1, L2=1, F3=1), "^F3: is no axis of the slice"),
    "solve a mapping": (lambda s, r: ptmcad.solve({"rho": 1}), "^rho: unknown key; the keys are"),
    "solve a record": (lambda s, r: ptmcad.solve(FIG4, rho=1), "^L2 is an axis of .*fig4.yaml and has no value"),
    "solve a file": (lambda s, r: ptmcad.solve("none.yaml", rho=1), "^none.yaml: there is no such file"),
    "solve a map": (lambda s, r: ptmcad.solve(r, rho=1), "^question: expected a slice.* RegionMap$"),
    "solve two models": (lambda s, r: ptmcad.solve(s, model=SYSTEM, rho=1), "^model: a slice or record has a model"),
    "solve a number": (lambda s, r: ptmcad.solve(30, rho=1), "^digits: give the number of digits by name: digits=30"),
    "solve for a slice": (lambda s, r: ptmcad.solve(model=s, L1=1), "^model: expected a mechanism or a system.*Slice$"),
    "solve for nothing": (lambda s, r: ptmcad.solve(model={}, L1=1), "^model: expected a mechanism"),
    "digits": (lambda s, r: ptmcad.solve(digits="many"), "^digits: 'many' is not a number of digits"),
    "a number of 5000 digits": (lambda s, r: ptmcad.solve(rho=10**5000), "^rho: a number has more than 2000 digits"),
    "data in itself": (lambda s, r: ptmcad.classify(in_itself()), "data that contains itself$"),
    "a family of a number": (lambda s, r: ptmcad.family(3), "^question: expected the file of a record.* not 3"),
    "a sweep of a number": (lambda s, r: ptmcad.sweep(3), "^question: expected the file of a record.* not 3"),
    "a quantity in a sum": (lambda s, r: r.field("energy + 1"), "'energy' is a quantity of its own, and no part"),
    "locate a number": (lambda s, r: r.locate(1), "^point: expected the values of rho and L2 by name.* not 1$"),
    "locate a slice": (lambda s, r: r.locate(s), "^point: expected the values of rho and L2 by name"),
    "locate elsewhere": (lambda s, r: r.locate({"k": 1}), "needs rho and L2, not k"),
    "intervals of a file": (lambda s, r: ptmcad.intervals("fig4.yaml", "rho", {}), "^slice: expected a slice"),
    "intervals of a map": (lambda s, r: ptmcad.intervals(r, "rho", {"L2": 1}), "^slice: expected a slice.*RegionMap$"),
    "along a number": (lambda s, r: ptmcad.intervals(s, 3, {"L2": 1}), "^along: expected an axis .* rho or L2, not 3"),
    "at a text": (lambda s, r: ptmcad.intervals(s, "rho", "L2=1"), "^at: expected a mapping .* not 'L2=1'"),
    "at nothing": (lambda s, r: ptmcad.pose_paths(s, "rho", None, 1), "^at: expected a mapping .* not None"),
    "widths": (lambda s, r: ptmcad.operation_widths(r, "rho"), "^slice: expected a slice"),
    "rows": (lambda s, r: ptmcad.operation_widths(s, "rho", "three"), "^rows: 'three' is not a number of rows"),
    "widths along": (lambda s, r: ptmcad.operation_widths(s, "k"), "^along: 'k' is not an axis of the slice"),
    "variety": (lambda s, r: ptmcad.slice_variety(r), "^slice: expected a slice"),
    "discriminant": (lambda s, r: ptmcad.discriminant_variety(r), "^slice: expected a slice.*the file of a record"),
    "cad": (lambda s, r: ptmcad.open_cad(None), "^slice: expected a slice.*not None"),
    "counts of a map": (lambda s, r: ptmcad.counts_at(r, a=1), "^model: expected a mechanism or a system"),
    "counts of a slice": (lambda s, r: ptmcad.counts_at(s, a=1), "^model: a count is of a mechanism or a system"),
    "a count": (lambda s, r: ptmcad.counts_at(SYSTEM, a=[1], b=0), "^a: expected a number or an expression"),
    "classify a map": (lambda s, r: ptmcad.classify(r), "^slice: expected a slice"),
    "classify's engine": (lambda s, r: ptmcad.classify(s, engine=r), "^engine: expected the name of an engine"),
    "classify's count": (lambda s, r: ptmcad.classify(s, count="all"), "^count: 'all' is none of stable, total, index"),
    "classify's 3": (lambda s, r: ptmcad.classify(s, count=3), "^count: expected the name of a count, not 3"),
    "verify a slice": (lambda s, r: ptmcad.verify(s), "^result: expected a map"),
    "load a mapping": (lambda s, r: ptmcad.load({}), "^path: expected the file of a record"),
    "a slice from text": (lambda s, r: ptmcad.slice_from_mapping("fig4"), "^mapping: expected a mapping like a record"),
    "compare": (lambda s, r: r.compare(s), "^other: expected a map"),
    "plot into a slice": (lambda s, r: r.plot(s), "^ax: expected axes of matplotlib's"),
    "a field of a slice": (lambda s, r: r.field(s), "^value: expected the name of a quantity"),
    "a field of no pose": (lambda s, r: r.field("energy", 1), "^pose: expected one of the poses as text"),
    "animate": (lambda s, r: r.animate(["rho"]), "^path: expected corners"),
}  # fmt: skip


@pytest.mark.parametrize("name", CALLS)
def test_a_wrong_argument_is_told_what_is_expected(name: str) -> None:
    call, words = CALLS[name]
    with pytest.raises(ConfigError, match=words):
        call(*slice_and_map())


def test_a_point_may_be_a_mapping_or_a_sample() -> None:
    result = shipped("fig4")
    cell = result.cells[3]
    assert result.locate(cell.sample).cell == 3
    assert result.locate({"rho": Fraction(7, 10), "L2": "3/2"}) == result.locate(
        rho="7/10", L2="3/2"
    )
