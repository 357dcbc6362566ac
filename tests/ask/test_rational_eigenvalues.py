"""Rational eigenvalues of Hessians of three unknowns at irrational solutions, whose digits no ball
settles.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest

import ptmcad
from ptmcad.answer.poses import Poses
from ptmcad.ask.solving import poses_at
from ptmcad.question.config import point_from_mapping

PLATE: dict[str, Any] = {
    "mechanism": {
        "parameters": {"h": {"kind": "length", "default": 1}, "W": {"kind": "force"}},
        "unknowns": {"x": "length", "y": "length", "t": "angle"},
        "points": {"A": [-1, 0], "B": [1, 0], "P": ["x", "y"]},
        "bodies": {
            "plate": {"at": "P", "angle": "t", "points": {"Q": ["-1/2", "h"], "R": ["1/2", "h"]}}
        },
        "springs": [{"between": [a, b], "k": 1} for a, b in ("AQ", "BR", "AP")],
        "loads": {"P": {"weight": "W"}},
    },
    "axes": {"h": ["1/4", 2], "W": [0, 4]},
}
"""The Hessian is 3 on the diagonal of x and y and couples both to t alone: 3 is an eigenvalue at
every solution.
"""


def solved(record: dict[str, Any], **at: str) -> Poses:
    model = ptmcad.slice_from_mapping(record).model
    return poses_at(model, point_from_mapping(at, model), 12)


def potential(text: str) -> dict[str, Any]:
    unknowns = {name: "real" for name in "xyz"}
    return {"system": {"unknowns": unknowns, "potential": text}, "axes": {"a": [0, 3], "b": [0, 3]}}


def test_an_eigenvalue_that_is_three_at_irrational_poses() -> None:
    found = solved(PLATE, h="1", W="20/11").equilibria
    assert [pose.index for pose in found] == [0, 1]
    for pose in found:
        assert [value.low for value in pose.eigenvalues if value.low == value.high] == [3]


@pytest.mark.parametrize(
    ("text", "rational"),
    [
        ("x^3/3 - a*x + y^2 + z^2 + 0*b", [2, 2]),
        ("x^3/3 - a*x - y^2/6 + 5*z^2 + 0*b", [Fraction(-1, 3), 10]),
        ("x^3/3 - a*x + y^3/3 - b*y + z^2/2", [1]),
        ("x^3/3 - a*x + y^2/2 + x*y*z - b*z^2", []),
    ],
)
def test_rational_eigenvalues_are_exact_with_their_multiplicity(
    text: str, rational: list[Any]
) -> None:
    found = solved(potential(text), a="2", b="3").equilibria
    assert len(found) >= 2
    for pose in found:
        exact = [value.low for value in pose.eigenvalues if value.low == value.high]
        assert exact == rational and len(pose.eigenvalues) == 3
        assert all(one.low <= other.high for one, other in pairwise(pose.eigenvalues))


def test_equal_irrational_eigenvalues_beside_another_are_enclosed() -> None:
    found = solved(potential("x^3/3 - a*x + y^3/3 - a*y + z^2/2 - b*z"), a="2", b="0").equilibria
    assert len(found) == 4
    near = Fraction(1, 10**8)
    for pose in found:
        x, y, _ = pose.reals  # the eigenvalues are 2 x, 2 y and 1, and x and y square roots of 2
        for value, there in zip(pose.eigenvalues, sorted([2 * x.low, 2 * y.low, 1]), strict=True):
            assert value.low - near < there < value.high + near
        assert 1 in [value.low for value in pose.eigenvalues if value.low == value.high]


def test_equal_eigenvalues_of_a_coupled_hessian_are_known_beside_irrational_ones() -> None:
    """At x^2 = y^2 = 1, t = -1, z = 0 they are 2, 2 and the roots of 6."""
    unknowns = {name: "real" for name in "xyzt"}
    text = "t^3/3 - 2*t + t*(x^2 + y^2)/2 + x^4/4 + y^4/4 + z^2 + a*x + 0*b"
    record = {
        "system": {"unknowns": unknowns, "potential": text},
        "axes": {"a": [-1, 1], "b": [0, 3]},
    }
    found = [
        pose
        for pose in solved(record, a="0", b="1").equilibria
        if [abs(value.center) for value in pose.reals] == [1, 1, 0, 1]
    ]
    assert len(found) == 4
    for pose in found:
        least, *equal, greatest = pose.eigenvalues
        assert [value.exact for value in equal] == [2, 2]
        assert least.high < 0 and least.high**2 < 6 + Fraction(1, 10**8)
        assert greatest.high**2 > 6 - Fraction(1, 10**8) and greatest.low**2 < 6
