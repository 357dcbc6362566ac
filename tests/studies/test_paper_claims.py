"""Every claim of the paper: its computed verdict, the computed facts, and the same facts found in another way.

The other ways share no code with the checks: exact dual numbers over the rationals in place of SymPy and FLINT,
tests/support/oracle.py for counts, Newton's method in floating point. Known answers: the paper itself, and
docs/errata.md.
"""

from __future__ import annotations

import dataclasses
import math
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import pytest
import sympy as sp
from support import oracle
from support.few import few
from support.free_length_equilibria import free_length_equilibria
from support.maps import once_per_run

from ptmcad.algebra.elimination import real_root_number
from ptmcad.answer.regionmap import Merge, Status
from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Outcome, Verdict, judge
from ptmcad.studies.paper.claims import (
    TEXTS,
    all_claims,
    basics,
    extensions,
    free_springs,
    general,
    overall,
    symmetric,
    unloaded,
    unloaded_map,
)
from ptmcad.studies.paper.free_lengths import FreeLengthDesign, proved_equilibrium
from ptmcad.studies.paper.slices import FIGURES, region_map, slice_of
from ptmcad.studies.paper.squaring.equations import squared_equations
from ptmcad.text.flint_numbers import to_fraction

SECTIONS = (
    "abstract", "1", "2", "3", "3.1", "3.2", "3.3", "4", "4.1", "4.2", "4.3", "5.1", "5.2", "conclusions",
)  # fmt: skip
CLAIMS = {claim.name: claim for claim in all_claims()}
OUTCOMES: dict[Callable[[], Outcome], Outcome] = {}


def outcome(name: str) -> Outcome:
    """What the check finds; claims that have one check in common share it."""
    check = CLAIMS[name].check
    if check not in OUTCOMES:
        OUTCOMES[check] = check()
    return OUTCOMES[check]


@pytest.fixture(scope="module", autouse=True)
def certified_maps_are_made_once() -> Iterator[None]:
    """By the first process of a run that asks for one."""
    whole = free_springs.certified
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(free_springs, "certified", cache(lambda n: once_per_run(f"paper, {n}", lambda: whole(n))))
        yield


CORRECTED = (
    "1-always-six", "2-fixed-point", "2-eq2", "2-eq4", "3-eq6", "3-degree-6", "3-linear", "3.1-singular", "3.1-eq9",
    "3.1-always", "3.2-eqs-used", "3.3-three-flat", "3.3-eq13", "4-parameters", "4.1-three-flat", "4.1-non-flat",
    "4.3-curves", "4.3-fig5-values", "5.1-terms", "5.1-nature", "5.2-degree-328", "c-width", "c-parallelogram",
    "c-singular", "c-four-unsymmetric", "a-one-dof", "3.3-others", "5.2-real", "5.2-difficult",
)  # fmt: skip
REFUTED = ("5.2-six", "c-six-free")
NOT_CHECKED = (
    "1-references", "2-zero-free-length", "3.3-large", "4-tools", "1-complicated", "5.2-specialise", "5.2-crane",
    "c-store",
)  # fmt: skip


def expected(name: str) -> Verdict:
    groups = ((CORRECTED, Verdict.CORRECTED), (REFUTED, Verdict.REFUTED), (NOT_CHECKED, Verdict.NOT_CHECKED))
    return next((verdict for names, verdict in groups if name in names), Verdict.CONFIRMED)


# --- another way to the model: dual numbers with rational coefficients ------------------------------------------------


@dataclass(frozen=True)
class Dual:
    """A number with derivatives by two angles, up to second order: (value, d1, d2, d11, d12, d22)."""

    parts: tuple[Fraction, ...]

    @classmethod
    def of(cls, x: Any) -> Dual:
        return x if isinstance(x, Dual) else cls((Fraction(x), *(Fraction(0),) * 5))

    def __add__(self, other: Any) -> Dual:
        return Dual(tuple(a + b for a, b in zip(self.parts, Dual.of(other).parts, strict=True)))

    __radd__ = __add__

    def __neg__(self) -> Dual:
        return Dual(tuple(-a for a in self.parts))

    def __sub__(self, other: Any) -> Dual:
        return self + -Dual.of(other)

    def __rsub__(self, other: Any) -> Dual:
        return -self + other

    def __mul__(self, other: Any) -> Dual:
        a, b = self.parts, Dual.of(other).parts
        return Dual((
            a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[2] * b[0],
            a[0] * b[3] + 2 * a[1] * b[1] + a[3] * b[0],
            a[0] * b[4] + a[1] * b[2] + a[2] * b[1] + a[4] * b[0],
            a[0] * b[5] + 2 * a[2] * b[2] + a[5] * b[0],
        ))  # fmt: skip

    __rmul__ = __mul__


Point = Mapping[str, Fraction]


def angle(t: Fraction, number: int) -> tuple[Dual, Dual]:
    """Cosine and sine of an angle with the given half-angle tangent, with their derivatives."""
    c, s, zero = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t), Fraction(0)
    if number == 1:
        return Dual((c, -s, zero, -c, zero, zero)), Dual((s, c, zero, -s, zero, zero))
    return Dual((c, zero, -s, zero, zero, -c)), Dual((s, zero, c, zero, zero, -s))


