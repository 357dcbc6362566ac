"""Moments, whose work is no function of the pose: nothing may be concluded from an energy where
they work.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from types import MappingProxyType
from typing import Any

import pytest
import yaml
from flint import fmpq

import ptmcad
from ptmcad.answer.paths import Fate
from ptmcad.ask.lines.follower import pose_paths
from ptmcad.ask.solving import poses_at
from ptmcad.exact.models import system_from
from ptmcad.exact.models.system import polynomial_at
from ptmcad.model import ptm
from ptmcad.model.work import moments_at
from ptmcad.question.slice import Slice
from ptmcad.show.ranges.pathtable import path_table


def arm(moment: object, others: Mapping[str, str] = MappingProxyType({}), **axes: Any) -> Slice:
    """A bar with two resting angles, 0 and 180 degrees, pushed by F and G and turned by a moment."""
    parameters: dict[str, Any] = {
        "M": {},
        "F": {"kind": "force", "default": "1/2"},
        "G": {"kind": "force"},
    }
    return ptmcad.slice_from_mapping(
        {
            "name": "arm",
            "mechanism": {
                "parameters": parameters,
                "unknowns": {"th": "angle", **others},
                "points": {"O": [0, 0], "P": ["cos(th)", "sin(th)"]},
                "bars": [["O", "P"]],
                "torsion": [
                    {"angle": "2*th", "k": 1},
                    *({"angle": name, "k": 2} for name in others),
                ],
                "moments": {"th": moment},
                "loads": {"P": ["F", "G"]},
            },
            "axes": axes or {"M": [-4, 4], "G": [0, 9]},
        }
    )


TWO_ANGLES = yaml.safe_load("""
name: pair
mechanism:
  parameters: {M: {}, K: {kind: stiffness, default: 3}}
  unknowns: {p: angle, q: angle}
  points: {O: [0, 0], P: [cos(p), sin(p)], Q: [cos(q), sin(q)]}
  bars: [[O, P], [O, Q]]
  torsion: [{angle: p, k: 1}, {angle: p + q, k: 1/4}, {angle: p - q, k: 1/4}, {angle: 2*q, k: K}]
  loads: {Q: [0, 1/10]}
  moments: {p: M}
