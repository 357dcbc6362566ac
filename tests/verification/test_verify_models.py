"""The verification of maps of other models than the paper's mechanism: accepted when true, rejected
when false.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from functools import cache, partial
from typing import Any

import pytest
import yaml
from forger.consistency import drop, put
from forger.judge import judged, violation
from support.maps import once_per_run
from support.random_models import random_mechanism, random_system
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import HARMLESS, Cell, Component, Kind, RegionMap
from ptmcad.model import described
from ptmcad.question.slice import Count
from ptmcad.text.plane import PlanePolynomial
from ptmcad.verification.claims import Claims
from ptmcad.verification.norms import check_norm
from ptmcad.verification.report import Violation
from ptmcad.verification.solutions import check_counts, check_solutions


def turned(moment: str) -> dict[str, Any]:
    """A bar on a spring under a moment."""
    return {
        "mechanism": {
            "name": "turned",
            "parameters": {"M": {}, "c": {}},
            "unknowns": {"th": "angle"},
            "points": {"O": [0, 0], "A": [1, "1/2"], "P": ["cos(th)", "sin(th)"]},
            "bars": [["O", "P"]],
            "springs": [{"between": ["A", "P"], "k": 1}],
            "moments": {"th": moment},
        },
        "axes": {"M": [-3, 3], "c": [-3, 3]},
    }


RECORDS: dict[str, dict[str, Any]] = yaml.safe_load("""
cusp: {system: {unknowns: {x: real}, equations: [x^3 - a*x + b]}, axes: {a: [-2, 2], b: [-2, 2]}}
kuramoto:
  system: {unknowns: {p: angle, q: angle}, equations: [sin(p-q)+sin(p)-w1, sin(q-p)+sin(q)-w2]}
  axes: {w1: [-2, 2], w2: [-2, 2]}
# one solution is zero everywhere, where the inequality's polynomial vanishes
duffing:
  system: {unknowns: {z: real}, equations: [(((W - 1 - 3/4*z)^2 + W/100)*z - G)*z], positive: [z]}
  axes: {W: [0, 3], G: [0, 1]}
  count: total
pendulum:
  mechanism:
    name: pendulum
    parameters:
      L: {kind: length, default: 1}
      a: {kind: base, default: 1, range: [0, 3]}
      k: {kind: stiffness, default: 1, range: [0, 4]}
      W: {kind: force, range: [-2, 2]}
    unknowns: {th: angle}
    points: {O: [0, 0], A: [0, a], P: [L*sin(th), L*cos(th)]}
    springs: [{between: [A, P], k: k}]
    loads: {P: [1/10, W]}
  axes: {a: [0, 3], W: [-4, 4]}
torque:
  mechanism:
    name: torque
    parameters:
      c: {kind: stiffness, range: [0, 4]}
      W: {kind: force, default: 1}
      M: {kind: force}
    unknowns: {th: angle}
    points: {O: [0, 0], P: [cos(th), sin(th)]}
    torsion: [{angle: th, k: c, rest: {cos: 3/5, sin: 4/5}}]
    loads: {P: [0, -W]}
    moments: {th: M}
  axes: {c: [0, 2], M: [-3, 3]}
# the second condition is zero at the solution x = 0, and one more sign condition has a curve of
# its own
stable where:
  system: {unknowns: {x: real}, equations: [x^3 - a*x], stable: [x + b, x*(x + 1) + b^2*x]}
  axes: {a: [-2, 2], b: [-2, 2]}
  count: stable
potential with an inequality:
  system: {unknowns: {x: real}, potential: x^4 - a*x^2 + b*x, positive: [x + 1]}
  axes: {a: [-2, 2], b: [-2, 2]}
  count: index
pole:
  system: {unknowns: {x: real, t: angle}, equations: [a*x^2 + b*x - 1, sin(t) - x/4]}
  axes: {a: [-2, 2], b: [-2, 2]}
