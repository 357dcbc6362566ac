"""Paths of stable poses: against a continuation and a descent that are not certified, and the
paper's reverse pose.
"""

from __future__ import annotations

import json
from fractions import Fraction
from functools import cache
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from flint import arb, ctx
from support.maps import CONFIGS

import ptmcad
from ptmcad.answer.paths import Fate, PosePath
from ptmcad.ask.lines.follower import pose_paths
from ptmcad.ask.lines.linesystem import line_system
from ptmcad.ask.lines.mirror import Mirror, mirror_of
from ptmcad.errors import ConfigError
from ptmcad.exact.models.system import on_slice
from ptmcad.exact.ranges.exactline import system_on
from ptmcad.formulas.continuation import (
    BITS,
    BranchEquations,
    Reached,
    at_value,
    bridge,
    enclose,
    follow,
)
from ptmcad.question.line import line_of
from ptmcad.question.slice import Slice
from ptmcad.show.ranges.pathtable import path_table
from ptmcad.show.ranges.rangedocument import document, part

ROOT = Path(__file__).resolve().parents[2]


def record(name: str) -> Slice:
    return ptmcad.load(ROOT / "configs" / f"{name}.yaml")


class Numbers:
    """The paper's equations in floating point, written down anew."""

    def __init__(self, slice: Slice, along: str, at: dict[str, str]):
        self.line = line_of(slice, along, at)
        self.values = cache(
            self._values
        )  # a descent asks for the same ones at each of its thousands of steps

    def _values(self, x: float) -> tuple[float, ...]:
        at = Fraction(x)
        p = {n: float(e.evaluate(at, Fraction(0))) for n, e in self.line.parameters.items()}
        assert p["k1"] == p["k2"] == p["k3"] and p["F3x"] == p["F4x"] == 0
        return p["L1"], p["L2"], p["rho"], p["F3"] / p["k1"], p["F4"] / p["k1"]

    def slopes(self, x: float, a: float, b: float) -> tuple[float, float]:
        """The energy's derivatives, over the stiffness."""
        l1, l2, rho, f3, f4 = self.values(x)
        first = l2 * sin(a + b) - 2 * rho * sin(a) + f3 * cos(a)
        second = l1 * sin(a + b) - 2 * rho * sin(b) + f4 * cos(b)
        return -l1 * first, -l2 * second

    def descend(self, x: float, a: float, b: float) -> tuple[float, float]:
        for _ in range(60000):
            da, db = self.slopes(x, a, b)
            a, b = a - 0.05 * da, b - 0.05 * db
            if abs(da) + abs(db) < 1e-13:
                break
        return a, b


def turn(angle: float) -> float:
    return (angle + pi) % (2 * pi) - pi


CASES = [
    ("fig4", "rho", {"L2": "3/2"}, "7/10"),
    ("fig3", "rho", {"F": "-10"}, "1/2"),
    pytest.param("fig5-text", "rho", {"F4": "-20"}, "7/10", marks=pytest.mark.slow),
    pytest.param("fig5-caption", "rho", {"F4": "-29"}, "1/2", marks=pytest.mark.slow),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "along", "at", "start"), CASES)
def test_an_upright_pose_snaps_to_the_reverse_one(
    name: str, along: str, at: dict[str, str], start: str
) -> None:
    """Section 4.2 of the paper; ends agree with the ranges, poses with a descent in floating point."""
    slice, numbers = record(name), Numbers(record(name), along, at)
    found = pose_paths(slice, along, at, Fraction(start))
    (operation,) = ptmcad.intervals(slice, along, at).operation
    upright = [p for p in found.paths if p.upright]
    reverse = [p for p in found.paths if p.reverse]
    assert len(upright) == len(reverse) == 1
    assert [e.fate for e in (reverse[0].low, reverse[0].high)] == [Fate.WINDOW] * 2
    for end, wall in ((upright[0].low, operation.low), (upright[0].high, operation.high)):
        assert end.fate is Fate.SNAP and end.at.polynomial == wall.polynomial  # type: ignore[union-attr]
        assert end.meeting[:2] == (0, 1) and end.target is not None
        assert end.target.sides == (-1, -1)
        assert (
            end.energy is not None
            and end.target_energy is not None
            and end.energy.low > end.target_energy.high
        )
        # a little further, because a descent takes long where the pose has just vanished
        beyond = float(end.at) + (0.01 if end is upright[0].high else -0.01)  # type: ignore[arg-type]
        first, second = (float(a) for a in end.last.angles)
        reached = numbers.descend(
            beyond, first + 1e-3, second - 1e-3
        )  # off the symmetry, in which a saddle lies
        for got, want in zip(reached, end.target.angles, strict=True):
            assert abs(turn(got - float(want))) < 0.1
    for path in found.paths:
        check_points(numbers, path)


