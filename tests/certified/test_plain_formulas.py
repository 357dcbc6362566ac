"""Plain formulas: any mechanism or potential with one to three unknowns, derived from its
description.
"""

from __future__ import annotations

from copy import deepcopy
from fractions import Fraction
from typing import Any

import pytest
import yaml
from flint import arb, arb_mat
from support.places import area_with
from support.records import TRUSS
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import Status
from ptmcad.ask.lines.along import certified_intervals
from ptmcad.certified.engine import certified_map
from ptmcad.certified.plain import rational
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.harmonics import Harmonics
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.plain.spectrum import inertia
from ptmcad.certified.plain.unknownranges import ranges
from ptmcad.errors import ConfigError, ExpressionError, GeometryError
from ptmcad.model.builtinmechanisms import RECORD
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Count, Slice
from ptmcad.show.ranges.linetable import table as interval_table
from ptmcad.text.expressions import constant

VON_MISES: dict[str, Any] = {"name": "von_mises", **TRUSS}
PENDULUM: dict[str, Any] = yaml.safe_load("""
name: pendulum
mechanism:
  name: pendulum
  parameters: {a: {kind: base, default: 1}, l0: {kind: free length, default: 0}, W: {kind: force}}
  unknowns: {th: angle}
  points: {O: [0, 0], A: [0, a], P: [sin(th), cos(th)]}
  bars: [[O, P]]
  springs: [{between: [A, P], k: 1, free: l0}]
  loads: {P: [1/10, W]}
parameters: {l0: 1/2}
axes: {a: [0, 3], W: [-4, 4]}
count: index
""")
NO_LENGTH = [
    f"{what} where spring k{n} has no length"
    for n, what in enumerate(("crease", "crease", "point"), 1)
]
PLAIN_PTM: dict[str, Any] = {
    "name": "plain_ptm",
    "mechanism": {key: value for key, value in RECORD.items() if key != "symmetries"}
    | {"name": "plain_ptm"},
    "parameters": {"L1": 1, "k": 100, "l0": "1/5", "F3": -10, "F4": -10},
    "axes": {"rho": ["1/20", 2], "L2": [0, 2]},
    "count": "index",
}


def _slice(record: dict[str, Any], **changes: Any) -> Slice:
    return slice_from_mapping(record | changes)


def test_von_mises_truss_has_three_equilibria_inside_of_the_astroid_of_area_1_0069() -> None:
    result = ptmcad.classify(_slice(VON_MISES), tolerance="1/200")
    low, high = area_with(result, "total", 3)
    assert low <= Fraction("1.0069") <= high
    assert {cell.index for cell in result.cells} == {(1, 0), (2, 1)}
    inside = result.locate(a="1/2", f="1/10")
    assert (inside.total, inside.stable) == (3, 2)


def test_bound_of_a_length_is_proved_or_the_slice_refused() -> None:
    slice = _slice(VON_MISES)
    ((low, high),) = ranges(problem_of(slice), slice.axes)
    assert (
        low == -high and 1.5 < high <= 4
    )  # 2 h = f + 2 h/l with |f| < 1 has no solution beyond 3/2
    ramp = yaml.safe_load("""
        name: ramp
        system: {unknowns: {x: real}, potential: a*x + b*x^3}
        axes: {a: [-1, 1], b: [-1, 1]}
    """)
    unbounded = slice_from_mapping(ramp)
    with pytest.raises(ConfigError, match="no bound of the unknown x"):
        ranges(problem_of(unbounded), unbounded.axes)


def test_pendulum_counts_cones_as_no_equilibria() -> None:
    result = ptmcad.classify(_slice(PENDULUM), tolerance="1/100")
    assert {cell.index for cell in result.cells} == {(1, 1), (2, 2)}
    for cell in result.cells:  # the energy at 4000 angles
        a, load = map(float, cell.sample)
        assert cell.stable == _minima(a, load)


def _minima(a: float, load: float, samples: int = 4000) -> int:
    from math import cos, pi, sin, sqrt

    def energy(th: float) -> float:
        length = sqrt(sin(th) ** 2 + (cos(th) - a) ** 2)
        return (length - 0.5) ** 2 / 2 - sin(th) / 10 - load * cos(th)

    values = [energy(2 * pi * k / samples) for k in range(samples)]
    return sum(values[k - 1] > values[k] < values[(k + 1) % samples] for k in range(samples))


def test_a_spring_that_one_angle_moves_has_a_crease_and_another_a_chart_and_a_cone() -> None:
    names = [curve.name for curve in curves(_slice(PLAIN_PTM), Count.INDEX)]
    assert names == ["fold", "fold with spring k3 short", *NO_LENGTH]


def test_minima_need_the_chart_of_a_spring_that_depends_on_both_angles_alone() -> None:
    fold = "fold of a stable equilibrium"
    names = [curve.name for curve in curves(_slice(PLAIN_PTM), Count.STABLE)]
    assert names == [fold, f"{fold} with spring k3 short"]
    every = [
        curve.name
        for curve in curves(_slice(PLAIN_PTM), Count.STABLE, frozenset({"cones-and-creases"}))
    ]
    assert every == [*names, *(name.replace("crease", "point") for name in NO_LENGTH)]