# two roots are multiple over b = -0.88, and over its conjugate 1.41 there are others
symmetric:
  system:
    unknowns: {p: angle, q: angle, r: real}
    equations: [cos(p) + cos(q) - a, r*sin(p) - sin(q), r + cos(p - q) - b]
    positive: [r]
  axes: {a: [-2, 2], b: [-2, 2]}
# three angles
chain:
  system:
    unknowns: {u: angle, v: angle, w: angle}
    potential: -a*cos(u) - cos(v) - b*sin(w) - cos(2*v - u)*0 - cos(w)
  axes: {a: [-2, -1], b: [1, 2]}
  count: index
# two moments, each of which depends on the other's unknown: the matrix of derivatives is not
# symmetric
moments:
  mechanism:
    name: moments
    parameters: {M: {}, a: {}}
    unknowns: {th: angle, s: length}
    points: {A: [0, a], P: [s + cos(th), sin(th)], G: [s, 0], O: [0, 0]}
    springs: [{between: [A, P], k: 1}, {between: [O, G], k: 2}]
    moments: {th: M*s, s: M/3*cos(th) + 1/2}
  axes: {M: [-2, 2], a: [-2, 2]}
moments of three unknowns:
  mechanism:
    name: moments_3
    parameters: {M: {}, F: {}}
    unknowns: {a: angle, x: length, y: length}
    points: {O: [0, 0], P: [x, y], Q: [x + cos(a), y + sin(a)], A: [2, 1]}
    springs: [{between: [O, P], k: 2}, {between: [A, Q], k: 1}]
    moments: {a: M*x + F, x: M*y/2, y: F*cos(a)}
  axes: {M: [-1, 1], F: [-1, 1]}
