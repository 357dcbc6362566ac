"""Stiff and extreme cases: every named one, random ones, and what they rest on."""

from __future__ import annotations

import json
import math
import random
from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples
from support.work import work_of

import ptmcad
from ptmcad.answer.regionmap import Status
from ptmcad.cli import run
from ptmcad.studies.byhand import angle_error
from ptmcad.studies.stress import campaign as campaign_module
from ptmcad.studies.stress.campaign import (
    KINDS,
    answer,
    random_case,
    tame,
)
from ptmcad.studies.stress.case import (
    FEW,
    NAMED,
    Case,
    Degenerate,
    Question,
    chosen,
    free_lengths,
    named_cases,
    point,
)
from ptmcad.studies.stress.doubleprecision import double_poses, newton_pose, sextic_poses
from ptmcad.studies.stress.judgement import Row, judge
from ptmcad.text.flint_numbers import from_fraction

CASES = named_cases()
TAME = point(F3=-10, F4=-10)
TWINS = (
    "map-units-force-1e12", "map-units-length-1e9", "map-unloaded-length-1e9", "line-units-force-1e12",
    "map-units-length-1e-9", "map-forces-1e-6",
)  # fmt: skip
"""Scaled the other way than a case that the fast tests have, or of another unit."""
MARKED = [
    pytest.param(c, id=c.name, marks=[pytest.mark.slow] if c.slow or c.name in TWINS else []) for c in CASES
]  # fmt: skip


def case(name: str) -> Case:
    return next(c for c in CASES if c.name == name)


@cache
def judged(name: str) -> Row:
    c = case(name)
    return judge(c, answer(c.question, name))


@pytest.mark.parametrize("case", MARKED)
@pytest.mark.slow_cases(
    "node-left-1e-30",
    "free-length-1e-12",
    "free-length-1e-9",
    "free-length-1e-6",
    "free-length-1e1",
    "free-length-1e2",
    "free-length-1e3",
    "free-length-units-1e-12",
    "free-length-units-1e12",
    "free-length-forces-1e-12",
    "map-units-force-1e-12",
    "map-unloaded-length-1e-9",
    "window-line-1e-20",
    "window-beside-fold-1e-20",
    "line-units-length-1e-9",
    "line-units-length-1e9",
    "line-symmetry-1e-30",
    "line-digits-40",
    "map-window-1e9",
    "window-beside-cusp-1e-20",
    "cusp-few-1e-12",
    "cusp-few-1e-16",
    "cusp-few-1e-6",
    "cusp-many-1e-12",
    "cusp-many-1e-16",
    "cusp-many-1e-6",
    "cusp-of-maxima-few-1e-16",
    "cusp-of-maxima-many-1e-16",
    "fold-few-1e-12",
    "fold-few-1e-16",
    "fold-few-1e-20",
    "fold-few-1e-6",
    "fold-many-1e-12",
    "fold-many-1e-16",
    "fold-many-1e-20",
    "fold-many-1e-6",
    "fold-of-maxima-few-1e-16",
    "fold-of-maxima-many-1e-16",
    "forces-1e-10",
    "forces-1e-20",
    "forces-1e-3",
    "forces-1e10",
    "forces-1e20",
    "forces-1e6",
    "lengths-loaded-1e-9",
    "lengths-strip-1e-3",
    "lengths-strip-1e-6",
    "lengths-strip-1e3",
    "lengths-strip-1e6",
    "lengths-strip-1e9",
    "line-units-force-1e-12",
    "map-forces-1e30",
    "node-left-1e-6",
    "node-right-1e-15",
    "node-right-1e-6",
    "short-base-1e-3",
    "short-base-1e-6",
    "short-base-1e-9",
    "springs-k1-1e-12",
    "springs-k1-1e-6",
    "springs-k1-1e6",
    "springs-k3-1e-6",
    "springs-k3-1e12",
    "springs-k3-1e6",
    "stiffness-1e-3",
    "stiffness-1e-6",
    "stiffness-1e-9",
    "stiffness-1e4",
    "stiffness-1e6",
    "stiffness-1e9",
    "straight-inside-1e-12",
    "straight-inside-1e-18",
    "straight-inside-1e-24",
    "straight-inside-1e-6",
    "straight-outside-1e-12",
    "straight-outside-1e-18",
    "straight-outside-1e-24",
    "straight-outside-1e-6",
    "symmetry-inside-1e-10",
    "symmetry-inside-1e-15",
    "symmetry-inside-1e-5",
    "symmetry-outside-1e-10",
    "symmetry-outside-1e-15",
    "symmetry-outside-1e-5",
    "units-force-1e-12",
    "units-force-1e12",
    "units-force-1e30",
    "units-length-1e-9",
)
def test_ptmcad_is_right(case: Case) -> None:
    verdict = judged(case.name)
    assert verdict["right"], verdict["remarks"]


