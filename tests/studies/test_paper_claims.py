"""Every claim of the paper: its computed verdict, the computed facts, and the same facts found in
another way.

The other ways share no code with the checks: exact slopes over the rationals in place of SymPy
and FLINT, tests/support/oracle.py for counts, Newton's method in floating point. Known
answers: the paper itself, and docs/errata.md.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cache
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import pytest
import sympy as sp
from support import oracle
from support.few import few
from support.free_length_equilibria import free_length_equilibria
from support.maps import once_per_run
from support.paper_energy import Bent, alike, bent

from ptmcad.answer.regionmap import Merge, Status
from ptmcad.studies.paper import free, maps, statements
from ptmcad.studies.paper.claim import TEXTS, Claim, Verdict, judge, texts
from ptmcad.studies.paper.critical import squared
from ptmcad.studies.paper.maps import FIGURES, region_map
from ptmcad.studies.paper.statements import expression, holds
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.flint_numbers import to_fraction

SECTIONS = (
    "abstract", "1", "2", "3", "3.1", "3.2", "3.3", "4", "4.1", "4.2", "4.3", "5.1", "5.2", "conclusions",
)  # fmt: skip
CLAIMS = texts()
TWELVE, TWENTY_SIX, THIRTY, AT_ELIMINATED = CLAIMS["5.2-six"]["with"]["designs"]


@cache
def outcome(name: str) -> Claim:
    """What is computed; claims that say the same share it."""
    shared = CLAIMS[name].get("like", name)
    return judge(name, CLAIMS[name]) if shared == name else outcome(shared)


@pytest.fixture(scope="module", autouse=True)
def certified_maps_are_made_once() -> Iterator[None]:
    """By the first process of a run that asks for one."""
    whole = free.certified
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            free, "certified", cache(lambda n: once_per_run(f"paper, {n}", lambda: whole(n)))
        )
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
    groups = (
        (CORRECTED, Verdict.CORRECTED),
        (REFUTED, Verdict.REFUTED),
        (NOT_CHECKED, Verdict.NOT_CHECKED),
    )
    return next((verdict for names, verdict in groups if name in names), Verdict.CONFIRMED)


# --- another way to the model: exact slopes and bends, from the nodes --------------------------------------------------

Point = Mapping[str, Fraction]
HALF_ANGLES = SimpleNamespace(
    cos=lambda t: (1 - t * t) / (1 + t * t),
    sin=lambda t: 2 * t / (1 + t * t),
    sqrt=lambda square: square,
)
"""Of tangents of half angles. Lengths are not rational, and without free lengths nothing has them."""


def pose(p: Point) -> Bent:
    """At rational half angles."""
    given = alike(
        p["rho"], p["L1"], p["L2"], 0, p["F3"], p["F4"], k=p["k"], f3x=p["F3x"], f4x=p["F4x"]
    )
    return bent(given, p["t1"], p["t2"], HALF_ANGLES)


def random_point(draw: Random, **given: Fraction | int) -> dict[str, Fraction]:
    names = ("L1", "L2", "rho", "k", "F3", "F4", "F3x", "F4x", "t1", "t2")
    point = {n: Fraction(draw.randint(1, 40), draw.randint(1, 9)) for n in names}
    for name in ("F3", "F4", "F3x", "F4x", "t1", "t2"):
        point[name] *= draw.choice((-1, 1))
    return (
        point
        | {"F3x": Fraction(0), "F4x": Fraction(0)}
        | {n: Fraction(v) for n, v in given.items()}
    )


def value(expression: Any, p: Point) -> Fraction:
    """A SymPy expression at rational values, half angles for the cosines and sines."""
    turned = {
        f"{f[0]}{n}": vars(HALF_ANGLES)[f](p[f"t{n}"]) for f in ("cos", "sin") for n in (1, 2)
    }
    at = dict(p) | turned
    found = sp.sympify(expression).subs(
        {
            s: sp.Rational(at[s.name].numerator, at[s.name].denominator)
            for s in expression.free_symbols
        }
    )
    return to_fraction(found)


POINTS = [random_point(Random(n)) for n in range(5)]


def sides(name: str, key: str) -> list[tuple[Any, Any]]:
    """Both sides of the equations that a claim states."""
    texts = (text.split(" = ") for text in CLAIMS[name][key])
    return [(expression(left), expression(right)) for left, right in texts]


def test_printed_and_right_equations_2_to_6_at_rational_points() -> None:
    """The verdicts on (2) to (6), found again without SymPy's differentiation."""
    differs = {"2-eq2": False, "2-eq4": False, "3-eq6": False}
    for p in POINTS:
        u, (u1, u2) = pose(p).energy, pose(p).slopes
        clear = (1 + p["t1"] ** 2) * (1 + p["t2"] ** 2)
        for name, key, known in (
            ("2-eq2", "shown", u), ("2-eq3", "printed", -u2 / p["L2"] / p["k"]),
            ("2-eq4", "shown", -u1 / p["L1"] / p["k"]), ("3-eq5", "printed", u1 / p["L1"] * clear),
            ("3-eq6", "shown", u2 / p["L2"] * clear),
        ):  # fmt: skip
            left, right = sides(name, key)[0]
            assert value(left, p) == value(right, p) == known
            differs[name] = (
                differs.get(name, True) or value(sides(name, "printed")[0][1], p) != known
            )
    assert all(differs.values())


