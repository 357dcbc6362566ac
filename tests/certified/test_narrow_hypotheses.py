"""Each hypothesis of docs/soundness.md that a slice can break is broken narrowly, or on a set
without area.

The rows of the table there on signs and poles have tests of their own (test_positivity,
test_domain, test_verification_signs), and those on arithmetic too (interval/test_arithmetic).
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction as Q
from time import perf_counter
from typing import Any

import pytest

pytest.importorskip("numba")

from support.dense_search import dense_search
from support.few import few

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.certified.engine import certified_map
from ptmcad.certified.peaks import peaks
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.certified.plain.zeros import PointCount
from ptmcad.errors import ConfigError, LimitReached
from ptmcad.model import ptm
from ptmcad.options import Options
from ptmcad.question.slice import Count, Slice

UNIT = {"L1": 1, "k": 1, "F3": "-1/10", "F4": "-1/10", "l0": "1/5"}


def slice_of(axes: Mapping[str, Any], count: str = "total", **parameters: Any) -> Slice:
    given = {name: value for name, value in (UNIT | parameters).items() if name not in axes}
    record = {"name": "narrow", "parameters": given, "axes": dict(axes), "count": count}
    return ptmcad.slice_from_mapping(record)


def seen_at(slice: Slice, x: Q, y: Q) -> dict[str, Any]:
    """The counts of a search that shares no code with the engine."""
    given = slice.parameters
    values = {
        name: given[name].evaluate(x, y) if name in given else Q(0) for name in ptm().variables
    }
    return dense_search({name: float(value) for name, value in values.items()}, 80)


def assert_true_along(m: RegionMap, points: list[tuple[Q, Q]], at_least: int) -> None:
    """The map's counts at the points, of which so many have to be decided."""
    first, second = m.slice.axis_names
    decided = 0
    for x, y in points:
        cell = m.locate(**{first: x, second: y}).cell
        if cell is not None:
            decided += 1
            seen = seen_at(m.slice, x, y)
            kind = "stable" if m.slice.count is Count.STABLE else "total"
            assert getattr(m.cells[cell], kind) == seen[kind], (x, y)
    assert decided >= at_least


EDGE = [(Q(k, 1000), Q(1, 2) + Q(n, 7)) for k in (1, 3, 20, 90) for n in (1, 2, 3)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "at_least"),
    [
        pytest.param(
            {"k1": "1/rho", "k2": "1", "k3": "1", "k": None}, 3, id="a stiffness without bound"
        ),
        pytest.param(
            {"k1": "1 + 1/(1000*rho)", "k2": 1, "k3": 1, "k": None},
            3,
            id="a stiffness that hardly grows",
        ),
        pytest.param({"F3": "-1/10 + 1/(100*rho)"}, 0, id="a load without bound"),
        pytest.param(
            {"l0_3": "rho^2/(rho^2 + (L2 - 1/2)^2)"},
            0,
            id="a free length without a limit at a corner",
        ),
    ],
)
def test_a_pole_on_the_window_s_edge(changes: dict[str, Any], at_least: int) -> None:
    given = {name: value for name, value in (UNIT | changes).items() if value is not None}
    record = {
        "name": "narrow",
        "parameters": given,
        "axes": {"rho": [0, "1/2"], "L2": ["1/2", 1]},
        "count": "stable",
    }
    slice, end = ptmcad.slice_from_mapping(record), None if at_least else perf_counter() + 30
    try:
        m = certified_map(slice, Options(tolerance=Q(1, 4), deadline=end))
    except LimitReached as stopped:  # the hardest leave much undetermined, which is no fault
        if stopped.partial is None:
            return
        assert isinstance(stopped.partial, RegionMap)
        m = stopped.partial
    assert_true_along(m, EDGE, at_least)


@pytest.mark.parametrize("free", ["(L2 - 1)^2/5", "(L2 - 1)^2*(rho - 9/10)^2", "(L2 - 1)^18"])
@pytest.mark.fast_cases("(L2 - 1)^2/5")
def test_a_spring_s_pull_that_vanishes_on_a_line(free: str) -> None:
    """There spring 3 has no free length, but it is present elsewhere, and so are its curves and its
    cone.
    """
    s = slice_of({"rho": ["4/5", 1], "L2": ["4/5", "6/5"]}, l0_3=free)
    assert "point where spring A3A4 has no length" in [c.name for c in curves(s, Count.TOTAL)]
    counter = plain_counter(s)
    for y in (Q(1), Q(1) + Q(1, 10**9), Q(1) - Q(1, 10**30)):
        found = counter.at(Q(17, 20), y, Count.STABLE)
        assert found.decided
        assert found.stable == seen_at(s, Q(17, 20), y)["stable"]


def test_a_spring_without_free_length_is_absent_however_it_is_written() -> None:
    s = slice_of({"rho": ["4/5", 1], "L2": ["4/5", "6/5"]}, l0_3="(L2 - 1)^2 - L2^2 + 2*L2 - 1")
    assert "point where spring A3A4 has no length" not in [c.name for c in curves(s, Count.TOTAL)]
    s = slice_of(
        {"rho": ["4/5", 1], "L2": ["4/5", "6/5"]}, l0_3="(L2 - 1)^2 - L2^2 + 2*L2 - 1 + 1e-300"
    )
    assert "point where spring A3A4 has no length" in [c.name for c in curves(s, Count.TOTAL)]


