"""Where compiled code leaves solutions: none that balls find is outside, and formulas are those of
the balls.
"""

from __future__ import annotations

import random
import sys
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import pi
from typing import Any

import pytest
from flint import arb
from support.held_sliders import PAIR, SLANTED
from support.maps import once_per_run
from support.records import TRUSS

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.question.config import load
from ptmcad.question.slice import Count
from ptmcad.verification.certified.boxes import Box, Unproved
from ptmcad.verification.certified.field import BallEquations
from ptmcad.verification.certified.kinks import sides
from ptmcad.verification.certified.parameters import over
from ptmcad.verification.certified.points import check_points, counting_of
from ptmcad.verification.certified.structure import CertifiedClaims
from ptmcad.verification.certified.waves import form_of

pytest.importorskip("numba")

import numpy as np

from ptmcad.verification.exclusion import check, places
from ptmcad.verification.exclusion.check import places_of
from ptmcad.verification.exclusion.forms import CENTER, WIDTH, evaluate
from ptmcad.verification.exclusion.places import SolutionPlaces
from ptmcad.verification.exclusion.systems import halves_over, window_equations
from ptmcad.verification.exclusion.tapes import tape_of

PAPER: dict[str, Any] = {
    "mechanism": "ptm",
    "parameters": {"L1": 1, "k": 100, "F3": -10, "F4": -10, "l0": "1/5"},
    "axes": {"rho": [0, "3/2"], "L2": [0, 2]},
}
SLIDING: dict[str, Any] = {
    "name": "sliding",
    "mechanism": {
        "name": "sliding",
        "parameters": {"F": {"kind": "force"}, "l": {"kind": "free length"}},
        "unknowns": {"x": "length"},
        "points": {"O": [0, 0], "B": [0, 1], "S": ["x", 0]},
        "springs": [
            {"between": ["O", "S"], "k": 1, "free": "l"},
            {"between": ["B", "S"], "k": 1, "free": "l"},
        ],
        "loads": {"S": ["F", 0]},
    },
    "axes": {"F": [-2, 2], "l": ["1/10", 2]},
}
"""One spring along the slider's guide, and one from its side."""
APART: dict[str, Any] = SLANTED | {"axes": {"a": ["1/4", "3/4"], "F": [1, 2]}}
"""Two sliders that have bounds over small parts of the window only."""
RECORDS: dict[str, dict[str, Any]] = {
    "paper": PAPER, "pair": PAIR, "sliding": SLIDING, "truss": TRUSS, "apart": APART
}  # fmt: skip
LOOP = "configs/mechanisms/four-bar-free.yaml"
CASES = [(name, count) for name in RECORDS for count in ("stable", "index")]
CASES += [("loop", "stable"), ("loop", "total")]


@cache
def a_map(name: str, count: str) -> RegionMap:
    def made() -> RegionMap:
        record = (
            replace(load(LOOP), count=Count(count))
            if name == "loop"
            else RECORDS[name] | {"count": count}
        )
        return ptmcad.classify(record, engine="certified", tolerance="1/10")

    found: RegionMap = once_per_run(f"places-{name}-{count}", made)
    return found


def test_places_have_bounds_of_their_own_where_the_window_has_none() -> None:
    claims = CertifiedClaims(a_map("apart", "index"))
    with pytest.raises(Unproved, match="no bound of the unknown x"):
        halves_over(claims)
    find, rng = SolutionPlaces(claims), random.Random(1)
    (one, two), steps = at_random(claims, rng), claims.sweep.steps
    point, whole = (
        find((one, one), (two, two)),
        find((Fraction(0), Fraction(steps)), (Fraction(0), Fraction(steps))),
    )
    assert point is not None
    assert max(point.whole) < 100
    assert whole is None


def at_random(claims: CertifiedClaims, rng: random.Random) -> tuple[Fraction, Fraction]:
    one, two = (Fraction(rng.randrange(1, 2**16) * claims.sweep.steps, 2**16) for _ in "uv")
    return one, two


@pytest.mark.parametrize(("name", "count"), CASES)
@pytest.mark.slow_cases(
    "paper-stable",
    "paper-index",
    "pair-index",
    "loop-total",
    "truss-stable",
    "loop-stable",
    "pair-stable",
    "apart-stable",
)
def test_places_have_all_solutions(name: str, count: str) -> None:
    """That balls alone find; and with places they find the same ones."""
    claims, rng, told = CertifiedClaims(a_map(name, count)), random.Random(name + count), 0
    found, counting = SolutionPlaces(claims), counting_of(claims)
    for _ in range(12):
        u, v = at_random(claims, rng)
        where = found((u, u), (v, v))
        try:
            alone = counting.at(claims, *claims.off_lattice(u, v))
        except Unproved:
            continue
        told += 1
        assert where is not None
        kept = [e for e in alone.found if count != "stable" or "-" not in e.signs]
        for e in kept:
            assert any(inside(e.center, box) for boxes in where.boxes for box in boxes)
        assert counting.at(claims, *claims.off_lattice(u, v), where).counts == alone.counts
    assert told > 8