def test_horizontal_forces_at_rational_points() -> None:
    """5.1: + 2 F3x and - 2 F4x."""
    for seed in range(3):
        p = random_point(Random(seed), F3x=7, F4x=-3)
        u1, u2 = pose(p).slopes
        clear = (1 + p["t1"] ** 2) * (1 + p["t2"] ** 2)
        five, six = (value(right, p) for _, right in sides("5.1-terms", "shown"))
        assert (five, six) == (u1 / p["L1"] * clear, u2 / p["L2"] * clear)
        assert value(sides("5.1-terms", "printed")[1][1], p) != u2 / p["L2"] * clear


# --- verdicts and facts -----------------------------------------------------------------------------------------------


def test_the_list_is_whole() -> None:
    """Names are unique, sections follow each other as in the paper, quotations are short."""
    assert re.findall(r"^([\w.-]+):$", TEXTS.read_text(encoding="utf-8"), re.MULTILINE) == list(
        CLAIMS
    )
    assert len(CLAIMS) > 85
    unread = {"quotation": "", "statement": "", "reason": "none"}
    sections = [SECTIONS.index(judge(name, unread).section) for name in CLAIMS]
    assert sections == sorted(sections)
    assert {*sections} == {*range(len(SECTIONS))}
    assert all(len(text["quotation"]) < 90 for text in CLAIMS.values())
    assert set(CORRECTED) | set(REFUTED) | set(NOT_CHECKED) <= set(CLAIMS)


FACTS: dict[str, dict[str, Any]] = {
    "a-six": {"attained": 6},
    "a-stable": {"pairs": [(4, 1), (6, 1), (6, 2)]},
    "2-both-kinds": {"cells of figures 2 to 4": 39},
    "4.2-region": {"stable": [1, 2], "regions with two": 1, "by index": [(1, 2, 1), (1, 3, 2), (2, 3, 1)]},
    "4.2-eq15-16": {"matched": [1, 1], "curves": 2},
    "4.3-curves": {"curves": 1, "degrees": [(24, 12)], "terms": [70]},
    "4.3-fig5-degrees": {"terms": [115, 115]},
    "5.2-degree-28": {"total degrees": (28, 28), "degrees": ((16, 12), (12, 16))},
    "5.2-degree-328": {"degree": 400, "exponent": 48, "left": 304, "factors": "(256, 1), (2, 8), (2, 16)",
                       "multiplicity of l1 = 0": 8, "multiplicity of l3 = 0": 16, "complex solutions": 128,
                       "real solutions": 48, "opposed": 128, "unsettled": 0},
    "5.2-spurious": {"real roots": 94, "real solutions": 48, "equilibria": 6, "stable": 2},
    "5.2-six": {"numbers": [(12, 2, 2, 0, 1), (26, 8, 0, 8, 1), (30, 10, 0, 10, 1), (6, 2, 2, 0, 4)]},
    "5.2-real": {"real roots": [94, 68, 66, 31, 27, 3], "inside": 1},
    "5.2-acceptable": {"numbers": [(6, 2, 2, 0, 4), (12, 2, 2, 0, 1), (26, 8, 0, 8, 1)]},
    "5.2-difficult": {"stable counts": [1, 2], "fine enough": True, "at the eliminated design": [2, 2],
                      "equilibria": [6, 6]},
    "c-tools": {"exact maps": 5},
    "c-four-unsymmetric": {"totals": (4, 6)},
}  # fmt: skip