def check_points(numbers: Numbers, path: PosePath) -> None:
    """Each point is an equilibrium, and neighbours are near each other."""
    for before, point in zip(path.points, path.points[1:], strict=False):
        slopes = numbers.slopes(float(point.value), *(float(a) for a in point.angles))
        assert max(map(abs, slopes)) < 1e-9
        assert before.value < point.value
        jumps = [abs(float(a) - float(b)) for a, b in zip(point.angles, before.angles, strict=True)]
        assert max(jumps) < 0.4


def test_the_pose_of_a_merger_at_an_irrational_value_is_told_by_its_symmetry() -> None:
    """V'' = b^2 - 2 at t = 0, which both minima reach at the root of two: V = -1 + 1/4 there."""
    potential = "-(b^2 - 1)*cos(t) + (2*cos(t)^2 - 1)/4 + a - a"
    slice = ptmcad.slice_from_mapping(
        {
            "name": "s",
            "system": {"unknowns": {"t": "angle"}, "potential": potential},
            "axes": {"b": [1, 2], "a": [0, 1]},
        }
    )
    end = pose_paths(slice, "b", {"a": "1/2"}, Fraction(6, 5), 1).paths[0].high
    assert end.fate is Fate.MERGE and end.target is not None and end.energy is not None
    assert end.target.angles[0].exact == 0
    assert end.energy == end.target_energy and end.energy.text(5) == "-0.75000"


def test_the_mirror_line_of_equations() -> None:
    """That of the chain is along (a, 1/2) without a load, and there is none with one that is not
    along it.
    """
    slice = ptmcad.load(CONFIGS / "mechanisms" / "two-bar-chain.yaml")

    def mirror(load: str) -> Mirror | None:
        return mirror_of(on_slice(*system_on(line_of(slice, "a", {"F": load}))).equations, 2)

    assert mirror("1/3") is None
    found = mirror("0")
    assert found is not None
    for a in (Fraction(-2), Fraction(0), Fraction(1, 3)):
        angle = found.angle(a, a)
        assert (
            angle is not None and abs(sin(float(angle)) * float(a) - cos(float(angle)) / 2) < 1e-12
        )
        wide, inner = (
            found.angle(a, a + Fraction(1, 100)),
            found.angle(a + Fraction(1, 200), a + Fraction(1, 200)),
        )
        assert wide is not None and inner is not None and (wide - inner).sin().contains(0)


def test_a_pair_that_meets_elsewhere_does_not_stop_a_path() -> None:
    """Fig. 3 at F = -10: a saddle and a maximum meet at rho = 0.0025, the stable pose goes on."""
    found = pose_paths(record("fig3"), "rho", {"F": "-10"}, Fraction(1, 10))
    (path,) = found.paths
    assert path.low.fate is path.high.fate is Fate.WINDOW
    assert path.points[0].value < Fraction(1, 1000) and path.points[-1].value > Fraction(19, 10)


def family() -> BranchEquations:
    return line_system(line_of(record("fig4"), "rho", {"L2": "3/2"})).branches


def test_a_tube_holds_one_branch_only() -> None:
    """Two stable poses at rho = 7/10: their tubes are apart, and no tube spans the fold."""
    mechanism = family()
    places = []
    for pose in ptmcad.solve(L2="3/2", F3=-10, F4=-10, rho="7/10").equilibria:
        place = at_value(mechanism, Fraction(7, 10), tuple(arb(float(a)) for a in pose.angles))  # type: ignore[arg-type]
        assert place is not None
        places.append(place)
        for got, want in zip(place.at(Fraction(7, 10)), pose.angles, strict=True):
            with ctx.workprec(BITS):
                assert abs(got - float(want)) < 1e-12
    for k, a in enumerate(places):
        for b in places[k + 1 :]:
            assert not a.holds(b, Fraction(7, 10))
    upright = next(
        Reached(Fraction(7, 10), p, p)
        for p, pose in zip(
            places, ptmcad.solve(L2="3/2", F3=-10, F4=-10, rho="7/10").equilibria, strict=True
        )
        if pose.stable and float(pose.angles[0]) > 0
    )
    steps, done = follow(mechanism, upright, Fraction(103, 100), Fraction(1, 10))
    assert done
    assert bridge(mechanism, steps[-1], Fraction(105, 100)) is None
    assert not follow(mechanism, steps[-1], Fraction(105, 100), Fraction(1, 10))[1]
    assert enclose(mechanism, Fraction(1), Fraction(11, 10), steps[-1].point) is None