@pytest.mark.parametrize(("name", "count"), CASES)
@pytest.mark.slow_cases(
    "paper-stable",
    "paper-index",
    "pair-index",
    "loop-total",
    "truss-stable",
    "sliding-stable",
    "loop-stable",
    "pair-stable",
    "apart-stable",
)
def test_places_over_a_box_have_those_over_its_points(name: str, count: str) -> None:
    claims, rng, told = CertifiedClaims(a_map(name, count)), random.Random(name), 0
    found, counting = SolutionPlaces(claims), counting_of(claims)
    half = Fraction(claims.sweep.steps, 4096)
    for _ in range(6):
        u, v = at_random(claims, rng)
        whole = found((u - half, u + half), (v - half, v + half))
        assert whole is not None
        for du, dv in ((1, 1), (-1, 1), (0, -1)):
            try:
                there = counting.at(claims, *claims.off_lattice(u + du * half, v + dv * half))
            except Unproved:
                continue
            told += 1
            kept = [e for e in there.found if count != "stable" or "-" not in e.signs]
            assert all(
                any(inside(e.center, box) for boxes in whole.boxes for box in boxes) for e in kept
            )
    assert told > 8


def inside(at: tuple[float, ...], box: Box) -> bool:
    """Whether a point is in a box, but for whole turns and rounding."""
    turned = [
        min(abs(x - m + 2 * k * pi) for k in (-1, 0, 1)) for x, m in zip(at, box[0], strict=True)
    ]
    return all(d <= r + 1e-9 for d, r in zip(turned, box[1], strict=True))


@pytest.mark.parametrize(("name", "count"), CASES)
@pytest.mark.slow_cases("paper-index", "paper-stable", "loop-total", "pair-index")
def test_formulas_are_those_of_the_balls(name: str, count: str) -> None:
    """Equations and Jacobian at random configurations, compiled and in balls: they share the
    formulas.
    """
    claims, rng = CertifiedClaims(a_map(name, count)), random.Random(count)
    form, slice = form_of(claims.result.slice), claims.result.slice
    for side in sides(form):
        equations = window_equations(claims)
        equations.sides = side
        rows = equations.hessian(equations.directions())
        wanted = [
            *equations.equations(equations.directions()),
            *(entry for row in rows for entry in row),
        ]
        tape, _, places = tape_of(equations.list, wanted, [])
        factors = [tape_of(equations.list, [f], []) for f in equations.factors]
        for _ in range(3):
            u, v = at_random(claims, rng)
            at = [rng.uniform(-2, 2) for _ in range(form.size)]
            x, y = (arb(str(float(c))) for c in claims.off_lattice(u, v))
            values = {n: arb(0) for n in slice.model.free_lengths}
            jet = BallEquations(
                form, values | {n: over(e, x, y) for n, e in slice.parameters.items()}, sides=side
            )([arb(c) for c in at])
            box = np.array([[float(c)] * 2 for c in (u, v)] + [[c, c] for c in at])
            numbers = numbers_of(tape, box)[places]
            scale = [numbers_of(t, box)[p[0]] for t, _, p in factors]
            n = form.size
            true = [float(value.mid()) / s for value, s in zip(jet.values, scale, strict=True)]
            true += [float(jet.jacobian[i][j].mid()) / scale[i] for i in range(n) for j in range(n)]
            assert numbers == pytest.approx(true, rel=1e-9, abs=1e-9)


def numbers_of(tape: Any, box: Any) -> Any:
    forms = np.empty((len(tape.code), WIDTH))
    evaluate(tape, box, forms, 0, len(tape.code))
    return forms[:, CENTER]


@pytest.mark.parametrize("name", ["truss", pytest.param("paper", marks=pytest.mark.slow)])
def test_a_search_that_is_spent_leaves_what_it_has(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    claims = CertifiedClaims(a_map(name, "index"))
    at = at_random(claims, random.Random(1))
    true = counting_of(claims).at(claims, *claims.off_lattice(*at))
    for budget, left in ((1, 512), (5, 512), (40, 512), (4000, 6)):
        monkeypatch.setattr(places, "BUDGET", budget)
        monkeypatch.setattr(places, "MAX_LEFT", left)
        where = SolutionPlaces(claims)((at[0],) * 2, (at[1],) * 2)
        assert where is not None
        assert len(list(where.boxes[0])) <= left
        assert all(any(inside(e.center, box) for box in where.boxes[0]) for e in true.found)


def test_without_compiled_code_balls_search_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    claims = CertifiedClaims(a_map("sliding", "index"))
    with_places = check_points(claims, places_of(claims))
    for name in [
        n
        for n in sys.modules
        if n.startswith("ptmcad.verification.exclusion.") and n != check.__name__
    ]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "numba", None)
    assert places_of(claims) is None
    assert check_points(claims, None) == with_places


def test_forged_counts_are_refused_with_places() -> None:
    true = a_map("pair", "stable")
    wrong = replace(
        true,
        cells=tuple(
            replace(c, stable=(c.stable or 0) + (k == 0)) for k, c in enumerate(true.cells)
        ),
    )
    assert not ptmcad.verify(wrong).ok
