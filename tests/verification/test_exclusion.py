"""The free area that is proved free of critical curves: nothing true is excluded, no dropped piece
passes.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from types import SimpleNamespace
from typing import Any

import pytest
import yaml
from support.maps import once_per_run
from support.records import TRUSS

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.question.config import load
from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.report import Unchecked, Violation

pytest.importorskip("numba")

import numpy as np
from support.replacing import replace

from ptmcad.verification.certified import freearea
from ptmcad.verification.certified.freearea import MAX_EFFORT, check_free_area, pieces_of
from ptmcad.verification.exclusion import running
from ptmcad.verification.exclusion.criticalsystems import systems_of
from ptmcad.verification.exclusion.forms import CENTER, ERROR, HIGH, LOW, WIDTH, evaluate, tape_of
from ptmcad.verification.exclusion.holding import holds
from ptmcad.verification.exclusion.pieces import no_pieces
from ptmcad.verification.exclusion.running import search
from ptmcad.verification.normalform.operations import MAX_VARIABLES, Formulas

ZEEMAN: dict[str, Any] = yaml.safe_load("""
mechanism:
  name: zeeman
  parameters:
    l0: {kind: free length, default: 1}
    k: {kind: stiffness, default: 1}
    X: {kind: force}
    Y: {kind: force}
  unknowns: {th: angle}
  points: {B: [cos(th), sin(th)], A: [-3, 0], P: [X, Y]}
  springs: [{between: [A, B], k: k, free: l0}, {between: [B, P], k: k, free: l0}]
axes: {X: [3/2, 5], Y: [-2, 2]}
count: total
""")


def paper(count: str, free: str, rho: list[str], l2: list[str]) -> dict[str, Any]:
    parameters = {"L1": 1, "k": 100, "F3": -10, "F4": -10, "l0": free}
    return {
        "mechanism": "ptm",
        "parameters": parameters,
        "axes": {"rho": rho, "L2": l2},
        "count": count,
    }


PAPER = {
    "stable": paper("stable", "1/5", ["11/10", "13/10"], ["4/5", "1"]),
    "total": paper("total", "1/5", ["11/10", "13/10"], ["4/5", "1"]),
    "admissible": paper("admissible", "1/2", ["7/5", "3/2"], ["21/20", "23/20"]),
}
"""Windows with one curve each: of admissible counts the one where a spring has its free length."""
LOOP = load("configs/mechanisms/four-bar-free.yaml")
CRANK: dict[str, Any] = yaml.safe_load("""
name: crank
mechanism:
  name: sprung_crank
  parameters: {F: {kind: force}, l0: {kind: free length}}
  unknowns: {th: angle}
  points: {O: [0, 0], A: [2, 0], B: [-1, 2], P: [cos(th), sin(th)]}
  bars: [[O, P]]
  springs: [{between: [A, P], k: 1, free: l0}, {between: [B, P], k: 1, free: 1/2}]
  loads: {P: [0, F]}
