"""Equilibria whose unknowns are related, such as bars folded onto each other: what may be zero is
enclosed closely.
"""

from __future__ import annotations

from fractions import Fraction
from math import pi, sqrt
from typing import Any

import pytest
import yaml

import ptmcad
from ptmcad.answer.poses import Pose, Poses
from ptmcad.text.enclosure import Enclosure

CHAIN: dict[str, Any] = yaml.safe_load("""
parameters: {l0: {kind: free length}, M: {}, N: {}, W: {kind: force}}
unknowns: {th1: angle, th2: angle}
points:
  A: [3, 4]
  B: [-1, 2]
  C: [5, 0]
  P: [cos(th1), sin(th1)]
  Q: [cos(th1) + cos(th2), sin(th1) + sin(th2)]
springs: [{between: [A, Q], k: 1, free: l0}, {between: [B, Q], k: 2, free: l0}]
torsion: [{angle: th2 - th1, k: 1/10}]
moments: {th1: M, th2: N}
loads: {P: [W, 0]}
""")
"""Two bars of length 1 from (0, 0), and an elbow whose spring is at rest where they are stretched.
"""


def chain(changed: dict[str, Any] | None = None, **parameters: object) -> Poses:
    values = {"l0": "1/2", "M": 0, "N": 0, "W": 0} | parameters
    return ptmcad.solve(model=ptmcad.Mechanism({**CHAIN, **(changed or {})}), **values)


def nearly(number: Enclosure, value: Fraction | int) -> bool:
    """Whether a number is proved to be a value but for 1e-12."""
    return abs(number.low - value) < Fraction(1, 10**12) > abs(number.high - value)


def folded(poses: Poses) -> list[Pose]:
    """Those whose second angle is about the first one and half a turn."""
    turned = [(float(pose.angles[1]) - float(pose.angles[0])) / pi % 2 for pose in poses.equilibria]
    return [pose for pose, t in zip(poses.equilibria, turned, strict=True) if abs(t - 1) < 1e-6]


@pytest.mark.parametrize("moment", [0, "1/7"])
@pytest.mark.slow_cases("0")
def test_a_chain_folded_onto_its_pivot_ends_there(moment: object) -> None:
    """Q is the pivot whatever the angle is; and the forces on Q, (5 - 1/2) (3, 4)/5 + 2 (sqrt
    5 - 1/2) (-1, 2)/sqrt 5, turn the first bar with the moment against the one given, and the
    second one the other way.
    """
    found = folded(chain(M=moment, N=f"-{moment}"))
    assert len(found) == 2
    gx, gy = 2.7 - 2 * (1 - 0.5 / sqrt(5)), 3.6 + 4 * (1 - 0.5 / sqrt(5))
    for pose in found:
        assert all(nearly(c, 0) for c in pose.nodes["Q"])
        assert nearly(pose.springs[0].length, 5) and nearly(pose.springs[0].force, Fraction(9, 2))
        assert nearly(pose.torsion[0].moment, 0) and nearly(pose.torsion[0].degrees, 180)
        assert pose.angles[0].exact is None
        c, s = (float(number) for number in pose.cosines_sines[:2])
        assert gy * c - gx * s == pytest.approx(-float(Fraction(moment)) if moment else 0, abs=1e-6)


@pytest.mark.parametrize(
    "change",
    [
        {"W": "1e-70"},
        {"M": "1e-70"},
        {"springs": [*CHAIN["springs"], {"between": ["A", "P"], "k": "1e-70", "free": 1}]},
        # the load takes off all of the spring's energy but its free length's part
        {
            "springs": [*CHAIN["springs"], {"between": ["C", "P"], "k": "1e-70", "free": 1}],
            "W": "-5e-70",
        },
        {"torsion": [{"angle": "th1 - pi/2", "k": "1e-70"}]},
    ],
)
@pytest.mark.fast_cases("change0", "change4")
def test_a_chain_that_is_nearly_folded_is_not_taken_for_one_that_is(change: dict[str, Any]) -> None:
    """The end is told from the pivot, however near it is."""
    parts = {name: value for name, value in change.items() if name in CHAIN}
    poses = chain(parts, **{name: value for name, value in change.items() if name not in CHAIN})
    found = folded(poses)
    assert len(found) == 2
    for pose in found:
        assert all(c.exact is None and 0 < abs(float(c)) < 1e-60 for c in pose.nodes["Q"])


def test_a_second_angle_that_is_the_negative_of_the_first() -> None:
    """Between A and B, on one line with the pivot, 3 - x - 1/2 = 2 (x - 1 - 1/2) at x = 11/6: bent
    to either side.
    """
    level = {"points": {**CHAIN["points"], "A": [3, 0], "B": [1, 0]}, "torsion": []}
    bent = [
        pose for pose in chain(level).equilibria if abs(float(pose.nodes["Q"][0]) - 11 / 6) < 1e-6
    ]
    assert [nearly(pose.nodes["Q"][1], 0) for pose in bent] == [True, True]
    assert [float(pose.cosines_sines[0]) for pose in bent] == pytest.approx([11 / 12] * 2)


def sliders(free: object, load: object) -> Poses:
    """Two on the line y = x, one held by its spring to A, the other one to the mirror image of A."""
    model = {
        "parameters": {"W": {"kind": "force"}},
        "unknowns": {"s": "length", "t": "length"},
        "points": {
            "O": [0, 0],
            "A": [2, 0],
            "B": [0, 2],
            "G": ["s", "s"],
            "H": ["t", "t"],
            "Z": ["s - t", "s + t"],
        },
        "springs": [
            {"between": ["A", "G"], "k": 1, "free": "1/3"},
            {"between": ["B", "H"], "k": 1, "free": "1/3"},
            {"between": ["O", "G"], "k": 1, "free": "1/3"},
            {"between": ["O", "H"], "k": 1, "free": free},
        ],
        "loads": {"H": ["W", 0]},
    }
    return ptmcad.solve(model=ptmcad.Mechanism(model), W=load)


def test_sliders_that_are_at_the_same_height_because_of_the_same_forces() -> None:
    (pose,) = sliders("1/3", 0).equilibria
    x = float(pose.reals[0])
    length = sqrt((x - 2) ** 2 + x**2)
    # half of each spring's slope
    assert (1 - 1 / 3 / length) * (x - 1) + (x - 1 / 3 / sqrt(2) / 1) == pytest.approx(0, abs=1e-5)
    assert nearly(pose.nodes["Z"][0], 0) and not nearly(pose.nodes["Z"][1], 0)


@pytest.mark.parametrize(
    ("free", "load"), [("1/3", "1e-70"), (Fraction(1, 3) + Fraction(1, 10**70), 0)]
)
def test_sliders_that_are_nearly_at_the_same_height(free: object, load: object) -> None:
    """The spring along the line is a push on one side of it, with an irrational direction."""
    (pose,) = sliders(str(free), load).equilibria
    assert pose.nodes["Z"][0].exact is None
    assert 0 < abs(float(pose.nodes["Z"][0])) < 1e-60
