"""Continuous quantities over maps, against exact poses, roots in closed form, and a landscape
flooded on a grid.
"""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import yaml
from support.few import few
from support.maps import CONFIGS, shipped

import ptmcad
from ptmcad.answer.field import Field
from ptmcad.answer.poses import Pose
from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.fields import equations
from ptmcad.cli import map as command
from ptmcad.cli import run
from ptmcad.errors import ConfigError
from ptmcad.show.data import cell_rows, region_rows
from ptmcad.workbench.fields.quantityfield import centre, exact_at, field_of, request_of


def of_kind(poses: tuple[Pose, ...], kind: str) -> list[Pose]:
    index = {"saddle": 1, "maximum": 2}
    return [
        p for p in poses
        if kind == "pose" or (kind == "stable" and p.stable) or (kind == "unstable" and not p.stable)
        or (kind in index and p.index == index[kind])
    ]  # fmt: skip


QUANTITIES: dict[str, Any] = {
    "energy": lambda p: p.known_energy.center,
    "stiffness": lambda p: p.eigenvalues[0].center,
    "angle:th2": lambda p: p.degrees[1].center,
    "length:k3": lambda p: p.springs[2].length.center,
    "force:k1": lambda p: p.springs[0].force.center,
    "x:A4": lambda p: p.nodes["A4"][0].center,
    "y:A3": lambda p: p.nodes["A3"][1].center,
    "sin(th1)*L2/rho + th2^2": None,
}


KNOWN: dict[tuple[str, Fraction, Fraction], tuple[Pose, ...]] = {}


def exact_poses_at(name: str, result: RegionMap, x: Fraction, y: Fraction) -> tuple[Pose, ...]:
    """Of a shipped map, found once."""
    if (name, x, y) not in KNOWN:
        KNOWN[name, x, y] = exact_at(result, x, y).equilibria
    return KNOWN[name, x, y]


def compare(
    result: RegionMap, value: str, pose: str, sides: tuple[int, int], number: int, seed: int
) -> None:
    """Random pixels against `solve`: relative to the largest value, to 9 digits; nan where there is
    no such pose.
    """
    field = field_of(
        result, request_of(result.slice, value, pose), *sides, checks=5
    )  # the comparison below is by more pixels
    assert (field.missed, field.difference < 1e-9) == (0, True)
    size = np.abs(field.values[~np.isnan(field.values)]).max(initial=1e-300)
    kind, _, rank = pose.partition(":")
    source = random.Random(f"{pose} {seed}")  # the same pixels for all quantities
    for _ in range(number):
        row, column = source.randrange(sides[1]), source.randrange(sides[0])
        x, y = centre(result, result.grid(*sides), row, column)
        poses = of_kind(exact_poses_at(result.slice.name, result, x, y), kind)
        found = field.values[row, column]
        if len(poses) < int(rank):
            assert np.isnan(found)
            continue
        p = poses[int(rank) - 1]
        if QUANTITIES[value] is None:
            a, b = (float(angle.center) for angle in p.angles)
            at = dict(zip(result.slice.axis_names, (float(x), float(y)), strict=True))
            expected = np.sin(a) * at["L2"] / at["rho"] + b**2
        else:
            expected = float(QUANTITIES[value](p))
        assert abs(found - expected) <= 1e-9 * size, (row, column)


@pytest.mark.parametrize(
    "value",
    few(QUANTITIES, "energy", "stiffness", "angle:th2", "force:k1", "sin(th1)*L2/rho + th2^2"),
)
@pytest.mark.fast_cases("energy", "force:k1")
def test_quantities_are_those_of_exact_poses(value: str) -> None:
    compare(
        shipped("fig4"), value, "stable:2" if value == "stiffness" else "stable:1", (24, 18), 10, 0
    )