SLOW = ("5.2-real", "5.2-degree-328")
"""Many eliminations."""


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in SLOW else ()) for name in CLAIMS]
)
@pytest.mark.slow_cases(
    "4.3-widest", "4.3-slow", "5.2-spurious", "5.2-difficult", "a-six", "a-stable", "5.2-degree-28"
)
def test_verdict(name: str) -> None:
    """The verdict, what each kind of verdict must come with, and the facts: known from the paper or
    docs/errata.md.
    """
    found = outcome(name)
    assert found.verdict is expected(name), found
    if found.verdict is Verdict.NOT_CHECKED:
        assert found.reason and not found.facts
    else:
        assert found.evidence and found.facts and not found.reason
        assert not any("{" in text for text in (*found.evidence, found.right, found.witness))
    assert bool(found.right) == (found.verdict is Verdict.CORRECTED)
    assert found.witness or found.verdict is not Verdict.REFUTED
    assert {key: (found.facts or {})[key] for key in FACTS.get(name, {})} == FACTS.get(name, {})
    assert not any("np." in text or "Fraction(" in text for text in found.evidence)


# --- the same found in other ways -------------------------------------------------------------------------------------


def count(**given: Any) -> tuple[int, int, int]:
    """Minima, saddles and maxima by tests/support/oracle.py."""
    values = {
        "L1": 1,
        "L2": 1,
        "rho": 1,
        "k1": 100,
        "k2": 100,
        "k3": 100,
        "F3": 0,
        "F4": 0,
        "F3x": 0,
        "F4x": 0,
    } | given
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


@pytest.mark.parametrize(
    "length2", few(["1/2", "99/100", "1", "101/100", "3/2", "2"], "1/2", "1", "3/2")
)
@pytest.mark.slow_cases("1/2", "3/2")
def test_width_of_fig4_by_the_oracle(length2: str) -> None:
    """4.3-widest: the ends of the range by bisection on the oracle's counts, which knows no
    variety.
    """
    (low, high), (least, _) = ((w.low, w.high) for w in maps.widths_at("fig4", [length2, "1"]))
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
        assert high < least


def test_unequal_angles_in_floating_point() -> None:
    """(12), (13) and the pairing: the roots of (12) are equilibria, exchange t1 and t2, and have
    the right det H.
    """
    k, rho, f, length = 100.0, 0.75, -10.0, 1.0
    a = 4 * f * k**2 * (length * rho + rho**2) + f**3
    b = 16 * k**3 * rho**3 + 4 * f**2 * k * rho
    c = -(f**3) + 4 * f * k**2 * (length * rho - rho**2)
    root = math.sqrt(b * b - 4 * a * c)
    pair = ((-b - root) / (2 * a), (-b + root) / (2 * a))
    for t2, other in (pair, pair[::-1]):
        t1 = -(f * t2 + 2 * k * rho) / (f - 2 * k * rho * t2)
        assert t1 == pytest.approx(other)
        angles = 2 * math.atan(t1), 2 * math.atan(t2)
        *_, (u1, u2), (u11, u12, u22) = bent(alike(rho, 1, 1, 0, f, f, k=k), *angles, math)
        assert abs(u1) + abs(u2) < 1e-9
        determinant = u11 * u22 - u12**2
        square = k * rho * t2**2 - f * t2 - k * rho
        assert determinant == pytest.approx(-4 * length**2 * square**2 / (1 + t2**2) ** 2)
        shown = (
            -4
            * (t2**2 + 1) ** 2
            * (4 * k**2 * rho**2 + f**2) ** 2
            * square**2
            / (f - 2 * k * rho * t2) ** 4
        )
        assert determinant != pytest.approx(shown)
        assert determinant < 0


def test_non_flat_equilibria_at_a_triangle() -> None:
    """3.1-eq9, 4.1-non-flat, at the triangle with sides 13, 20, 21 and height 12: exact rational
    half angles.
    """
    p = random_point(Random(0), L1=13, L2=20, rho=Fraction(21, 2), k=1, F3=0, F4=0,
                     t1=Fraction(12, 13 + 5), t2=Fraction(12, 20 + 16))  # fmt: skip
    (x3, y3), (x4, y4), _, _, slopes, (u11, u12, u22) = pose(p)
    assert slopes == (0, 0)
    assert (u11, u22) == (13**2, 20**2)
    assert u11 * u22 - u12**2 == (2 * p["rho"] * 12) ** 2
    assert y3 == y4 == 12
    assert x3 - x4 == p["rho"]


