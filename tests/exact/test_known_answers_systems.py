"""Systems and mechanisms of other fields against answers of the literature, or by hand; the ids
name the source.

Areas come from closed forms, which no engine knows. Where the certified engine takes a system, its
map is asked too.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from math import asinh, atanh, comb, pi, sqrt
from pathlib import Path
from typing import Any

import pytest
import yaml
from flint import fmpq

import ptmcad
from ptmcad.answer.regionmap import Kind
from ptmcad.exact.point_system import solutions_at
from ptmcad.exact.stages import problem_of, variety_of
from ptmcad.question.slice import Slice

PAIR = {"x": "real", "y": "real"}
ONE = {"x": "real"}


@dataclass(frozen=True)
class Known:
    """A system with what is known of it.

    Attributes
    ----------
    areas : by the count that the record asks for.
    points : the axes' values, then the count.
    certified : the share that the certified engine may leave open; none where it does not take the
        system.
    """

    source: str
    system: dict[str, Any]
    axes: dict[str, list[Any]]
    count: str = "total"
    areas: dict[Any, float] = field(default_factory=dict)
    points: list[tuple[str, str, Any]] = field(default_factory=list)
    certified: str = "1/50"

    @property
    def slice(self) -> Slice:
        record = {"name": "known", "system": self.system, "axes": self.axes, "count": self.count}
        return ptmcad.slice_from_mapping(record)


def selkov(b: float) -> float:
    """The antiderivative of the a at which the fixed point of Sel'kov's model has a trace of zero."""
    return -b / 2 - b**3 / 3 + (b * sqrt(1 + 8 * b * b) + asinh(sqrt(8) * b) / sqrt(8)) / 4


KNOWN = {
    "swallowtail": Known(
        "R. Thom (1972); the area is that within b = 2 x - 4 x^3, c = 3 x^4 - x^2 up to where the curve meets itself",
        {"unknowns": ONE, "equations": ["x^4 - x^2 + b*x + c"]},
        {"b": [-1, 1], "c": [-1, "1/2"]},
        areas={4: 32 / 105 / 2**1.5},
        points=[("0", "1/10", 4), ("0", "2/5", 0), ("0", "-1/2", 2), ("1/2", "-13/200", 4), ("1/2", "-7/100", 2),
                ("3/4", "-1/12", 2)],
    ),
    "imperfect pitchfork": Known(
        "S. Strogatz, Nonlinear Dynamics and Chaos (1994), 3.6; |h| < 2 (r/3)^(3/2)",
        {"unknowns": ONE, "equations": ["h + r*x - x^3"], "stable": ["3*x^2 - r"]},
        {"r": [-1, 2], "h": [-2, 2]},
        "stable",
        {2: 16 * sqrt(2) / 5 / 3**1.5 * 2, 1: 12 - 32 * sqrt(2) / 5 / 3**1.5},
        [("1", "0", 2), ("1", "19/50", 2), ("1", "39/100", 1), ("-1/2", "0", 1)],
    ),
    "subcritical pitchfork": Known(
        "S. Strogatz, Nonlinear Dynamics and Chaos (1994), 3.4; jumps at r = -1/4 and r = 0",
        {"unknowns": ONE, "equations": ["r*x + x^3 - x^5 + 0*s"], "stable": ["5*x^4 - 3*x^2 - r"]},
        {"r": ["-1/2", "1/2"], "s": [0, 1]},
        "stable",
        {1: 0.25, 3: 0.25, 2: 0.5},
        [("-26/100", "1/2", 1), ("-24/100", "1/2", 3), ("1/100", "1/2", 2)],
    ),
    "spruce budworm": Known(
        "D. Ludwig, D. Jones and C. Holling, J. Animal Ecology 47 (1978); cusp at k = 3 sqrt 3, r = 3 sqrt 3/8",
        {"unknowns": ONE, "equations": ["x*(r*(k - x)*(1 + x^2) - k*x)"], "positive": ["x"]},
        {"k": [2, 12], "r": ["1/10", 1]},
        points=[("10", "1/2", 3), ("10", "3/5", 1), ("10", "3/10", 1), ("10", "559/1000", 3), ("10", "56/100", 1),
                ("519/100", "6495/10000", 1), ("54/10", "637/1000", 3), ("54/10", "64/100", 1)],
    ),
    "brusselator": Known(
        "G. Nicolis and I. Prigogine (1977); the fixed point (a, b/a) is stable where b < 1 + a^2",
        {"unknowns": PAIR, "equations": ["a + x^2*y - (b + 1)*x", "b*x - x^2*y"], "positive": ["x", "y"],
         "stable": ["x^2 + b + 1 - 2*x*y", "x^2"]},
        {"a": ["1/2", 1], "b": [1, "5/2"]},
        "stable",
        {1: (1 - 1 / 8) / 3, 0: 3 / 4 - (1 - 1 / 8) / 3},
        [("3/4", "3/2", 1), ("3/4", "8/5", 0)],
    ),
    "selkov": Known(
        "S. Strogatz, Nonlinear Dynamics and Chaos (1994), 7.3; Hopf where b^2 = (1 - 2 a -+ sqrt(1 - 8 a))/2",
        {"unknowns": PAIR, "equations": ["-x + a*y + x^2*y", "b - a*y - x^2*y"], "positive": ["x", "y"],
         "stable": ["1 - 2*x*y + a + x^2", "a + x^2"]},
        {"a": ["1/1000", "1/5"], "b": ["1/10", "6/5"]},
        "stable",
        {0: selkov(sqrt((0.998 + sqrt(0.992)) / 2)) - selkov(0.1) - 0.001 * (sqrt((0.998 + sqrt(0.992)) / 2) - 0.1)},
        [("8/100", "6/10", 0), ("13/100", "6/10", 1), ("1/20", "1", 1)],
        "1/20",
    ),
    "genetic switch": Known(
        "T. Gardner, C. Cantor and J. Collins, Nature 403 (2000); at equal rates bistable beyond 2, by hand",
        {"unknowns": PAIR, "equations": ["x*(1 + y^2) - a", "y*(1 + x^2) - b"], "positive": ["x", "y"],
         "stable": ["(1 + x^2)*(1 + y^2) - 4*x^2*y^2"]},
        {"a": ["1/2", 4], "b": ["1/2", 4]},
        "stable",
        points=[("199/100", "199/100", 1), ("201/100", "201/100", 2), ("7/2", "7/2", 2), ("7/2", "1", 1)],
    ),
    "covalent modification": Known(
        "A. Goldbeter and D. Koshland, PNAS 78 (1981); one state between 0 and 1, however steep the switch",
        {"unknowns": ONE, "equations": ["v*(1 - x)*(1/20 + x) - w*x*(1/20 + 1 - x)"], "positive": ["x", "1 - x"]},
        {"v": ["1/10", 2], "w": ["1/10", 2]},
        areas={1: 3.61},
    ),
    "nerve": Known(
        "R. FitzHugh, Biophys. J. 1 (1961); three fixed points where |I - 7/(10 b)| < 2/3 (1 - 1/b)^(3/2)",
        {"unknowns": PAIR, "equations": ["x - x^3/3 - y + I", "x + 7/10 - b*y"]},
        {"I": [-1, 2], "b": [1, 3]},
        areas={3: 4 / 3 * ((2 / 3) ** 1.5 * 3 + 3 * sqrt(2 / 3) - 3 * atanh(sqrt(2 / 3)))},
        points=[("7/20", "2", 3), ("0", "2", 1), ("7/20", "101/100", 1)],
    ),
    "two oscillators": Known(
        "Y. Kuramoto (1975); locked where |w| < K",
        {"unknowns": {"t": "angle"}, "equations": ["w - K*sin(t)"], "stable": ["K*cos(t)"]},
        {"K": [0, 2], "w": [-2, 2]},
        "stable",
        {1: 4, 0: 4},
    ),
    "elliptic umbilic": Known(
        "R. Thom (1972); a deltoid of area 2 pi, the image of |z| = 1 under conj(z)^2 + 2 z",
        {"unknowns": PAIR, "potential": "x^3/3 - x*y^2 + x^2 + y^2 - a*x - b*y"},
        {"a": [-4, 4], "b": [-4, 4]},
        "index",
        {(1, 3, 0): 2 * pi, (0, 2, 0): 64 - 2 * pi},
        [("0", "0", (1, 3, 0)), ("29/10", "0", (1, 3, 0)), ("31/10", "0", (0, 2, 0)), ("-11/10", "0", (0, 2, 0))],
    ),
    "hyperbolic umbilic": Known(
        "R. Thom (1972); without coupling sqrt(a/3) and sqrt(b/3), of both signs",
        {"unknowns": PAIR, "potential": "x^3 + y^3 - a*x - b*y"},
        {"a": [-1, 2], "b": [-1, 1]},
        "index",
        {(1, 2, 1): 2, (0, 0, 0): 4},
    ),
    "snap through of a truss": Known(
        "R. von Mises (1923); |f/2|^(2/3) + |a|^(2/3) = 1, an astroid whose area is 2 * 3 pi/8 over f",
        {"unknowns": {"h": "real", "d": "real"}, "equations": ["d^2 - a^2 - h^2", "2*(d - 1)*h - f*d"],
         "positive": ["d"]},
        {"a": ["-3/2", "3/2"], "f": ["-5/2", "5/2"]},
        areas={3: 3 * pi / 4},
    ),
}  # fmt: skip


def named(known: dict[str, Known]) -> list[Any]:
    return [pytest.param(entry, id=f"{name} [{entry.source}]") for name, entry in known.items()]


@pytest.mark.parametrize("known", named(KNOWN))
def test_areas_and_points_by_the_exact_engine(known: Known) -> None:
    result = ptmcad.classify(known.slice, area_tolerance="1e-5")
    for value, area in known.areas.items():
        low, high = area_by(result, known.count, value)
        assert low * (1 - 1e-9) <= area <= high * (1 + 1e-9)
        assert high - low < 1e-4 * area
    for x, y, value in known.points:
        assert getattr(result.locate(**at(known, x, y)), known.count) == value
    values = {getattr(region, known.count) for region in result.regions}
    assert values >= known.areas.keys() | {value for _, _, value in known.points}


@pytest.mark.parametrize("known", named(KNOWN))
@pytest.mark.fast_cases(
    "covalent modification [A. Goldbeter and D. Koshland, PNAS 78 (1981); one state between 0 a"
    "nd 1, however steep the switch]",
    "two oscillators [Y. Kuramoto (1975); locked where |w| < K]",
)
def test_areas_and_points_by_the_certified_engine(known: Known) -> None:
    pytest.importorskip("numba")
    result = ptmcad.classify(known.slice, engine="certified", tolerance=known.certified, jobs=1)
    across, up = result.slice.axes
    window = (across.high - across.low) * (up.high - up.low)
    for value, area in known.areas.items():
        low, _ = area_by(result, known.count, value)
        assert low <= area <= low + float(result.undetermined * window)
    for x, y, value in known.points:
        found = result.locate(**at(known, x, y))
        assert getattr(found, known.count) in (value, None)
    for cell in result.cells:
        true = ptmcad.counts_at(result.slice.model, **at(known, *map(str, cell.sample)))
        assert getattr(cell, known.count) == getattr(true, known.count)


def at(known: Known, x: str, y: str) -> dict[str, str]:
    return dict(zip(known.axes, (x, y), strict=True))


def area_by(result: ptmcad.RegionMap, count: str, value: Any) -> tuple[float, float]:
    areas = [region.area for region in result.regions if getattr(region, count) == value]
    return float(sum(low for low, _ in areas)), float(sum(high for _, high in areas))


SHIPPED = Path(__file__).resolve().parents[2] / "configs" / "systems"


@pytest.mark.parametrize(
    "name",
    [
        *["cubic", "cubic-and-quadratic", "duffing", "kuramoto", "schloegl", "von-mises-truss"],
        pytest.param("orthogonal-3r", marks=pytest.mark.slow),
    ],
)
@pytest.mark.fast_cases("schloegl")
def test_published_areas_of_shipped_systems_by_the_certified_engine(name: str) -> None:
    pytest.importorskip("numba")
    slice = ptmcad.load(SHIPPED / f"{name}.yaml")
    known = slice.reference
    result = ptmcad.classify(slice, engine="certified", tolerance="1/100", jobs=1)
    across, up = slice.axes
    room = float(result.undetermined * (across.high - across.low) * (up.high - up.low))
    for value, area in known["areas"].items():
        low, _ = area_by(result, slice.count.value, int(value))
        slack = float(Fraction(str(known.get("tolerance", "1/10000")))) * float(area)
        assert low - slack <= float(area) <= low + room + slack


# -------------------------------------------------------------------------- numbers of complex solutions, and varieties


def chain(bars: int) -> dict[str, Any]:
    """Bars of length 1 in a chain, each joint on a spring of length zero to one point, with loads
    at the joints.
    """
    angles = [f"t{k}" for k in range(bars)]
    points: dict[str, Any] = {"O": [0, 0], "A": ["a", "1/2"]}
    for k in range(bars):
        points[f"P{k}"] = ["+".join(f"{f}({t})" for t in angles[: k + 1]) for f in ("cos", "sin")]
    return {
        "name": "chain",
        "mechanism": {
            "name": "chain",
            "parameters": {"a": {"kind": "number"}, "F": {"kind": "force"}},
            "unknowns": dict.fromkeys(angles, "angle"),
            "points": points,
            "springs": [{"between": ["A", f"P{k}"], "k": 1} for k in range(bars)],
            "loads": {f"P{bars - 1}": ["1/5", "F"], "P0": ["1/7", 0]}
            if bars > 1
            else {"P0": ["1/5", "F"]},
        },
        "axes": {"a": [0, 1], "F": [0, 1]},
    }


FOUR_BAR: dict[str, Any] = yaml.safe_load("""
name: four-bar
system:
  unknowns: {p: angle, q: angle, m: real}
  equations:
    - k2*b*L1*sin(p) - F*L1*cos(p) + m*L1*(b*sin(p) + L2*sin(p - q))
    - -k1*b*L2*sin(q) - G*L2*cos(q) - m*L2*(b*sin(q) + L1*sin(p - q))
    - (b + L2*cos(q) - L1*cos(p))^2 + (L2*sin(q) - L1*sin(p))^2 - L3^2
