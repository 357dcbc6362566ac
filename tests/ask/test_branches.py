"""Bifurcation diagrams: all solutions along a line, by quantities, joined to branches."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import jsonschema
import pytest

import ptmcad
from ptmcad.answer.branches import Branch, Branches
from ptmcad.ask.branches import branch_diagram
from ptmcad.ask.quantities import quantities, quantity
from ptmcad.cli import run
from ptmcad.errors import ConfigError
from ptmcad.question.config import load
from ptmcad.show.ranges.branches import kind

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
FIG4 = str(CONFIGS / "fig4.yaml")


def numbers(branch: Branch, k: int) -> list[float]:
    found = [point.numbers[k] for point in branch.points]
    assert all(number is not None for number in found)
    return [float(number) for number in found if number is not None]


@pytest.fixture(scope="module")
def fig4() -> Branches:
    names = ("th1", "energy", "stiffness", "force:A1A4", "length:A1A4", "y:A3")
    return branch_diagram(load(FIG4), "rho", {"L2": "3/2"}, names)


def test_the_branches_are_all_equilibria(fig4: Branches) -> None:
    """Four, six and four of them, as the ranges say; two are stable in the middle."""
    folds = (0.4981306959, 1.041432630)
    places = [sum(float(b.points[0].value) > fold for fold in folds) for b in fig4.branches]
    assert [places.count(k) for k in range(3)] == [4, 6, 4]
    assert [sum(bool(b.stable) for b, k in zip(fig4.branches, places, strict=True) if k == n) for n in range(3)] == [
        1, 2, 1]  # fmt: skip
    assert not fig4.undecided


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
    """A stable branch and a saddle have nearly the same energy at a fold, and no eigenvalue to speak of."""
    for branch in fig4.branches:
        energies, places = numbers(branch, 1), [float(p.value) for p in branch.points]
        steps = [abs((b - a) / (y - x)) for a, b, x, y in zip(energies, energies[1:], places, places[1:], strict=False)]
        assert max(steps) < 1500
    middle = [b for b in fig4.branches if 0.49 < float(b.points[0].value) < 0.5]
    for end in (0, -1):
        near = [b for b in middle if abs(numbers(b, 2)[end]) < 1]
        assert sorted(kind(b, fig4.model) for b in near) == ["saddle", "stable"]
        assert abs(numbers(near[0], 1)[end] - numbers(near[1], 1)[end]) < 1e-3


def test_the_cubic() -> None:
    """x^3 - a x + 1/2 has one solution, or three where 4 a^3 > 27/4."""
    found = branch_diagram(load(CONFIGS / "systems" / "cubic.yaml"), "a", {"b": Fraction(1, 2)}, ["x"])
    fold = (27 / 16) ** (1 / 3)
    assert [len(found.branches), sum(float(b.points[-1].value) < fold for b in found.branches)] == [4, 1]
    for branch in found.branches:
        for point in branch.points:
            x, a = numbers(Branch(None, None, (point,)), 0)[0], float(point.value)
            assert abs(x**3 - a * x + 0.5) < 1e-4


def test_free_lengths() -> None:
    pytest.importorskip("numba")
    slice = ptmcad.slice_from_options(CONFIGS / "free02.yaml", ranges=["rho=3/10:3/5"])
    found = branch_diagram(slice, "rho", {"L2": "3/2"}, ["th1", "force:A3A4"])
    assert len(found.branches) == 10
    assert sum(bool(b.stable) for b in found.branches if float(b.points[0].value) < 0.4) == 1
    for branch in found.branches:
        assert len(branch.points) >= 24


def test_quantities_that_there_are_not() -> None:
    model = load(FIG4).model
    # each spring by its own name, too, as `ptmcad map` has it
    assert len(quantities(model)) == 20
    with pytest.raises(ConfigError, match="did you mean 'energy'"):
        quantity(model, "enrgy")
    with pytest.raises(ConfigError, match="there are x"):
        quantity(load(CONFIGS / "systems" / "cubic.yaml").model, "energy")


def test_from_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    common = ["range", FIG4, "--along", "rho"]
    asked = ["--quantity", "th1", "--quantity", "energy", "--quantity", "th1", "--format", "json,svg"]
    assert run([*common, "--at", "L2=3/2", *asked, "--out", str(tmp_path), "--name", "x"]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"x.json", "x.svg", "x-branches.svg"}
    data = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))
    schema = json.loads((CONFIGS.parent / "docs" / "range.schema.json").read_text(encoding="utf-8"))
    jsonschema.validate(data, schema, cls=jsonschema.Draft202012Validator)
    assert data["branches"]["quantities"] == ["th1", "energy"] and len(data["branches"]["branches"]) == 14
    picture = (tmp_path / "x-branches.svg").read_text(encoding="utf-8")
    assert "th1, energy of all solutions along rho: stable, saddle, maximum." in picture
    out = capsys.readouterr().out
    assert "\nfrom         to        kind     th1 (degrees)          energy\n" in out
    assert run([*common, "--over", "L2", "--quantity", "th1"]) == 2
    assert "error: --quantity: needs the value of the other axis too" in capsys.readouterr().err


def test_a_picture_of_branches_with_free_lengths(tmp_path: Path) -> None:
    pytest.importorskip("numba")
    common = ["range", str(CONFIGS / "free02.yaml"), "--along", "rho", "--at", "L2=3/2", "--range", "rho=3/10:2/5"]
    assert run([*common, "--quantity", "energy", "--format", "svg", "--out", str(tmp_path), "--name", "x"]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["x-branches.svg"]


def test_a_picture_of_paths_shows_what_is_not_stable(tmp_path: Path) -> None:
    """... behind the paths; not of what nothing tells to be stable."""
    cubic = str(CONFIGS / "systems" / "cubic.yaml")
    for name, record, words in (("a", FIG4, ["rho", "L2=3/2", "7/10"]), ("b", cubic, ["a", "b=1/2", "0"])):
        along, at, start = words
        asked = ["--along", along, "--at", at, "--path", start, "--format", "svg", "--name", name]
        assert run(["range", record, *asked, "--out", str(tmp_path)]) == 0
    behind = (tmp_path / "a-path.svg").read_text(encoding="utf-8")
    assert "saddle, not followed" in behind and "maximum, not followed" in behind
    assert "not followed" not in (tmp_path / "b-path.svg").read_text(encoding="utf-8")