@pytest.mark.parametrize(("length2", "rho", "stable"), [
    (1, 2, (0, 0)), (3, Fraction(1, 2), (1, 0)), (Fraction(1, 4), Fraction(1, 4), (0, 1)), (1, Fraction(1, 2), None),
])  # fmt: skip
def test_flat_equilibria_one_by_one(length2: Any, rho: Any, stable: tuple[int, int] | None) -> None:
    """3.3-three-flat: which of the four is stable, from H by hand; its determinant is not zero
    (c-singular).
    """
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
    """4.2-reverse, 4.2-range, 4.2-pulling, 4.3-range: minima found by going downhill, which finds
    minima only.
    """
    assert {
        (int(math.copysign(1, y3)), int(math.copysign(1, y4))) for y3, y4 in stable_heights(at)
    } == signs


def test_free_lengths_by_newton() -> None:
    """5.2-six: as many equilibria as a Newton search with difference quotients finds."""
    for design in (TWELVE, TWENTY_SIX, THIRTY):
        assert len(free.equilibria(design).equilibria) == free_length_equilibria(
            *map(float, design)
        )


def test_squared_equations_vanish_at_the_equilibria() -> None:
    """5.2-degree-28: squaring loses no equilibrium."""
    for e in free.equilibria(free.ELIMINATED).equilibria:
        tangents = [math.tan(float(a.center) / 2) for a in e.angles]
        for p in squared(free.ELIMINATED).equations:
            terms = [
                float(c) * tangents[0] ** int(i) * tangents[1] ** int(j) for (i, j), c in p.terms()
            ]
            assert abs(math.fsum(terms)) < 1e-8 * max(map(abs, terms))


def test_three_degrees_of_freedom_at_rational_points() -> None:
    """2-dof: the positions' derivatives by rho, th1 and th2 are independent, by
    elimination.
    """
    for p in POINTS:
        (x3, y3), (x4, y4), *_ = pose(p)
        by_angle = (0, 0, 0, -y3, x3), (0, y4, p["rho"] - x4, 0, 0)  # of A2, A4 and A3
        rows = [[Fraction(x) for x in row] for row in ((1, 1, 0, 0, 0), *by_angle)]
        assert sp.Matrix(3, 5, lambda i, j: sp.Rational(*rows[i][j].as_integer_ratio())).rank() == 3  # noqa: B023


def elastic(design: Sequence[str], a: float, b: float) -> Bent:
    """U/k of (17) in floating point, and the springs' lengths."""
    return bent(alike(*map(float, design)), a, b, math)


def test_gradient_by_difference_quotients() -> None:
    """5.2-eq17: the shared derivation is the slope of (17)."""
    design, (a, b), h = TWELVE, (0.7, -2.1), 1e-6
    rho, length1, length2, free_length, f3, f4 = map(float, design)
    values = {"rho": rho, "L1": length1, "L2": length2, "k": 1.0, "F3": f3, "F4": f4, "F3x": 0.0, "F4x": 0.0,
              "c1": math.cos(a), "s1": math.sin(a), "c2": math.cos(b), "s2": math.sin(b)}  # fmt: skip
    values |= {"l0": free_length} | dict(
        zip(("l1", "l2", "l3"), elastic(design, a, b).lengths, strict=True)
    )
    for n, slope in enumerate(statements.gradient()):
        up, down = ((a + h * (n == 0) * e, b + h * (n == 1) * e) for e in (1, -1))
        found = (elastic(design, *up).energy - elastic(design, *down).energy) / (2 * h)
        assert float(slope.subs({s: values[s.name] for s in slope.free_symbols})) == pytest.approx(
            found, abs=1e-8
        )


