"""The quotient by an involution: which are found, its formulas, and a map with three odd angles."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from math import asin, sqrt, tan
from pathlib import Path
from typing import Any

import pytest
import yaml
from flint import ctx
from mpmath import mp, mpf
from support.mechanisms_energy import energy

from ptmcad.text.balls import ball_of

pytest.importorskip("numba")

from support.replacing import replace

import ptmcad
from ptmcad.ask.lines.along import certified_intervals
from ptmcad.certified import enclosedline
from ptmcad.certified.plain.geometry import geometry
from ptmcad.certified.plain.mirrors import MirrorFrame, frames, halving, mirrors
from ptmcad.certified.plain.opening import Coordinates, coordinates, opening
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.plain.springchart import chart
from ptmcad.certified.plain.straight import branches
from ptmcad.certified.plain.symmetricfolds import MAX_ODD, NEAR_SQUARED
from ptmcad.certified.plain.unknownranges import ranges
from ptmcad.formulas.ballarithmetic import run_arb
from ptmcad.formulas.tape import record
from ptmcad.model.involutions import Involution
from ptmcad.question.config import load, slice_from_mapping
from ptmcad.question.slice import Slice

SHIPPED = Path(__file__).resolve().parents[2] / "configs"
PENDULUM = yaml.safe_load("""
parameters: {k: {kind: stiffness}, F: {kind: force}, l: {kind: length}}
unknowns: {a: angle, b: angle, c: angle}
points:
  O: [0, 0]
  P: [cos(a), sin(a)]
  Q: [cos(a) + cos(b), sin(a) + sin(b)]
  R: [cos(a) + cos(b) + cos(c), sin(a) + sin(b) + sin(c)]
  E: [5, 0]
bars: [[O, P], [P, Q], [Q, R]]
supports: {O: pin, E: pin}
springs:
  - {between: [P, E], k: k, free: l}
  - {between: [Q, E], k: 1}
  - {between: [R, E], k: 1, free: l}
  - {between: [O, R], k: 1/2}
loads: {R: [F, 0]}
""")
"""Three bars in a row along an axis: all angles are odd."""
MASS = yaml.safe_load("""
parameters: {c: {kind: stiffness}, s0: {kind: free length, default: 1/5}, W: {kind: force}}
unknowns: {x: length, y: length}
points: {A: [0, 0], P: [x, y]}
supports: {A: pin}
springs: [{between: [A, P], k: c, free: s0}]
loads: {P: {weight: W}}
""")
"""A weight on a spring."""
CART = yaml.safe_load("""
parameters: {k: {kind: stiffness}, l: {kind: length}}
unknowns: {t: angle, u: length, v: length}
points:
  A: [u, 0]
  B: [v, 1/2]
  C: [cos(t), sin(t) + 2]
  D: [1, 0]
  E: [1, 1/2]
  M: [-1, 0]
  N: [-1, 1/2]
  S: [0, 2]
bars: [[S, C]]
supports: {S: pin, D: pin, E: pin, M: pin, N: pin}
springs:
  - {between: [A, C], k: k, free: l}
  - {between: [B, C], k: 1, free: l/2}
  - {between: [A, D], k: 1, free: l}
  - {between: [A, M], k: 1, free: l}
  - {between: [B, E], k: 2}
  - {between: [B, N], k: 2}
""")
"""Two sliders and a bar above them: a reflection takes each slider to its negative, and the bar's
angle to pi less it; springs are each other's images."""
TWINS = yaml.safe_load("""
parameters: {k: {kind: stiffness}, F: {kind: force}, l: {kind: length}}
unknowns: {a: angle, b: angle}
points: {A: [0, 0], B: [1, 0], P: [cos(a), sin(a)], Q: [1 - cos(b), sin(b)]}
bars: [[A, P], [B, Q]]
supports: {A: pin, B: pin}
springs:
  - {between: [A, Q], k: k, free: l}
  - {between: [B, P], k: k, free: l}
  - {between: [P, Q], k: 3, free: l/2}
loads: {P: [0, F], Q: [0, F]}
""")
"""Two bars that are each other's images."""
WINDOWS: dict[str, dict[str, list[str]]] = {
    "pendulum": {"F": ["-2", "-1"], "l": ["1/2", "1"]},
    "cart": {"k": ["1", "2"], "l": ["1/4", "1/2"]},
    "twins": {"F": ["-2", "-1"], "l": ["1/4", "1/2"]},
}
MECHANISMS: dict[str, dict[str, Any]] = {"pendulum": PENDULUM, "cart": CART, "twins": TWINS}