def energy(p: Point) -> Dual:
    """U from the nodes' coordinates."""
    (c1, s1), (c2, s2) = angle(p["t1"], 1), angle(p["t2"], 2)
    x3, y3 = p["L1"] * c1, p["L1"] * s1
    x4, y4 = p["rho"] - p["L2"] * c2, p["L2"] * s2
    squares = x4 * x4 + y4 * y4 + (x3 - p["rho"]) * (x3 - p["rho"]) + y3 * y3
    squares = squares + (x4 - x3) * (x4 - x3) + (y4 - y3) * (y4 - y3)
    loads = p["F3"] * y3 + p["F4"] * y4 + p["F3x"] * x3 + p["F4x"] * x4
    return p["k"] / 2 * squares - loads


def random_point(draw: Random, **given: Fraction | int) -> dict[str, Fraction]:
    names = ("L1", "L2", "rho", "k", "F3", "F4", "F3x", "F4x", "t1", "t2")
    point = {n: Fraction(draw.randint(1, 40), draw.randint(1, 9)) for n in names}
    for name in ("F3", "F4", "F3x", "F4x", "t1", "t2"):
        point[name] *= draw.choice((-1, 1))
    return point | {"F3x": Fraction(0), "F4x": Fraction(0)} | {n: Fraction(v) for n, v in given.items()}


def value(expression: Any, p: Point) -> Fraction:
    """A SymPy expression at rational values, half angles for the cosines and sines."""
    (c1, s1), (c2, s2) = angle(p["t1"], 1), angle(p["t2"], 2)
    at = dict(p) | {"c1": c1.parts[0], "s1": s1.parts[0], "c2": c2.parts[0], "s2": s2.parts[0]}
    found = sp.sympify(expression).subs(
        {s: sp.Rational(at[s.name].numerator, at[s.name].denominator) for s in expression.free_symbols}
    )
    return to_fraction(found)


POINTS = [random_point(Random(n)) for n in range(5)]


def test_printed_and_right_equations_2_to_6_at_rational_points() -> None:
    """The verdicts on (2) to (6), found again without SymPy's differentiation or FLINT."""
    differs = {"2": False, "4": False, "6": False}
    for p in POINTS:
        u = energy(p).parts
        one = sp.Integer(1)
        assert value(printed.potential_2(one), p) == u[0]
        differs["2"] |= value(printed.potential_2(sp.Symbol("rho", positive=True)), p) != u[0]
        assert value(printed.EQUATION_3, p) == -u[2] / p["L2"]
        assert value(printed.EQUATION_4, p) == -u[1] / p["L1"]
        differs["4"] |= value(printed.EQUATION_4_PRINTED, p) != -u[1] / p["L1"]
        clear = (1 + p["t1"] ** 2) * (1 + p["t2"] ** 2)
        assert value(printed.EQUATION_5, p) == u[1] / p["L1"] * clear
        assert value(printed.EQUATION_6, p) == u[2] / p["L2"] * clear
        differs["6"] |= value(printed.EQUATION_6_PRINTED, p) != u[2] / p["L2"] * clear
    assert all(differs.values())


def test_horizontal_forces_at_rational_points() -> None:
    """5.1: + 2 F3x and - 2 F4x."""
    for seed in range(3):
        p = random_point(Random(seed), F3x=7, F4x=-3)
        u = energy(p).parts
        clear = (1 + p["t1"] ** 2) * (1 + p["t2"] ** 2)
        five, six = printed.with_horizontal_forces(1, -1)
        assert (value(five, p), value(six, p)) == (u[1] / p["L1"] * clear, u[2] / p["L2"] * clear)
        assert value(printed.with_horizontal_forces(1, 1)[1], p) != u[2] / p["L2"] * clear


# --- verdicts and facts -----------------------------------------------------------------------------------------------


def test_the_list_is_whole() -> None:
    """Names are unique, sections follow each other as in the paper, quotations are short."""
    assert re.findall(r"^([\w.-]+):$", TEXTS.read_text(encoding="utf-8"), re.MULTILINE) == list(CLAIMS)
    assert len(CLAIMS) > 85
    sections = [SECTIONS.index(claim.section) for claim in CLAIMS.values()]
    assert sections == sorted(sections)
    assert {*sections} == {*range(len(SECTIONS))}
    assert all(len(claim.quotation) < 90 for claim in CLAIMS.values())
    assert set(CORRECTED) | set(REFUTED) | set(NOT_CHECKED) <= set(CLAIMS)