parameters: {b: 2, L1: 1, L2: 3/2, L3: 7/4, k1: 1, k2: 4/3}
axes: {F: [-2, 2], G: [-2, 2]}
""")
X_JOINT: dict[str, Any] = yaml.safe_load("""
name: x-joint
system:  # tan(th2/2) = kappa tan(t/2), so that cos th2 = N/D and sin th2 = 2 kappa sin(t)/D
  unknowns: {t: angle}
  equations:
    - (k2*b*sin(t) - F*cos(t))*(1 + cos(t) + K^2*(1 - cos(t)))^2
      - 2*K*(2*K*k1*b*sin(t) + G*(1 + cos(t) - K^2*(1 - cos(t))))
parameters: {b: 1/2, K: 3, k1: 1, k2: 4/3}  # bars of length 1: K = (1 + b)/(1 - b)
axes: {F: [-2, 2], G: [-2, 2]}
""")
OSCILLATORS: dict[str, Any] = yaml.safe_load("""
name: four-oscillators
system:
  unknowns: {a: angle, b: angle, c: angle}
  equations:
    - sin(a - b) + sin(a - c) + sin(a) - w1
    - sin(b - a) + sin(b - c) + sin(b) - w2
    - sin(c - a) + sin(c - b) + sin(c) - 1/5