WRONG_IN_DOUBLES = (
    "stiffness-1e-12", "lengths-strip-1e9", "short-base-1e-12", "forces-1e30", "symmetry-outside-1e-20",
    "straight-inside-1e-30", "fold-many-1e-30", "fold-few-1e-30", "cusp-many-1e-30", "node-right-1e-30",
)  # fmt: skip


def test_double_precision_is_wrong() -> None:
    """What the manual says of it."""
    assert [name for name in WRONG_IN_DOUBLES if judged(name)["double_right"]] == []


@pytest.mark.parametrize(
    "name", ["units-force-1e30", "units-length-1e-9", "lengths-loaded-1e-9", "fold-few-1e-6"]
)
def test_double_precision_is_right_where_nothing_cancels(name: str) -> None:
    verdict = judged(name)
    assert verdict["double_right"]
    assert verdict["double_error"] is not None
    assert verdict["double_error"] < 1e-9


# ------------------------------------------------------------------------------------------------------------- cost


HARDEST = [
    max((c for c in CASES if c.family == family and not c.question.axes), default=None,
        key=lambda c: abs(math.log10(c.stiffness)))
    for family in dict.fromkeys(c.family for c in CASES)
]  # fmt: skip


@pytest.mark.parametrize("case", [pytest.param(c, id=c.name) for c in HARDEST if c is not None])
@pytest.mark.fast_cases(
    "stiffness-1e-12", "symmetry-inside-1e-20", "node-right-1e-30", "free-length-1e-12"
)
def test_an_extreme_case_takes_at_most_five_times_the_work_of_a_tame_one(case: Case) -> None:
    """Work is counted in calls of functions, so that no clock is asked; the tame one has ordinary
    numbers.
    """
    tame = (
        point(l0=Fraction(1, 5), F3=-10, F4=-10) if free_lengths(case.question.parameters) else TAME
    )
    assert work_of(case.question) <= 5 * work_of(tame)


def test_work_is_the_same_in_every_run() -> None:
    assert work_of(TAME) == work_of(TAME)


def test_precision_starts_low_and_grows_by_doubling() -> None:
    tame = ptmcad.solve(**TAME.parameters).bits
    assert tame == 112
    for c in CASES:
        if c.family == "units" and not c.question.axes:
            assert ptmcad.solve(**c.question.parameters).bits == tame  # scaling cancels nothing
    reached = [
        ptmcad.solve(**point(F3=-(Fraction(10) ** e), F4=-(Fraction(10) ** e)).parameters).bits
        for e in (-5, -15, -30)
    ]
    assert reached == sorted(reached)
    assert all(bits in (112, 224, 448, 896) for bits in reached)


# ---------------------------------------------------------------------------------------------------- constructions