def slice_of(name: str, **loads: object) -> Slice:
    given = {p: "2" for p in MECHANISMS[name]["parameters"] if p not in WINDOWS[name]}
    mechanism = MECHANISMS[name] | ({"loads": loads} if loads else {})
    return slice_from_mapping(
        {
            "name": name,
            "mechanism": {"name": name, **mechanism},
            "parameters": given,
            "axes": WINDOWS[name],
        }
    )


def found(slice: Slice) -> Involution | None:
    return next(iter(mirrors(slice, problem_of(slice))), None)


def test_a_branch_has_the_mirrors_that_keep_its_sides() -> None:
    """Of a slider's spring along its guide, one side of which an involution takes to the other."""
    slider = yaml.safe_load("""
        name: slider
        mechanism:
          parameters: {l: {kind: length}, m: {kind: length}}
          unknowns: {u: length, w: length}
          points: {O: [0, 0], A: [u, 0], P: [0, w]}
          supports: {O: pin}
          springs:
            - {between: [O, A], k: 1, free: l}
            - {between: [A, P], k: 1, free: m}
            - {between: [O, P], k: 1}
        parameters: {}
        axes: {l: [1, 2], m: [1, 2]}
    """)
    slice = slice_from_mapping(slider)
    sides = branches(problem_of(slice), slice.axes)
    assert len(sides) == 2
    for side in sides:
        (kept,) = mirrors(slice, side)
        assert kept.text(("u", "w"), slice.axis_names) == "w -> -w"


def test_what_is_near_fixed_points_is_searched_about_them() -> None:
    """Odd coordinates reach a little farther than where the other search begins."""
    share = sqrt(NEAR_SQUARED)
    farthest = max(share, asin(share), 2 * tan(asin(share) / 2))
    assert farthest < MAX_ODD < 1.01 * farthest


def test_which_are_found() -> None:
    assert found(slice_of("pendulum")) == Involution((0, 1, 2), (-1, -1, -1), (0, 0, 0))
    assert found(slice_of("pendulum", R=["F", "1/1000"])) is None
    assert found(slice_of("cart")) == Involution((0, 1, 2), (-1, -1, -1), (1, 0, 0))
    assert found(slice_of("twins")) == Involution((1, 0), (1, 1), (0, 0))
    assert found(slice_of("twins", P=[0, "F"], Q=[0, "2*F"])) is None


def place_of(at: Coordinates, e: Sequence[mpf], c: mpf, w: Sequence[mpf]) -> list[mpf]:
    """The unknowns, by the definition of the coordinates."""
    r = mp.acos(c) if at.is_turning else mp.sqrt(c)
    odds = []
    for share, reach in zip(w, at.frame.reaches, strict=True):
        if reach:
            odds.append(mpf(reach.numerator) / reach.denominator * r * share)
        else:
            odds.append(r if at.is_turning else 2 * mp.atan(r * share))
    return [
        (p.even_sign * e[p.even] if p.even >= 0 else 0)
        + (p.odd_sign * odds[p.odd] if p.odd >= 0 else 0)
        + p.quarters * mp.pi / 2
        for p in at.frame.places
    ]


def cases(name: str) -> list[tuple[MirrorFrame, int]]:
    slice = slice_of(name)
    problem = problem_of(slice)
    change, *_ = mirrors(slice, problem)
    return [
        (f, lead)
        for f in frames(problem, change, ranges(problem, slice.axes))
        for lead in range(len(f.reaches))
    ]


@pytest.mark.parametrize("name", MECHANISMS)
@pytest.mark.slow_cases("cart")
def test_formulas_are_the_energys_derivatives(name: str) -> None:
    """Against difference quotients of an energy that is read off the record by other means."""
    slice, rng = slice_of(name), random.Random(3)
    exact = geometry(problem_of(slice), slice.axes)
    for frame, lead in rng.sample(cases(name), min(2, len(cases(name)))):
        at = coordinates(frame, lead)
        near = opening(at, [s.vector for s in chart(exact, unknowns=at.unknowns()).cones])
        numbers = [Fraction(rng.randint(100, 900), 1000) for _ in range(3 + len(frame.places))]
        x, y = (
            a.low + (a.high - a.low) * share for a, share in zip(slice.axes, numbers, strict=False)
        )
        *free, r = numbers[2 : 3 + len(frame.ranges)]
        shares = numbers[3 + len(frame.ranges) :][: len(at.w) - 1]
        tape = record([[near.slope, *near.ratios, near.bend, *near.mixed, *(f for row in near.by_even for f in row),
                        *near.by_coordinate, *(f for row in near.by_ratio for f in row)]])  # fmt: skip
        with ctx.workprec(200):
            run = run_arb(tape, [ball_of(v) for v in (x, y, *free, r, *shares)], 200)
            values = [float(run[int(k)].mid()) for k in tape.outputs[0]]
        with mp.workdps(40):
            big = [mpf(v.numerator) / v.denominator for v in (x, y, *free, r, *shares)]
            given = {n: mpf(2) for n in MECHANISMS[name]["parameters"]}
            given |= dict(zip(slice.axis_names, big, strict=False))
            r_, size = big[2 + len(free)], len(free)
            c = mp.cos(r_) if at.is_turning else r_**2
            expected = reference(name, at, given, [*big[2 : 2 + size], c, *big[3 + size :]])
        assert values == pytest.approx([float(v) for v in expected], rel=1e-9, abs=1e-9)


