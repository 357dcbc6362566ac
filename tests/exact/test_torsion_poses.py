"""Torsion springs in poses: deflections and moments by hand, by both engines, and in documents and
tables.
"""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from flint import arb, ctx

from ptmcad import Poses, solve
from ptmcad.answer.poses import Pose
from ptmcad.answer.regionmap import Status
from ptmcad.certified.plain.certifiedposes import plain_poses
from ptmcad.exact.exactposes import exact_poses
from ptmcad.model import Mechanism, described
from ptmcad.model.evaluate import multiples
from ptmcad.text.balls import ball_of

SCHEMA = json.loads(
    (Path(__file__).resolve().parents[2] / "docs" / "poses.schema.json").read_text(encoding="utf-8")
)
PENDULUM: dict[str, Any] = yaml.safe_load("""
parameters: {W: {kind: force}, c: {kind: stiffness, default: 2}}
unknowns: {th: angle}
points: {O: [0, 0], P: [cos(th), sin(th)]}
bars: [[O, P]]
torsion: [{angle: th, k: c}]
loads: {P: {weight: W}}
""")
"""c sin(th) + W cos(th) = 0: the weight W turns the bar down, the spring back up to th = 0."""
CHAIN: dict[str, Any] = yaml.safe_load("""
parameters: {l0: {kind: free length}, W: {kind: force}}
unknowns: {th: angle, phi: angle}
points:
  O: [0, 0]
  A: [8/5, 4/5]
  P: [cos(th), sin(th)]
  Q: [cos(th) + cos(phi), sin(th) + sin(phi)]
bars: [[O, P], [P, Q]]
springs: [{between: [A, Q], k: 3, free: l0}]
torsion: [{angle: th, k: 2, rest: {cos: 3/5, sin: 4/5}}, {angle: phi - 2*th - pi/2, k: 1/3}]
loads: {Q: [W, -W]}
""")


def with_torsion(record: dict[str, Any], *springs: dict[str, Any]) -> Mechanism:
    return described({**record, "torsion": list(springs)})


def turned(pose: Pose) -> list[tuple[str, str, str]]:
    return [(t.deflection.text(8), t.degrees.text(8), t.moment.text(8)) for t in pose.torsion]


def test_a_bar_that_hangs_on_a_torsion_spring_by_hand() -> None:
    """tan th = -W/c, so that (cos, sin) = (4, -3)/5 for W = 3/2: the moment is 2 (-3/5), the
    weight's 3/2 4/5.
    """
    held, fallen = solve(model=described(PENDULUM), W="3/2").equilibria
    (spring,) = held.torsion
    assert (spring.name, spring.stiffness, spring.moment.exact) == ("th", 2, Fraction(-6, 5))
    assert (spring.deflection.text(10), spring.degrees.text(10)) == (
        "-0.6435011088",
        "-36.86989765",
    )
    assert fallen.torsion[0].moment.exact == Fraction(6, 5)
    assert fallen.torsion[0].degrees.text(10) == "143.1301024"


BENT = ("-0.78539816", "-45", "-1.4142136")


@pytest.mark.parametrize(
    ("further", "expected"),
    [
        ([], []),
        ([{"angle": "4*th", "k": 1, "rest": "pi"}], [("0", "0", "0")]),
        ([{"angle": "4*th", "k": 1}], [("3.1415927", "180", "0")]),
    ],
    ids=["one", "at rest", "half a turn off"],
)
@pytest.mark.parametrize(
    "first",
    [{"angle": "th", "k": 2}, {"angle": "th + pi/2", "k": 2, "rest": "pi/2"}],
    ids=["", "quarter turns"],
)
def test_rational_degrees_and_rests_are_told_exactly(
    first: dict[str, Any], further: list[dict[str, Any]], expected: list[tuple[str, str, str]]
) -> None:
    """W = c: th = -45 degrees is an equilibrium; what is added there has no moment at it."""
    poses = solve(model=with_torsion(PENDULUM, first, *further), W=2).equilibria
    (pose,) = (p for p in poses if p.degrees[0].exact == -45)
    assert turned(pose) == [BENT, *expected]
    for spring in pose.torsion:
        assert spring.degrees.exact is not None
        assert (spring.deflection.exact == 0) == (spring.degrees.exact == 0)


def recomputed(poses: Poses, pose: Pose, bits: int = 400) -> list[tuple[arb, arb]]:
    """Deflection and moment of each torsion spring, from the pose's angles alone."""
    model = poses.model
    assert isinstance(model, Mechanism)
    found = []
    angles = dict(zip(model.angles, pose.angles, strict=True))
    with ctx.workprec(bits):
        for spring, torsion in zip(pose.torsion, model.torsion, strict=True):
            total = -arb.atan2(ball_of(torsion.rest[1]), ball_of(torsion.rest[0]))
            for name, m in multiples(torsion.angle).items():
                total += ball_of(m) * arb(
                    ball_of(angles[name].center), ball_of(angles[name].radius)
                )
            turns = round(float(total / (2 * arb.pi())))
            total -= 2 * arb.pi() * turns
            found.append((total, ball_of(spring.stiffness) * total.sin()))
    return found