@pytest.mark.parametrize(
    ("at", "multiplicity"), [(at, 3 if at.cusp else 2) for at in NAMED.values()], ids=list(NAMED)
)
@pytest.mark.slow_cases("other fold", "fold of maxima", "cusp of maxima")
def test_constructed_poses_are_degenerate(at: Degenerate, multiplicity: int) -> None:
    """On the fold itself two equilibria coincide, at the cusp three: zero is recognised exactly."""
    poses = ptmcad.solve(**at.parameters)
    assert poses.status is Status.ON_VARIETY
    (double,) = (p for p in poses.equilibria if p.multiplicity > 1)
    assert double.multiplicity == multiplicity
    assert all(e.low <= x <= e.high for e, x in zip(double.cosines_sines, at.pose, strict=True))
    with pytest.raises(ArithmeticError, match="multiple root"):
        sextic_poses(at.parameters)


@pytest.mark.parametrize("name", ["fold", "fold of maxima", "cusp"])
def test_sides_differ_by_one_pair(name: str) -> None:
    """By the second method alone, at a distance at which nothing is extreme."""
    at = NAMED[name]
    for sign, counts in ((1, at.many), (-1, FEW)):
        poses = sextic_poses(at.beside(sign * Fraction(1, 1000)))
        assert (len(poses), sum(index == 0 for *_, index in poses)) == counts


def test_cases_expect_what_the_constructions_say() -> None:
    for c in CASES:
        kind, _, side = c.name.rpartition("-1e")[0].rpartition("-")
        if c.family in ("fold", "cusp"):
            total, stable = NAMED[kind.replace("-", " ")].many if side == "many" else FEW
            assert c.expected == f"{total}/{stable}"


def test_cases_expect_what_rose_and_astroid_say() -> None:
    """The counts of the symmetric slice from its two curves, with x = 2 rho and y = |F|/k;
    L2 = 1 + 1e-20 is near.
    """
    for c in CASES:
        if c.source.startswith("the rose and the astroid"):
            p = c.question.parameters
            x, y = 2 * p["rho"], -p["F3"] / p["k1"]
            rose = (x * x + y * y) ** 3 - 4 * x * x * y * y
            astroid = (x * x + y * y - 4) ** 3 + 108 * x * x * y * y
            assert c.expected == ("4/1" if rose < 0 or astroid > 0 else "6/2" if x > y else "6/1")


# --------------------------------------------------------------------------------------------------- second methods


@settings(max_examples=examples(25), deadline=None)
@given(st.integers(0, 10**6))
def test_the_reference_agrees_with_signatures_of_hermite_forms(seed: int) -> None:
    """Counts by the sextic's roots and by Tarski queries on the quotient algebra."""

    from support.counting import system_of
    from support.signatures import count_by_signature

    p, _ = tame(random.Random(seed))
    counts = count_by_signature(system_of("ptm"), {n: from_fraction(v) for n, v in p.items()})
    indices = [index for *_, index in sextic_poses({n: Fraction(v) for n, v in p.items()})]
    assert (indices.count(0), indices.count(1), indices.count(2)) == counts.index


def test_newton_in_balls_proves_what_the_sextic_finds() -> None:
    parameters = dict(TAME.parameters)
    for *angles, index in sextic_poses(parameters):
        first, second = (float(angle.mid()) for angle in angles)
        proved = newton_pose(parameters, (first, second))
        assert proved is not None
        assert proved[2] == index
        assert all(own.overlaps(angle) for own, angle in zip(proved, angles, strict=False))


def test_newton_in_balls_proves_nothing_at_a_degenerate_pose() -> None:
    c1, s1, c2, s2 = map(float, NAMED["fold"].pose)
    assert (
        newton_pose(dict(NAMED["fold"].parameters), (math.atan2(s1, c1), math.atan2(s2, c2)))
        is None
    )


