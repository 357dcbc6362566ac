"""Equilibria of symmetric mechanisms with free lengths: exact numbers of those at rational points,
and enclosures.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
import yaml

import ptmcad
from ptmcad.model import Model
from ptmcad.text.enclosure import Enclosure

PENDULUM: dict[str, Any] = yaml.safe_load("""
parameters: {l0: {kind: free length}, W: {kind: force}}
unknowns: {th: angle}
points: {O: [0, 0], A: [0, 3], P: [sin(th), cos(th)]}
springs: [{between: [A, P], k: 1, free: l0}]
loads: {P: {weight: W}}
""")


def with_anchor(x: object) -> Model:
    return ptmcad.Mechanism({**PENDULUM, "points": {**PENDULUM["points"], "A": [x, 3]}})


def test_an_upright_pendulum_by_hand() -> None:
    """At th = 0 the spring has length 2: E = (2 - 1/2)^2/2 + 1, E'' = 3 - (1/2) 3/2 - 1; at th = pi
    length 4.
    """
    up, down = ptmcad.solve(model=ptmcad.Mechanism(PENDULUM), l0="1/2", W=1).equilibria
    assert (up.energy.exact, up.eigenvalues[0].exact) == (Fraction(17, 8), Fraction(5, 4))
    assert (up.angles[0].exact, up.springs[0].length.exact, up.nodes["P"][0].exact) == (0, 2, 0)
    assert (down.energy.exact, down.eigenvalues[0].exact) == (Fraction(41, 8), Fraction(-13, 8))
    assert (down.degrees[0].exact, down.angles[0].text(8)) == (180, "3.1415927")


def test_a_mechanism_that_is_nearly_symmetric_is_not_taken_for_one_that_is() -> None:
    """Exact zeros are proved: with the anchor beside the axis the equilibrium is beside it too."""
    up = ptmcad.solve(model=with_anchor("1e-12"), l0="1/2", W=1).equilibria[0]
    assert up.angles[0].exact is None
    assert 0 < float(up.angles[0]) < 1e-12


def test_a_pose_that_no_symmetry_explains_is_proved_by_its_gradient() -> None:
    """3-4-5: the spring pulls with 9/2 along (3, 4)/5 at th = 0, and the load takes the part across
    the bar.
    """
    balanced = {**PENDULUM, "points": {**PENDULUM["points"], "A": [3, 5]}, "loads": {"P": ["W", 0]}}
    poses = ptmcad.solve(model=ptmcad.Mechanism(balanced), l0="1/2", W="-27/10")
    (up,) = (pose for pose in poses.equilibria if pose.stable)
    assert (up.angles[0].exact, up.springs[0].force.exact) == (0, Fraction(9, 2))


def test_a_cosine_that_is_a_short_decimal_by_accident_has_digits() -> None:
    """A = (0, 2): E = (r - 1)^2/2 + (2/3) cos th with r^2 = 5 - 4 cos th is flat at r = 3/2, cos
    th = 11/16.
    """
    short = {**PENDULUM, "points": {**PENDULUM["points"], "A": [0, 2]}}
    poses = ptmcad.solve(model=ptmcad.Mechanism(short), digits=8, l0=1, W="2/3")
    bent = [pose for pose in poses.equilibria if pose.stable]
    assert [pose.nodes["P"][1].text(8) for pose in bent] == ["0.68750000"] * 2
    assert [pose.springs[0].length.text(8) for pose in bent] == ["1.5000000"] * 2


def test_poses_are_followed_from_a_symmetric_start() -> None:
    slice = ptmcad.slice_from_mapping({"mechanism": PENDULUM, "axes": {"W": [0, 4], "l0": [0, 1]}})
    paths = ptmcad.pose_paths(slice, "W", {"l0": "1/2"}, 1)
    assert len(paths.paths) == 1


def nearly(number: Enclosure | None, value: Fraction | int) -> bool:
    """Whether a number is proved to be a value but for 1e-12."""
    return number is not None and abs(number.low - value) < Fraction(1, 10**12) > abs(
        number.high - value
    )


def test_a_relaxed_spring_has_nearly_its_free_length() -> None:
    """Without a load |AP|^2 = 10 - 6 cos th = l0^2 at the stable poses, which no symmetry explains."""
    poses = ptmcad.solve(model=ptmcad.Mechanism(PENDULUM), l0="12/5", W=0).equilibria
    assert [pose.stable for pose in poses] == [True, True, False, False]
    for pose in poses[:2]:
        spring = pose.springs[0]
        assert (
            nearly(spring.length, Fraction(12, 5))
            and nearly(spring.force, 0)
            and nearly(pose.energy, 0)
        )
        assert pose.admissible is None, "whether the spring is longer than that is not decided"
        assert float(pose.cosines_sines[0]) == pytest.approx((10 - 2.4**2) / 6)


TRUSS = yaml.safe_load("""
parameters: {a: {kind: length}, b: {kind: length}, f: {kind: force}}
unknowns: {h: length}
points: {A: [-a, 0], B: [b, 0], P: [0, h]}
springs: [{between: [A, P], k: 1, free: 1}, {between: [B, P], k: 1, free: 1}]
loads: {P: [0, f]}
""")
"""Von Mises's truss, where b = a."""