def test_an_angle_that_a_ring_does_not_have_is_refused() -> None:
    """Its cosine would else be that of the angle zero."""
    ring = Harmonics(("s", "x"), ("x",))
    for angle, of in (("t", ring.cos), ("x", ring.sin)):
        with pytest.raises(ExpressionError, match=f"{angle} is not an unknown angle"):
            of(angle)


def test_harmonics_are_in_normal_form() -> None:
    ring = Harmonics(("s", "t"), ())
    c, s = ring.cos("s"), ring.sin("s")
    assert c * c + s * s == ring.constant(Fraction(1))
    d, u = ring.cos("t"), ring.sin("t")
    difference = c * d + s * u  # cos(s - t)
    assert set(difference.terms) == {((1, -1), (0, 0))}
    assert difference.derivative(0).derivative(1) == difference
    assert difference - difference == ring.constant(Fraction(0))


@pytest.mark.parametrize(
    ("entries", "negative"),
    [
        ([1, 0, 0, 1], 0),
        ([0, 1, 1, 0], 1),
        ([-1, 2, 2, -5], 2),
        ([1, 1, 1, 1], None),
        ([arb(0, 1), 0, 0, 1], None),
    ],
)
def test_inertia(entries: list[Any], negative: int | None) -> None:
    assert inertia(arb_mat(2, 2, entries)) == negative


def test_what_the_plain_formulas_do_not_take_is_refused_by_name() -> None:
    four: dict[str, Any] = {"unknowns": {f"t{n}": "angle" for n in range(4)},
                            "potential": "cos(t0) + a*cos(t1) + b*cos(t2) + cos(t3)"}  # fmt: skip
    with pytest.raises(ConfigError, match="up to 3 unknowns"):
        plain_counter(
            slice_from_mapping({"name": "four", "system": four, "axes": {"a": [1, 2], "b": [1, 2]}})
        )
    upwards = slice_from_mapping(PENDULUM)
    with pytest.raises(
        GeometryError,
        match="a free length must not be negative in the whole window, but l0 is -1/2 at",
    ):
        certified_map(
            replace(upwards, parameters={**upwards.parameters, "l0": constant(Fraction(-1, 2))})
        )


def test_equations_without_a_potential_are_counted() -> None:
    cusp = yaml.safe_load("""
        name: cusp
        system: {unknowns: {x: real}, equations: [x^3 - a*x + b]}
        axes: {a: [-2, 2], b: [-2, 2]}
    """)
    slice = slice_from_mapping(cusp)
    exact, certified = (
        ptmcad.classify(slice),
        ptmcad.classify(slice, engine="certified", tolerance="1/100"),
    )
    for cell in certified.cells:
        assert exact.locate(a=cell.sample[0], b=cell.sample[1]).total == cell.total
    assert {cell.total for cell in certified.cells} == {1, 3}


def test_range_of_the_truss_ends_on_the_astroid() -> None:
    found = certified_intervals(_slice(VON_MISES), "a", {"f": "1/10"}, 10)
    table = interval_table(found, 10)
    assert "peaks" not in table
    three, one = found.intervals
    assert (three.index, one.index) == ((2, 1), (1, 0))
    fold = (1 - 0.05 ** (2 / 3)) ** 1.5  # (f/2)^(2/3) + a^(2/3) = 1
    assert float(one.low.low) <= fold + 1e-12 and fold - 1e-12 <= float(one.low.high)


def test_poses_of_the_truss() -> None:
    poses = solve(VON_MISES, {"a": "1/2", "f": "1/10"})
    assert poses.status is Status.CERTIFIED
    assert [pose.index for pose in poses.equilibria] == [0, 0, 1]
    assert [pose.admissible for pose in poses.equilibria] == [True, False, False]
    for pose in poses.equilibria:  # 2 h (1 - 1/l) = f
        h = float(pose.reals[0].center)
        length = (h * h + 0.25) ** 0.5
        assert 2 * h * (1 - 1 / length) == pytest.approx(0.1, abs=1e-9)
        assert float(pose.eigenvalues[0].center) == pytest.approx(
            2 - 2 * 0.25 / length**3, rel=1e-9
        )


def test_a_number_that_is_zero_without_a_reason_is_enclosed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A third spring, from the side, is relaxed at h = 4/5 with the others, by another equation.

    That h is rational and all slopes vanish is the only proof.
    """
    record = deepcopy(VON_MISES)
    record["mechanism"]["points"]["C"] = ["27/20", -1]
    record["mechanism"]["springs"].append({"between": ["C", "P"], "k": 1, "free": "9/4"})
    model = _slice(record).model
    found = ptmcad.solve(model=model, l0=1, a="3/5", f=0)
    assert [0, 0, 0] in [
        [spring.force.exact for spring in pose.springs] for pose in found.equilibria
    ]
    monkeypatch.setattr(rational, "_real", lambda ball: ((Fraction(1),), ball - 1))  # a false guess
    found = ptmcad.solve(model=model, l0=1, a="3/5", f=0)
    assert found.status is Status.CERTIFIED
    tiny = Fraction(1, 10**100)
    assert any(
        all(-tiny < s.force.low < s.force.high < tiny for s in pose.springs)
        for pose in found.equilibria
    )
    assert ptmcad.solve(model=model, l0=1, a="3/5", f="1/100").status is Status.CERTIFIED


def solve(record: dict[str, Any], at: dict[str, str]) -> ptmcad.Poses:
    model = _slice(record).model
    return ptmcad.solve(model=model, **({"l0": "1"} if record is VON_MISES else {}), **at)
