"""Quarter turns added to angles are worked out exactly, wherever angles stand; other fixed angles
are refused.
"""

from __future__ import annotations

from typing import Any

import pytest

import ptmcad
from ptmcad.errors import ConfigError
from ptmcad.model import described, described_system
from ptmcad.model.evaluate import evaluate
from ptmcad.model.identities import PolynomialRing
from ptmcad.model.trees import split_angle
from ptmcad.text.syntax import parse
from ptmcad.text.tree import to_text


def plate(angle: str, corner: list[object], torsion: dict[str, object]) -> dict[str, Any]:
    return {
        "parameters": {"W": {"kind": "force"}, "k": {"kind": "stiffness", "default": 1}},
        "unknowns": {"th": "angle", "phi": "angle"},
        "points": {"A": [2, 1], "P": ["sin(th)", "cos(th)"]},
        "bodies": {"plate": {"at": "P", "angle": angle, "points": {"Q": corner, "R": [0, 0]}}},
        "springs": [{"between": ["A", "Q"], "k": "k"}],
        "torsion": [torsion],
        "loads": {"P": {"weight": "W"}},
    }


TURNED = [
    ("phi + pi/2", [0, 1]), ("phi - pi/2", [0, -1]), ("phi + pi", [-1, 0]), ("pi + phi + pi/2", [0, -1]),
    ("phi - 3*pi/2", [0, 1]), ("phi + 2*pi", [1, 0]), ("(2*phi + pi)/2", [0, 1]),
]  # fmt: skip


@pytest.mark.parametrize(("angle", "corner"), TURNED, ids=[angle for angle, _ in TURNED])
def test_a_turned_body_is_the_one_with_turned_points(angle: str, corner: list[object]) -> None:
    one, other = (
        described(plate(*given, {"angle": "phi", "k": 1})) for given in ((angle, [1, 0]), ("phi", corner))
    )  # fmt: skip
    ring = PolynomialRing()
    for name in ("Q", "R"):
        for a, b in zip(one.points[name], other.points[name], strict=True):
            assert evaluate(a, ring).terms == evaluate(b, ring).terms


def test_a_turn_of_a_torsion_springs_angle_is_one_of_its_rest() -> None:
    for angle, rest in (
        ("phi - th + pi/2", "-pi/2"),
        ("phi - th - pi/2", "pi/2"),
        ("phi - th + 3*pi", "pi"),
    ):
        one, other = (
            described(plate("phi", [1, 0], {"angle": a, "k": 1, "rest": r})).torsion[0]
            for a, r in ((angle, 0), ("phi - th", rest))
        )
        assert one.rest == other.rest
        assert (
            evaluate(one.energy, PolynomialRing()).terms
            == evaluate(other.energy, PolynomialRing()).terms
        )


def test_points_and_equations_have_them_too() -> None:
    ring = PolynomialRing()
    record = plate("phi", [1, 0], {"angle": "phi", "k": 1})
    record["points"]["P"] = ["-cos(th + pi/2)", "sin(pi/2 - th)^2 + 2*cos(2*th - th - pi)"]
    x, y = (evaluate(tree, ring) for tree in described(record).points["P"])
    assert x.terms == evaluate(parse("sin(th)"), ring).terms
    assert y.terms == evaluate(parse("cos(th)^2 - 2*cos(th)"), ring).terms
    system = described_system({"unknowns": {"x": "angle"}, "equations": ["a*sin(x + pi/2) + b"]})
    assert tuple(system.parameters) == ("a", "b")
    assert evaluate(system.equations[0], ring).terms == evaluate(parse("a*cos(x) + b"), ring).terms


def test_the_angle_is_left_as_it_was() -> None:
    for text, varying, turns in (
        ("2*a - b - pi/2", "2*a - b", 3),
        ("pi", "0", 2),
        ("a - b", "a - b", 0),
    ):
        angle, found = split_angle(parse(text))
        assert (to_text(angle), found) == (varying, turns)


@pytest.mark.parametrize("angle", ["phi + pi/3", "phi + 1", "phi + pi/4"])
def test_other_fixed_angles_are_refused_with_a_remedy(angle: str) -> None:
    with pytest.raises(
        ConfigError,
        match=r"bodies\.plate\.angle: only multiples of pi/2 .* turn the points of a body",
    ):
        described(plate(angle, [1, 0], {"angle": "phi", "k": 1}))


def test_maps_of_turned_bodies_agree_and_are_verified() -> None:
    maps = [
        ptmcad.classify({"mechanism": plate(angle, corner, {"angle": turn, "k": "1/4", "rest": rest}),
                         "axes": {"W": [-1, 1], "k": ["1/2", 2]}, "count": "total"})
        for angle, corner, turn, rest in (("phi + pi/2", [1, 0], "phi + pi", 0), ("phi", [0, 1], "phi", "pi"))
    ]  # fmt: skip
    assert [cell.total for cell in maps[0].cells] == [cell.total for cell in maps[1].cells]
    assert [region.area for region in maps[0].regions] == [
        region.area for region in maps[1].regions
    ]
    assert ptmcad.verify(maps[0]).ok
