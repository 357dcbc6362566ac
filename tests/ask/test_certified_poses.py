"""solve and range with free lengths: certified poses, and critical values along a line."""

from __future__ import annotations

import json
from fractions import Fraction as Q
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
import yaml
from click.testing import CliRunner
from support.dense_search import dense_search, derivatives

import ptmcad
from ptmcad import Poses, solve
from ptmcad.answer.poses import Pose
from ptmcad.answer.regionmap import Status
from ptmcad.ask.lines.along import certified_intervals
from ptmcad.cli.range import command
from ptmcad.errors import ConfigError
from ptmcad.question.config import load, slice_from_options
from ptmcad.show.ranges.linetable import table
from ptmcad.show.render.energy import Energy

SCHEMA = json.loads(
    (Path(__file__).resolve().parents[2] / "docs" / "poses.schema.json").read_text(encoding="utf-8")
)
POINTS: list[dict[str, Any]] = [
    {"rho": "7/10", "L2": "3/2", "F3": -10, "F4": -10, "l0": "4/5"},
    {"rho": "7/10", "L2": "3/2", "l0": "1/5"},
    {"rho": "7/10", "L2": 1, "F3": -10, "F4": -10, "l0": "1/5"},
    {"rho": 1, "L2": "3/2", "l0": "1/5"},
    {"rho": 1, "L2": 1, "F3": -10, "l0": "2/5"},
    {
        "rho": "1/3",
        "L2": "6/5",
        "k1": 50,
        "k3": 150,
        "F3": 3,
        "F4x": -7,
        "l0_1": "1/2",
        "l0_3": "3/10",
    },
]


@cache
def solved(number: int) -> Poses:
    return solve(**POINTS[number])


@pytest.mark.parametrize("number", range(len(POINTS)))
@pytest.mark.fast_cases("1", "2")
def test_poses_agree_with_the_energy_written_out_again(number: int) -> None:
    poses = solved(number)
    assert poses.status is Status.CERTIFIED
    values = {name: float(value) for name, value in poses.parameters.items()}
    seen = dense_search(values, 60)
    assert (seen["total"], seen["stable"]) == (len(poses.equilibria), poses.stable)
    assert seen["admissible"] == sum(pose.admissible is True for pose in poses.equilibria)
    energy = Energy(poses.model, poses.parameters)
    for pose in poses.equilibria:
        a, b = (np.array([float(x.center)]) for x in pose.angles)
        g1, g2, h11, h12, h22, lengths = derivatives(values, a, b)
        assert abs(g1[0]) + abs(g2[0]) < 1e-8
        eigenvalues = np.linalg.eigvalsh([[h11[0], h12[0]], [h12[0], h22[0]]])
        assert eigenvalues == pytest.approx([float(x.center) for x in pose.eigenvalues], rel=1e-8)
        assert lengths[:, 0] == pytest.approx(
            [float(s.length.center) for s in pose.springs], abs=1e-9
        )
        assert energy(a, b)[0] == pytest.approx(float(pose.energy.center), abs=1e-9)
        for spring in pose.springs:
            force = spring.stiffness * (spring.length.center - spring.free_length)
            assert float(force) == pytest.approx(float(spring.force.center), abs=1e-7)


@pytest.mark.parametrize("number", range(len(POINTS)))
@pytest.mark.fast_cases("1", "3")
def test_document_and_table(number: int) -> None:
    poses = solved(number)
    text = poses.to_json()
    assert Poses.from_json(text) == poses
    jsonschema.Draft202012Validator(SCHEMA).validate(json.loads(text))
    assert "tense" in poses.table() and "certified" in poses.table()


def numbers(pose: Pose) -> list[Any]:
    springs = [x for s in pose.springs for x in (s.length, s.force)]
    nodes = [x for at in pose.nodes.values() for x in at]
    return [
        *pose.angles,
        *pose.degrees,
        *pose.cosines_sines,
        *nodes,
        *springs,
        pose.energy,
        *pose.eigenvalues,
    ]


def test_many_digits_and_few_agree() -> None:
    few, many = solved(0), solve(digits=150, **POINTS[0])
    for a, b in zip(few.equilibria, many.equilibria, strict=True):
        for x, y in zip(numbers(a), numbers(b), strict=True):
            assert y.settles(150) and x.low <= y.high and y.low <= x.high


