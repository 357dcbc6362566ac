"""Springs between the same points (Lemma S7): they answer as the one spring that they are together,
and the checker agrees.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("numba")

from support.examples import examples

import ptmcad
from ptmcad.answer.poses import Poses
from ptmcad.certified.engine import certified_map
from ptmcad.certified.plain.certifiedposes import plain_poses
from ptmcad.certified.plain.problem import problem_of
from ptmcad.model import Mechanism
from ptmcad.options import Options
from ptmcad.verification import verify
from ptmcad.verification.normalform.waves import form_of

Springs = list[dict[str, Any]]
TOGETHER: Springs = [
    {"between": ["A", "P"], "k": 3, "free": "2/3"},
    {"between": ["B", "P"], "k": 1, "free": "1/3"},
]
"""1 (l - 1)^2 + 2 (l - 1/2)^2 is 3 (l - 2/3)^2 and a constant."""
APART: dict[str, Springs] = {
    "same ends": [
        {"between": ["A", "P"], "k": 1, "free": 1},
        {"between": ["A", "P"], "k": 2, "free": "1/2"},
        TOGETHER[1],
    ],
    "ends in the other order": [
        TOGETHER[1],
        {"between": ["P", "A"], "k": 1, "free": 1},
        {"between": ["A", "P"], "k": 2, "free": "1/2"},
    ],
}


def bead(springs: Springs, count: str = "index") -> dict[str, Any]:
    """A point in the plane, held by springs."""
    return {
        "name": "bead",
        "mechanism": {
            "name": "bead",
            "parameters": {"F": {"kind": "force"}, "G": {"kind": "force"}},
            "unknowns": {"x": "length", "y": "length"},
            "points": {
                "A": [0, 0],
                "B": [2, 0],
                "P": ["x", "y"],
            },
            "springs": springs,
            "loads": {"P": ["F", "G"]},
        },
        "axes": {"F": [-2, 2], "G": [-2, 2]},
        "count": count,
    }


def poses(springs: Springs, force: Fraction, up: Fraction) -> Poses:
    model = ptmcad.slice_from_mapping(bead(springs)).model
    assert isinstance(model, Mechanism)
    return plain_poses(model, {"F": force, "G": up}, 8)


@pytest.mark.parametrize("how", list(APART))
def test_springs_side_by_side_are_one_cone(how: str) -> None:
    """Of engine and checker, of twice the first one's pull."""
    slice = ptmcad.slice_from_mapping(bead(APART[how]))
    pulls = {cone.name.count("+"): cone.pull.constant() for cone in problem_of(slice).cones}
    assert pulls == {0: Fraction(1, 3), 1: Fraction(2)}
    checked = {cone.name.count("+"): str(cone.pull) for cone in form_of(slice).cones}
    assert checked == {0: "1/3", 1: "2"}


@pytest.mark.parametrize("count", ["stable", "total", "index"])
@pytest.mark.parametrize("how", list(APART))
@pytest.mark.fast_cases("ends in the other order-index")
def test_they_have_the_map_of_the_one_spring(how: str, count: str) -> None:
    options = Options(tolerance=Fraction(1, 50), jobs=1)
    one, many = (
        certified_map(ptmcad.slice_from_mapping(bead(s, count)), options)
        for s in (TOGETHER, APART[how])
    )
    assert many.undetermined < Fraction(1, 50)
    # the boxes may differ, where the first spring is longer: not what is counted, nor the bounds of
    # what it covers
    assert len(one.regions) == len(many.regions)
    for r, s in zip(one.regions, many.regions, strict=True):
        assert (r.stable, r.total, r.index) == (s.stable, s.total, s.index)
        assert max(r.area[0], s.area[0]) <= min(r.area[1], s.area[1])


def test_the_checker_confirms_them_everywhere() -> None:
    """It joins them by itself, from the description."""
    slice = ptmcad.slice_from_mapping(bead(APART["ends in the other order"], "stable"))
    report = verify(certified_map(slice, Options(tolerance=Fraction(1, 50), jobs=1)), boxes=4)
    told = {check.name for check in report.checks if check.passed}
    assert told >= {"counts and solutions", "random boxes", "the whole free area"}


forces = st.fractions(min_value=-2, max_value=2, max_denominator=16)


@settings(max_examples=examples(15), deadline=None)
@given(st.sampled_from(list(APART)), forces, forces)
def test_they_have_the_equilibria_of_the_one_spring(
    how: str, force: Fraction, up: Fraction
) -> None:
    one, many = poses(TOGETHER, force, up), poses(APART[how], force, up)
    assert one.status is many.status
    pairs = list(zip(one.equilibria, many.equilibria, strict=True))
    assert [a.index for a, _ in pairs] == [b.index for _, b in pairs]
    for a, b in pairs:
        assert all(
            max(p.low, q.low) <= min(p.high, q.high) for p, q in zip(a.reals, b.reals, strict=True)
        )


def test_a_vector_the_other_way_is_as_long() -> None:
    """Without |c| the sum would be 1 - 1."""
    slice = ptmcad.slice_from_mapping(bead(APART["ends in the other order"]))
    assert [c.pull.constant() for c in problem_of(slice).cones if "+" in c.name] == [2]


def test_a_rational_equilibrium_has_its_exact_numbers() -> None:
    """At x = 2/3 one spring has its free length and the load balances the other: nothing but
    arithmetic tells so.
    """
    found = poses(TOGETHER, Fraction(-1), Fraction(0))
    forces = [[spring.force.exact for spring in pose.springs] for pose in found.equilibria]
    assert [Fraction(0), Fraction(1)] in forces
