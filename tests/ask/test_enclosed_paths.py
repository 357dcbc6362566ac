"""Paths of stable poses with free lengths: against exact paths where these are tiny, proved poses,
a film's fall, steepest descent.
"""

from __future__ import annotations

import json
import re
from fractions import Fraction
from itertools import pairwise
from math import degrees
from pathlib import Path

import jsonschema
import pytest
from support.maps import CONFIGS

import ptmcad
from ptmcad.answer.paths import Fate, PosePaths
from ptmcad.cli import run
from ptmcad.errors import ConfigError
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure

pytest.importorskip("numba")

FREE02 = CONFIGS / "free02.yaml"
SCHEMA = json.loads((CONFIGS.parent / "docs" / "range.schema.json").read_text(encoding="utf-8"))


def slice_of(*, free: str = "1/5", window: str = "11/10:13/10") -> ptmcad.Slice:
    return ptmcad.slice_from_options(FREE02, sets=[f"l0={free}"], ranges=[f"rho={window}"])


@pytest.fixture(scope="module")
def found() -> PosePaths:
    return ptmcad.pose_paths(slice_of(), "rho", {"L2": "3/2"}, "6/5")


@pytest.mark.slow
def test_it_snaps_at_the_fold_to_the_pose_that_is_left(found: PosePaths) -> None:
    assert [(p.number, p.low.fate, p.high.fate) for p in found.paths] == [
        (1, Fate.WINDOW, Fate.WINDOW), (2, Fate.WINDOW, Fate.SNAP)]  # fmt: skip
    end = found.paths[1].high
    assert isinstance(end.at, Enclosure)
    assert end.at.text(8) == "1.2316624"
    assert (end.meeting, end.leaving) == ((0, 1), ())
    assert end.target is not None
    assert end.energy is not None
    assert end.target_energy is not None
    points = [end.at.center + Fraction(k, 10**5) for k in (1, 2)]
    beyond = [
        ptmcad.solve(rho=rho, L2="3/2", F3=-10, F4=-10, l0="1/5").equilibria for rho in points
    ]
    near, far = (next(p for p in poses if p.stable) for poses in beyond)
    for got, one, two in zip(end.target.angles, near.angles, far.angles, strict=True):
        assert got.radius < Fraction(1, 10**20)
        assert float(got) == pytest.approx(2 * float(one) - float(two), abs=1e-8)
    lower = 2 * float(near.known_energy) - float(far.known_energy)
    assert float(end.target_energy) == pytest.approx(lower, abs=1e-7)
    assert end.energy.low > end.target_energy.high


@pytest.mark.slow
def test_every_point_is_a_proved_stable_pose_and_neighbours_are_near(found: PosePaths) -> None:
    for path in found.paths:
        assert [p.value for p in path.points] == sorted({p.value for p in path.points})
        assert Fraction(6, 5) in {p.value for p in path.points}
        assert len(path.points) > 15
        for point in path.points[::5]:
            poses = ptmcad.solve(rho=point.value, L2="3/2", F3=-10, F4=-10, l0="1/5").equilibria
            near = [p for p in poses if all(
                a.low <= b.high and b.low <= a.high for a, b in zip(p.angles, point.angles, strict=True))]  # fmt: skip
            assert [p.stable for p in near] == [True]
        for one, two in pairwise(path.points):
            assert abs(float(one.angles[0]) - float(two.angles[0])) < 0.1
    assert (found.paths[0].upright, found.paths[0].reverse) == (False, True)
    assert (found.paths[1].upright, found.paths[1].reverse) == (True, False)


@pytest.mark.slow
def test_tiny_free_lengths_make_no_difference() -> None:
    """To the exact paths without, which are proved."""
    slices = [slice_of(free=free, window="4/5:6/5") for free in ("1/1000000", "0")]
    free, exact = (
        ptmcad.pose_paths(slice, "rho", {"L2": "3/2"}, "9/10", 2).paths[0] for slice in slices
    )
    assert isinstance(free.high.at, Enclosure)
    assert isinstance(exact.high.at, AlgebraicNumber)
    assert (
        (free.low.fate, free.high.fate)
        == (exact.low.fate, exact.high.fate)
        == (Fate.WINDOW, Fate.SNAP)
    )
    assert float(free.high.at) == pytest.approx(float(exact.high.at), abs=1e-4)
    assert free.high.meeting == exact.high.meeting
    assert free.high.target is not None
    assert exact.high.target is not None
    for a, b in zip(free.high.target.angles, exact.high.target.angles, strict=True):
        assert degrees(float(a)) == pytest.approx(degrees(float(b)), abs=0.05)


@pytest.mark.parametrize(
    ("start", "number", "message", "key"),
    [
        ("2", None, "2 is not inside the window of rho, 11/10 to 13/10", "--path"),
        ("1.23166242", None, "", ""),
        ("6/5", 3, "3 is none of the 2 stable poses at rho = 6/5", "--pose"),
        ("x", None, "x", "--path"),
    ],
)
@pytest.mark.slow_cases("1.23166242-None--")
def test_starts_that_there_are_not(start: str, number: int | None, message: str, key: str) -> None:
    if not message:  # beside the fold, however near
        assert len(ptmcad.pose_paths(slice_of(), "rho", {"L2": "3/2"}, start, 1).paths) == 1
        return
    with pytest.raises(ConfigError, match=message) as caught:
        ptmcad.pose_paths(slice_of(), "rho", {"L2": "3/2"}, start, number)
    assert caught.value.key == key


@pytest.mark.usefixtures("coarse")
def test_the_command_draws_and_tells_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = [
        "range",
        str(FREE02),
        "--along",
        "rho",
        "--at",
        "L2=3/2",
        "--range",
        "rho=6/5:5/4",
        "--path",
        "61/50",
    ]
    assert (
        run([*asked, "--pose", "2", "--format", "json,svg", "--out", str(tmp_path), "--name", "x"])
        == 0
    )
    out = capsys.readouterr().out
    assert re.search(
        r"^pose 2 at rho = 1\.22: .*; y3 > 0 and y4 > 0 on the path$",
        out,
        re.M,
    ), out
    assert (
        "  up: rho = 1.231662423: fold: the stable pose merges with a saddle and both vanish; the mechanism"
        in out
    )
    assert {path.name for path in tmp_path.iterdir()} == {"x.json", "x.svg", "x-path.svg"}
    data = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))
    jsonschema.validate(data, SCHEMA, cls=jsonschema.Draft202012Validator)
    assert "joined" not in data["path"]
    assert data["path"]["paths"][0]["high"]["at"]["decimal"].startswith("1.23166242")
    picture = (tmp_path / "x-path.svg").read_text(encoding="utf-8")
    assert "saddle, not followed" in picture