axes: {F: [1, 2], l0: [2, 3]}
count: admissible
""")
"""One stable equilibrium, and one curve: where the first spring has its free length."""
RECORDS = {"crank": CRANK, "zeeman": ZEEMAN, "truss": TRUSS, "loop": LOOP}


@cache
def a_map(name: str, tolerance: float = 3e-3) -> RegionMap:
    def made() -> RegionMap:
        return ptmcad.classify(
            (RECORDS | PAPER)[name], engine="certified", tolerance=str(tolerance)
        )

    return once_per_run(f"exclusion-{name}-{tolerance}", made)


def without(stored: RegionMap, number: int) -> RegionMap:
    """A map without one of its rectangles."""
    cover = stored.cover
    assert cover is not None
    kept = cover.rectangles[:number] + cover.rectangles[number + 1 :]
    return replace(stored, cover=replace(cover, rectangles=kept))


@pytest.mark.parametrize("name", RECORDS)
@pytest.mark.slow_cases("zeeman", "loop", "truss")
def test_all_of_a_true_map_is_proved(name: str) -> None:
    assert check_free_area(MAX_EFFORT, CertifiedClaims(a_map(name))).startswith(
        "100 % of the free area"
    )


def test_more_effort_proves_more(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(freearea, "BOXES_AT_FIRST", 3_000)
    claims = CertifiedClaims(a_map("truss"))
    assert isinstance(check_free_area(0, claims), Unchecked)
    found = [check_free_area(effort, claims) for effort in (1, 3)]
    shares = [Fraction(text.split(" %", maxsplit=1)[0]) for text in found]
    assert isinstance(found[0], Unchecked)
    assert 50 < shares[0] < shares[1] == 100


def with_one_cell(stored: RegionMap) -> RegionMap:
    """A map that knows of its largest cell only, so that no two samples can be found to be joined."""
    cell = min(stored.cells, key=lambda c: c.level)
    return replace(stored, cells=(replace(cell, region=0),))


def outcomes(stored: RegionMap, tries: int, effort: int = MAX_EFFORT) -> Iterator[str]:
    """What is found without single pieces, which are chosen at random."""
    cover = stored.cover
    assert cover is not None
    rng = random.Random(20)
    for number in rng.sample(range(len(cover.rectangles)), tries):
        try:
            yield check_free_area(effort, CertifiedClaims(without(with_one_cell(stored), number)))
        except Violation as violation:
            yield f"found: {violation}"


@pytest.mark.parametrize("name", RECORDS)
@pytest.mark.slow_cases("crank", "zeeman", "loop")
def test_a_dropped_rectangle_is_found(name: str) -> None:
    # one that others hold, or that no curve meets, is no loss
    found = list(outcomes(a_map(name), 6))
    assert all(text.startswith(("found: at", "100 %")) for text in found)
    assert sum(text.startswith("found") for text in found) >= 4


@pytest.mark.parametrize("count", PAPER)
@pytest.mark.slow_cases("admissible", "total")
def test_all_of_a_map_of_the_paper_s_mechanism_is_proved(count: str) -> None:
    stored = a_map(count, 0.05)
    assert len({region.stable for region in stored.regions}) == 2
    assert check_free_area(MAX_EFFORT, CertifiedClaims(stored)).startswith("100 % of the free area")


OPERATIONS = (
    "add",
    "subtract",
    "multiply",
    "divide",
    "cosine",
    "sine",
    "inverse_length",
    "length",
    "direction",
)


def some_formula(f: Formulas, rng: random.Random) -> int:
    """A formula of some operations, each of the last values."""
    values = [*map(f.variable, range(MAX_VARIABLES)), f.number(Fraction(rng.randint(-9, 9), 7))]
    for _ in range(rng.randint(2, 12)):
        name = rng.choice(OPERATIONS)
        a, b = rng.choice(values), rng.choice(values[-4:])
        if name in ("cosine", "sine"):
            values.append(getattr(f, name)(a))
        elif name == "direction":
            values.append(f.direction(a, b)[0])
        elif name != "divide" or f.constant(b) != 0:
            values.append(getattr(f, name)(a, b))
    return values[-1]


def test_affine_forms_hold_the_values() -> None:
    rng, checked = random.Random(7), 0
    for _ in range(400):
        f = Formulas()
        tape, _, (place,) = tape_of(f, [], [some_formula(f, rng)])
        at = np.array([rng.uniform(-2, 2) for _ in range(MAX_VARIABLES)])
        half = np.array([10 ** rng.uniform(-9, 0) for _ in range(MAX_VARIABLES)])
        forms = np.empty((len(tape.code), WIDTH))
        evaluate(tape, np.stack([at - half, at + half], axis=1), forms, 0, len(tape.code))
        wide = forms[place].copy()
        if not wide[ERROR] < np.inf:
            continue
        for _ in range(10):
            e = np.array([rng.choice((-1, 1, rng.uniform(-1, 1))) for _ in range(MAX_VARIABLES)])
            point = at + half * e
            evaluate(tape, np.stack([point, point], axis=1), forms, 0, len(tape.code))
            low, high = forms[place, LOW], forms[place, HIGH]
            if not high - low < 1e-6:
                continue
            value, lost = (low + high) / 2, (high - low) + 1e-13 * (1 + abs(low))
            assert wide[LOW] - lost <= value <= wide[HIGH] + lost
            assert abs(value - wide[CENTER] - wide[:MAX_VARIABLES] @ e) <= wide[ERROR] + lost
            checked += 1
    assert checked > 1000


def test_a_search_loses_no_box_where_it_tries_some_with_all_formulas(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    claims = CertifiedClaims(a_map("loop"))
    system, pieces = systems_of(claims.lattice)[0], no_pieces(claims.sweep.steps)

    def left() -> tuple[int, set[bytes]]:
        unseen, _, looked = search(system, pieces, system.start[None], 4_000, 2.0**-20)
        return looked, {box.tobytes() for box in unseen}

    monkeypatch.setattr(running, "LEARNT_FROM", 10**9)
    all_at_once = left()
    assert len(all_at_once[1]) > 300
    monkeypatch.setattr(running, "LEARNT_FROM", 0)
    monkeypatch.setattr(running, "WORTH", 0.0)
    assert left() == all_at_once


def test_a_box_that_is_halved_after_all_keeps_its_second_half(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of 32 boxes two are tried with all formulas; the others are stuck by some, and halved by all."""
    calls = []

    def looked(_system: Any, _pieces: Any, boxes: Any, outcome: Any, rest: Any, _told: Any) -> None:
        calls.append(len(boxes))
        outcome[:] = running.HALVED if len(calls) == 3 else running.STUCK
        if len(calls) == 3:
            rest[:] = boxes
            boxes[:, 0, 1] = rest[:, 0, 0] = 0.5

    system: Any = SimpleNamespace(zeros=(0,), signs=(), compiled=lambda _smallest: None)
    monkeypatch.setattr(running, "look", looked)
    monkeypatch.setattr(running, "LEARNT_FROM", 0)
    start = np.tile([[0.0, 1.0], [0.0, 1.0]], (32, 1, 1))
    unseen, stuck, _ = search(system, no_pieces(1), start, 32, 2.0**-20)
    assert calls == [2, 30, 30] and len(stuck) == 2
    assert unseen[:30].tolist() == [[[0.0, 0.5], [0.0, 1.0]]] * 30
    assert unseen[30:].tolist() == [[[0.5, 1.0], [0.0, 1.0]]] * 30


