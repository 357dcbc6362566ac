"""What a model says of itself to whatever shows it: names of its solutions, what is drawn, numbers
of a pose.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

import ptmcad
from ptmcad.answer.counts import Counts, operation_number
from ptmcad.answer.words import assignments, followed, noun, sought, untold
from ptmcad.model import Model, ptm
from ptmcad.model.work import loads_at
from ptmcad.question.config import load

CONFIGS = Path(__file__).resolve().parents[2] / "configs"


def model(name: str) -> Model:
    return load(CONFIGS / f"{name}.yaml").model


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        (
            "mechanisms/inverted-pendulum",
            ("stable pose", "stable equilibria", "operation range", 2, True),
        ),
        ("mechanisms/four-bar", ("stable solution", "stable equilibria", "range", 1, False)),
        ("systems/duffing", ("solution", "solutions", "range", 1, False)),
        ("systems/schloegl", ("stable solution", "stable solutions", "range", 1, False)),
    ],
)
def test_words_follow_from_the_model(name: str, expected: tuple[str, str, str, int, bool]) -> None:
    own = model(name)
    least = operation_number(own, [Counts(1, 0, None)])
    assert (
        followed(own),
        sought(own),
        own.nouns.range,
        least,
        own.drawable is not None,
    ) == expected
    assert noun(own, 1) in sought(own, 1)
    assert untold(own) == ""


def test_a_moment_on_another_unknown_leaves_stability_untold() -> None:
    lever = ptmcad.Mechanism(
        parameters={"L": {"kind": "length"}, "k": {"kind": "stiffness"}, "M": {}},
        unknowns={"a": "angle", "b": "angle"},
        points={
            "O": [0, 0],
            "P": ["L*cos(a)", "L*sin(a)"],
            "Q": ["L*cos(a) + L*cos(b)", "L*sin(a) + L*sin(b)"],
        },
        bars=[["O", "P"], ["P", "Q"]],
        springs=[{"between": ["O", "Q"], "k": "k"}],
        moments={"a": "M*cos(b)"},
    )
    assert untold(lever) == "nothing says which are stable, as a moment depends on another unknown"
    assert followed(lever) == "pose"


def test_parameters_have_the_units_of_what_they_measure() -> None:
    own = ptm()
    assert own.unit_of("L1") == ("length",)
    assert own.unit_of("k") == own.unit_of("k1") == ("force", "/", "length")
    assert own.unit_of("F3") == ("force",)
    assert own.unit_of("l0") == own.unit_of("unknown") == ()
    assert own.energy_unit == ("force", "·", "length")
    assert model("systems/duffing").energy_unit == ()


def test_loads_have_their_points_and_names() -> None:
    values = {"L1": Fraction(1), "F3": Fraction(-10)}
    found = loads_at(ptm(), values)
    assert [load.point for load, _ in found] == list(ptm().loaded) == ["A3", "A4"]
    load, force = found[0]
    assert dict(zip(load.names, force, strict=True))["F3"] == -10
    assert all(force == (0, 0) for _, force in found[1:])  # what has no value is zero


def test_numbers_of_a_pose_by_name_are_those_of_its_fields() -> None:
    poses = ptmcad.solve(rho="7/10", L2="3/2", F3="-10", F4="-10")
    assert poses.in_order == poses.equilibria
    assert poses.working == poses.equilibria[: poses.stable]
    for pose in poses.equilibria:
        unknowns, nodes, springs, torsion = pose.quantities(poses.model)
        assert [q[:2] for q in unknowns] == [
            ("th1", "rad"),
            ("th2", "rad"),
            ("th1", "deg"),
            ("th2", "deg"),
        ]
        assert [value for _, _, value in unknowns] == [*pose.angles, *pose.degrees]
        assert {name: value for name, _, value in nodes} == {
            f"{name} {axis}": x
            for name in poses.model.moving
            for axis, x in zip("xy", pose.nodes[name], strict=True)
        }  # type: ignore[attr-defined]
        assert [value for _, _, value in springs] == [s.length for s in pose.springs] + [
            s.force for s in pose.springs
        ]
        assert torsion == ()
    texts = assignments(poses.model, ["1°", "2°"], [], lambda name: name.upper())
    assert texts == ["TH1 = 1°", "TH2 = 2°"]