FACTS: dict[str, dict[str, Any]] = {
    "a-six": {"bound": 6, "attained": 6},
    "1-always-six": {"infinite at rho = 0 unloaded": True, "only there": True},
    "a-stable": {"allowed": ("4,1", "6,1", "6,2"), "seen": ("4,1", "6,1", "6,2")},
    "2-fixed-point": {"moving": ("A2",)},
    "2-both-kinds": {"cells": 39},
    "3-degree-6": {"degree of the resultant": 8, "degree left": 6},
    "3-linear": {"equilibria over t2 = 0": 2},
    "3.1-singular": {"stable ones near the flat one under a small load": 1, "flat equilibria under vertical load": ()},
    "3.1-eq9": {"total inside": 6, "total outside": 4, "cosine": "-1/8", "arctan fails": True},
    "3.1-parallelogram": {"x3 - x4": "rho"},
    "3.2-arsenault": {"degree": 4},
    "3.2-distinct": {"total": 6, "equal angles": 4},
    "3.2-eq12": {"ratio": "1", "degree": 2},
    "3.2-four": {"degree": 4, "real roots": 4},
    "3.3-three-flat": {"never": ("(pi, pi)",), "stable": ("(0, 0)", "(pi, 0)", "(0, pi)", "none")},
    "4-parameters": {"parameters": 6, "lengths alone": False},
    "4.1-width": {"L2 > 1": "1", "L2 < 1": "L2"},
    "4.2-region": {"stable": (1, 2), "regions with two": 1, "sliver": True},
    "4.2-eq15-16": {"matched": (1, 1), "curves": 2, "degrees": (6, 6), "rose and astroid": True},
    "4.3-curves": {"curves": 1, "degrees": (24, 12), "terms": 70},
    "4.3-fig5-degrees": {"terms": (115, 115)},
    "5.2-degree-28": {"total degrees": (28, 28), "in t1, t2": (16, 12, 12, 16)},
    "5.2-degree-328": {"degree": 400, "exponent": 48, "left": 304, "factors": ("(256, 1)", "(2, 8)", "(2, 16)"),
                       "multiplicity of l1 = 0": 8, "multiplicity of l3 = 0": 16, "complex solutions": 128,
                       "real solutions": 48, "opposed": 128, "unsettled": 0},
    "5.2-spurious": {"real roots": 94, "real, any signs": 48, "equilibria": 6, "proved": 6, "stable": 2},
    "5.2-six": {"l0 = 0.2": (12, 12, 2, 2), "l0 = 1.01487": (26, 26, 8, 0), "l0 = 1.43487": (30, 30, 10, 0),
                "at the eliminated design": 6},
    "2-dof": {"by coordinates": 3, "by constraints": 3, "A2 by rho alone": True},
    "a-one-dof": {"degrees of freedom": 3, "equilibria at most": 6},
    "3.3-others": {"(total, stable, saddles)": ("4,1,2", "6,1,3", "6,2,3"), "seen are allowed": True},
    "4.1-geometric": {"Heron": True},
    "5.2-eq17": {"(1) for l0 = 0": True, "derivatives": (1, 1), "coefficient of l1": "-k*l0"},
    "5.2-real": {"real roots": (94, 68, 66, 31, 27, 3), "within 12 to 30": (27,)},
    "5.2-acceptable": {"rho = 0.7": (2, 0, 4), "rho = 0.96859": (2, 0, 1), "rho = 1.20609": (8, 8, 1)},
    "5.2-difficult": {"stable counts": (1, 2), "fine enough": True, "at the eliminated design": (2, 2)},
    "c-tools": {"exact maps": 5, "all counted": True},
    "c-four-unsymmetric": {"bound": 2, "not symmetric": 2, "unstable": 4, "totals": (4, 6)},
}  # fmt: skip


SLOW = ("5.2-six", "c-six-free", "5.2-real", "5.2-degree-328", "4.3-widest")
"""Many eliminations; tests/algebra makes one of each kind, and the proofs one by one are below."""


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in SLOW else ()) for name in CLAIMS]
)
def test_verdict(name: str) -> None:
    """The verdict, what each kind of verdict must come with, and the facts: known from the paper or docs/errata.md."""
    found = outcome(name)
    assert found.verdict is expected(name), found
    if found.verdict is Verdict.NOT_CHECKED:
        assert found.reason and not found.facts
    else:
        assert found.evidence and found.facts and not found.reason
    assert bool(found.right) == (found.verdict is Verdict.CORRECTED)
    assert found.witness or found.verdict is not Verdict.REFUTED
    assert {key: found.facts[key] for key in FACTS.get(name, {})} == FACTS.get(name, {})
    assert not any("np." in text or "Fraction(" in text for text in found.evidence)


# --- the same found in other ways -------------------------------------------------------------------------------------


def count(**given: Any) -> tuple[int, int, int]:
    """Minima, saddles and maxima by tests/support/oracle.py."""
    values = {"L1": 1, "L2": 1, "rho": 1, "k1": 100, "k2": 100, "k3": 100, "F3": 0, "F4": 0, "F3x": 0, "F4x": 0} | given
    return oracle.count({name: Fraction(v) for name, v in values.items()})


@pytest.mark.parametrize(("at", "minima", "total"), [
    ({"L2": "3/2", "rho": 1}, 2, 6),
    ({"rho": "3/4", "F3": -10, "F4": -10}, 2, 6),
    ({"L2": "3/2", "rho": "7/10", "F3": -10, "F4": -10}, 2, 6),
    ({"L2": "3/2", "rho": 2}, 1, 4),
    ({"L2": "3/2", "rho": "3/4", "F3": -10, "F4": -20}, 2, 6),
    ({"rho": "1/2", "F3": -30, "F4": -20}, 2, 6),
    ({"L2": "3/2", "rho": "7/10", "F3": -10, "F4": -10, "F3x": 5, "F4x": -7}, 2, 6),
    ({"rho": 2, "F3": -10, "F4": -10, "F3x": -30, "F4x": 10}, 1, 4),
], ids=["fig2", "fig3", "fig4", "3.1-flat", "fig5-text", "fig5-caption", "5.1", "5.1-few"])  # fmt: skip
def test_counts_by_the_oracle(at: dict[str, Any], minima: int, total: int) -> None:
    found = count(**at)
    assert (found[0], sum(found)) == (minima, total)