@pytest.mark.parametrize(
    "pose",
    few(
        ["stable:2", "unstable:1", "saddle:3", "maximum:2", "pose:5"],
        "stable:2",
        "unstable:1",
        "maximum:2",
    ),
)
@pytest.mark.fast_cases("maximum:2")
def test_poses_are_those_of_solve(pose: str) -> None:
    """Of each kind, on both sides of the boundaries."""
    compare(shipped("fig4"), "angle:th2", pose, (24, 18), 15, 1)


def test_mirrored_poses_come_in_the_order_of_solve() -> None:
    """Without loads the poses th and -th have one energy."""
    compare(shipped("fig2"), "angle:th2", "stable:2", (15, 15), 15, 2)


@pytest.mark.slow
def test_two_thousand_pixels_of_figure_4() -> None:
    """Issue: equal to `solve` to 6 digits, none on the wrong branch."""
    compare(shipped("fig4"), "angle:th2", "stable:1", (400, 400), 1000, 3)
    compare(shipped("fig4"), "angle:th2", "stable:2", (400, 400), 1000, 4)


def flooded(energy: np.ndarray, start: tuple[int, int], others: list[tuple[int, int]]) -> float:
    """The lowest level at which a pixel of a torus is joined to another one, by pixels added in
    their order.
    """
    n = len(energy)
    parent = list(range(n * n))

    def root(k: int) -> int:
        while parent[k] != k:
            parent[k] = parent[parent[k]]
            k = parent[k]
        return k

    in_ = np.zeros(n * n, dtype=bool)
    flat = energy.ravel()
    targets = [a * n + b for a, b in others]
    first = start[0] * n + start[1]
    for k in np.argsort(flat).tolist():
        in_[k] = True
        a, b = divmod(k, n)
        for c, d in ((a + 1, b), (a - 1, b), (a, b + 1), (a, b - 1)):
            other = (c % n) * n + d % n
            if in_[other]:
                parent[root(k)] = root(other)
        if in_[first] and any(in_[t] and root(t) == root(first) for t in targets):
            return float(flat[k])
    raise AssertionError("the torus is connected")