@pytest.mark.parametrize("design", [AT_ELIMINATED, TWELVE, TWENTY_SIX], ids=[6, 12, 26])
def test_stable_and_tense_by_difference_quotients(design: Sequence[str]) -> None:
    """5.2-acceptable: stability and lengths at the poses, from the energy alone."""
    h, found = 1e-4, [0, 0, 0]
    for e in free.equilibria(design).equilibria:
        a, b = (float(angle.center) for angle in e.angles)
        u = {
            (i, j): elastic(design, a + i * h, b + j * h).energy
            for i in (-1, 0, 1)
            for j in (-1, 0, 1)
        }
        h11, h22 = u[1, 0] + u[-1, 0] - 2 * u[0, 0], u[0, 1] + u[0, -1] - 2 * u[0, 0]
        h12 = (u[1, 1] + u[-1, -1] - u[1, -1] - u[-1, 1]) / 4
        stable, tense = (
            h11 > 0 and h11 * h22 > h12**2,
            min(elastic(design, a, b).lengths) > float(design[3]),
        )
        found[0] += stable
        found[1] += stable and not tense
        found[2] += tense and not stable
    expected = free.numbers(design)
    assert found == [expected["stable"], expected["short"], expected["loose"]]


def test_real_roots_by_isolation() -> None:
    """5.2-real: real roots isolated on the line; they are counted among all complex ones."""
    from flint import fmpq

    from ptmcad.algebra.real_roots import isolate

    system = squared(("5/4", "1", "3/2", "1/5", "0", "0"))
    number = 0
    for p in system.factors.values():
        bound = fmpq(1 + max(abs(int(c)) for c in p.coeffs()))
        number += len(isolate(p, -bound, bound))
    assert number == FACTS["5.2-real"]["real roots"][4]


def test_maps_with_free_lengths_at_points() -> None:
    """5.2-difficult: as many stable equilibria as Newton's method in balls proves from a grid of
    starting points.
    """
    from ptmcad.ask.location import locate
    from ptmcad.studies.stress.doubleprecision import double_poses, proved_poses

    draw, seen = Random(7), list[int]()
    map_ = free.certified("L2 = 3/2")
    while len(seen) < 5:
        rho, length = Fraction(draw.randint(26, 124), 100), Fraction(draw.randint(1, 49), 200)
        there = locate(map_, {"rho": rho, "l0": length})
        if there.stable is not None:
            p = {
                "rho": rho,
                "L1": Fraction(1),
                "L2": Fraction(3, 2),
                "F3": Fraction(-10),
                "F4": Fraction(-10),
            }
            p |= dict.fromkeys(("k1", "k2", "k3"), Fraction(100)) | dict.fromkeys(
                ("l0_1", "l0_2", "l0_3"), length
            )
            poses = proved_poses(p, [pose[:2] for pose in double_poses(p) or ()])
            assert there.stable == sum(index == 0 for *_, index in poses)
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


def changed(name: str, **text: Any) -> Claim:
    """What would be computed of a claim with another text."""
    return judge(name, {**CLAIMS[name], **text})


EQUATIONS = [
    name for name, one in CLAIMS.items()
    if expected(name) is Verdict.CONFIRMED and "check" not in one and " = " in one["printed"][0]
]  # fmt: skip


@pytest.mark.parametrize("name", EQUATIONS)
@pytest.mark.slow_cases("3-minors", "3.2-linear", "3.3-negative", "4.2-unequal")
def test_a_wrong_equation_is_not_confirmed(name: str) -> None:
    first, *others = CLAIMS[name]["printed"]
    assert changed(name, printed=[f"{first} + rho", *others]).verdict is Verdict.UNDECIDED


@pytest.mark.parametrize("name", ["2-eq2", "2-eq4", "3-eq6", "3.3-eq13", "5.1-terms"])
@pytest.mark.slow_cases("3.3-eq13")
def test_a_right_equation_would_be_confirmed(name: str) -> None:
    """Had the paper printed the right one, the verdict would say so: it is not typed in."""
    assert changed(name, printed=CLAIMS[name]["shown"][:2]).verdict is Verdict.CONFIRMED


@pytest.mark.parametrize(
    "name",
    [
        n
        for n in CORRECTED
        if "shown" in CLAIMS[n] and "like" not in CLAIMS[n] and "needs" not in CLAIMS[n]
    ],
)
@pytest.mark.slow_cases(
    "1-always-six",
    "3-degree-6",
    "3.3-eq13",
    "5.1-nature",
    "a-one-dof",
    "5.2-degree-328",
    "5.2-real",
)
def test_what_was_not_shown_corrects_nothing(name: str) -> None:
    """Nor is a claim refuted by a witness of which nothing was shown."""
    first, *others = CLAIMS[name]["shown"]
    assert changed(name, shown=[first, *others, "rho = 0"]).verdict is Verdict.UNDECIDED


