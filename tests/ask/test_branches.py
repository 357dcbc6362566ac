"""Bifurcation diagrams: all solutions along a line, by quantities, joined to branches."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import ptmcad
from ptmcad.answer.paths import Branch, Branches
from ptmcad.ask.lines.diagram import SolutionsOnLine, branch_diagram
from ptmcad.ask.quantities import OPTION, of_pose, quantities, quantity
from ptmcad.cli import run
from ptmcad.errors import ConfigError
from ptmcad.question.config import load
from ptmcad.question.line import line_of
from ptmcad.question.slice import Slice
from ptmcad.show.ranges.pathtable import kind
from ptmcad.workbench.fields import fieldvalues as fields
from ptmcad.workbench.fields.fieldvalues import quantity_of

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
FIG4 = str(CONFIGS / "fig4.yaml")


def numbers(branch: Branch, k: int) -> list[float]:
    found = [point.numbers[k] for point in branch.points]
    assert all(number is not None for number in found)
    return [float(number) for number in found if number is not None]


def diagram(slice: Slice, along: str, at: dict[str, Any], names: Sequence[str]) -> Branches:
    line = line_of(slice, along, at, free=True)
    return branch_diagram(slice, SolutionsOnLine(line), names)


@pytest.fixture(scope="module")
def fig4() -> Branches:
    names = ("th1", "energy", "stiffness", "force:A1A4", "length:A1A4", "y:A3")
    return diagram(load(FIG4), "rho", {"L2": "3/2"}, names)


@pytest.mark.slow
def test_each_point_is_what_solve_says(fig4: Branches) -> None:
    for branch in fig4.branches[::3]:
        point = branch.points[7]
        poses = ptmcad.solve(digits=6, rho=point.value, L2="3/2", F3=-10, F4=-10)
        (pose,) = [p for p in poses.equilibria if p.degrees[0] == point.numbers[0]]
        assert (pose.stable, pose.index) == (branch.stable, branch.index)
        spring = pose.springs[0]
        told = (pose.energy, pose.eigenvalues[0], spring.force, spring.length, pose.nodes["A3"][1])
        assert point.numbers[1:] == told


def test_branches_are_smooth_and_meet_at_the_folds(fig4: Branches) -> None:
    """A stable branch and a saddle have nearly the same energy at a fold, and no eigenvalue to
    speak of.
    """
    for branch in fig4.branches:
        energies, places = numbers(branch, 1), [float(p.value) for p in branch.points]
        steps = [
            abs((b - a) / (y - x))
            for a, b, x, y in zip(energies, energies[1:], places, places[1:], strict=False)
        ]
        assert max(steps) < 1500
    middle = [b for b in fig4.branches if 0.49 < float(b.points[0].value) < 0.5]
    for end in (0, -1):
        near = [b for b in middle if abs(numbers(b, 2)[end]) < 1]
        assert sorted(kind(b, fig4.model) for b in near) == ["saddle", "stable"]
        assert abs(numbers(near[0], 1)[end] - numbers(near[1], 1)[end]) < 1e-3


def test_the_cubic() -> None:
    """x^3 - a x + 1/2 has one solution, or three where 4 a^3 > 27/4."""
    found = diagram(load(CONFIGS / "systems" / "cubic.yaml"), "a", {"b": Fraction(1, 2)}, ["x"])
    fold = (27 / 16) ** (1 / 3)
    assert [len(found.branches), sum(float(b.points[-1].value) < fold for b in found.branches)] == [
        4,
        1,
    ]
    for branch in found.branches:
        for point in branch.points:
            x, a = numbers(Branch(None, None, (point,)), 0)[0], float(point.value)
            assert abs(x**3 - a * x + 0.5) < 1e-4


def test_quantities_that_there_are_not() -> None:
    model = load(FIG4).model
    # each spring by its own name, too, as `ptmcad map` has it
    assert len(quantities(model)) == 20
    with pytest.raises(ConfigError, match="did you mean 'energy'"):
        quantity(model, "enrgy")
    with pytest.raises(ConfigError, match="there are x"):
        quantity(load(CONFIGS / "systems" / "cubic.yaml").model, "energy")


COMMANDS = [
    (lambda slice, text: quantity(slice.model, text), OPTION),
    (lambda slice, text: quantity_of(text, slice), fields.OPTION),
]


@pytest.mark.parametrize(("read", "key"), COMMANDS)
def test_both_commands_take_the_same_names(read: Callable[[Slice, str], Any], key: str) -> None:
    slice = load(FIG4)
    for name, known in quantities(slice.model).items():
        found = read(slice, name)
        if (
            name not in slice.model.angles or key == OPTION
        ):  # by itself an angle is an expression, in radians
            assert (found.name, found.unit) == (name, known.unit)
    for text, name, unit in [("angle:th2", "angle:th2", "degrees"), (" force : k1 ", "force:k1", "force"),
                             ("x:A1", "x:A1", "length"), ("stiffness ", "stiffness", "force × length")]:  # fmt: skip
        found = read(slice, text)
        assert (found.name, found.unit) == (name, unit)


@pytest.mark.parametrize(("read", "key"), COMMANDS)
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("enrgy", "did you mean 'energy'"),
        ("torque:k1", "'torque' is not among force, length, angle, x and y"),
        ("force:k4", "ptm has no spring 'k4': they are A1A4, A2A3, A3A4, k1"),
        ("length:zzz", "ptm has no spring 'zzz': they are A1A4, A2A3, A3A4, k1, k2, k3"),
        ("angle:rho", "ptm has no unknown angle 'rho': they are th1, th2"),
        ("y:A9", "ptm has no point 'A9': they are A1, A2"),
    ],
)
def test_both_commands_refuse_a_name_alike(
    read: Callable[[Slice, str], Any], key: str, text: str, message: str
) -> None:
    with pytest.raises(ConfigError, match=message) as caught:
        read(load(FIG4), text)
    assert caught.value.key == key


@pytest.mark.parametrize("read", [read for read, _ in COMMANDS])
def test_both_commands_say_that_there_is_no_energy(read: Callable[[Slice, str], Any]) -> None:
    with pytest.raises(ConfigError, match=r"solutions of cubic have no energy; there are x$"):
        read(load(CONFIGS / "systems" / "cubic.yaml"), "stiffness")


def test_a_barrier_is_no_number_of_a_pose() -> None:
    with pytest.raises(ConfigError, match="`ptmcad map --value barrier` has it"):
        quantity(load(FIG4).model, "barrier")


def test_numbers_of_a_pose() -> None:
    model = load(FIG4).model
    pose = ptmcad.solve(rho="7/10", L2="3/2", F3=-10).equilibria[0]
    of = {text: of_pose(quantity(model, text), pose) for text in (*quantities(model), "angle:th2")}
    assert of["force:k2"] == of["force:A2A3"] == pose.springs[1].force
    assert of["length:k3"] == of["length:A3A4"] == pose.springs[2].length
    assert (of["th1"], of["th2"]) == pose.degrees and of["angle:th2"] == of["th2"]
    assert (of["x:A4"], of["y:A4"]) == pose.nodes["A4"]
    assert (of["energy"], of["stiffness"]) == (pose.energy, pose.eigenvalues[0])


@pytest.mark.usefixtures("coarse")
def test_from_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    common = ["range", FIG4, "--along", "rho"]
    asked = [
        "--quantity",
        "th1",
        "--quantity",
        "energy",
        "--quantity",
        "th1",
        "--format",
        "json,svg",
    ]
    assert run([*common, "--at", "L2=3/2", *asked, "--out", str(tmp_path), "--name", "x"]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"x.json", "x.svg", "x-branches.svg"}
    data = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))
    schema = json.loads((CONFIGS.parent / "docs" / "range.schema.json").read_text(encoding="utf-8"))
    jsonschema.validate(data, schema, cls=jsonschema.Draft202012Validator)
    assert (
        data["branches"]["quantities"] == ["th1", "energy"]
        and len(data["branches"]["branches"]) == 14
    )
    picture = (tmp_path / "x-branches.svg").read_text(encoding="utf-8")
    assert "th1, energy of all solutions along rho: stable, saddle, maximum." in picture
    out = capsys.readouterr().out
    assert (
        "\nfrom         to        kind     th1 (degrees)          energy (force × length)\n" in out
    )
    assert run([*common, "--over", "L2", "--quantity", "th1"]) == 2
    assert "error: --quantity: needs the value of the other axis too" in capsys.readouterr().err


@pytest.mark.usefixtures("coarse")
def test_a_picture_of_paths_shows_what_is_not_stable(tmp_path: Path) -> None:
    """... behind the paths; not of what nothing tells to be stable."""
    cubic = str(CONFIGS / "systems" / "cubic.yaml")
    for name, record, words in (
        ("a", FIG4, ["rho", "L2=3/2", "7/10"]),
        ("b", cubic, ["a", "b=1/2", "0"]),
    ):
        along, at, start = words
        asked = ["--along", along, "--at", at, "--path", start, "--format", "svg", "--name", name]
        assert run(["range", record, *asked, "--out", str(tmp_path)]) == 0
    behind = (tmp_path / "a-path.svg").read_text(encoding="utf-8")
    assert "saddle, not followed" in behind and "maximum, not followed" in behind
    assert "not followed" not in (tmp_path / "b-path.svg").read_text(encoding="utf-8")