axes: {w1: [-2, 2], w2: [-2, 2]}
""")
ZEEMAN_LENGTHS: dict[str, Any] = yaml.safe_load("""
name: zeeman
system:  # u and v are the inverse lengths of the elastics
  unknowns: {t: angle, u: real, v: real}
  equations:
    - (x*sin(t) - y*cos(t))*(1 - u/4) + sin(t)*(1 - v/4)
    - u^2*((x - cos(t)/2)^2 + (y - sin(t)/2)^2) - 1
    - v^2*((1 - cos(t)/2)^2 + sin(t)^2/4) - 1
axes: {x: [-2, -1], y: [-1/2, 1/2]}
""")
PLATFORM: dict[str, Any] = yaml.safe_load("""
name: platform
system:
  unknowns: {t: angle, p: angle, u: real}
  equations:
    - (1 - u/3)*(L*cos(t) + cos(p) - 2)*(-L*sin(t)) + (1 - u/3)*(L*sin(t) + sin(p))*L*cos(t)
      + (L*cos(t) + cos(p)/2 - sin(p) - 1)*(-L*sin(t)) + (L*sin(t) + sin(p)/2 + cos(p) - 2)*L*cos(t)
      + W*L*cos(t)
    - (1 - u/3)*(L*cos(t) + cos(p) - 2)*(-sin(p)) + (1 - u/3)*(L*sin(t) + sin(p))*cos(p)
      + (L*cos(t) + cos(p)/2 - sin(p) - 1)*(-sin(p)/2 - cos(p))
      + (L*sin(t) + sin(p)/2 + cos(p) - 2)*(cos(p)/2 - sin(p)) + W*cos(p)
    - u^2*((L*cos(t) + cos(p) - 2)^2 + (L*sin(t) + sin(p))^2) - 1
