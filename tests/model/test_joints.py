"""Where torsion springs are: the point at which the parts meet that a spring's angle is between, or
none.
"""

from __future__ import annotations

from math import cos, hypot, sin
from typing import Any

import pytest
import yaml

from ptmcad.cli.mechanisms import description
from ptmcad.errors import ConfigError
from ptmcad.model import Mechanism, described, joints, ptm
from ptmcad.model.builtinmechanisms import RECORD
from ptmcad.model.joints import Joint, joints_of
from ptmcad.show.linedrawing import approximate_text
from ptmcad.show.render import draw_mechanism
from ptmcad.show.spiral import spiral, spirals

SEAT: dict[str, Any] = yaml.safe_load("""
parameters: {L: {kind: length}, W: {kind: force}}
unknowns: {th: angle, phi: angle}
points: {O: [0, 0], P: [L*sin(th), L*cos(th)]}
bodies: {seat: {at: P, angle: phi - th + pi/2, points: {Q: [L, 0], R: [1/2, L^2]}}}
bars: [[O, P], [Q, R]]
loads: {R: {weight: W}}
""")
"""The leg's angle is measured from the vertical, clockwise; the seat's direction is phi - th."""
ROCKER: dict[str, Any] = yaml.safe_load("""
unknowns: {th: angle}
points: {O: [0, 0], B: [2, 0], P: [cos(th), sin(th)], Q: [2 + cos(th), sin(th)]}
bars: [[O, P], [B, Q], [P, Q]]
loads: {P: [0, -1]}
""")
CRANK: dict[str, Any] = yaml.safe_load("""
unknowns: {th: angle, x: length}
points: {S: [x, 0], A: [1, 0], P: [x + cos(th), sin(th)]}
bars: [[S, P]]
springs: [{between: [A, S], k: 1}]
""")

PAPER: dict[str, Any] = {
    key: value for key, value in RECORD.items() if key not in ("name", "symmetries")
}


def with_torsion(record: dict[str, Any], *springs: dict[str, Any]) -> Mechanism:
    return described({**record, "torsion": [{"k": 1, **spring} for spring in springs]})


@pytest.mark.parametrize(
    ("record", "angle", "joint"),
    [
        (SEAT, "th", Joint("O", "P")),
        (SEAT, "pi/2 - th", Joint("O", "P")),
        (SEAT, "phi", Joint("P", "Q")),
        (SEAT, "-phi", Joint("P", "Q")),
        (SEAT, "phi - th", None),
        (SEAT, "2*th", None),
        (ROCKER, "th", None),
        (CRANK, "th", None),
        ({**CRANK, "supports": {"S": "slider x"}}, "th", Joint("S", "P")),
        (PAPER, "th2", Joint("A2", "A4")),
        (PAPER, "th1 + th2", None),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_joints_by_hand(record: dict[str, Any], angle: str, joint: Joint | None) -> None:
    """The seat's leg turns clockwise: between it, of -th, and the seat, of phi - th, is phi.

    A parallelogram has its angle at each of its corners, and a crank without a support shows
    nothing that it turns against.
    """
    (found,) = joints_of(with_torsion(record, {"angle": angle}))
    assert found == joint


def test_what_a_description_says_of_the_place_goes_first() -> None:
    m = with_torsion(
        SEAT,
        {"angle": "phi - th", "at": "R"},
        {"angle": "th", "at": "P"},
        {"angle": "2*th"},
        {"angle": "th"},
    )
    assert joints_of(m) == (Joint("R", "Q"), Joint("P", "O"), None, Joint("O", "P"))
    lonely = with_torsion({**ROCKER, "bars": []}, {"angle": "th", "at": "B"})
    assert joints_of(lonely) == (Joint("B"),)


def test_coordinates_that_are_too_large_leave_joints_unknown(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    m = with_torsion(SEAT, {"angle": "th"})
    joints_of.cache_clear()
    monkeypatch.setattr(joints, "MAX_WORK", 5)
    assert joints_of(m) == (None,)
    joints_of.cache_clear()


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("Z", "torsion.1.at: there is no point 'Z'"),
        ([1, 0], "torsion.1.at: a list is no point's name"),
    ],
)
def test_a_place_that_is_no_point_is_refused(place: object, message: str) -> None:
    with pytest.raises(ConfigError, match=message.replace(".", r"\.")):
        with_torsion(SEAT, {"angle": "th", "at": place})


def test_names_tell_springs_apart() -> None:
    """An angle's quarter turns are no part of its name, and no spring is lost where two have one
    angle.
    """
    m = with_torsion(
        SEAT,
        {"angle": "phi - 2*th"},
        {"angle": "th + pi/2"},
        {"angle": "th"},
        {"angle": "th + th - th"},
    )
    assert [spring.name for spring in m.torsion] == ["phi-2*th", "th", "th#3", "th#4"]


def test_a_spiral_ends_on_the_arm() -> None:
    line = spiral((1.0, 2.0), (1.0, 5.0), 0.5, 1.5)
    assert hypot(line[0][0] - 1, line[0][1] - 2) == pytest.approx(0.5)
    assert line[-1] == pytest.approx((1.0, 3.5))
    places = {"O": (0.0, 0.0), "P": (cos(1.0), sin(1.0))}
    found = spirals((Joint("O", "P"), None, Joint("O", "P")), places, 0.1, 0.3, 0.1)
    assert [*found] == [1, 3]
    inner, outer = found.values()
    assert inner[-1] == pytest.approx((0.3 * cos(1), 0.3 * sin(1)))
    assert hypot(*outer[0]) == pytest.approx(0.4), "beyond the first one, with a gap"


def test_line_drawings_show_torsion_springs() -> None:
    m = with_torsion(SEAT, {"angle": "th"}, {"angle": "2*th"})
    text = approximate_text(m)
    assert text.count("@") == 1 and "oP" in text
    assert "@ those with torsion springs" in description(m)
    drawn = {str(artist.get_gid()) for artist in draw_mechanism(m).findobj()}
    assert "torsion-1" in drawn and sum(gid.startswith("bar-") for gid in drawn) == len(m.bars)
    assert "@" not in description(ptm())