@pytest.mark.parametrize("digits", [6, 40])
@pytest.mark.parametrize("l0", ["0", "1/3"], ids=["exact", "certified"])
@pytest.mark.slow_cases("certified-6", "certified-40")
def test_every_digit_is_that_of_the_angles(l0: str, digits: int) -> None:
    poses = solve(model=described(CHAIN), l0=l0, W="1/7", digits=digits)
    assert poses.status is (Status.EXACT if l0 == "0" else Status.CERTIFIED)
    assert len(poses.equilibria) >= 4
    precise = solve(model=described(CHAIN), l0=l0, W="1/7", digits=60)
    for pose, fine in zip(poses.equilibria, precise.equilibria, strict=True):
        for spring, (angle, moment) in zip(pose.torsion, recomputed(precise, fine), strict=True):
            with ctx.workprec(400):
                degrees = angle * 180 / arb.pi()
                for number, ball in (
                    (spring.deflection, angle),
                    (spring.degrees, degrees),
                    (spring.moment, moment),
                ):
                    printed = ball_of(Fraction(number.text(digits)))
                    assert abs(printed - ball) < abs(ball) * arb(10) ** (1 - digits) / 2
                    assert ball_of(number.low) <= ball.upper() and ball.lower() <= ball_of(
                        number.high
                    )


def test_both_engines_agree() -> None:
    """On springs of free length zero, which the certified engine takes as well."""
    model = described(CHAIN)
    at = {"W": Fraction(1, 7)}
    exact, certified = exact_poses(model, at, 10), plain_poses(model, {**at, "l0": Fraction(0)}, 10)
    assert [p.index for p in exact.equilibria] == [p.index for p in certified.equilibria]
    assert [turned(p) for p in exact.equilibria] == [turned(p) for p in certified.equilibria]


def test_a_symmetric_pose_has_exact_deflections_in_the_certified_engine() -> None:
    """Upright under its spring: at rest, a quarter, half a turn off, and by the angle whose cosine
    is 3/5.
    """
    rests: list[Any] = ["pi/2", 0, "-pi/2", "pi", {"cos": "3/5", "sin": "4/5"}]
    balanced = [
        {"angle": "th", "k": 1, "rest": rest} for rest in (*rests, {"cos": "-3/5", "sin": "4/5"})
    ]
    model = described({
        **PENDULUM,
        "parameters": {"l0": {"kind": "free length"}},
        "points": {**PENDULUM["points"], "A": [0, 3]},
        "springs": [{"between": ["A", "P"], "k": 1, "free": "l0"}],
        "torsion": balanced,
        "loads": {},
    })  # fmt: skip
    up = solve(model=model, l0="1/2").equilibria[0]
    assert up.degrees[0].exact == 90
    assert turned(up) == [
        ("0", "0", "0"), ("1.5707963", "90", "1"), ("3.1415927", "180", "0"), ("-1.5707963", "-90", "-1"),
        ("0.64350111", "36.869898", "0.6"), ("-0.64350111", "-36.869898", "-0.6"),
    ]  # fmt: skip
    assert up.torsion[4].moment.exact == Fraction(3, 5)


def test_relaxed_torsion_springs_have_hardly_a_moment() -> None:
    """P at rest is (3, 4)/5, A = P + (13, -3)/10: Q is 1 from A, and the energy 0, at
    atan(-3/13) +- acos(|PA|/2).
    """
    rest = {"cos": "3/5", "sin": "4/5"}
    placed = {**CHAIN, "points": {**CHAIN["points"], "A": ["19/10", "1/2"]}}
    model = with_torsion(placed, {"angle": "th", "k": 2, "rest": rest})
    tiny = Fraction(1, 10**100)
    relaxed = [
        p for p in solve(model=model, l0=1, W=0).equilibria if abs(p.springs[0].force.high) < tiny
    ]
    assert sorted(p.degrees[1].text(6) for p in relaxed) == ["-61.1523", "35.1630"]
    for pose in relaxed:
        bent = pose.torsion[0]
        assert all(
            number.low <= 0 <= number.high < tiny
            for number in (bent.deflection, bent.degrees, bent.moment)
        )


REST = {"cos": "3/5", "sin": "4/5"}


def test_a_mechanism_that_is_nearly_at_rest_is_not_taken_for_one_that_is() -> None:
    """A load of 1e-90 turns the bar by as much as a stiffness of 2 + 2 2/3 lets it, which balls of
    224 bits miss.
    """
    record = {
        **PENDULUM,
        "parameters": {"l0": {"kind": "free length"}, "W": {"kind": "force"}},
        "points": {**PENDULUM["points"], "A": ["6/5", "8/5"]},
        "springs": [{"between": ["A", "P"], "k": 1, "free": "l0"}],
        "loads": {"P": ["W", 0]},
    }
    poses = solve(
        model=with_torsion(record, {"angle": "th", "k": 2, "rest": REST}), l0="1/3", W="1e-90"
    )
    (spring,) = next(pose for pose in poses.equilibria if pose.stable).torsion
    # by the law of cosines |AP|^2 = 5 - 4 cos(deflection), so that |AP|'' = 2 where the spring
    # pulls with 2/3
    assert float(spring.deflection.center * 10**90) == pytest.approx(-0.8 / (2 + 4 / 3))
    assert spring.moment.exact is None


def test_documents_tell_what_torsion_springs_do_and_are_read_back() -> None:
    poses = solve(model=described(CHAIN), l0=0, W="1/7")
    text = poses.to_json()
    jsonschema.validate(json.loads(text), SCHEMA)
    again = Poses.from_json(text)
    assert again == poses and again.to_json() == text
    entries = json.loads(text)["equilibria"][0]["torsion"]
    assert [list(entry) for entry in entries] == [
        ["name", "stiffness", "deflection", "degrees", "moment"]
    ] * 2
    assert [entry["name"] for entry in entries] == ["th", "phi-2*th"]
