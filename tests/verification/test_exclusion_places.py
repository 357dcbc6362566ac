"""Where compiled code leaves solutions: none that balls find is outside, and formulas are those of
the balls.
"""

from __future__ import annotations

import random
import subprocess
import sys
from fractions import Fraction
from functools import cache
from math import pi
from typing import Any

import pytest
import yaml
from support.counting import counted_at
from support.maps import once_per_run
from support.records import TRUSS

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.model import known_of
from ptmcad.question.config import load
from ptmcad.question.slice import Count
from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.normalform.boxes import Box, Unproved
from ptmcad.verification.normalform.lattice import SliceLattice

pytest.importorskip("numba")


from support.replacing import replace

from ptmcad.verification.exclusion import places
from ptmcad.verification.exclusion.criticalsystems import halves_over
from ptmcad.verification.exclusion.places import SolutionPlaces

PAPER: dict[str, Any] = yaml.safe_load("""
mechanism: ptm
parameters: {L1: 1, k: 100, F3: -10, F4: -10, l0: 1/5}
axes: {rho: [0, 3/2], L2: [0, 2]}
""")
SLIDING: dict[str, Any] = yaml.safe_load("""
name: sliding
mechanism:
  name: sliding
  parameters: {F: {kind: force}, l: {kind: free length}}
  unknowns: {x: length}
  points: {O: [0, 0], B: [0, 1], S: [x, 0]}
  springs: [{between: [O, S], k: 1, free: l}, {between: [B, S], k: 1, free: l}]
  loads: {S: [F, 0]}
axes: {F: [-2, 2], l: [1/10, 2]}
""")
"""One spring along the slider's guide, and one from its side."""
RECORDS: dict[str, dict[str, Any]] = {"paper": PAPER, "sliding": SLIDING, "truss": TRUSS}
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
    lattice = SliceLattice(load("stability-pair"), 2**10)
    with pytest.raises(Unproved, match="no bound of the unknown x"):
        halves_over(lattice, lattice.window, lattice.window)
    find, place = SolutionPlaces(lattice), ((Fraction(300),) * 2, (Fraction(417),) * 2)
    assert max(find(*place)[0].whole) < 100
    with pytest.raises(Unproved, match="no bound of the unknown x"):
        find(lattice.window, lattice.window)


def at_random(claims: CertifiedClaims, rng: random.Random) -> tuple[Fraction, Fraction]:
    one, two = (Fraction(rng.randrange(1, 2**16) * claims.sweep.steps, 2**16) for _ in "uv")
    return one, two


@pytest.mark.parametrize(("name", "count"), CASES)
@pytest.mark.fast_cases("truss-index", "sliding-index")
def test_places_over_a_box_have_those_over_its_points(name: str, count: str) -> None:
    claims, rng, told = CertifiedClaims(a_map(name, count)), random.Random(name), 0
    found, counting = SolutionPlaces(claims.lattice), claims.counting
    half = Fraction(claims.sweep.steps, 4096)
    for _ in range(6):
        u, v = at_random(claims, rng)
        whole = found((u - half, u + half), (v - half, v + half))
        for du, dv in ((1, 1), (-1, 1), (0, -1)):
            try:
                there = counting.at(*claims.lattice.off(u + du * half, v + dv * half))
            except Unproved:
                continue
            told += 1
            kept = [e for e in there.found if count != "stable" or "-" not in e.signs]
            assert all(any(inside(e.center, box) for boxes in whole for box in boxes) for e in kept)
    assert told > 8


def inside(at: tuple[float, ...], box: Box) -> bool:
    """Whether a point is in a box, but for whole turns and rounding."""
    turned = [
        min(abs(x - m + 2 * k * pi) for k in (-1, 0, 1)) for x, m in zip(at, box[0], strict=True)
    ]
    return all(d <= r + 1e-9 for d, r in zip(turned, box[1], strict=True))


@pytest.mark.parametrize("name", ["truss", pytest.param("paper", marks=pytest.mark.slow)])
def test_a_search_that_is_spent_leaves_what_it_has(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    claims = CertifiedClaims(a_map(name, "index"))
    at = at_random(claims, random.Random(1))
    true = claims.counting.at(*claims.lattice.off(*at))
    for budget, left in ((1, 512), (5, 512), (40, 512), (4000, 6)):
        monkeypatch.setattr(places, "BUDGET", budget)
        monkeypatch.setattr(places, "MAX_LEFT", left)
        where = SolutionPlaces(claims.lattice)((at[0],) * 2, (at[1],) * 2)
        assert len(list(where[0])) <= left
        assert all(any(inside(e.center, box) for box in where[0]) for e in true.found)


def test_without_compiled_code_the_same_code_runs() -> None:
    """In a process of its own, as decorators ask for numba when modules are loaded."""
    run = """
import subprocess
import sys
sys.modules["numba"] = None
from fractions import Fraction
from ptmcad.model import known_of
from ptmcad.question.slice import Axis, Count, Slice
from ptmcad.text.expressions import constant
from ptmcad.verification.certified.models import ModelCounting
from ptmcad.verification.normalform.lattice import SliceLattice
axes = (Axis("x", Fraction(0), Fraction(1)), Axis("y", Fraction(0), Fraction(1)))
given = {"rho": 1, "L1": 1, "L2": Fraction(3, 2), "k1": 1, "k2": 1, "k3": 1, "l0_1": Fraction(1, 5)}
model = known_of("ptm")
values = {n: constant(Fraction(given.get(n, 0))) for n in model.variables}
slice = Slice("", model, axes, values, Count.INDEX)
counting = ModelCounting(SliceLattice(slice, 2))
print(counting.at(Fraction(1, 2), Fraction(1, 2)).counts.index)
"""
    found = subprocess.run([sys.executable, "-c", run], capture_output=True, text=True, check=True)
    given = {"rho": "1", "L1": "1", "L2": "3/2", "k1": "1", "k2": "1", "k3": "1", "l0_1": "1/5"}
    values = {n: Fraction(given.get(n, "0")) for n in known_of("ptm").variables}
    assert found.stdout.strip() == str(counted_at(values, Count.INDEX)[2].counts.index)


def test_forged_counts_are_refused_with_places() -> None:
    true = a_map("truss", "stable")
    wrong = replace(
        true,
        cells=tuple(
            replace(c, stable=(c.stable or 0) + (k == 0)) for k, c in enumerate(true.cells)
        ),
    )
    assert not ptmcad.verify(wrong).ok