def test_a_fact_of_another_value_confirms_nothing() -> None:
    """Facts are compared with the values that the text demands, and must be there."""
    assert (
        changed("4.3-similar", printed=[{"stable": [1, 3], "regions with two": 1}]).verdict
        is Verdict.UNDECIDED
    )
    assert (
        changed("4.3-similar", printed=[{"stable": [1, 2]}, "1 = 2"]).verdict is Verdict.UNDECIDED
    )
    with pytest.raises(KeyError):
        changed("4.3-similar", printed=[{"unstable": [1, 2]}])


def test_statements() -> None:
    assert holds("s1^2 + c1^2 = 1") and not holds("s1^2 + c2^2 = 1") and holds("not s1 = c1")
    assert holds("at(rho, rho=2) > 1") and not holds("at(rho, rho=2) > 3")
    assert holds("flat_stable(L2=1, rho=2) = 1") and not holds(
        "flat_stable(-1, 1, L2=1, rho=2) = 1"
    )


@pytest.mark.parametrize(("name", "key"), [("4.1-lines", "texts"), ("4.2-eq15-16", "texts")])
def test_a_curve_that_is_none_is_noticed(name: str, key: str) -> None:
    given = CLAIMS[name]["with"]
    wrong = {**given, key: [*given[key][:-1], f"{given[key][-1]} + rho"]}
    assert changed(name, **{"with": wrong}).verdict is Verdict.UNDECIDED


def test_six_equilibria_would_not_refute() -> None:
    """A witness with six equilibria decides nothing: no number of designs can confirm the claim
    either.
    """
    assert (
        changed("5.2-six", **{"with": {"designs": [AT_ELIMINATED], "sentence": "{at}"}}).verdict
        is Verdict.UNDECIDED
    )