""") | {
    # a moment that depends on its own angle: but for its constant part it has an energy
    "moment": turned("M*sin(2*th) + c"),
    "constant moment": turned("M + c/2"),
    **{f"system {seed}": random_system(seed) for seed in (0, 1, 2, 4, 7, 8)},
    **{f"mechanism {seed}": random_mechanism(seed) for seed in (0, 3, 6, 9)},
}
LARGE = ("kuramoto", "system 7", "moments of three unknowns")
"""Of which others are of the same kind: equations without a potential, a random system, moments."""
SMALL = (
    "cusp",
    "duffing",
    "stable where",
    "potential with an inequality",
    "system 0",
    "mechanism 0",
    "moment",
    "constant moment",
    "torque",
)


@cache
def map_of(name: str) -> RegionMap:
    """A map as a reader of its file has it."""

    def compute() -> RegionMap:
        return ptmcad.classify(
            ptmcad.slice_from_mapping({"name": "map", **RECORDS[name]}), area_tolerance="1/100"
        )

    return RegionMap.from_json(once_per_run(f"model {name}", compute).to_json())


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow if n in LARGE else ()) for n in RECORDS]
)
@pytest.mark.fast_cases(
    "pendulum",
    "torque",
    "chain",
    "constant moment",
    "system 0",
    "system 2",
    "system 8",
    "mechanism 0",
    "mechanism 3",
    "mechanism 9",
)
def test_true_maps_are_accepted(name: str) -> None:
    report = ptmcad.verify(map_of(name))
    assert report.ok, report.violation
    assert {c.name for c in report.checks if not c.passed} <= {"plan without trace", "provenance"}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n in SMALL else pytest.mark.slow) for n in RECORDS]
)
@pytest.mark.slow_cases(
    "moment", "stable where", "duffing", "potential with an inequality", "constant moment", "cusp"
)
def test_false_alterations_are_rejected(name: str) -> None:
    """One place of each kind of the forger."""
    tally = judged(name, map_of(name), 1, 0)
    assert not tally.wrong, "\n".join(tally.wrong)


# ------------------------------------------------------------------------------------------ what is false about a model


@pytest.mark.parametrize("name", ["moments", "moments of three unknowns"])
@pytest.mark.slow_cases("moments")
def test_what_a_moment_alters_is_rejected(name: str) -> None:
    """Its part in the equations and their derivatives, a potential, what is stable and an index,
    which it has not.
    """
    true = map_of(name)
    assert not true.system.potential and {c.stable for c in true.cells} == {None} == {
        c.index for c in true.cells
    }
    k = next(k for k, c in enumerate(true.cells) if c.solutions)
    cell, system = true.cells[k], true.system
    signs = replace(cell, solutions=(replace(cell.solutions[0], signs="+"), *cell.solutions[1:]))
    index = (cell.total or 0, *(0 for _ in true.slice.model.unknowns))
    weaker = system.gradient[0].replace("M*", "")
    for false, check in (
        (replace(true, system=replace(system, potential="0")), "equations"),
        (
            replace(true, system=replace(system, gradient=(weaker, *system.gradient[1:]))),
            "equations",
        ),
        (with_cell(true, k, replace(cell, stable=cell.total)), "counts"),
        (with_cell(true, k, replace(cell, total=(cell.total or 0) + 2)), "counts"),
        (with_cell(true, k, replace(cell, index=index)), "counts"),
        (with_cell(true, k, signs), "solutions"),
        (replace(true, slice=replace(true.slice, count=Count.STABLE)), "shape"),
        (replace(true, slice=replace(true.slice, count=Count.INDEX)), "shape"),
    ):
        found = violation(false, check)
        assert found is not None and found[0] == check


@pytest.mark.parametrize("less", ["M", "M*cos_th", "1/2*M*cos_th^2", "c*sin_th"])
def test_the_work_of_a_moment_is_in_the_potential(less: str) -> None:
    """With another constant or another wave it is another potential."""
    true = map_of("moment")
    potential = f"{true.system.potential} - {less}"
    found = violation(replace(true, system=replace(true.system, potential=potential)), "equations")
    assert found is not None and found[0] == "equations"


def test_derivatives_under_moments_are_no_symmetric_matrix() -> None:
    true = map_of("moments")
    (a, b), (c, d) = true.system.hessian
    assert b != c
    for hessian in (((a, c), (b, d)), ((a, b), (b, d)), ((a, c), (c, d))):
        found = violation(replace(true, system=replace(true.system, hessian=hessian)), "equations")
        assert found is not None and found[0] == "equations"


def with_cell(true: RegionMap, k: int, cell: Cell) -> RegionMap:
    return replace(true, cells=(*true.cells[:k], cell, *true.cells[k + 1 :]))


def test_real_solutions_may_leave_over_a_harmless_curve() -> None:
    """On the torus they stay; a curve of poles of real unknowns must be used."""
    true = map_of("pole")
    poles = [n for n, c in enumerate(true.components) if c.kind is Kind.INFINITY and not c.left_out]
    assert poles
    for n in poles:
        false = replace(true, components=put(true.components, n, left_out=HARMLESS))
        found = violation(false, "variety complete")
        assert found is not None
        assert "real solutions may leave every bounded set" in found[1]


def dropped(true: RegionMap, kind: Kind) -> list[RegionMap]:
    found = [n for n, c in enumerate(true.components) if c.kind is kind]
    assert found
    return [replace(true, components=drop(true.components, n)) for n in found]


@pytest.mark.parametrize(
    ("name", "kind", "check"),
    [
        ("stable where", Kind.BOUNDARY, "conditions"),
        ("potential with an inequality", Kind.BOUNDARY, "conditions"),
        ("cusp", Kind.CRITICAL, "variety complete"),
        ("pole", Kind.INFINITY, "variety complete"),
    ],
)
def test_a_curve_that_is_missing_is_missed(name: str, kind: Kind, check: str) -> None:
    for false in dropped(map_of(name), kind):
        found = violation(false, check)
        assert found is not None
        assert found[0] == check


def test_a_curve_that_bounds_nothing() -> None:
    line = Component(
        PlanePolynomial.of([(1, 0, 1), (0, 0, -7)]), Kind.BOUNDARY, "no point in the window"
    )
    true = map_of("stable where")
    found = violation(replace(true, components=(*true.components, line)), "boundary components")
    assert found is not None
    assert "bounds nothing" in found[1]


def test_a_condition_that_is_said_to_be_zero() -> None:
    """And one that is zero, but is said to be positive."""
    true = map_of("stable where")
    for n, cell in enumerate(true.cells):
        for k, solution in enumerate(cell.solutions):
            for sign in "0+-":
                signs = solution.signs[:-1] + sign
                if signs != solution.signs:
                    cells = put(true.cells, n, solutions=put(cell.solutions, k, signs=signs))
                    found = violation(replace(true, cells=cells), "solutions")
                    assert found is not None
    assert any("0" in s.signs for c in true.cells for s in c.solutions)


def other_system(change: Callable[[dict[str, Any]], Any], name: str) -> RegionMap:
    """The claims of a map, said of a model that differs."""
    record = {"name": "map", **RECORDS[name]}
    key = "system" if "system" in record else "mechanism"
    model = deepcopy(record[key])
    change(model)
    slice = ptmcad.slice_from_mapping({**record, key: model})
    return replace(map_of(name), slice=replace(map_of(name).slice, model=slice.model))


@pytest.mark.parametrize(
    ("name", "change", "what"),
    [
        (
            "cusp",
            lambda m: m.update(equations=["x^3 - a*x + 2*b"]),
            "the stored equation 0 differs",
        ),
        ("duffing", lambda m: m.update(positive=["z - 1"]), "the stored inequality 0 differs"),
        (
            "duffing",
            lambda m: m.update(positive=["z", "z + 1"]),
            "there are 2 of the kind inequality n, not 1",
        ),
        (
            "stable where",
            lambda m: m.update(stable=["x + b", "x"]),
            "the stored condition 1 for stability differs",
        ),
        ("pendulum", lambda m: m.update(loads={"P": ["1/9", "W"]}), "the stored potential differs"),
        (
            "torque",
            lambda m: m["torsion"][0].update(rest={"cos": "4/5", "sin": "3/5"}),
            "the stored potential differs",
        ),
        (
            "torque",
            lambda m: m.update(moments={"th": "-M"}),
            "the stored gradient's entry 0 differs",
        ),
        (
            "torque",
            lambda m: m.update(moments={"th": "M*cos(th)"}),
            "differs from the mechanism's in its slope by th",
        ),
    ],
)
def test_claims_of_another_model(
    name: str, change: Callable[[dict[str, Any]], Any], what: str
) -> None:
    found = violation(other_system(change, name), "equations")
    assert found is not None
    assert found[0] == "equations"
    assert what in found[1]


@pytest.mark.parametrize("check", [check_counts, check_solutions, partial(check_norm, seed="")])
def test_counts_boxes_and_the_norm_are_those_with_the_moment(
    check: Callable[[Claims], str],
) -> None:
    """Whatever the stored equations say: what they are checked with is derived anew."""
    check(Claims(map_of("torque")))
    with pytest.raises(Violation):
        check(Claims(other_system(lambda m: m.update(moments={"th": "M + 1"}), "torque")))


def test_a_free_length_makes_it_another_mechanism() -> None:
    def stretched(m: dict[str, Any]) -> None:
        m["springs"] = [{"between": ["A", "P"], "k": "k", "free": "1/10"}]

    found = violation(other_system(stretched, "pendulum"), "equations")
    assert found is not None
    assert "free length of spring k is not zero" in found[1]


def test_a_mechanism_with_the_name_of_a_built_in_one(shipped: Callable[..., RegionMap]) -> None:
    """What a map claims is about the description, not about its name."""
    record = {**RECORDS["pendulum"]["mechanism"], "name": "ptm"}
    false = replace(shipped("fig3"), slice=replace(shipped("fig3").slice, model=described(record)))
    assert not ptmcad.verify(false).ok
