"""`verify` of maps with springs on lines that turn, by half an angle too: true ones are proved,
false ones are not.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import Any

import pytest
import yaml
from flint import arb

pytest.importorskip("numba")

from support.counting import MIDDLE, claims_of
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.certified.engine import certified_map
from ptmcad.certified.plain import criticalcurves as plain_curves
from ptmcad.options import Options
from ptmcad.question.slice import Count
from ptmcad.verification.certified.ballequations import BallEquations
from ptmcad.verification.certified.cellsamples import check_points
from ptmcad.verification.certified.counted import CellCounts
from ptmcad.verification.certified.coverclaims import CertifiedClaims, check_form
from ptmcad.verification.certified.models import ModelCounting
from ptmcad.verification.normalform.boxes import Unproved
from ptmcad.verification.normalform.waves import Form, form_of, sides
from ptmcad.verification.report import Violation


def record(mechanism: dict[str, Any], count: str = "index", **axes: list[Any]) -> dict[str, Any]:
    parameters = {
        "l": {"kind": "free length", "default": 1},
        "F": {"kind": "force", "default": 0},
        "G": {"kind": "force", "default": 0},
    }
    given = {"name": "creased", **mechanism, "parameters": parameters}
    return {
        "name": "creased",
        "mechanism": given,
        "axes": axes or {"F": [-2, 2], "l": [0, 2]},
        "count": count,
    }


CRANK: dict[str, Any] = yaml.safe_load("""
unknowns: {th: angle}
points: {O: [0, 0], A: [1, 0], P: [cos(th), sin(th)]}
springs: [{between: [A, P], k: 1, free: l}]
loads: {P: [F, G]}
""")
BEHIND: dict[str, Any] = {**CRANK, "points": {**CRANK["points"], "A": [-1, 0]}}
"""The crease at half a turn, where the search begins and ends."""
LEANING: dict[str, Any] = {
    **CRANK,
    "points": {"O": [0, 0], "A": ["6/5", "8/5"], "B": [-2, 0], "P": ["2*cos(th)", "2*sin(th)"]},
    "springs": [
        {"between": ["A", "P"], "k": 1, "free": "l"},
        {"between": ["B", "P"], "k": 1, "free": "1/3"},
    ],
}
TILTED: dict[str, Any] = {
    **CRANK,
    "points": {"O": [0, 0], "A": [1, 2], "P": ["cos(th) - 2*sin(th)", "2*cos(th) + sin(th)"]},
}
PAIR: dict[str, Any] = yaml.safe_load("""
unknowns: {a: angle, b: angle}
points: {O: [0, 0], P: [cos(a), sin(a)], Q: [cos(b), sin(b)]}
springs: [{between: [P, Q], k: 1, free: l}]
loads: {P: [F, G], Q: [1/3, -1/7]}
""")
ARM: dict[str, Any] = yaml.safe_load("""
unknowns: {a: angle, x: length}
points: {O: [0, 0], A: [1, 0], S: [x*cos(a), x*sin(a)]}
springs: [{between: [O, S], k: 1, free: l}, {between: [A, S], k: 1, free: 1/4}]
loads: {S: [F, G]}
""")
LOOP: dict[str, Any] = yaml.safe_load("""
unknowns: {th: angle, x: length}
points: {O: [0, 0], A: [0, 1], P: [cos(th), sin(th)], S: [x, 0]}
bars: [[O, P]]
closing: [{between: [P, S], length: 2}]
springs: [{between: [A, P], k: 1, free: l}]
loads: {S: [F, G]}
""")
CASES = {
    "crank": record(CRANK),
    "crank, total": record(CRANK, "total", G=[-1, 1], l=["1/10", 1]),
    "crank, stable": record(CRANK, "stable"),
    "crank, admissible": record(CRANK, "admissible"),
    "leaning": record(LEANING),
    "pair": record(PAIR, F=[1, 2], l=[1, 2]),
    "loop": record(LOOP, "total", F=["1/4", "1/2"], l=["1/2", 1]),
}


@cache
def made(name: str) -> RegionMap:
    return certified_map(
        ptmcad.slice_from_mapping(CASES[name]), Options(tolerance=Fraction(1, 50), jobs=1)
    )


def form(mechanism: dict[str, Any]) -> Form:
    return form_of(ptmcad.slice_from_mapping(record(mechanism, "total")))


@pytest.mark.parametrize("name", list(CASES))
@pytest.mark.slow_cases("pair", "loop", "crank", "crank, stable")
def test_true_maps_are_proved(name: str) -> None:
    report = ptmcad.verify(made(name), seed=1, boxes=2)
    assert report.ok
    checks = {c.name: c for c in report.checks}
    assert checks["counts and solutions"].passed
    if name not in ("pair", "loop"):
        assert checks["the whole free area"].passed


@pytest.mark.parametrize("name", ["crank, total"])
def test_a_map_without_the_crease_is_not_proved(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plain_curves, "_boundaries", lambda *_: iter(()))
    slice = ptmcad.slice_from_mapping(CASES[name])
    false = certified_map(slice, Options(tolerance=Fraction(1, 50), jobs=1))
    monkeypatch.undo()
    assert len(false.cells) < len(made(name).cells)
    (area,) = (
        c for c in ptmcad.verify(false, seed=1, boxes=0).checks if c.name == "the whole free area"
    )
    assert not area.passed


@pytest.mark.parametrize("name", ["crank", "pair"])
def test_a_wrong_count_is_found(name: str) -> None:
    true = made(name)
    cell = true.cells[0]
    assert cell.index is not None and cell.total is not None
    wrong = replace(
        cell,
        total=cell.total + 1,
        stable=cell.index[0] + 1,
        index=(cell.index[0] + 1, *cell.index[1:]),
    )
    assert not ptmcad.verify(replace(true, cells=(wrong, *true.cells[1:])), boxes=0, effort=0).ok


def test_a_half_angle_in_the_place_of_the_angle_is_found() -> None:
    true = made("crank")
    cell = true.cells[0]
    halves = tuple(replace(s, center=tuple(c / 2 for c in s.center)) for s in cell.solutions)
    wrong = replace(cell, solutions=halves)
    assert not ptmcad.verify(replace(true, cells=(wrong, *true.cells[1:])), boxes=0, effort=0).ok


@pytest.mark.parametrize(
    ("mechanism", "twice"),
    [
        (CRANK, [(1,)]),
        (TILTED, [(1,)]),
        (LEANING, [(1,), (1,)]),
        (PAIR, [(1, 1)]),
        (ARM, [(2, 0), None]),
        (LOOP, [(1, 0)]),
    ],
)
def test_lines_are_told_from_the_vectors(mechanism: dict[str, Any], twice: list[Any]) -> None:
    lines = [cone.line for cone in form(mechanism).cones]
    assert [line and line.twice for line in lines] == twice


def test_what_half_of_an_angle_turns_is_another_after_a_full_turn() -> None:
    values = {"l": arb(1), "F": arb(0), "G": arb(0)}

    def circles(mechanism: dict[str, Any]) -> tuple[bool, ...]:
        of = form(mechanism)
        return BallEquations(of, values, sides=next(iter(sides(of)))).circles

    assert circles(CRANK) == (False,)
    assert circles(PAIR) == (False, False)
    assert circles(ARM) == (True, False)


def counts_of(mechanism: dict[str, Any], values: dict[str, Fraction], count: Count) -> CellCounts:
    model = ptmcad.slice_from_mapping(record(mechanism, "total")).model
    return claims_of(values, count, model).counting.at(*MIDDLE).counts


def test_an_equilibrium_at_both_ends_of_the_circle_is_one() -> None:
    """At th = pi, where the search begins and ends: it is on one side of the spring there, and on
    the other here.
    """
    values = {"l": Fraction(1), "F": Fraction(1, 3), "G": Fraction(0)}
    counts = counts_of(CRANK, values, Count.INDEX)
    assert counts.index == (2, 1)


@pytest.mark.parametrize(
    "at", [("1/4", "-131/64", "-3/32"), ("31/64", "-53/64", "-5/16"), ("43/64", "-185/64", "19/64")]
)
def test_what_continues_a_side_hides_no_equilibrium_a_turn_away(at: tuple[str, str, str]) -> None:
    """Beyond the crease the energy's continuation has a zero a full turn from an equilibrium of the
    same side.
    """
    free, force, up = map(Fraction, at)
    values = {"l": free, "F": force, "G": up}
    assert counts_of(BEHIND, values, Count.INDEX).index == (2, 1)


@pytest.mark.parametrize("count", ["total", "stable"])
def test_a_line_whose_spring_has_no_free_length_has_no_sides(count: str) -> None:
    """The parameter m is zero all over the slice."""
    mechanism = yaml.safe_load("""
        unknowns: {x: length}
        points: {S: [x, -1], B: [0, -1], C: [1, 1/2]}
        springs: [{between: [B, S], k: 1, free: m}, {between: [C, S], k: 1, free: l}]
        loads: {S: [F, G]}
    """)
    given = record(mechanism, count, F=[1, 2], l=["1/10", 1])
    given["mechanism"]["parameters"] |= {"m": {"kind": "free length", "default": 0}}
    true = certified_map(
        ptmcad.slice_from_mapping(given), Options(tolerance=Fraction(1, 50), jobs=1)
    )
    assert len(form_of(true.slice).cones) == 1
    report = ptmcad.verify(true, seed=1, boxes=2, effort=0)
    assert report.ok
    assert next(c for c in report.checks if c.name == "counts and solutions").passed


def turned(**axes: Any) -> dict[str, Any]:
    """A crank whose spring's other end is in a direction of which only the slice says that it is
    one.
    """
    given = record(
        CRANK | {"points": {"A": ["c", "s"], "P": ["cos(th)", "sin(th)"]}}, "index", **axes
    )
    given["mechanism"]["parameters"] |= {"c": {"default": 1}, "s": {"default": 0}}
    return given | {"parameters": {"c": "(1 - t^2)/(1 + t^2)", "s": "2*t/(1 + t^2)"}}


def test_directions_are_told_by_the_values_of_parameters() -> None:
    given = turned()
    given["axes"] = {"F": [1, 2], "t": ["1/4", 1]}
    true = certified_map(
        ptmcad.slice_from_mapping(given), Options(tolerance=Fraction(1, 50), jobs=1)
    )
    (cone,) = form_of(true.slice).cones
    assert cone.line is not None and cone.line.twice == (1,)
    report = ptmcad.verify(true, seed=1, boxes=2, effort=0)
    assert report.ok
    assert next(c for c in report.checks if c.name == "counts and solutions").passed
    given["parameters"]["s"] = "t/(1 + t^2)"  # no direction any more
    assert form_of(ptmcad.slice_from_mapping(given)).cones[0].line is None


@pytest.mark.parametrize("away", [Fraction(1, 10**20), Fraction(1, 10**29)])
def test_narrow_boxes_beside_solutions_are_refused_on_the_side_of_a_crease(away: Fraction) -> None:
    true = made("crank")
    cell = true.cells[0]
    values = dict(zip(true.slice.axis_names, cell.sample, strict=True))
    poses = [
        Fraction(p.angles[0].text(45))
        for p in ptmcad.solve(true.slice, digits=45, **values).equilibria
    ]
    narrow = Fraction(1, 10**30)

    def moved(by: Fraction) -> RegionMap:
        solutions = tuple(
            replace(s, center=(min(poses, key=lambda x: abs(x - s.center[0])) + by,), radius=narrow)
            for s in cell.solutions
        )
        return replace(true, cells=(replace(cell, solutions=solutions), *true.cells[1:]))

    assert ptmcad.verify(moved(Fraction(0)), seed=1, boxes=0, effort=0).ok
    assert not ptmcad.verify(moved(away), seed=1, boxes=0, effort=0).ok


def test_more_admissible_equilibria_than_stable_ones_are_refused() -> None:
    true = made("crank, admissible")
    cell = true.cells[0]
    assert cell.stable is not None
    wrong = replace(
        true, cells=(replace(cell, further={"admissible": cell.stable + 1}), *true.cells[1:])
    )
    with pytest.raises(Violation, match="admissible equilibria among"):
        check_form(CertifiedClaims(wrong))


def test_counts_of_an_undecided_sample_are_those_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    true = made("crank")
    sample, at = tuple(true.cells[0].sample), ModelCounting.at

    def undecided(self: ModelCounting, x: Fraction, y: Fraction) -> Any:
        if (x, y) == sample:
            raise Unproved("a test")
        return at(self, x, y)

    monkeypatch.setattr(ModelCounting, "at", undecided)
    assert check_points(CertifiedClaims(true)) == "2 samples, 4 equilibria"
    # a pair less, in count and list
    cell = next(c for c in true.cells if tuple(c.sample) == sample)
    assert cell.index is not None and cell.total is not None and cell.stable is not None
    rest = tuple(s for s in cell.solutions if "-" in s.signs)
    index = (0, *cell.index[1:])
    wrong = replace(cell, total=len(rest), stable=0, index=index, solutions=rest)
    with pytest.raises(Violation, match="in the same cell"):
        check_points(CertifiedClaims(replace(true, cells=(wrong, *true.cells[1:]))))