axes: {L: [1, 2], W: [1, 2]}
""")


@pytest.mark.parametrize(
    ("record", "number"),
    [
        *(
            pytest.param(chain(n), comb(2 * n, n), id=f"chain of {n} [C(2 n, n), REFERENCE]")
            for n in (1, 2, 3)
        ),
        pytest.param(
            FOUR_BAR, 12, id="four-bar with springs on its diagonals [two eliminations, REFERENCE]"
        ),
        pytest.param(X_JOINT, 6, id="antiparallelogram with springs on its diagonals [REFERENCE]"),
        pytest.param(OSCILLATORS, 14, id="four Kuramoto oscillators [REFERENCE]"),
        pytest.param(
            ZEEMAN_LENGTHS, 16, id="Zeeman's machine, lengths of all signs [arXiv 2009.13408]"
        ),
        pytest.param(
            PLATFORM, 20, id="platform on a leg and two springs, one free length [Vikas's thesis]"
        ),
    ],
)
@pytest.mark.slow_cases(
    "chain of 3 [C(2 n, n), REFERENCE]",
    "platform on a leg and two springs, one free length [Vikas's thesis]",
)
def test_numbers_of_complex_solutions(record: dict[str, Any], number: int) -> None:
    """At three points; with multiplicities and without."""
    problem = problem_of(ptmcad.slice_from_mapping(record))
    for share in (fmpq(29, 100), fmpq(37, 71), fmpq(13, 17)):
        x, y = (share * (high - low) + low for low, high in problem.window)
        assert solutions_at(problem.system, problem.on.values((x, y))) == (number, number)


@pytest.mark.parametrize(
    ("record", "degree", "terms"),
    [
        pytest.param(chain(2), 24, 313, id="chain of two bars [REFERENCE]"),
        pytest.param(
            FOUR_BAR, 18, 100, id="four-bar [two eliminations, REFERENCE]", marks=pytest.mark.slow
        ),
        pytest.param(
            OSCILLATORS, 42, 809, id="four Kuramoto oscillators [REFERENCE]", marks=pytest.mark.slow
        ),
    ],
)
def test_sizes_of_critical_curves(record: dict[str, Any], degree: int, terms: int) -> None:
    components = variety_of(problem_of(ptmcad.slice_from_mapping(record))).components
    (found,) = [c.polynomial.terms for c in components if c.kind is Kind.CRITICAL]
    assert (max(i + j for i, j, _ in found), len(found)) == (degree, terms)


# ----------------------------------------------------------------------------------------------- cusps of a manipulator

Q, Q1, Q2 = (
    "(d3^2 + d4^2 + 2 + 2*d3*d4*cos(t) + 2*d4*sin(t))",
    "(2*d4*cos(t) - 2*d3*d4*sin(t))",
    "(-2*d3*d4*cos(t) - 2*d4*sin(t))",
)
A, A1, A2 = "(d3 + d4*cos(t))", "(-d4*sin(t))", "(-d4*cos(t))"
Z4 = f"(4*{A}^2 - (R - {Q})^2)"
CUSPS: dict[str, Any] = {
    # postures at (r, z) solve (R - q)^2 + 4 (z^2 - A^2) = 0 with R = r^2 + z^2; they are threefold
    # where both derivatives by t are zero too, and there are such places above and below z = 0
    "unknowns": {"t": "angle", "R": "real"},
    "equations": [
        f"(R - {Q})*{Q1} + 4*{A}*{A1}",
        f"{Q1}^2 - (R - {Q})*{Q2} - 4*({A1}^2 + {A}*{A2})",
    ],
    "positive": [Z4, f"4*R - {Z4}"],
}


@pytest.mark.parametrize(
    ("d3", "ends", "cusps"),
    [
        ("1/2", ("0.227", "0.601", "1.118"), (0, 4, 2, 0)),
        ("2", ("0.201", "2.108", "2.828"), (0, 4, 2, 4)),
    ],
)
def test_cusps_of_orthogonal_manipulators_as_baili_wenger_and_chablat_have_them(
    d3: str, ends: tuple[str, ...], cusps: tuple[int, ...]
) -> None:
    """arXiv 0707.2842, d2 = r2 = 1, r3 = 0: on both sides of each end, half a unit of its last
    digit away.
    """
    record = {"name": "cusps", "system": CUSPS, "axes": {"d3": [0, 3], "d4": [0, 3]}}
    model = ptmcad.slice_from_mapping(record).model
    for end, before, after in zip(ends, cusps, cusps[1:], strict=False):
        near = [Fraction(end) + side * Fraction(1, 2000) for side in (-1, 1)]
        assert [2 * ptmcad.counts_at(model, d3=d3, d4=str(d4)).total for d4 in near] == [
            before,
            after,
        ]


# ----------------------------------------------------------------------------------------------------- Zeeman's machine

ZEEMAN: dict[str, Any] = yaml.safe_load("""
name: zeeman
mechanism:
  name: zeeman
  parameters: {x: {kind: number}, y: {kind: number}, l0: {kind: free length, default: 0}}
  unknowns: {t: angle}
  points: {O: [0, 0], P: [cos(t)/2, sin(t)/2], A: [1, 0], C: [x, y]}
  springs: [{between: [A, P], k: 1, free: l0}, {between: [C, P], k: 1, free: l0}]