@pytest.mark.parametrize("length2", few(["1/2", "99/100", "1", "101/100", "3/2", "2"], "1/2", "1", "3/2"))
def test_width_of_fig4_by_the_oracle(length2: str) -> None:
    """4.3-widest: the ends of the range by bisection on the oracle's counts, which knows no variety."""
    widest = general.widest()
    low, high = widest.widths[Fraction(length2)]
    middle = Fraction(1, 2) if Fraction(length2) <= Fraction(101, 100) else Fraction(4, 5)

    def two(rho: Fraction) -> bool:
        return count(L2=length2, rho=rho, F3=-10, F4=-10)[0] == 2

    assert two(middle)

    def end(inside: Fraction, outside: Fraction) -> Fraction:
        for _ in range(20):
            half = (inside + outside) / 2
            inside, outside = (half, outside) if two(half) else (inside, half)
        return inside

    width = end(middle, Fraction(2)) - end(middle, Fraction(1, 20))
    assert float(width) == pytest.approx(float(low), abs=1e-5)
    assert high - low < Fraction(1, 10**12)
    if length2 != "1":
        assert high < widest.widths[Fraction(1)][0]


def test_unequal_angles_in_floating_point() -> None:
    """(12), (13) and the pairing: the roots of (12) are equilibria, exchange t1 and t2, and have the right det H."""
    k, rho, f, length = 100.0, 0.75, -10.0, 1.0
    a = 4 * f * k**2 * (length * rho + rho**2) + f**3
    b = 16 * k**3 * rho**3 + 4 * f**2 * k * rho
    c = -(f**3) + 4 * f * k**2 * (length * rho - rho**2)
    root = math.sqrt(b * b - 4 * a * c)
    pair = ((-b - root) / (2 * a), (-b + root) / (2 * a))
    for t2, other in (pair, pair[::-1]):
        t1 = -(f * t2 + 2 * k * rho) / (f - 2 * k * rho * t2)
        assert t1 == pytest.approx(other)
        p = {"L1": 1, "L2": 1, "rho": rho, "k": k, "F3": f, "F4": f, "F3x": 0, "F4x": 0, "t1": t1, "t2": t2}
        u = [float(x) for x in energy({n: Fraction(v) for n, v in p.items()}).parts]
        assert abs(u[1]) + abs(u[2]) < 1e-9
        determinant = u[3] * u[5] - u[4] ** 2
        square = k * rho * t2**2 - f * t2 - k * rho
        assert determinant == pytest.approx(-4 * length**2 * square**2 / (1 + t2**2) ** 2)
        shown = -4 * (t2**2 + 1) ** 2 * (4 * k**2 * rho**2 + f**2) ** 2 * square**2 / (f - 2 * k * rho * t2) ** 4
        assert determinant != pytest.approx(shown)
        assert determinant < 0


def test_non_flat_equilibria_at_a_triangle() -> None:
    """3.1-eq9, 4.1-non-flat, at the triangle with sides 13, 20, 21 and height 12: exact rational half angles."""
    p = random_point(Random(0), L1=13, L2=20, rho=Fraction(21, 2), k=1, F3=0, F4=0,
                     t1=Fraction(12, 13 + 5), t2=Fraction(12, 20 + 16))  # fmt: skip
    u = energy(p).parts
    assert u[1] == u[2] == 0
    assert (u[3], u[5]) == (13**2, 20**2)
    assert u[3] * u[5] - u[4] ** 2 == (2 * p["rho"] * 12) ** 2
    (c1, s1), (c2, s2) = angle(p["t1"], 1), angle(p["t2"], 2)
    assert 13 * s1.parts[0] == 20 * s2.parts[0] == 12
    assert 13 * c1.parts[0] - (p["rho"] - 20 * c2.parts[0]) == p["rho"]


@pytest.mark.parametrize(("length2", "rho", "stable"), [
    (1, 2, (0, 0)), (3, Fraction(1, 2), (1, 0)), (Fraction(1, 4), Fraction(1, 4), (0, 1)), (1, Fraction(1, 2), None),
])  # fmt: skip
def test_flat_equilibria_one_by_one(length2: Any, rho: Any, stable: tuple[int, int] | None) -> None:
    """3.3-three-flat: which of the four is stable, from H by hand; its determinant is not zero (c-singular)."""
    k, length2, rho = 1, Fraction(length2), Fraction(rho)
    good = []
    for a in (0, 1):
        for b in (0, 1):
            c1, c2 = (-1) ** a, (-1) ** b
            h11 = 2 * k * rho * c1 - k * length2 * c1 * c2
            h22 = length2 * (2 * k * rho * c2 - k * c1 * c2)
            h12 = -k * length2 * c1 * c2
            assert h11 * h22 - h12**2 != 0
            if h11 > 0 and h11 * h22 - h12**2 > 0:
                good.append((a, b))
    assert good == ([] if stable is None else [stable])