@pytest.mark.parametrize("drawn", [1_000, pytest.param(20_000, marks=pytest.mark.slow)])
def test_what_is_held_lies_in_the_cover(drawn: int) -> None:
    """Strips that are said to be held have no point outside, by the sweep, which is exact."""
    for name, tolerance in (("zeeman", 3e-3), ("truss", 3e-3)):
        claims = CertifiedClaims(a_map(name, tolerance))
        pieces, rng, held, steps = pieces_of(claims), random.Random(1), 0, claims.sweep.steps
        for _ in range(drawn):
            along, n = rng.randrange(2), rng.randrange(len(pieces.frames))
            f, size = pieces.frames[n], 10 ** rng.uniform(-4, 0.3)
            a = rng.uniform(f[2 * along], f[2 * along + 1])
            b = min(a + size * (f[2 * along + 1] - f[2 * along]), steps)
            middle = rng.uniform(f[2 - 2 * along], f[3 - 2 * along])
            slope, half = (
                rng.gauss(0, 1),
                10 ** rng.uniform(-3, 0) * size * (f[3 - 2 * along] - f[2 - 2 * along]),
            )
            ends = [middle, middle + slope * (b - a)]
            low, high = max(0.0, min(ends) - half), min(float(steps), max(ends) + half)
            if not (
                a < b
                and low < high
                and holds(pieces, along, np.array([a, b, a, middle, slope, -half, half, low, high]))
            ):
                continue
            held += 1
            u = rng.uniform(a, b)
            v = middle + slope * (u - a) + rng.choice((-1, 1, rng.uniform(-1, 1))) * half
            place = (Fraction(u), Fraction(v)) if along == 0 else (Fraction(v), Fraction(u))
            if low <= v <= high and all(0 < x < steps for x in place):
                component = claims.sweep.locate(*place)
                assert component is None or component not in claims.cell_of
        assert held > drawn // 200