parameters: {l0: 1/4}
axes: {x: [-2, -3/4], y: [-1/2, 1/2]}
count: index
""")


def test_zeemans_machine_has_two_stable_positions_within_four_cusps() -> None:
    """arXiv 2009.13408: against the signs of the moment at 4000 angles, on a grid of control
    points.
    """
    pytest.importorskip("numba")
    result = ptmcad.classify(ptmcad.slice_from_mapping(ZEEMAN), tolerance="1/50", jobs=1)
    assert {cell.index for cell in result.cells} == {(1, 1), (2, 2)}
    checked = 0
    for i in range(12):
        for j in range(10):
            x, y = (
                Fraction(-2) + Fraction(5 * (2 * i + 1), 96),
                Fraction(-1, 2) + Fraction(2 * j + 1, 20),
            )
            found = result.locate(x=x, y=y)
            if found.index is not None:
                assert found.total == balanced(float(x), float(y))
                checked += 1
    assert checked > 100


def balanced(x: float, y: float, samples: int = 4000) -> int:
    """How often the moment on the disc changes its sign."""
    from math import cos, hypot, sin

    def moment(t: float) -> float:
        px, py = cos(t) / 2, sin(t) / 2
        total = 0.0
        for ax, ay in ((1.0, 0.0), (x, y)):
            length = hypot(px - ax, py - ay)
            total += (1 - 0.25 / length) * ((px - ax) * -py + (py - ay) * px)
        return total

    signs = [moment(2 * pi * (k + 0.5) / samples) > 0 for k in range(samples)]
    return sum(signs[k - 1] != signs[k] for k in range(samples))


def test_the_area_under_a_polynomials_graph_is_known_to_the_last_digit_at_any_tolerance() -> None:
    """Of x^2 = 3 b - a^60 + a: above the graph of (a^60 - a)/3 there are two solutions."""
    system = {"unknowns": {"x": "real"}, "equations": ["x^2 - 3*b + a^60 - a"]}
    question = {"system": system, "axes": {"a": ["-1", "1/2"], "b": [-1, 1]}}
    result = ptmcad.classify(question, area_tolerance="1/10")
    by_number = {result.cells[region.cells[0]].total: region.area for region in result.regions}
    graph = (Fraction(1, 2) ** 61 + 1) / 183 - (Fraction(1, 4) - 1) / 6
    for total, expected in ((2, Fraction(3, 2) - graph), (0, Fraction(3, 2) + graph)):
        low, high = by_number[total]
        assert low <= expected <= high
        assert high - low < Fraction(1, 10**15)