def test_flat_poses_are_exact() -> None:
    poses = solved(1)
    flat = [pose for pose in poses.equilibria if pose.flat]
    assert len(flat) == 4
    # at th1 = pi, th2 = 0 spring A3A4 has its free length exactly: no force
    assert any(
        spring.force.low == spring.force.high == 0 for pose in flat for spring in pose.springs
    )
    assert all(pose.energy.low == pose.energy.high for pose in flat)


def test_without_free_lengths_nothing_changes() -> None:
    plain, zero = solve(rho=1, L2="3/2"), solve(rho=1, L2="3/2", l0=0)
    assert plain == zero and plain.status is Status.EXACT
    assert all(pose.admissible is None for pose in plain.equilibria)
    assert (
        "admissible" not in plain.to_json()
        and "l0" not in plain.to_json()
        and "tense" not in plain.table()
    )


def test_infinitely_many_equilibria_are_undecided() -> None:
    poses = solve(rho=0, L2="3/2", l0="1/5")
    assert poses.status is Status.UNDECIDED and not poses.equilibria and poses.remark
    assert poses.remark in " ".join(poses.table().split())
    assert Poses.from_json(poses.to_json()) == poses


def test_a_negative_free_length_is_refused() -> None:
    with pytest.raises(ConfigError, match="l0"):
        solve(rho=1, L2="3/2", l0="-1/5")


# --------------------------------------------------------------------------------------------------------------- range


@pytest.mark.slow
def test_critical_free_lengths_enclosed() -> None:
    """Known: folds at rho = 7/10, L2 = 3/2, f = -1/10 are among the 52 of REFERENCE; counts are
    proved between.
    """
    slice = slice_from_options(
        None, "l0,rho", ("L2=3/2", "F3=-10", "F4=-10"), ("l0=0:1", "rho=0:2")
    )
    found = certified_intervals(slice, "l0", {"rho": "7/10"}, 20)
    assert [change.names[0] for change in found.changes] == [
        "point where spring A3A4 has no length"
    ] * 2 + ["fold"] * 2
    assert all(change.proved and change.at.settles(20) for change in found.changes)
    assert [interval.index for interval in found.intervals] == [
        (2, 3, 1), (2, 4, 1), (2, 5, 1), (3, 6, 1), (3, 7, 2)
    ]  # fmt: skip
    for interval in found.intervals:
        values = {"rho": 0.7, "L2": 1.5, "L1": 1.0, "F3": -0.1, "F4": -0.1, "F3x": 0.0, "F4x": 0.0}
        free = float(interval.sample)
        values |= {
            f"{name}{i}": value for i in (1, 2, 3) for name, value in (("k", 1.0), ("l0_", free))
        }
        assert dense_search(values, 80)["index"] == interval.index
    assert "0.38821735322286586534" in table(found, 20)
    assert table(found, 20).splitlines()[-1].startswith("operation range: ")


def test_the_cone_s_critical_length_by_hand() -> None:
    """It solves A1^2 + A2^2 + 2 A1 A2 c12 = s12^2 l0^2 (REFERENCE) at the triangle rho, L1, L2."""
    slice = slice_from_options(
        None, "l0,rho", ("L2=3/2", "F3=-10", "F4=-10"), ("l0=1/3:1/2", "rho=0:2")
    )
    found = ptmcad.intervals(slice, "l0", {"rho": "7/10"})
    assert found.enclosed and found.decided
    (cone,) = found.changes
    rho, p, q, free = 0.7, 1.0, 1.5, float(cone.at.center)
    c1, c2 = (rho**2 + p**2 - q**2) / (2 * rho * p), (rho**2 + q**2 - p**2) / (2 * rho * q)
    residues = []
    for side in (1, -1):
        s1, s2 = side * (1 - c1**2) ** 0.5, side * (1 - c2**2) ** 0.5
        a1 = (1 - free / q) * rho * s1 + 0.1 * c1
        a2 = (1 - free / p) * rho * s2 + 0.1 * c2
        c12, s12 = c1 * c2 - s1 * s2, s1 * c2 + c1 * s2
        residues.append(a1**2 + a2**2 + 2 * a1 * a2 * c12 - s12**2 * free**2)
    assert min(map(abs, residues)) < 1e-12