@pytest.mark.slow
def test_an_elimination_without_spurious_roots_would_not_confirm(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = free.elimination()
    monkeypatch.setattr(free, "elimination", lambda: {**found, "real roots": 6})
    assert changed("5.2-spurious").verdict is Verdict.UNDECIDED


@pytest.mark.parametrize(("numbers", "verdict"), [
    ((12, 30, 20), Verdict.CONFIRMED), ((11, 20), Verdict.CORRECTED), ((20, 31), Verdict.CORRECTED),
    ((11, 31), Verdict.UNDECIDED),
])  # fmt: skip
def test_verdict_on_real_roots_follows_the_numbers(
    monkeypatch: pytest.MonkeyPatch, numbers: tuple[int, ...], verdict: Verdict
) -> None:
    given = CLAIMS["5.2-real"]["with"]
    found = iter(numbers)
    monkeypatch.setattr(free, "squared", lambda _design: SimpleNamespace(real_roots=next(found)))
    some = {**given, "designs": given["designs"][: len(numbers)]}
    assert changed("5.2-real", **{"with": some}).verdict is verdict


def test_tense_springs_everywhere_would_not_confirm(monkeypatch: pytest.MonkeyPatch) -> None:
    """5.2-acceptable says that both conditions have to be verified: were all stable poses tense,
    one would do.
    """
    tense = {"total": 6, "stable": 2, "tense": 2, "short": 0, "loose": 4}
    monkeypatch.setattr(free, "numbers", lambda _design: tense)
    assert changed("5.2-acceptable").verdict is Verdict.UNDECIDED


@pytest.mark.parametrize("change", [
    {"status": Status.PARTIAL}, {"undetermined": Fraction(1, 5)},
])  # fmt: skip
def test_an_unfinished_map_decides_nothing(
    monkeypatch: pytest.MonkeyPatch, change: dict[str, Any]
) -> None:
    """5.2-difficult stays undecided when a map was stopped or leaves too much open."""
    whole = free.certified
    monkeypatch.setattr(free, "certified", lambda name: dataclasses.replace(whole(name), **change))
    assert changed("5.2-difficult").verdict is Verdict.UNDECIDED


def test_without_numba_what_needs_it_is_not_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Poses and maps with free lengths need an optional package, and their claims say so where it
    is missing.
    """
    monkeypatch.setattr("ptmcad.extras.find_spec", lambda _name: None)
    assert [n for n, c in CLAIMS.items() if c.get("needs")] == [
        "5.2-spurious", "5.2-six", "5.2-acceptable", "5.2-difficult", "c-six-free",
    ]  # fmt: skip
    found = changed("5.2-difficult")
    assert found.verdict is Verdict.NOT_CHECKED
    assert "numba" in found.reason


def test_a_general_count_that_is_not_general_corrects_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """3.3-others: a count seen that the theorem does not allow would show one of the two wrong."""
    seen = maps.seen_counts()
    monkeypatch.setattr(maps, "seen_counts", lambda: seen | {(5, 2)})
    assert changed("3.3-others").verdict is Verdict.UNDECIDED


def test_a_rod_that_does_not_move_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """2-dof rests on the model's nodes."""
    at = dict(statements.points()) | {"A3": statements.points()["A2"]}
    monkeypatch.setattr(statements, "points", lambda: at)
    assert statements.independent() == 2


def test_a_place_that_is_not_one_would_not_be_confirmed(monkeypatch: pytest.MonkeyPatch) -> None:
    """4.3-widest: another place of the maximum decides nothing, and a wider row refutes."""
    found = maps.over_length()
    monkeypatch.setattr(maps, "over_length", lambda: dataclasses.replace(found, maxima=()))
    assert changed("4.3-widest").verdict is Verdict.UNDECIDED
    widths = maps.row_widths()
    monkeypatch.setattr(
        maps, "row_widths", lambda: widths | {Fraction(3, 2): Enclosure(Fraction(1), Fraction(1))}
    )
    assert changed("4.3-widest").verdict is Verdict.REFUTED


def test_proven_links_keep_the_counts() -> None:
    """4-constant, the fact it rests on."""
    assert any(link.merge is Merge.PROVEN for f in FIGURES for link in region_map(f).adjacencies)


def test_rule_of_verdicts() -> None:
    """Nothing is corrected without a right statement that holds, nor refuted without a witness."""
    right, wrong = ["1 = 1"], ["1 = 2"]
    text = {"quotation": "q", "statement": "s", "printed": wrong, "evidence": "x"}
    for more, verdict in (
        ({"printed": right, "shown": right, "right": "r"}, Verdict.CONFIRMED),
        ({"shown": right, "right": "r"}, Verdict.CORRECTED),
        ({"shown": right}, Verdict.UNDECIDED),
        ({"shown": wrong, "right": "r", "witness": "w"}, Verdict.UNDECIDED),
        ({"witness": "w"}, Verdict.REFUTED),
        ({"printed": right, "reason": "none"}, Verdict.NOT_CHECKED),
    ):
        assert judge("2-a", {**text, **more}).verdict is verdict


def test_errata_page_lists_what_is_not_as_printed() -> None:
    """docs/errata.md names exactly the claims that are corrected or refuted."""
    page = (Path(__file__).resolve().parents[2] / "docs" / "errata.md").read_text(encoding="utf-8")
    assert set(re.findall(r"`([a-z0-9.]+-[a-z0-9-]+)`", page)) == {*CORRECTED, *REFUTED}


@pytest.mark.parametrize(("figure", "at"), [
    ("fig2", "3/2"), ("fig3", "-10"), ("fig4", "3/2"), ("fig5-text", "-20"), ("fig5-caption", "-20"),
], ids=FIGURES)  # fmt: skip
def test_ranges_end_on_the_curves_of_the_maps(figure: str, at: str) -> None:
    """The operation range computes the variety of the line and not of the plane: its ends lie on
    the plane's curves.
    """
    from flint import fmpz_poly

    from ptmcad.algebra.polynomials import coefficients_in, from_plane, univariate
    from ptmcad.answer.intervals import lower, upper
    from ptmcad.text.flint_numbers import from_fraction

    found = maps.operation(figure, "rho", at)
    number = maps.slice_of(figure).axis_names.index("rho")
    cut = fmpz_poly([1])
    for c in region_map(figure).components:
        cut *= univariate(
            coefficients_in(from_plane(c.polynomial), number), from_fraction(Fraction(at))
        )
    for end in (found.low, found.high):
        low, high = (cut(from_fraction(x)) for x in (lower(end), upper(end)))
        assert low * high <= 0