def stable_heights(at: Mapping[str, float]) -> list[tuple[float, float]]:
    """(y3, y4) of the stable equilibria, by descent from a grid in floating point."""
    length2, rho, f3, f4 = (at[n] for n in ("L2", "rho", "f3", "f4"))
    found: list[tuple[float, float]] = []
    for i in range(8):
        for j in range(8):
            a, b = (i + 0.4) * math.pi / 4, (j + 0.7) * math.pi / 4
            for _ in range(4000):
                s12 = math.sin(a + b)
                g1 = -(length2 * s12 - 2 * rho * math.sin(a) + f3 * math.cos(a))
                g2 = -length2 * (s12 - 2 * rho * math.sin(b) + f4 * math.cos(b))
                a, b = a - 0.1 * g1, b - 0.1 * g2
                if abs(g1) + abs(g2) < 1e-10:
                    break
            y = (math.sin(a), length2 * math.sin(b))
            if all(math.dist(y, z) > 1e-5 for z in found):
                found.append(y)
    return found


@pytest.mark.parametrize(("at", "signs"), [
    ({"L2": 1.0, "rho": 0.75, "f3": -0.1, "f4": -0.1}, {(1, 1), (-1, -1)}),
    ({"L2": 1.0, "rho": 1.2, "f3": -0.1, "f4": -0.1}, {(-1, -1)}),
    ({"L2": 1.5, "rho": 0.7, "f3": -0.1, "f4": -0.1}, {(1, 1), (-1, -1)}),
    ({"L2": 1.5, "rho": 0.3, "f3": -0.1, "f4": -0.1}, {(-1, -1)}),
    ({"L2": 1.0, "rho": 1.2, "f3": 0.1, "f4": 0.1}, {(1, 1)}),
    ({"L2": 1.0, "rho": 0.75, "f3": 0.1, "f4": 0.1}, {(1, 1), (-1, -1)}),
])  # fmt: skip
def test_heights_by_descent(at: dict[str, float], signs: set[tuple[int, int]]) -> None:
    """4.2-reverse, 4.2-range, 4.2-pulling, 4.3-range: minima found by going downhill, which finds minima only."""
    assert {(int(math.copysign(1, y3)), int(math.copysign(1, y4))) for y3, y4 in stable_heights(at)} == signs


def test_free_lengths_by_newton() -> None:
    """5.2-six: as many equilibria as a Newton search with difference quotients finds."""
    for design in extensions.WITNESSES:
        proved = extensions.equilibria_with(design)
        assert len(proved) == free_length_equilibria(*map(float, design))


def test_squared_equations_vanish_at_the_equilibria() -> None:
    """5.2-degree-28: squaring loses no equilibrium."""
    rho, rods, free, loads = extensions.ELIMINATED
    equations = squared_equations(rho, rods, free, loads)
    design = ("0.7", "1", "1.5", "0.2", "-0.1", "-0.1")
    for e in extensions.equilibria_with(design):
        tangents = [math.tan(float(a) / 2) for a in e.angles]
        for p in equations:
            terms = [float(c) * tangents[0] ** int(i) * tangents[1] ** int(j) for (i, j), c in p.terms()]
            assert abs(math.fsum(terms)) < 1e-8 * max(map(abs, terms))


@pytest.mark.parametrize(("coefficients", "number"), [
    ([0, 1], 1), ([1, 0, 1], 0), ([0, -1, 0, 1], 3), ([6, -5, 1], 2), ([0, 0, 0, -2, 1], 2), ([3], 0), ([-2, 0, 1], 2),
])  # fmt: skip
def test_real_root_number(coefficients: list[int], number: int) -> None:
    from flint import fmpz_poly

    assert real_root_number(fmpz_poly(coefficients)) == number


def test_no_box_without_an_equilibrium() -> None:
    """Krawczyk's test proves nothing where there is no equilibrium, nor where the box is off by more than its width."""
    rho, length1, length2, free, f3, f4 = map(Fraction, extensions.TWELVE)
    design = FreeLengthDesign(rho, length1, length2, free, f3, f4)
    (a, b) = (float(x) for x in extensions.equilibria_with(extensions.TWELVE)[0].angles)
    assert proved_equilibrium(design, (a, b)) is not None
    assert proved_equilibrium(design, (a + 1e-8, b)) is None
    assert proved_equilibrium(design, (a + 0.5, b)) is None


@pytest.mark.parametrize("figure", FIGURES)
def test_slices_are_those_of_the_shipped_records(figure: str) -> None:
    import ptmcad

    shipped = ptmcad.load(Path(__file__).resolve().parents[2] / "configs" / f"{figure}.yaml")
    ours = slice_of(figure)
    assert (ours.axes, ours.parameters, ours.title) == (shipped.axes, shipped.parameters, shipped.title)


def test_three_degrees_of_freedom_at_rational_points() -> None:
    """2-dof: the positions' derivatives by rho, th1 and th2 are independent, by dual numbers and elimination."""
    for p in POINTS:
        (c1, s1), (c2, s2) = angle(p["t1"], 1), angle(p["t2"], 2)
        moving = (p["rho"] - p["L2"] * c2, p["L2"] * s2, p["L1"] * c1, p["L1"] * s1)
        by_angle = [[Fraction(0)] + [Dual.of(x).parts[n] for x in moving] for n in (1, 2)]
        rows = [[Fraction(x) for x in (1, 1, 0, 0, 0)], *by_angle]
        assert sp.Matrix(3, 5, lambda i, j: sp.Rational(*rows[i][j].as_integer_ratio())).rank() == 3  # noqa: B023