def reference(name: str, at: Coordinates, given: dict[str, mpf], point: list[mpf]) -> list[mpf]:
    """The derivatives of an `Opening` by difference quotients, at even coordinates, c, and the
    shares in turn.
    """
    size, others, lead = len(at.evens), range(len(at.w) - 1), at.lead

    def u(*z: mpf) -> mpf:
        w = [*z[size + 1 : size + 1 + lead], mpf(1), *z[size + 1 + lead :]]
        return energy(MECHANISMS[name], given, place_of(at, z[:size], z[size], w))

    def by(f: Any, k: int, z: Sequence[mpf] = point) -> mpf:
        return mp.diff(f, tuple(z), tuple(int(n == k) for n in range(len(point))))

    def slope(*z: mpf) -> mpf:
        return by(u, size, z)

    def ratio(j: int) -> Any:
        return lambda *z: by(u, size + 1 + j, z) / z[size]

    ratios = [ratio(j) for j in others]
    return [
        slope(*point), *(f(*point) for f in ratios), by(slope, size), *(by(slope, k) for k in range(size)),
        *(by(f, k) for f in ratios for k in range(size)), *(by(f, size) for f in ratios),
        *(by(f, size + 1 + j) for f in ratios for j in others),
    ]  # fmt: skip


def test_a_half_of_a_window_says_the_same_as_the_whole_of_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Forces on three cables whose mirror image is across, and two axes that an exchange of
    unknowns exchanges.
    """
    truss = {
        "name": "pair", "unknowns": {"u": "real", "v": "real"}, "parameters": {"a": {}, "b": {}},
        "potential": "u^4 + v^4 - u^2 - v^2 + u*v/2 + a*u + b*v",
    }  # fmt: skip
    window = {"axes": {"a": [-1, 1], "b": [-1, 1]}}
    cases = [(load(SHIPPED / "mechanisms" / "three-cables.yaml"), "1/20"),
             (slice_from_mapping({"name": "pair", "system": truss, "count": "stable", **window}), "1/20")]  # fmt: skip
    rng = random.Random(11)
    for slice, tolerance in cases:
        given: dict[str, Any] = {"engine": "certified", "tolerance": tolerance, "jobs": 1}
        change = halving(slice)
        assert change is not None
        half = ptmcad.classify(slice, **given)
        with monkeypatch.context() as patched:
            patched.setattr("ptmcad.certified.engine.halving", lambda slice: None)
            whole = ptmcad.classify(slice, **given)
        assert half.undetermined <= Fraction(tolerance)
        assert ["one half of the window" in str(found.plan[-1]) for found in (half, whole)] == [
            True,
            False,
        ]
        counter, known = plain_counter(slice), 0
        for _ in range(25):
            x, y = (
                a.low + (a.high - a.low) * Fraction(rng.randrange(1, 10**4), 10**4)
                for a in slice.axes
            )
            for point in ((x, y), change.at((x, y))):
                at = dict(zip(slice.axis_names, point, strict=True))
                one, other = half.locate(**at), whole.locate(**at)
                if one.stable is not None:
                    known += 1
                    assert counter.at(*point, slice.count).stable == one.stable
                    assert other.stable in (None, one.stable) and other.admissible in (
                        None,
                        one.admissible,
                    )
        assert known > 35
        assert ptmcad.verify(half).ok


def test_pitchforks_along_a_line_of_all_equilibria() -> None:
    """By the quotient, where one involution keeps the line, with the counts that were known between
    them.
    """
    slice = load(SHIPPED / "free-load.yaml")
    found = certified_intervals(slice, "rho", {"F": "-10"}, 10)
    assert [change.proved for change in found.changes if change.names == ("pitchfork",)] == [
        True
    ] * 5
    assert [interval.index for interval in found.intervals] == [
        (2, 5, 1), (3, 6, 1), (2, 5, 1), (2, 4, 1), (2, 3, 1), (2, 4, 2), (2, 6, 4),
        (2, 6, 4), (2, 4, 2), (2, 3, 1), (1, 2, 1), (2, 3, 1), (2, 4, 1), (2, 3, 1),
    ]  # fmt: skip


@pytest.mark.slow
def test_a_spring_without_length_in_a_configuration_that_is_its_own_image() -> None:
    """At rho = L1 - L2 the bars are in a line, and so is a curve of configurations whose spring has
    no length: that spring's direction is a variable there, and pitchforks with a short one are
    proved beside it."""
    slice = load(SHIPPED / "free02-unloaded.yaml")
    slice = replace(
        slice,
        axes=(replace(slice.axes[0], low=Fraction("0.16"), high=Fraction("0.182")), slice.axes[1]),
    )
    found = certified_intervals(slice, "rho", {"L2": "5/6"}, 10)
    assert [(change.names, change.proved) for change in found.changes] == [
        (("point where spring A3A4 has no length",), True), (("pitchfork",), True)
    ]  # fmt: skip
    assert found.changes[0].at.low <= Fraction(1, 6) <= found.changes[0].at.high
    assert [interval.index for interval in found.intervals] == [(2, 4, 2), (2, 5, 1), (2, 6, 2)]


def test_what_is_undecided_along_a_line_is_not_looked_at_closely_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A mass on a spring turns freely without its weight: that is undecided once, and nothing else
    is lost.
    """
    record = {
        "name": "mass",
        "mechanism": MASS,
        "axes": {"W": [0, 20], "c": [10, 80]},
        "count": "stable",
    }
    slice, calls, search = slice_from_mapping(record), list[int](), enclosedline.isolate

    def counted(*arguments: Any) -> Any:
        calls.append(0)
        return search(*arguments)

    monkeypatch.setattr(enclosedline, "isolate", counted)
    found = certified_intervals(slice, "W", {"c": "40"}, 10)
    few, changes = len(calls), enclosedline._changes
    assert not found.changes[0].proved and found.changes[0].at.high < Fraction(1, 1000)
    assert [interval.index for interval in found.intervals] == [(1, 1, 0), (1, 0, 0)]
    monkeypatch.setattr(enclosedline, "_changes", lambda *arguments: changes(*arguments[:-1], ()))
    calls.clear()
    alone = certified_intervals(slice, "W", {"c": "40"}, 10)
    assert few < len(calls)
    assert (alone.intervals, alone.changes[1:]) == (found.intervals, found.changes[1:])


