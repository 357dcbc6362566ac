"""Moments, whose work is no function of the pose: nothing may be concluded from an energy where they work."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

import ptmcad
from ptmcad.ask.ranges import Fate, pose_paths
from ptmcad.exact.models import system_from
from ptmcad.mechanism import ptm
from ptmcad.mechanism.moments import moments_at
from ptmcad.question.slice import Slice
from ptmcad.show.ranges.table import path_table


def arm(moment: object, **axes: Any) -> Slice:
    """A bar with two resting angles, 0 and 180 degrees, pushed by F and G and turned by a moment."""
    parameters: dict[str, Any] = {"M": {}, "F": {"kind": "force", "default": "1/2"}, "G": {"kind": "force"}}
    return ptmcad.slice_from_mapping(
        {
            "name": "arm",
            "mechanism": {
                "parameters": parameters,
                "unknowns": {"th": "angle"},
                "points": {"O": [0, 0], "P": ["cos(th)", "sin(th)"]},
                "bars": [["O", "P"]],
                "torsion": [{"angle": "2*th", "k": 1}],
                "moments": {"th": moment},
                "loads": {"P": ["F", "G"]},
            },
            "axes": axes or {"M": [-4, 4], "G": [0, 9]},
        }
    )


TWO_ANGLES = {
    "name": "pair",
    "mechanism": {
        "parameters": {"M": {}, "K": {"kind": "stiffness", "default": 3}},
        "unknowns": {"p": "angle", "q": "angle"},
        "points": {"O": [0, 0], "P": ["cos(p)", "sin(p)"], "Q": ["cos(q)", "sin(q)"]},
        "bars": [["O", "P"], ["O", "Q"]],
        "torsion": [
            {"angle": "p", "k": 1},
            {"angle": "p + q", "k": "1/4"},
            {"angle": "p - q", "k": "1/4"},
            {"angle": "2*q", "k": "K"},
        ],
        "loads": {"Q": [0, "1/10"]},
        "moments": {"p": "M"},
    },
    "axes": {"M": ["-1/4", 1], "K": [1, 4]},
}


def test_a_pose_snaps_where_no_moment_works_and_is_not_said_to_where_one_does() -> None:
    """The same fold along G: at M = 0 the energy descends to the one minimum left, at M = 1/5 by each turn too."""
    still = pose_paths(arm("M"), "G", {"M": 0}, "1/2", 2)
    (path,) = still.paths
    assert path.high.fate is Fate.SNAP and path.high.target is not None
    assert path.high.energy is not None and path.high.target_energy is not None
    assert path.high.target_energy.high < path.high.energy.low
    turned = pose_paths(arm("M"), "G", {"M": "1/5"}, "1/2", 2)
    (path,) = turned.paths
    assert path.high.fate is Fate.VANISH and path.high.target is None
    assert path.high.energy is None and path.high.target_energy is None
    assert "under the moment it may never come to rest: where it goes from there is not decided" in path_table(turned)
    assert "lower by" not in path_table(turned) and "snaps to" not in path_table(turned)


def test_a_moment_that_is_the_axis_works_on_the_whole_line() -> None:
    """Also where the axis passes through 0: the pose vanishes where the moment does not."""
    found = pose_paths(arm("M"), "M", {"G": 1}, 0)
    ends = [end for path in found.paths for end in (path.low, path.high)]
    assert {end.fate for end in ends} == {Fate.VANISH} and all(end.target is None for end in ends)


def test_a_pair_of_bars_under_a_moment_is_not_said_to_rest() -> None:
    """At M > 1 / 2 the first bar turns for ever, though one minimum of several values is left."""
    found = pose_paths(ptmcad.slice_from_mapping(TWO_ANGLES), "M", {"K": 3}, 0)
    ends = {end.fate for path in found.paths for end in (path.low, path.high)}
    assert Fate.VANISH in ends and Fate.SNAP not in ends and Fate.MERGE not in ends


@pytest.mark.parametrize(("moment", "known"), [("M*sin(th)", False), ("M + sin(th) - sin(th)", False), ("M/2", True)])
def test_description_and_equations_agree_on_what_has_a_potential(moment: str, known: bool) -> None:
    """By the names in the description, whether or not the unknown cancels out."""
    model = arm(moment).model
    assert (model.has_potential, system_from(model).has_index) == (known, known)


def test_solutions_without_a_potential_are_not_called_minima() -> None:
    found = pose_paths(arm("M*cos(th)"), "G", {"M": 1}, "1/2")
    text = path_table(found)
    assert "equilibrium" in text and "minimum" not in text and "maximum" not in text


def test_moments_at_a_point() -> None:
    model = arm("2*M").model
    assert moments_at(model, {"M": Fraction("1/4")}) == {"th": Fraction("1/2")}
    assert not moments_at(model, {"M": Fraction(0)})
    assert not moments_at(ptm(), {})