OFF = (Q(0), Q(1, 10**6), Q(-1, 10**6), Q(1, 10**13), Q(-1, 10**13), Q(1, 10**20))


@pytest.mark.parametrize("off", few(OFF, Q(0), Q(1, 10**6), Q(-1, 10**13)))
@pytest.mark.slow_cases("off0", "off4")
def test_rho_next_to_a_bar_s_length(off: Q) -> None:
    """Spring 1 has no length on a whole circle where rho = L2, and its formulas are others there,
    not next to it.
    """
    s = slice_of({"rho": [0, 2], "L2": [0, 2]})
    x, y = Q(7, 5) + off, Q(7, 5)
    counts = plain_counter(s)
    stable = counts.at(x, y, Count.STABLE)
    assert stable.decided
    assert stable.stable == seen_at(s, x, y)["stable"]
    total = counts.at(x, y, Count.TOTAL)
    # on the circle and next to it undecided is an answer too; what is decided is what is seen
    # further on the same side
    far = Q(1, 10**4) if off > 0 else -Q(1, 10**4)
    assert (
        total == PointCount()
        or total.total == seen_at(s, Q(7, 5) + (far if off else 0), y)["total"]
    )


def test_rho_nearly_equal_to_a_bar_everywhere() -> None:
    """The crease is in no point of the window, but next to each of them."""
    near, apart = (
        slice_of({"m": ["1/2", "3/5"], "L2": ["4/5", "9/10"]}, rho=f"m + m/10^{digits}", L1="m")
        for digits in (9, 4)
    )
    assert "crease where spring A2A3 has no length" in [c.name for c in curves(near, Count.TOTAL)]
    counts, beside = plain_counter(near), plain_counter(apart)
    for x, y in ((Q(11, 20), Q(17, 20)), (Q(1, 2), Q(9, 10))):
        found = counts.at(x, y, Count.TOTAL)
        assert found == PointCount() or found.total == beside.at(x, y, Count.TOTAL).total


def test_euler_s_sum_is_not_used_where_a_cone_changes() -> None:
    """At l0 = 1/3 a peak appears (see test_interval_points); 10^-60 beside it, it is known whether
    it is there.
    """
    ones = dict.fromkeys(("L1", "L2", "k1", "k2", "k3"), Q(1))
    given = dict.fromkeys(ptm().variables, Q(0)) | ones | {"rho": Q(1, 2)}
    little = Q(1, 10**60)
    for free, count, regular in (
        (Q(1, 3) - little, 0, True),
        (Q(1, 3), 0, False),
        (Q(1, 3) + little, 2, True),
    ):
        found = peaks(given | {f"l0_{i}": free for i in (1, 2, 3)})
        assert found == (count, regular)


@pytest.mark.parametrize("bar", ["L1", "L2"])
def test_euler_s_sum_is_not_used_where_a_spring_has_no_length_on_a_circle(bar: str) -> None:
    given = {
        **dict.fromkeys(ptm().variables, Q(0)),
        "L1": Q(1),
        "L2": Q(3, 2),
        "k1": Q(1),
        "k2": Q(1),
        "k3": Q(1),
    }
    spring = {"L2": "l0_1", "L1": "l0_2"}[bar]
    assert not peaks(given | {"rho": given[bar], spring: Q(1, 10**60)})[1]
    assert peaks(given | {"rho": given[bar] + Q(1, 10**60), spring: Q(1, 10**60)})[1]
    assert peaks(given | {"rho": given[bar]})[1]


@pytest.mark.parametrize("power", [-150, -99, 99, 139, 141, 160])
@pytest.mark.slow_cases("-99", "99")
def test_lengths_that_doubles_can_hardly_square(power: int) -> None:
    """Scaled lengths and loads change no count; what floating point cannot tell is undecided, not
    wrong.
    """
    unit = Q(10) ** power
    values = {
        "rho": Q(7, 10),
        "L1": Q(1),
        "L2": Q(3, 2),
        "F3": Q(-1, 10),
        "F4": Q(-1, 10),
        "l0": Q(1, 5),
    }
    poses = ptmcad.solve(k=1, **{name: value * unit for name, value in values.items()})
    assert poses.status is Status.UNDECIDED or len(poses.equilibria) == 6


@pytest.mark.parametrize("power", [-400, 400])
def test_constants_beyond_the_range_of_doubles(power: int) -> None:
    unit = Q(10) ** power
    loads = {name: Q(-1, 10) * unit for name in ("F3", "F4")}
    poses = ptmcad.solve(rho="7/10", L1=1, L2="3/2", k=unit, l0="1/5", **loads)
    assert poses.status is Status.UNDECIDED or len(poses.equilibria) == 6


def test_an_axis_beyond_what_areas_in_floats_can_hold() -> None:
    s = slice_of({"rho": [1, "1e101"], "L2": ["1/2", 1]})
    with pytest.raises(ConfigError, match="computes in floats"):
        certified_map(s)