@pytest.mark.parametrize(
    ("start", "number", "message"),
    [
        ("5", None, "not inside the window"),
        ("2", None, "not inside"),
        ("7/10", 3, "none of the 2 stable"),
        ("7/10", 0, "none"),
    ],
)
def test_bad_starts(start: str, number: int | None, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        pose_paths(record("fig4"), "rho", {"L2": "3/2"}, Fraction(start), number)


def test_a_critical_start_is_refused() -> None:
    with pytest.raises(ConfigError, match="critical value"):
        pose_paths(record("fig2"), "rho", {"L2": "3/2"}, Fraction(5, 4))


def test_a_path_towards_infinitely_many_equilibria_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """Unloaded equal rods: near rho = 0 the steps shrink with rho, so they are counted, and the
    rest is undecided.
    """
    monkeypatch.setattr("ptmcad.formulas.continuation._MAX_STEPS", 40)
    slice = ptmcad.load(CONFIGS / "fig3.yaml")
    paths = pose_paths(slice, "rho", {"F": Fraction(0)}, Fraction(1, 2), 1)
    assert paths.paths[0].low.fate is Fate.UNDECIDED
    assert paths.paths[0].low.last.value > 0


def test_a_start_that_can_not_be_enclosed_is_refused() -> None:
    slice = ptmcad.load(CONFIGS / "fig2.yaml")
    with pytest.raises(ConfigError, match="start farther away"):
        pose_paths(slice, "rho", {"L2": Fraction(1)}, Fraction(1, 10**24), 1)


def system(**asked: Any) -> Slice:
    axes = {"a": [-2, 2], "b": [-2, 2]}
    return ptmcad.slice_from_mapping({"name": "s", "system": asked, "axes": axes, "count": "total"})


def test_solutions_of_equations_are_followed_to_their_fold() -> None:
    """x^3 - x + b at b = 0: the middle root meets the others at b = +-2/sqrt(27), where
    x = +-1/sqrt(3).
    """
    cusp = system(unknowns={"x": "real"}, equations=["x^3 - a*x + b"])
    found = pose_paths(cusp, "b", {"a": 1}, 0)
    assert len(found.paths) == 3
    for path in found.paths:
        for point in path.points:
            (x,) = map(float, point.reals)
            assert abs(x**3 - x + float(point.value)) < 1e-12
    middle = found.paths[1]
    for end, sign in ((middle.low, -1), (middle.high, 1)):
        assert end.fate is Fate.VANISH and end.at.polynomial == (-4, 0, 27)  # type: ignore[union-attr]
        assert abs(float(end.last.reals[0]) - sign / 3**0.5) < 0.01 and end.energy is None
    shown = path_table(found)
    assert "fold: the solution merges with a solution and both vanish" in shown and "x = 1" in shown
    jsonschema.validate(
        json.loads(document("s", "s", part(found, 12))),
        json.loads((ROOT / "docs" / "range.schema.json").read_text(encoding="utf-8")),
        cls=jsonschema.Draft202012Validator,
    )


def test_a_path_ends_where_a_condition_fails() -> None:
    """x = b on the line: it leaves x + 1 > 0 at -1, and is stable above 1/2 only."""
    asked = {
        "unknowns": {"x": "real"},
        "equations": ["x - b*(1 + 0*a)"],
        "positive": ["x + 1"],
        "stable": ["2*x - 1"],
    }
    (path,) = pose_paths(system(**asked), "b", {"a": 1}, 1).paths
    assert path.low.fate is Fate.UNSTABLE and path.low.at.exact == Fraction(1, 2)  # type: ignore[union-attr]
    assert path.high.fate is Fate.WINDOW
    del asked["stable"]
    (path,) = pose_paths(system(**asked), "b", {"a": 1}, 1).paths
    assert path.low.fate is Fate.EXCLUDED and path.low.at.exact == -1  # type: ignore[union-attr]


def test_minima_of_a_potential_in_the_plane() -> None:
    """Without a torus the energy may descend for ever: it is not said where a minimum that vanishes
    goes.
    """
    slice = system(unknowns={"x": "real", "y": "real"}, potential="x^4 + y^4 - a*x^2 - b*y + x*y")
    found = pose_paths(slice, "b", {"a": 1}, 0)
    assert [(p.low.fate, p.high.fate) for p in found.paths] == [
        (Fate.WINDOW, Fate.VANISH),
        (Fate.VANISH, Fate.WINDOW),
    ]
    assert found.paths[0].high.meeting == (0, 1) and found.paths[0].high.leaving == ()


def test_solutions_that_may_meet_in_several_ways_are_not_told_apart() -> None:
    """x^2 = b and y^2 = 2 b: the four solutions vanish at b = 0, in pairs or all together as far as
    signs tell.
    """
    slice = system(
        unknowns={"x": "real", "y": "real"}, potential="x^3/3 - b*x + y^3/3 - 2*b*y + a - a"
    )
    found = pose_paths(slice, "b", {"a": 1}, 1)
    (path,) = found.paths
    assert path.low.fate is Fate.VANISH and path.low.among
    assert path.low.meeting == (0, 1, 1, 2) and path.low.leaving == ()
    assert (
        "the stable solution meets one or more of a saddle, a saddle and a maximum and vanishes;"
        in path_table(found)
    )
    data = json.loads(document("x", "x", part(found, 12)))
    schema = json.loads((ROOT / "docs" / "range.schema.json").read_text(encoding="utf-8"))
    jsonschema.validate(data, schema, cls=jsonschema.Draft202012Validator)
    assert (
        data["path"]["paths"][0]["low"]["among"] is True
        and "among" not in data["path"]["paths"][0]["high"]
    )


def test_losing_stability_is_no_merger() -> None:
    """There are eight solutions on both sides of b = 0.71660, and a fold of others comes soon, at
    0.71665.
    """
    asked = yaml.safe_load("""
        unknowns: {x: real, t: angle}
        equations: [x^3 - a*x + b*cos(t), sin(t)*x - 1/5 + cos(t)^2/3 - a*sin(t)^2/4]
        positive: [3 - x^2, x*sin(t) + 1/2]
        stable: [3*x^2 - a, x*cos(t) + 1]
    """)
    found = pose_paths(system(**asked), "b", {"a": "3/2"}, Fraction(1, 2)).paths
    assert [(p.low.fate, p.high.fate) for p in found] == [(Fate.WINDOW, Fate.UNSTABLE)] * 2
    counts = ptmcad.intervals(system(**asked), "b", {"a": "3/2"})
    assert counts.changes[-2].before.total == counts.changes[-2].after.total == 8


def test_folds_at_the_same_value_far_apart_are_two() -> None:
    """x (x^4 - 2 x^2 + 1 - b): pairs meet at x = 1 and at x = -1, both at b = 0."""
    slice = system(unknowns={"x": "real"}, potential="x^6/6 - x^4/2 + (1 - b)*x^2/2 + a - a")
    found = pose_paths(slice, "b", {"a": "1/2"}, Fraction(1, 4))
    assert [p.low.fate for p in found.paths] == [Fate.VANISH, Fate.WINDOW, Fate.VANISH]
    for path in (found.paths[0], found.paths[2]):
        assert path.low.meeting == (0, 1) and path.low.leaving == () and not path.low.among
    assert (
        path_table(found).count("fold: the stable solution merges with a maximum and both vanish")
        == 2
    )


def test_a_fold_that_can_not_be_told_from_a_pitchfork_is_undecided() -> None:
    """Two minima and a maximum become one minimum: which of them meet is told by symmetry, or not
    at all.
    """
    plain = "x^4/4 - b*x^2/2 + a - a"
    even = pose_paths(system(unknowns={"x": "real"}, potential=plain), "b", {"a": 1}, 1)
    assert [p.low.fate for p in even.paths] == [Fate.VANISH, Fate.VANISH]
    assert all(p.low.meeting == (0, 0, 1) and p.low.leaving == (0,) for p in even.paths)
    skew = "x^4/4 - b*x^2/2 + x^5/10 - b*x^3/6 + a - a"  # the slope is x (x^2 - b) (1 + x/2)
    odd = pose_paths(system(unknowns={"x": "real"}, potential=skew), "b", {"a": 1}, 1)
    near = [p for p in odd.paths if abs(float(p.points[0].reals[0])) < 1.5]
    assert len(near) == 2 and all(p.low.fate is Fate.UNDECIDED and not p.low.meeting for p in near)


def test_solutions_that_go_to_infinity_do_not_meet() -> None:
    """b x^2 = 1: both solutions leave every region at b = 0, each at its own end of the line."""
    found = pose_paths(
        system(unknowns={"x": "real"}, equations=["b*x^2 - 1 + a - a"]), "b", {"a": 1}, 1
    )
    assert [(p.low.fate, p.low.meeting) for p in found.paths] == [(Fate.UNDECIDED, ())] * 2