def test_double_precision_agrees_on_a_tame_point() -> None:
    parameters = dict(TAME.parameters)
    found, known = double_poses(parameters), sextic_poses(parameters)
    assert found is not None
    assert sorted(index for *_, index in found) == sorted(index for *_, index in known)
    for th1, *_ in found:
        assert min(angle_error(th1, float(k[0].mid())) for k in known) < 1e-12


def test_a_wrong_answer_is_called_wrong() -> None:
    """The judge itself: counts, status, poses and areas that are not right do not pass."""
    c = case("stiffness-1e4")
    other = ptmcad.solve(**point(k=10, F3=-10, F4=-10).parameters)
    assert not judge(c, other)["right"]
    assert "reference" in " ".join(
        judge(c, ptmcad.solve(**point(k=1001, F3=-10, F4=-10).parameters))["remarks"]
    )
    question = case("window-line-1e-20").question
    low, high = question.axes["rho"]
    halved = Question(question.parameters, {**question.axes, "rho": (low, (low + high) / 2)})
    assert not judge(case("window-line-1e-20"), answer(halved))["right"]


# ----------------------------------------------------------------------------------------------------- random cases


@settings(max_examples=examples(30), deadline=None)
@given(st.integers(0, 10**6), st.integers(0, 4))
def test_random_extreme_cases_are_answered_right(seed: int, number: int) -> None:
    c = random_case(seed, number)
    verdict = judge(c, answer(c.question))
    assert verdict["right"], (c.name, verdict["remarks"])


def test_random_cases_are_the_same_in_every_run_and_of_all_kinds() -> None:
    assert [random_case(3, k) for k in range(10)] == [random_case(3, k) for k in range(10)]
    assert {random_case(3, k).name.rsplit("-", 1)[1] for k in range(5)} == set(KINDS)
    assert random_case(3, 0) != random_case(4, 0)


# ---------------------------------------------------------------------------------------------- record, plot, command


def test_the_command_lists_its_cases(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["stress", "--list"]) == 0
    out = capsys.readouterr().out
    assert all(c.name in out for c in CASES)


def test_a_table_alone_leaves_no_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["stress", "fold-few-1e-6", "--format", "table"]) == 0
    assert "fold-few-1e-6" in capsys.readouterr().out
    assert not list(tmp_path.iterdir())


def test_the_command_runs_cases_and_writes_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = [
        "stress",
        "fold-many-1e-30",
        "--random",
        "2",
        "--repeats",
        "1",
        "--out",
        str(tmp_path),
    ]
    assert run([*arguments, "--format", "table,json,csv,svg"]) == 0
    out = capsys.readouterr().out
    assert "5/2 wrong" in out
    assert "ptmcad is right in 3 of 3 cases" in out
    assert {p.name for p in tmp_path.iterdir()} == {"stress.json", "stress.csv", "stress.svg"}


def test_the_command_refuses_unknown_names(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["stress", "stifness"]) == 2
    assert "did you mean 'stiffness'" in capsys.readouterr().err


def test_a_time_limit_saves_what_there_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert (
        run(["stress", "units", "--timeout", "1e-9", "--format", "json", "--out", str(tmp_path)])
        == 3
    )
    document = json.loads((tmp_path / "stress.partial.json").read_text())
    assert document["complete"] is False
    assert "time limit" in capsys.readouterr().err


def test_a_wrong_answer_gives_exit_status_1(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def wrong(_case: Case, _found: object) -> Row:
        return judged("stiffness-1e4") | {
            "found": "4/1",
            "right": False,
            "remarks": ["total 4, but 6 by construction"],
        }

    monkeypatch.setattr(campaign_module, "judge", wrong)
    assert run(["stress", "stiffness-1e4", "--repeats", "1", "--format", "table"]) == 1
    assert "4/1 WRONG" in capsys.readouterr().out


def test_families_and_names_choose_cases() -> None:
    assert {c.family for c in chosen(["node"])} == {"node"}
    assert [c.name for c in chosen(["digits-40"])] == ["digits-40"]
    assert chosen([]) == CASES