def elastic_energy(design: tuple[str, ...], angles: tuple[float, float]) -> tuple[float, tuple[float, ...]]:
    """U/k of (17) in floating point, and the springs' lengths."""
    rho, length1, length2, free, f3, f4 = map(float, design)
    a, b = angles
    x3, y3 = length1 * math.cos(a), length1 * math.sin(a)
    x4, y4 = rho - length2 * math.cos(b), length2 * math.sin(b)
    lengths = (math.hypot(x4, y4), math.hypot(x3 - rho, y3), math.hypot(x4 - x3, y4 - y3))
    return sum((n - free) ** 2 for n in lengths) / 2 - f3 * y3 - f4 * y4, lengths


def test_engine_gradient_by_difference_quotients() -> None:
    """5.2-eq17: the translated formulas of the certified engine are the slope of (17)."""
    from ptmcad.studies.paper.free_potential import LENGTHS, engine_gradient, l0

    design, (a, b), h = extensions.TWELVE, (0.7, -2.1), 1e-6
    rho, length1, length2, free, f3, f4 = map(float, design)
    values = {"rho": rho, "L1": length1, "L2": length2, "k": 1.0, "F3": f3, "F4": f4, "F3x": 0.0, "F4x": 0.0,
              "c1": math.cos(a), "s1": math.sin(a), "c2": math.cos(b), "s2": math.sin(b)}  # fmt: skip
    at = {symbol: n for symbol, n in zip(LENGTHS, elastic_energy(design, (a, b))[1], strict=True)} | {l0: free}
    for n, slope in enumerate(engine_gradient()):
        up, down = ((a + h * (n == 0) * e, b + h * (n == 1) * e) for e in (1, -1))
        found = (elastic_energy(design, up)[0] - elastic_energy(design, down)[0]) / (2 * h)
        there = at | {s: values[s.name] for s in slope.free_symbols if s.name in values}
        assert float(slope.subs(there)) == pytest.approx(found, abs=1e-8)


@pytest.mark.parametrize("design", [extensions.AT_ELIMINATED, extensions.TWELVE, extensions.TWENTY_SIX])
def test_stable_and_tense_by_difference_quotients(design: tuple[str, ...]) -> None:
    """5.2-acceptable: stability and lengths at the poses, from the energy alone."""
    h, found = 1e-4, [0, 0, 0]
    for e in extensions.equilibria_with(design):
        a, b = map(float, e.angles)
        u = {(i, j): elastic_energy(design, (a + i * h, b + j * h))[0] for i in (-1, 0, 1) for j in (-1, 0, 1)}
        h11, h22 = u[1, 0] + u[-1, 0] - 2 * u[0, 0], u[0, 1] + u[0, -1] - 2 * u[0, 0]
        h12 = (u[1, 1] + u[-1, -1] - u[1, -1] - u[-1, 1]) / 4
        stable, tense = h11 > 0 and h11 * h22 > h12**2, min(elastic_energy(design, (a, b))[1]) > float(design[3])
        found[0] += stable
        found[1] += stable and not tense
        found[2] += tense and not stable
    assert outcome("5.2-acceptable").facts[f"rho = {design[0]}"] == tuple(found)


def test_real_roots_by_complex_roots() -> None:
    """5.2-real: all complex roots, real ones recognised by their enclosures; no root isolation on the line."""
    from ptmcad.algebra.polynomials import coefficients_in
    from ptmcad.algebra.resultants import resultant

    _, rods, free, _ = extensions.ELIMINATED
    first, second = squared_equations(free_springs.WITHOUT_LOADS[1], rods, free, (Fraction(0), Fraction(0)))
    roots: list[Any] = resultant(coefficients_in(first, 0), coefficients_in(second, 0)).complex_roots()
    assert sum(root.imag == 0 for root, _ in roots) == FACTS["5.2-real"]["real roots"][4]


def test_maps_with_free_lengths_at_points() -> None:
    """5.2-difficult: as many stable equilibria as Krawczyk's test proves from a grid of starting points."""
    from ptmcad.ask.location import locate
    from ptmcad.studies.paper.free_lengths import proved_equilibria

    half, draw = Fraction(3, 2), Random(7)
    seen: list[int] = []
    map_ = free_springs.certified("L2 = 3/2")
    while len(seen) < 5:
        rho, free = Fraction(draw.randint(26, 124), 100), Fraction(draw.randint(1, 49), 200)
        there = locate(map_, {"rho": rho, "l0": free})
        if there.stable is not None:
            load = Fraction(-1, 10)
            poses = proved_equilibria(FreeLengthDesign(rho, Fraction(1), half, free, load, load))
            assert there.stable == sum(e.stable for e in poses)
            seen.append(there.stable)
    assert set(seen) == {1, 2}


def test_half_are_saddles_by_the_oracle() -> None:
    """3.3-others, at points that the check does not use."""
    draw = Random(33)
    for _ in range(4):
        loads = {n: draw.randint(-90, 90) for n in ("F3", "F4", "F3x", "F4x")}
        at = {n: Fraction(draw.randint(20, 250), 100) for n in ("L2", "rho")}
        minima, saddles, maxima = count(**at, **loads)
        assert minima in (1, 2) and saddles == minima + maxima


# --- verdicts follow the evidence: each check is broken once ----------------------------------------------------------


def _wrong(expression: Any) -> Any:
    return expression + sp.Symbol("rho", positive=True)