def test_a_line_without_a_springs_length_parts_no_regions() -> None:
    """Over rho = 1 two springs can lose their lengths; the count of stable equilibria stays what it
    is.
    """
    found = ptmcad.classify("free-load", tolerance="1/200")
    left, right = (found.locate(rho=rho, F="-20") for rho in ("99/100", "101/100"))
    assert left.region is not None
    assert left.region == right.region


@pytest.mark.parametrize(
    ("height", "found"), [("2", 0), ("3", 1)], ids=["at C's reach", "out of it"]
)
def test_a_spring_without_length_where_all_unknowns_are_fixed_leaves_no_quotient(
    height: str, found: int
) -> None:
    """Two bars that stand upright below A: with coordinates about that pose no map of them would
    end.
    """
    mechanism = {
        "parameters": {"f": {"kind": "free length", "default": "1/2"}, "W": {"kind": "force"}},
        "unknowns": {"v": "angle", "u": "angle"},
        "points": {
            "A": [0, height],
            "B": ["sin(u)", "cos(u)"],
            "C": ["sin(u) + sin(v)", "cos(u) + cos(v)"],
        },
        "springs": [{"between": ["A", "C"], "k": 1, "free": "f"}],
        "torsion": [{"angle": "u", "k": "1/2"}],
        "loads": {"C": [0, "-W"]},
    }
    slice = slice_from_mapping(
        {"name": "upright", "mechanism": mechanism, "axes": {"W": ["1/4", 2], "f": ["1/10", "1/2"]}}
    )
    assert len(mirrors(slice, problem_of(slice))) == found
    if not found:
        result = ptmcad.classify(slice, engine="certified", tolerance="1/20")
        assert sorted(region.stable for region in result.regions) == [1, 2]