axes: {M: [-1/4, 1], K: [1, 4]}
""")


def test_a_pose_snaps_where_no_moment_works_and_is_not_said_to_where_one_does() -> None:
    """The same fold along G: at M = 0 the energy descends to the one minimum left, at M = 1/5 by
    each turn too.
    """
    still = pose_paths(arm("M"), "G", {"M": 0}, "1/2", 2)
    (path,) = still.paths
    assert path.high.fate is Fate.SNAP and path.high.target is not None
    assert path.high.energy is not None and path.high.target_energy is not None
    assert path.high.target_energy.high < path.high.energy.low
    turned = pose_paths(arm("M"), "G", {"M": "1/5"}, "1/2", 2)
    (path,) = turned.paths
    assert path.high.fate is Fate.VANISH and path.high.target is None
    assert path.high.energy is None and path.high.target_energy is None
    assert (
        "under the moment it may never come to rest: where it goes from there is not decided"
        in path_table(turned)
    )
    assert "lower by" not in path_table(turned) and "snaps to" not in path_table(turned)


def slider(load: str, moments: dict[str, str]) -> ptmcad.Slice:
    """A slider on a spring, and a bar that turns about it, which another spring holds to a point
    above.
    """
    mechanism = {
        "parameters": {"M": {"kind": "force"}, "F": {"kind": "force"}},
        "unknowns": {"s": "length", "th": "angle"},
        "points": {"O": [0, 0], "A": ["s", 0], "P": ["s + cos(th)", "sin(th)"], "B": [1, 2]},
        "bars": [["A", "P"]],
        "springs": [{"between": ["B", "P"], "k": 1}, {"between": ["O", "A"], "k": "1/2"}],
        "loads": {"P": [0, load]},
        "moments": moments,
    }
    return ptmcad.slice_from_mapping(
        {"name": "s", "mechanism": mechanism, "axes": {"M": [-2, 2], "F": [-2, 2]}}
    )


def test_what_works_on_a_length_is_called_a_force() -> None:
    """And a slider on a level, whose height is 0, is not among the points that are above or below."""
    along = pose_paths(slider("F", {"s": "M"}), "F", {"M": "1/100"}, "-19/10", 2)
    told = path_table(along)
    assert along.moved == ("s",)
    assert (
        "under the force on s it may never come to rest: where it goes from there is not decided"
        in told
    )
    assert "moment" not in told and "y of A" not in told and "y of P" in told
    assert [len(path.low.last.sides) for path in along.paths if path.low.last] == [1] * len(
        along.paths
    )
    both = pose_paths(slider("F", {"s": "M", "th": "M/50"}), "F", {"M": "1/100"}, "-19/10", 2)
    assert "under the moment and the force on s it may" in path_table(both)
    still = pose_paths(slider("F", {"s": "M"}), "F", {"M": 0}, "-19/10", 2)
    assert still.moved == () and "come to rest" not in path_table(still)


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


KNOWN = {"M*cos(s)": False, "M + sin(s) - sin(s)": False, "M*sin(th)": True, "M/2": True}


@pytest.mark.parametrize(("moment", "known"), KNOWN.items())
def test_description_and_equations_agree_on_what_has_a_potential(moment: str, known: bool) -> None:
    """By the names in the description, whether or not the other unknown cancels out."""
    model = arm(moment, {"s": "angle"}).model
    assert (not model.coupled, system_from(model).potential is not None) == (known, known)


def test_moments_at_a_point() -> None:
    model = arm("2*M").model
    assert moments_at(model, {"M": Fraction("1/4")}) == {"th": Fraction("1/2")}
    assert not moments_at(model, {"M": Fraction(0)})
    assert not moments_at(ptm(), {})


WORKS = {
    "M*sin(th)": ({}, "M*(1 - cos(th))"),
    "M*sin(2*th) + 1/3": ({"th": Fraction(1, 3)}, "M*sin(th)^2"),
    "M*cos(th)^2": ({"th": Fraction(1, 2)}, "M*sin(th)*cos(th)/2"),
    "M*sin(th)^4 - 3/8*M": ({}, "-M*cos(th)*sin(th)^3/4 - 3/8*M*cos(th)*sin(th)"),
    "M*cos(th)*sin(th)^2*G": ({}, "M*G*sin(th)^3/3"),
}
"""Moments, to their constant parts at M = 1 and the work of the rest, integrated by hand."""


@pytest.mark.parametrize("moment", WORKS)
def test_a_moment_of_its_own_angle_has_a_constant_part_and_an_energy(moment: str) -> None:
    steady, work = WORKS[moment]
    model = arm(moment).model
    assert moments_at(model, {"M": Fraction(1), "G": Fraction(2), "F": Fraction(0)}) == steady
    by_hand = ptmcad.System(
        parameters={"M": {}, "G": {}},
        unknowns={"th": "angle"},
        potential=f"cos(2*th)*0 + 1 - cos(2*th) - G*sin(th) - ({work}) + 0*M",
    )
    values = {"M": fmpq(3, 7), "G": fmpq(2, 5), "F": fmpq(0)}
    (found, system), (expected, other) = (
        (polynomial_at(system, system.potential, values), system)
        for system in map(system_from, (model, by_hand))
    )
    assert found == expected and system.criterion == other.criterion


def test_under_a_moment_of_mean_zero_a_pose_snaps() -> None:
    """Its energy has one value for each pose: a moment M sin(th) is a load of -M along x, but for a
    constant.
    """
    (path,) = pose_paths(arm("M*sin(th)"), "G", {"M": "1/5"}, "1/2", 2).paths
    assert path.high.fate is Fate.SNAP and path.high.target is not None
    moved, loaded = (
        poses_at(
            arm(moment).model, {"M": Fraction(1, 5), "G": Fraction(1, 2), "F": force}, 12
        ).equilibria
        for moment, force in (("M*sin(th)", Fraction(1, 2)), ("0*M", Fraction(3, 10)))
    )
    assert [pose.index for pose in moved] == [pose.index for pose in loaded]
    for one, other in zip(moved, loaded, strict=True):
        assert one.known_energy.low + Fraction(1, 5) < other.known_energy.high
        assert other.known_energy.low < one.known_energy.high + Fraction(1, 5)