@pytest.mark.parametrize("number", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_a_barrier_is_the_level_at_which_a_flooded_landscape_joins_two_poses(number: int) -> None:
    """By a way of its own: 240 x 240 points of the torus, added from the lowest upwards."""
    result = shipped("fig4")
    sides = (16, 16)
    one, two = (
        field_of(result, request_of(result.slice, "barrier", f"stable:{k}"), *sides, checks=5)
        for k in (1, 2)
    )
    assert (np.isnan(one.values) == (result.grid(*sides).stable < 2)).all()
    rows, columns = np.nonzero(~np.isnan(one.values))
    n = 240
    angles = -np.pi + 2 * np.pi * (np.arange(n) + 0.5) / n
    at = np.stack(np.meshgrid(angles, angles, indexing="ij"))
    source = random.Random(5)
    for k in source.sample(range(len(rows)), 2)[number : number + 1]:
        x, y = centre(result, result.grid(*sides), int(rows[k]), int(columns[k]))
        poses = [p for p in exact_at(result, x, y).equilibria if p.stable]
        values = {name: float(e.evaluate(x, y)) for name, e in result.slice.parameters.items()}
        energy = equations.state_at(result.slice.model, values, at).energy
        assert energy is not None
        places = [
            (int((float(p.angles[0].center) + np.pi) * n / 2 / np.pi) % n,
             int((float(p.angles[1].center) + np.pi) * n / 2 / np.pi) % n) for p in poses
        ]  # fmt: skip
        for field, own, others in ((one, 0, places[1:]), (two, 1, places[:1])):
            level = flooded(energy, places[own], others)
            barrier = field.values[rows[k], columns[k]]
            assert barrier == pytest.approx(level - float(poses[own].known_energy.center), abs=0.1)


def cubic() -> RegionMap:
    record = yaml.safe_load("""
        name: cubic
        system: {unknowns: {x: real}, equations: [x^3 - a*x + b]}
        axes: {a: [-1, 3], b: [-2, 2]}
    """)
    return ptmcad.classify(ptmcad.slice_from_mapping(record))


def test_roots_of_a_cubic() -> None:
    """x^3 - a x + b by numpy's roots: without an energy the larger one comes first."""
    result = cubic()
    fields = [result.field("x", f"pose:{k}", 21, 22) for k in (1, 2, 3)]
    for row, b in enumerate(fields[0].y):
        for column, a in enumerate(fields[0].x):
            roots = np.roots([1, 0, -a, b])
            real = sorted(roots[np.abs(roots.imag) < 1e-9].real, reverse=True)
            found = [f.values[row, column] for f in fields]
            assert [v for v in found if not np.isnan(v)] == pytest.approx(real, abs=1e-6)


@pytest.mark.slow
def test_a_certified_map_and_its_stable_poses(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    record = yaml.safe_load("""
        name: short
        mechanism: ptm
        parameters: {l0: 1/5, F3: -10, F4: -10}
        axes: {rho: ['1', 6/5], L2: ['1', 6/5]}
    """)
    result = ptmcad.classify(ptmcad.slice_from_mapping(record), tolerance="1/10", jobs=1)
    field = field_of(result, request_of(result.slice, "energy", "stable:1"), 12, checks=10)
    assert (field.missed, field.checked > 0, field.difference < 1e-9) == (0, True, True)
    assert (np.isnan(field.values) == (result.grid(12).stable < 1)).all()
    monkeypatch.setattr(
        "ptmcad.workbench.fields.quantityfield.filled", None
    )  # refused before anything is followed
    for value, pose in (("energy", "saddle:1"), ("barrier", "stable:1")):
        with pytest.raises(ConfigError, match="knows the stable equilibria only"):
            result.field(value, pose, 12)


def test_what_is_nowhere_is_nan_everywhere() -> None:
    field = shipped("fig4").field("energy", "stable:3", 8)
    assert np.isnan(field.values).all()
    assert (field.checked, field.missed) == (0, 0)


@pytest.mark.parametrize(
    ("value", "pose", "message"),
    [
        ("force:k9", "stable:1", "ptm has no spring 'k9'"),
        ("angle:th", "stable:1", "no unknown angle 'th'"),
        ("torque:k1", "stable:1", "'torque' is not among force, length, angle, x and y"),
        ("th1 + q", "stable:1", "'q' is neither an unknown nor a parameter"),
        ("th1 +", "stable:1", "th1 +"),
        ("1e400*th1", "stable:1", "'1e400[*]th1' has a number beyond doubles"),
        ("th1^10^400", "stable:1", "beyond doubles"),
        ("1/(th1 - th1)", "stable:1", "divides by zero"),
        ("energy", "stable", ""),
        ("energy", "stable:0", "'stable:0' is not a pose such as stable:1"),
        ("energy", "second", "'second' is not a pose such as stable:1"),
        ("barrier", "saddle:1", "a barrier is that of a stable pose"),
    ],
)
def test_requests_without_meaning_are_refused(value: str, pose: str, message: str) -> None:
    if not message:
        assert shipped("fig2").field(value, pose, 3).pose == "stable:1"
        return
    with pytest.raises(ConfigError, match=message):
        shipped("fig2").field(value, pose, 3)


@pytest.mark.parametrize(
    ("value", "pose", "message"),
    [
        ("energy", "pose:1", "solutions of system have no energy"),
        ("x", "stable:1", "nothing says which solutions of system are stable"),
        ("x", "saddle:1", "solutions of system have no index"),
        ("force:k1", "pose:1", "system has no spring 'k1': there are none"),
    ],
)
def test_a_system_has_neither_energy_nor_springs(value: str, pose: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        cubic().field(value, pose, 3)


@pytest.mark.usefixtures("coarse")
def test_the_command_writes_pictures_and_numbers(
    tmp_path: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = [
        "map",
        str(CONFIGS / "fig2.yaml"),
        "--value",
        "barrier",
        "--pose",
        "stable:2",
        "--pixels",
        "20x15",
    ]
    assert (
        run([*arguments, "--format", "png,svg,csv,npz", "--out", str(tmp_path), "--checks", "5"])
        == 0
    )
    said = capsys.readouterr().out
    assert "barrier of stable:2: " in said
    assert "5 random pixels agree with exact poses" in said
    stem = "fig2-barrier-stable-2"
    assert {p.name for p in tmp_path.iterdir()} == {
        f"{stem}.{kind}" for kind in ("png", "svg", "csv", "npz")
    }
    expected = field_of(
        shipped("fig2"), request_of(shipped("fig2").slice, "barrier", "stable:2"), 20, 15, checks=0
    ).values
    with np.load(tmp_path / f"{stem}.npz") as arrays:
        assert np.array_equal(arrays["values"], expected, equal_nan=True)
    table = np.genfromtxt(tmp_path / f"{stem}.csv", delimiter=",", names=True)
    assert np.array_equal(table["value"].reshape(15, 20), expected, equal_nan=True)


def test_a_difference_from_exact_poses_is_said(
    tmp_path: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def wrong(*_: object, **__: object) -> Field:
        values = np.ones((2, 2))
        sides = np.array([0.0, 1.0])
        return Field(
            "energy",
            "stable:1",
            "",
            sides,
            sides,
            ("L2", "rho"),
            values,
            values.astype(int),
            0,
            3,
            0.25,
        )

    monkeypatch.setattr("ptmcad.workbench.fields.quantityfield.field_of", wrong)
    assert command.MAX_DIFFERENCE < 0.25
    assert run(["map", "--slice", "L2,rho", "--out", str(tmp_path)]) != 0
    assert "do not trust this map" in capsys.readouterr().err


TURNED = yaml.safe_load("""
name: turned
mechanism:
  parameters: {M: {kind: force}, b: {kind: base}}
  unknowns: {th: angle}
  points: {O: [0, 0], B: [b, 0], P: [cos(th), sin(th)]}
  springs: [{between: [B, P], k: 2}]
  moments: {th: M*sin(th)^2}
axes: {b: [1/2, 2], M: [-1, 1]}
""")
"""A moment whose mean works on the angle, and whose rest is the slope of an energy."""


def test_moments_on_their_own_unknown_are_in_the_energy() -> None:
    """As `solve` has it: the part with a value for each pose."""
    result = ptmcad.classify(TURNED)
    field = result.field("energy", "stable:1", 9)
    assert (field.missed, field.checked > 0, field.difference < 1e-9) == (0, True, True)
    for row, column in ((0, 0), (4, 7), (8, 3)):
        pose = next(
            p
            for p in exact_at(result, *centre(result, result.grid(9), row, column)).equilibria
            if p.stable
        )
        assert field.values[row, column] == pytest.approx(float(pose.known_energy.center), abs=1e-9)
    with pytest.raises(ConfigError, match="under the moment a pose"):
        result.field("barrier", "stable:1", 9)


def test_springs_have_the_names_of_other_commands() -> None:
    """By their stiffness or by their ends, as `range --quantity` takes them too."""
    result = shipped("fig2")
    assert np.array_equal(
        result.field("force:k2", columns=5).values, result.field("force:A2A3", columns=5).values
    )


def test_a_barrier_that_was_not_found_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ptmcad.workbench.fields.barrier.STEPS", 1)
    field = shipped("fig4").field("barrier", "stable:2", 16)
    assert field.missed == (shipped("fig4").grid(16).stable == 2).sum() > 0
    assert np.isnan(field.values).all()


def test_windows_beyond_doubles_are_refused() -> None:
    record = yaml.safe_load("""
        name: vast
        system: {unknowns: {z: real}, equations: [z^2 - x*y]}
        axes: {x: [1e400, 2e400], y: [1, 2]}
    """)
    result = ptmcad.classify(record)
    assert result.boundaries() == ()  # no curve is in the window
    for ask in (
        result.grid, lambda: result.field("z", "pose:1"), lambda: region_rows(result), lambda: cell_rows(result),
    ):  # fmt: skip
        with pytest.raises(ConfigError, match="beyond doubles"):
            ask()


def test_at_its_poles_an_expression_has_no_value(recwarn: pytest.WarningsRecorder) -> None:
    """The diagonal's pixels, of which there are seven; and nowhere at all."""
    with pytest.raises(ConfigError, match=r"'sin\(th1\)/0' divides by zero"):
        shipped("fig4").field("sin(th1)/0", "stable:1", 7)
    field = shipped("fig4").field("1/(rho-L2)", "stable:1", 7)
    assert np.array_equal(np.isnan(field.values), np.eye(7, dtype=bool))
    assert field.checked and field.difference < 1e-9
    assert not recwarn.list


@pytest.mark.parametrize(
    ("value", "beyond", "known"),
    [
        ("rho^1000000", 9, None),  # two columns too small or too large, and the one at 1, see below
        ("1e-400*rho", 9, None),
        ("cos(10^400)", 9, None),
        ("1 + 1e-400*rho", 0, 1.0),  # what is lost is less than rounding
        ("cos(10^-400)", 0, 1.0),
        ("0*10^300", 0, 0.0),
    ],
)
def test_values_that_no_double_is_near_are_undecided_and_counted(
    value: str, beyond: int, known: float | None
) -> None:
    field = shipped("fig4").field(value, "stable:1", 3)
    at_one = value.startswith("rho^")  # the middle column is at rho = 1
    assert field.beyond == beyond - 3 * at_one
    assert np.isnan(field.values).sum() == field.beyond
    assert np.all(field.values[~np.isnan(field.values)] == (1.0 if at_one else known))


@pytest.mark.parametrize(
    ("value", "title", "nothing"),
    [
        ("stiffness", "Stiffness of stable pose 1: fig4", ""),
        ("angle:th1", "Angle θ₁ of stable pose 1: fig4", ""),
        ("rho*th1", "ρ*θ₁ of stable pose 1: fig4", ""),
        ("1e-400*rho", "1e−400*ρ of stable pose 1: fig4", "1e−400*ρ is beyond doubles"),
        ("1/(rho-1)", "1/(ρ−1) of stable pose 1: fig4", "no pixel has a value"),
    ],
)
@pytest.mark.fast_cases(
    r"1e-400*rho-1e\u2212400*\u03c1 of stable pose 1: fig4-1e\u2212400*\u03c1 is beyond doubles",
    r"1/(rho-1)-1/(\u03c1\u22121) of stable pose 1: fig4-no pixel has a value",
)
def test_a_picture_names_its_quantity_as_the_bar_beside_it(
    value: str, title: str, nothing: str
) -> None:
    from ptmcad.show.render.fieldpicture import field_figure
    from ptmcad.show.render.printing import settings

    result = shipped("fig4")
    field = result.field(value, "stable:1", 1 if "-1)" in value else 3)
    with settings():
        figure = field_figure(result, field, (), 0, 50)
    assert [t.get_text() for t in figure.axes[0].texts] == ([nothing] if nothing else [])
    assert title in [t.get_text() for t in figure.texts]


@pytest.mark.usefixtures("coarse")
def test_a_pose_that_the_counts_exclude_is_refused_before_anything_is_drawn(
    tmp_path: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    result = tmp_path / "fig4.json"
    result.write_text(shipped("fig4").to_json(), encoding="utf-8")

    def refused(pose: str) -> str:
        asked = ["map", str(result), "--pixels", "7", "--checks", "1", "--out", str(tmp_path)]
        assert run([*asked, "--pose", pose]) == 2
        return capsys.readouterr().err

    for pose, most in (("stable:9", 2), ("maximum:3", 2), ("pose:7", 6)):
        said = f"--pose: there is no {pose} in the window: of its kind there are at most {most}"
        assert said in refused(pose)
    # what the counts leave open is seen at the pixels
    assert "no pixel has maximum:2" in refused("maximum:2")
