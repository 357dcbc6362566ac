"""A pose along a path: against certified paths, exact poses, folds in closed form."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import degrees, pi

import numpy as np
import pytest
import yaml
from support.maps import shipped

import ptmcad
from ptmcad.answer.motion import Motion
from ptmcad.ask.fields import track
from ptmcad.ask.fields.track import Track, corners_of
from ptmcad.errors import ConfigError, PtmcadError
from ptmcad.workbench.fields import posemotion as module
from ptmcad.workbench.fields.posemotion import motion_of


@pytest.fixture(scope="module")
def snap() -> Motion:
    """The second stable pose of figure 4 to the right, over the boundary."""
    return shipped("fig4").animate("rho=3/4:6/5,L2=3/2", "stable:2", frames=30)


@pytest.mark.slow
def test_it_snaps_where_and_to_what_the_certified_path_does(snap: Motion) -> None:
    paths = ptmcad.pose_paths(shipped("fig4").slice, "rho", {"L2": "3/2"}, "3/4", 2)
    end = paths.paths[0].high
    (fall,) = snap.falls
    assert not isinstance(end.at, Fraction)
    assert abs(fall.at[0] - float(end.at.low)) < 1e-6
    assert end.target is not None
    assert end.target_energy is not None
    assert end.energy is not None
    for found, angle in zip(fall.after, end.target.angles, strict=True):
        assert abs((found - float(angle.center) + pi) % (2 * pi) - pi) < 1e-4
    assert fall.drop == pytest.approx(float(end.energy.center - end.target_energy.center), rel=1e-3)


def test_a_fall_descends_and_counts_nothing(snap: Motion) -> None:
    falling = [step for step in snap.steps if step.falling]
    heights = [step.height for step in falling if step.height is not None]
    assert len(heights) == len(falling) == 12
    assert all(a >= b - 1e-9 for a, b in pairwise(heights))
    assert heights[0] - heights[-1] == pytest.approx(snap.falls[0].drop)
    assert {(step.total, step.stable, step.others) for step in falling} == {(None, None, ())}
    assert len({step.at for step in falling}) == 1
    moved = np.diff([step.unknowns for step in falling], axis=0)
    assert np.ptp(np.linalg.norm(moved, axis=1)) < 0.02


@pytest.mark.slow
def test_hysteresis_of_a_bistable_slider() -> None:
    """By hand: F^(2/3) + (2 c)^(2/3) = 1 at the folds; there and back it snaps at either side."""
    motion = shipped("mechanisms/bistable-slider").animate(
        {"F": [-1, 1, -1], "c": "1/5"}, frames=40
    )
    fold = (1 - 0.4 ** (2 / 3)) ** 1.5
    assert [fall.at[0] for fall in motion.falls] == pytest.approx([fold, -fold], abs=1e-6)
    assert motion.steps[-1].unknowns == pytest.approx(motion.steps[0].unknowns)
    assert motion.counted == 40


def test_a_pose_that_gives_way_by_symmetry_falls_to_a_side() -> None:
    """The pendulum that stands on its head: at H = 0 its spring holds it up to W = 1."""
    motion = shipped("mechanisms/inverted-pendulum").animate("H=0,W=-7/5:7/5", frames=20)
    (fall,) = motion.falls
    assert fall.at[1] == pytest.approx(1, abs=1e-6)
    assert [abs(degrees(v)) for v in (*fall.before, *fall.after)] == pytest.approx(
        [0, 180], abs=1e-3
    )


def test_what_was_not_stable_or_has_no_energy_does_not_fall() -> None:
    saddle = shipped("fig4").animate("rho=3/4:6/5,L2=3/2", "saddle:1", frames=12)
    assert "the pose, which was not stable, vanishes" in saddle.end
    record = yaml.safe_load("""
        name: cubic
        system: {unknowns: {x: real}, equations: [x^3 - a*x + b]}
        axes: {a: [-1, 3], b: [-2, 2]}
    """)
    cubic = ptmcad.classify(record).animate("a=2:0,b=1/2", "pose:2", frames=12)
    assert (
        "a = 1.19055, b = 0.5 the pose vanishes, and without a potential nothing says where"
        in cubic.end
    )
    for step in cubic.steps:
        x, a = step.unknowns[0], float(step.at[0])
        assert abs(x**3 - a * x + 0.5) < 1e-9


def test_a_pose_that_is_lost_within_a_region_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(track, "ALONG", 1e-12)
    with pytest.raises(PtmcadError, match="in the middle of a region"):
        motion_of(shipped("fig4"), "rho=3/4:4/5,L2=3/2", frames=5)


def test_a_pose_that_is_none_of_the_counted_ones_is_an_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "SAME", 0.0)
    with pytest.raises(PtmcadError, match="none of those that are counted"):
        motion_of(shipped("fig4"), "rho=3/4:4/5,L2=3/2", frames=5)


def test_steps_keep_off_the_curves() -> None:
    """A step that lies on a curve of the map is moved a little along the path."""
    result = shipped("mechanisms/inverted-pendulum")
    assert result.locate(H=0, W=1).cell is None
    motion = result.animate("H=0,W=3/4:5/4", frames=3)
    middle = next(step for step in motion.steps if step.share > 0.4 and not step.falling)
    assert middle.at[1] != 1
    assert abs(middle.at[1] - 1) < 1e-5
    assert middle.total in (2, 4)


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("rho=1/2", "give values of both axes, as in rho=FROM:TO,L2=VALUE"),
        ("rho=1/2:1,F3=2", "give values of both axes"),
        ("rho=1/2:1,L2", "neither NAME=VALUE nor NAME=FROM:TO"),
        ("rho=1/2:,L2=1", "neither NAME=VALUE nor NAME=FROM:TO"),
        ("rho=1/2,rho=1", "neither NAME=VALUE nor NAME=FROM:TO"),
        ("rho=1/2:2,L2=1", "rho = 2 is not inside the window, 0 to 2"),
        ("rho=1/2:1:3/4,L2=1:3/2", "rho has 3 values and L2 2"),
        ("rho=1/2,L2=1", "the path leads nowhere: write rho=FROM:TO"),
        ("rho=1/2:x,L2=1", "x"),
    ],
)
def test_paths_without_meaning_are_refused(path: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message) as caught:
        shipped("fig4").animate(path)
    assert caught.value.key == "--path"


def test_other_requests_without_meaning_are_refused() -> None:
    for frames in (1, 601, True):
        with pytest.raises(ConfigError, match="is not a number of frames from 2 to 600"):
            shipped("fig4").animate("rho=1/2:1,L2=1", frames=frames)
    with pytest.raises(
        ConfigError,
        match="there is no stable:2 at the path's start, rho = 1/10, L2 = 1: only 1 of them",
    ):
        shipped("fig4").animate("rho=1/10:1,L2=1", "stable:2")


def test_a_path_goes_evenly_through_its_corners() -> None:
    slice = shipped("fig4").slice
    corners = corners_of(
        slice, {"rho": [Fraction(1, 2), 1, 1, 1], "L2": ["1/2", "1/2", "1/2", "3/2"]}
    )
    track = Track(slice, corners)
    assert [track.place(Fraction(k, 6)) for k in range(7)] == [
        (Fraction(1, 2) + Fraction(k, 4), Fraction(1, 2))
        if k <= 2
        else (1, Fraction(1, 2) + Fraction(k - 2, 4))
        for k in range(7)
    ]


def test_a_pose_that_comes_to_a_condition_leaves_and_none_falls_beyond() -> None:
    record = yaml.safe_load("""
        system: {unknowns: {x: real}, potential: x^4/4 - x^2/2 - b*x, positive: [x + c]}
        axes: {b: [-1, 1], c: [0, 2]}
    """)
    result = ptmcad.classify(ptmcad.slice_from_mapping(record))
    falls = result.animate("b=9/10:-9/10,c=1/4", frames=20)
    assert (
        falls.end
        == "at b = -0.3849, c = 0.25 the pose vanishes, and no other was reached from there"
    )
    leaves = result.animate("b=-1/10:-9/10,c=6/5", frames=20)
    assert (
        leaves.end
        == f"at b = {-(1.2**3) + 1.2:.6g}, c = 1.2 the pose leaves what the inequalities allow"
    )