@pytest.mark.parametrize("a", ["3/5", "1/3"])
def test_springs_that_are_relaxed_together_by_the_same_equation(a: str) -> None:
    """Both halves of a symmetric truss without load have length 1 at h^2 = 1 - a^2, one equation
    for one unknown.
    """
    stable, *others = ptmcad.solve(model=ptmcad.Mechanism(TRUSS), a=a, b=a, f=0).equilibria
    assert [pose.stable for pose in others] == [True, False]
    for pose in (stable, others[0]):
        assert all(nearly(spring.length, 1) and nearly(spring.force, 0) for spring in pose.springs)
        assert nearly(pose.energy, 0)
        assert float(pose.reals[0]) ** 2 == pytest.approx(1 - float(Fraction(a)) ** 2)


def test_an_unknown_may_have_the_name_of_a_number() -> None:
    """The truss with its height called energy: at a = 3/5 without load the springs are relaxed at
    4/5.
    """
    points = {"A": ["-a", 0], "B": ["b", 0], "P": [0, "energy"]}
    named = {**TRUSS, "unknowns": {"energy": "length"}, "points": points}
    stable, *_ = ptmcad.solve(model=ptmcad.Mechanism(named), a="3/5", b="3/5", f=0).equilibria
    assert abs(float(stable.reals[0])) == pytest.approx(4 / 5)
    assert nearly(stable.energy, 0)


def test_springs_that_are_relaxed_together_by_symmetry() -> None:
    """A plate between four springs, level where all are relaxed: three equations in two unknowns,
    one where phi = 0.
    """
    plate = {
        "parameters": {"f": {"kind": "force"}},
        "unknowns": {"h": "length", "phi": "angle"},
        "points": {"A": [-2, 0], "B": [2, 0], "P": [0, "h"]},
        "bodies": {
            "plate": {"at": "P", "angle": "phi", "points": {"Q": ["-1/2", 0], "R": ["1/2", 0]}}
        },
        "springs": [
            {"between": pair, "k": 1, "free": free}
            for pair, free in (
                (["A", "Q"], "21/10"),
                (["B", "R"], "21/10"),
                (["A", "R"], "29/10"),
                (["B", "Q"], "29/10"),
            )
        ],
        "loads": {"P": [0, "f"]},
    }
    poses = ptmcad.solve(model=ptmcad.Mechanism(plate), f=0)
    relaxed = [pose for pose in poses.equilibria if nearly(pose.energy, 0)]
    assert len(relaxed) == 2
    for pose in relaxed:
        assert all(
            nearly(s.length, Fraction(n, 10))
            for s, n in zip(pose.springs, (21, 21, 29, 29), strict=True)
        )
        assert float(pose.reals[0]) ** 2 == pytest.approx(2.16)
        assert pose.angles[0].exact == 0


def test_springs_that_are_nearly_relaxed_together_are_not() -> None:
    """With b next to a the springs' equations contradict each other."""
    pose = ptmcad.solve(
        model=ptmcad.Mechanism(TRUSS), a="3/5", b=Fraction(3, 5) + Fraction(1, 10**40), f=0
    ).equilibria[0]
    assert all(0 < abs(float(spring.force)) < 1e-38 for spring in pose.springs)


@pytest.mark.parametrize("digits", [6, 7, 8])
def test_a_number_that_may_be_halfway_between_two_texts_has_one_digit_more(digits: int) -> None:
    """A pendulum's eigenvalue a^2 sin^2/l^2 = 0.99474375, which nothing explains, at seven digits;
    in a file, too.
    """
    pendulum = yaml.safe_load("""
        parameters: {a: {kind: length}, f: {kind: force}}
        unknowns: {th: angle}
        points: {O: [0, 0], A: [a, 0], P: [cos(th), sin(th)]}
        springs: [{between: [A, P], k: 1, free: 2}]
        loads: {P: [0, f]}
    """)
    poses = ptmcad.solve(digits=digits, model=ptmcad.Mechanism(pendulum), a="23/10", f=0)
    (eigenvalue,) = poses.equilibria[0].eigenvalues
    assert eigenvalue.text(digits) == {6: "0.994744", 7: "0.99474375", 8: "0.99474375"}[digits]
    assert ptmcad.Poses.from_json(poses.to_json()).equilibria == poses.equilibria