@pytest.mark.parametrize(("name", "claim"), [
    ("EQUATION_3", "2-eq3"),
    ("EQUATION_4", "2-eq4"),
    ("EQUATION_5", "3-eq5"),
    ("EQUATION_6", "3-eq6"),
    ("EQUATION_7", "3.1-eq7-8"),
    ("EQUATION_10", "3.2-eq10"),
    ("EQUATION_11", "3.2-eq11"),
    ("EQUATION_12", "3.2-eq12"),
    ("BOUNDARY_15", "4.2-eq15-16"),
    ("BOUNDARY_16", "4.2-eq15-16"),
    ("DETERMINANT_13", "3.3-eq13"),
])  # fmt: skip
def test_a_wrong_equation_is_not_confirmed(monkeypatch: pytest.MonkeyPatch, name: str, claim: str) -> None:
    monkeypatch.setattr(printed, name, _wrong(getattr(printed, name)))
    assert CLAIMS[claim].check().verdict is Verdict.UNDECIDED


@pytest.mark.parametrize(("name", "right", "claim"), [
    ("EQUATION_4_PRINTED", "EQUATION_4", "2-eq4"),
    ("EQUATION_6_PRINTED", "EQUATION_6", "3-eq6"),
])  # fmt: skip
def test_a_right_equation_would_be_confirmed(
    monkeypatch: pytest.MonkeyPatch, name: str, right: str, claim: str
) -> None:
    """Had the paper printed the right one, the verdict would say so: it is not typed in."""
    monkeypatch.setattr(printed, name, getattr(printed, right))
    assert CLAIMS[claim].check().verdict is Verdict.CONFIRMED


def test_a_right_determinant_would_be_confirmed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(printed, "DETERMINANT_13", symmetric.on_unequal(symmetric.determinant()))
    assert CLAIMS["3.3-eq13"].check().verdict is Verdict.CONFIRMED


def test_a_third_line_that_is_none_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(printed, "UNLOADED_LINES", (*printed.UNLOADED_LINES[:2], _wrong(printed.UNLOADED_LINES[2])))
    assert CLAIMS["4.1-lines"].check().verdict is Verdict.UNDECIDED
    assert CLAIMS["4.1-boundaries-flat"].check().verdict is Verdict.UNDECIDED


def test_six_equilibria_would_not_refute(monkeypatch: pytest.MonkeyPatch) -> None:
    """A witness with six equilibria decides nothing: a lower bound cannot confirm the claim either."""
    monkeypatch.setattr(extensions, "WITNESSES", (extensions.AT_ELIMINATED,))
    assert CLAIMS["5.2-six"].check().verdict is Verdict.UNDECIDED


def test_an_elimination_without_spurious_roots_would_not_confirm(monkeypatch: pytest.MonkeyPatch) -> None:
    found = dataclasses.replace(extensions.elimination(), real_roots=6)
    monkeypatch.setattr(extensions, "elimination", lambda: found)
    assert CLAIMS["5.2-spurious"].check().verdict is Verdict.UNDECIDED


def test_a_wrong_potential_is_not_confirmed(monkeypatch: pytest.MonkeyPatch) -> None:
    """5.2-eq17, with the free length added to the lengths."""
    right = printed.potential_17
    monkeypatch.setattr(printed, "potential_17", lambda lengths, free, work: right(lengths, -free, work))
    assert CLAIMS["5.2-eq17"].check().verdict is Verdict.UNDECIDED


@pytest.mark.parametrize(("numbers", "verdict"), [
    ((12, 30, 20), Verdict.CONFIRMED), ((11, 20), Verdict.CORRECTED), ((20, 31), Verdict.CORRECTED),
    ((11, 31), Verdict.REFUTED),
])  # fmt: skip
def test_verdict_on_real_roots_follows_the_numbers(
    monkeypatch: pytest.MonkeyPatch, numbers: tuple[int, ...], verdict: Verdict
) -> None:
    monkeypatch.setattr(free_springs, "real_roots", lambda: {f"design {n}": n for n in numbers})
    assert CLAIMS["5.2-real"].check().verdict is verdict


def test_tense_springs_everywhere_would_not_confirm(monkeypatch: pytest.MonkeyPatch) -> None:
    """5.2-acceptable says that both conditions have to be verified: were all stable poses tense, one would do."""
    whole = extensions.equilibria_with
    tense = lambda design: tuple(dataclasses.replace(e, tense=True) for e in whole(design))  # noqa: E731
    monkeypatch.setattr(free_springs, "equilibria_with", tense)
    assert CLAIMS["5.2-acceptable"].check().verdict is Verdict.UNDECIDED


@pytest.mark.parametrize("change", [
    {"status": Status.PARTIAL}, {"undetermined": Fraction(1, 5)},
])  # fmt: skip
def test_an_unfinished_map_decides_nothing(monkeypatch: pytest.MonkeyPatch, change: dict[str, Any]) -> None:
    """5.2-difficult stays undecided when a map was stopped or leaves too much open."""
    whole = free_springs.certified
    monkeypatch.setattr(free_springs, "certified", lambda name: dataclasses.replace(whole(name), **change))
    assert CLAIMS["5.2-difficult"].check().verdict is Verdict.UNDECIDED