SLIDERS = """
mechanism:
  name: two_sliders
  parameters:
    free: {kind: length, default: 1}
    F: {kind: force, range: [-2, 2]}
    G: {kind: force, range: [-2, 2]}
  unknowns: {x: length, y: length}
  points: {O: [0, 0], S: [x, 0], T: [y, 1]}
  supports: {O: pin, S: slider x, T: slider x}
  springs: [{between: [O, S], k: 1}, {between: [O, T], k: 2, free: free}]
  loads: {S: [F, 0], T: [G, 0]}
axes: {F: [-1, 1], G: [-1, 1]}
"""


@pytest.mark.parametrize("force", [Q(1, 2), Q(0)])
def test_a_coordinate_that_interval_arithmetic_knows_exactly(force: Q, tmp_path: Path) -> None:
    (tmp_path / "sliders.yaml").write_text(SLIDERS, encoding="utf-8")
    model = load(tmp_path / "sliders.yaml").model
    (pose,) = solve(model=model, F=force, G="1/4").equilibria
    assert pose.reals[0].exact == force
    assert pose.reals[1].exact is None


@pytest.mark.slow
def test_the_issue_s_line() -> None:
    slice = slice_from_options(
        None, "rho,L2", ("l0=1/5", "F3=-10", "F4=-10"), ("rho=0:4", "L2=0:4")
    )
    found = certified_intervals(slice, "rho", {"L2": "3/2"}, 10)
    stable = [interval.index[0] for interval in found.intervals if interval.index]
    assert stable == [1, 2, 2, 2, 2, 1, 1, 2, 2, 1, 1, 2, 2, 2, 1]


@pytest.mark.slow
def test_range_on_the_command_line(tmp_path: Path) -> None:
    options = [
        "--along",
        "l0",
        "--at",
        "rho=7/10,L2=3/2",
        "--range",
        "l0=1/3:1/2",
        "--set",
        "F3=-10",
    ]
    done = CliRunner().invoke(command, options)
    assert done.exit_code == 0 and "min-saddle-max" in done.output
    followed = CliRunner().invoke(command, [*options, "--path", "2/5"])
    assert followed.exit_code == 0 and "pose 2 at l0 = 0.4: th1 = 67.34006196" in followed.output
    drawn = [*options, "--format", "svg", "--out", str(tmp_path), "--name", "x"]
    assert CliRunner().invoke(command, drawn).exit_code == 0
    assert (tmp_path / "x.svg").exists()


def test_a_free_length_of_zero_beside_one_that_is_a_number() -> None:
    """One angle, two springs: the parameter is zero and the number is not, so that the point tells
    both. The poses are those of a dense look at the energy's slope."""
    mechanism = yaml.safe_load("""
        parameters: {l0: {kind: free length}, F: {kind: force}}
        unknowns: {th: angle}
        points: {A: [2, 0], B: [0, 2], P: [cos(th), sin(th)]}
        springs: [{between: [A, P], k: 1, free: l0}, {between: [B, P], k: 1, free: 1/2}]
        loads: {P: [F, 0]}
    """)
    record = {"name": "two", "mechanism": mechanism, "axes": {"F": [-1, 1], "l0": [0, 1]}}
    poses = solve(record, F="1/3", l0=0)
    assert poses.status is Status.CERTIFIED and poses.parameters["l0"] == 0
    angle = np.linspace(0, 2 * np.pi, 100_001)
    away = np.hypot(np.cos(angle), np.sin(angle) - 2)
    energy = ((np.cos(angle) - 2) ** 2 + np.sin(angle) ** 2 + (away - 0.5) ** 2) / 2 - np.cos(
        angle
    ) / 3
    slope = np.diff(energy)
    minima = np.sum((slope[:-1] < 0) & (slope[1:] >= 0))
    assert len(poses.equilibria) == np.sum((slope[:-1] < 0) != (slope[1:] < 0)) == 2
    assert sum(bool(pose.stable) for pose in poses.equilibria) == minima == 1
    found = min(float(pose.energy.center) for pose in poses.equilibria if pose.energy is not None)
    assert abs(found - energy.min()) < 1e-8