@pytest.mark.parametrize("change", [{"W": "1e-60"}, {"M": "1e-60"}])
def test_a_spring_that_is_nearly_relaxed_is_not_taken_for_one_that_is(
    change: dict[str, str],
) -> None:
    moved = {
        **PENDULUM,
        "parameters": {**PENDULUM["parameters"], "M": {"kind": "force"}},
        "moments": {"th": "M"},
    }
    at = {"W": "0", "M": "0", **change}
    pose = ptmcad.solve(model=ptmcad.Mechanism(moved), l0="12/5", **at).equilibria[0]
    assert 0 < abs(float(pose.springs[0].force)) < 1e-58
    assert 0 < abs(float(pose.energy)) < 1e-58


LEANING: dict[str, Any] = yaml.safe_load("""
parameters: {l0: {kind: free length}, F: {kind: force}}
unknowns: {th: angle}
points: {O: [0, 0], A: [2, 1], P: [cos(th), sin(th)], Z: [cos(th) - 2*sin(th), 3*cos(th)^2]}
springs: [{between: [A, P], k: 1, free: l0}]
loads: {P: [0, F]}
""")


def test_what_is_zero_by_a_mirror_along_no_axis_is_enclosed() -> None:
    """P is on the line OA, of slope 1/2: cos th = 2 sin th and cos^2 th = 4/5."""
    poses = ptmcad.solve(model=ptmcad.Mechanism(LEANING), l0="1/2", F=0)
    assert all(nearly(pose.nodes["Z"][0], 0) for pose in poses.equilibria)
    assert [pose.nodes["Z"][1].text(8) for pose in poses.equilibria] == ["2.4000000"] * 2
    assert [pose.cosines_sines[0].text(8) for pose in poses.equilibria] == [
        "0.89442719",
        "-0.89442719",
    ]


@pytest.mark.parametrize("load", ["1e-12", "1e-60", "1e-75"])
def test_what_is_nearly_zero_beside_a_slanted_mirror_is_not_told_as_zero(load: str) -> None:
    """Enclosed without zero, however near it is."""
    poses = ptmcad.solve(model=ptmcad.Mechanism(LEANING), l0="1/2", F=load)
    assert all(
        pose.nodes["Z"][0].exact is None and abs(float(pose.nodes["Z"][0])) < 1e-11
        for pose in poses.equilibria
    )


def test_a_number_that_no_proof_tells_from_zero_is_enclosed() -> None:
    """The bent poses of the test of an accident, where cos th = 11/16."""
    points = {**PENDULUM["points"], "A": [0, 2], "Z": ["cos(th) - 11/16", 1]}
    poses = ptmcad.solve(model=ptmcad.Mechanism({**PENDULUM, "points": points}), l0=1, W="2/3")
    bent = [pose for pose in poses.equilibria if abs(abs(float(pose.degrees[0])) - 46.567) < 1e-3]
    assert (poses.status.value, len(bent)) == ("certified", 2)
    assert all(pose.nodes["Z"][0].exact is None and nearly(pose.nodes["Z"][0], 0) for pose in bent)
    assert "|Z x| < 1e-" in poses.table()


LONG = Fraction(333333333333333333333333333340, 10**30 + 1)
"""Thirty digits above and below."""


@pytest.mark.parametrize("load", ["27/10", "2.7" + 140 * "0" + "1"])
def test_a_rational_equilibrium_of_thirty_digits(load: str) -> None:
    """P is (3, 4) from A, where the spring pulls with 9/2: as the load does, but for one in 10^141,
    which is within the ball by which the place is guessed.
    """
    x, y = LONG, 1 / LONG
    bead = {
        "parameters": {"F": {"kind": "force"}},
        "unknowns": {"x": "length", "y": "length"},
        "points": {"A": [str(x - 3), str(y - 4)], "P": ["x", "y"], "Z": [f"x - {x}", f"y - {y}"]},
        "springs": [{"between": ["A", "P"], "k": 1, "free": "1/2"}],
        "loads": {"P": ["F", "18/5"]},
    }
    (pose,) = ptmcad.solve(model=ptmcad.Mechanism(bead), F=load).equilibria
    if load == "27/10":
        assert [z.exact for z in pose.nodes["Z"]] == [0, 0]
        assert (pose.reals[0].exact, pose.springs[0].force.exact) == (x, Fraction(9, 2))
    else:
        assert all(z.exact is None and 0 < abs(float(z)) < 1e-130 for z in pose.nodes["Z"])