def test_without_numba_the_forecast_is_not_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    """5.2-difficult needs an optional package, and says so where it is missing."""
    monkeypatch.setitem(sys.modules, "numba", None)
    monkeypatch.delitem(sys.modules, "ptmcad.certified.compiled", raising=False)
    found = CLAIMS["5.2-difficult"].check()
    assert found.verdict is Verdict.NOT_CHECKED
    assert "numba" in found.reason


def test_a_general_count_that_is_not_general_corrects_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """3.3-others: a count seen that the theorem does not allow would show one of the two wrong."""
    allowed, seen = overall.allowed_and_seen()
    monkeypatch.setattr(symmetric, "allowed_and_seen", lambda: (allowed, seen | {(5, 2)}))
    assert CLAIMS["3.3-others"].check().verdict is Verdict.UNDECIDED


@pytest.mark.parametrize("found", [(-1, 3), (3, -1), (2, 2)])
def test_other_numbers_of_freedom_are_not_confirmed(monkeypatch: pytest.MonkeyPatch, found: tuple[int, int]) -> None:
    monkeypatch.setattr(basics, "degrees_of_freedom", lambda: found)
    assert CLAIMS["2-dof"].check().verdict is Verdict.UNDECIDED


def test_a_rod_that_stretches_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """2-dof rests on the model's nodes."""
    at = dict(basics.coordinates())
    at["A3"] = (2 * at["A3"][0], at["A3"][1])
    monkeypatch.setattr(basics, "coordinates", lambda: at)
    assert basics.degrees_of_freedom() == (-1, -1)


def test_a_failed_derivation_confirms_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """4.1-non-flat: were the closed form wrong, the paper's "no general information" would not become true by it."""
    monkeypatch.setattr(unloaded_map, "on_triangle", lambda expression: _wrong(unloaded.on_triangle(expression)))
    assert CLAIMS["4.1-non-flat"].check().verdict is Verdict.UNDECIDED


def test_every_step_of_the_proof_is_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    """4.3-widest is undecided as soon as one step is not shown."""
    found = general.widest()
    assert len(found.steps) == 16
    for step in found.steps:
        monkeypatch.setattr(general, "widest", lambda: type(found)({**found.steps, step: False}, found.widths))  # noqa: B023
        assert CLAIMS["4.3-widest"].check().verdict is Verdict.UNDECIDED


def test_a_wider_place_would_refute(monkeypatch: pytest.MonkeyPatch) -> None:
    found = general.widest()
    wide = {**found.widths, Fraction(3, 2): (Fraction(3, 5), Fraction(3, 5))}
    monkeypatch.setattr(general, "widest", lambda: type(found)(found.steps, wide))
    assert CLAIMS["4.3-widest"].check().verdict is Verdict.REFUTED


def test_proven_links_keep_the_counts() -> None:
    """4-constant, the fact it rests on."""
    assert any(link.merge is Merge.PROVEN for f in FIGURES for link in region_map(f).adjacencies)


def test_rule_of_verdicts() -> None:
    """Nothing is corrected without a right statement that holds, nor refuted without a witness."""
    assert judge(True, ("x",), {}, corrected=True, right="r").verdict is Verdict.CONFIRMED
    assert judge(False, ("x",), {}, corrected=True, right="r").verdict is Verdict.CORRECTED
    assert judge(False, ("x",), {}, corrected=True).verdict is Verdict.UNDECIDED
    assert judge(False, ("x",), {}, corrected=False, right="r").verdict is Verdict.UNDECIDED
    assert judge(False, ("x",), {}, witness="w").verdict is Verdict.REFUTED


def test_errata_page_lists_what_is_not_as_printed() -> None:
    """docs/errata.md names exactly the claims that are corrected or refuted."""
    page = (Path(__file__).resolve().parents[2] / "docs" / "errata.md").read_text(encoding="utf-8")
    assert set(re.findall(r"`([a-z0-9.]+-[a-z0-9-]+)`", page)) == {*CORRECTED, *REFUTED}


def test_widest_range_by_another_proof() -> None:
    """4.3-widest: `ptmcad range --over` proves it by chords and derivatives of the ends, on pieces of the axis."""
    from ptmcad.exact.ranges.width import operation_widths

    (maximum,) = operation_widths(slice_of("fig4"), "rho", rows=1).maxima
    low, high = general.widest().widths[Fraction(1)]
    assert maximum.at.exact == 1
    assert maximum.width.low <= high and low <= maximum.width.high


@pytest.mark.parametrize(("figure", "at"), [
    ("fig2", {"L2": "3/2"}), ("fig3", {"F": -10}), ("fig4", {"L2": "3/2"}), ("fig5-text", {"F4": -20}),
    ("fig5-caption", {"F4": -20}),
], ids=FIGURES)  # fmt: skip
def test_ranges_by_another_way(figure: str, at: dict[str, Any]) -> None:
    """The operation range by `ptmcad range`, which computes the variety of the line and not of the plane."""
    from ptmcad.answer.intervals import lower, upper
    from ptmcad.exact.ranges.line import intervals
    from ptmcad.studies.paper.slices import operation_range

    ((_, fixed),) = at.items()
    (found,) = intervals(slice_of(figure), "rho", at).operation
    ours = operation_range(figure, "rho", fixed)
    assert ours is not None
    a, b, c, d = ours.bounds()
    assert lower(found.low) <= b and a <= upper(found.low)
    assert lower(found.high) <= d and c <= upper(found.high)
