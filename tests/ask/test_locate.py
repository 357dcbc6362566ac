"""Exact answers next to walls, on them, on critical abscissae, outside; and the map's JSON."""

from __future__ import annotations

import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
from support import oracle
from support.few import few
from support.maps import CONFIGS, shipped
from support.shipped_records import EXACT

from ptmcad import RegionMap, load
from ptmcad.algebra.polynomials import from_plane
from ptmcad.algebra.real_roots import isolate, refine
from ptmcad.answer.regionmap import Status
from ptmcad.errors import ConfigError
from ptmcad.exact.cad.projection import curve
from ptmcad.text.flint_numbers import from_fraction, to_fraction

TINY = Fraction(1, 10**40)
SHIPPED = [path.stem for path in EXACT]


@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.slow_cases("stiffness", "unequal-springs")
def test_points_next_to_walls(name: str) -> None:
    """10^-40 below and above each wall of each stack: the cells below and above it."""
    result = shipped(name)
    base, names = result.base, result.slice.axis_names
    fibre = result.slice.axes[1 - base]
    low, high = from_fraction(fibre.low), from_fraction(fibre.high)
    checked = 0
    for stack in result.stacks:
        u = from_fraction(stack.sample)
        for level, wall in enumerate(stack.walls):
            p = curve(
                wall.component, from_plane(result.components[wall.component].polynomial), base
            ).polynomial_over(u)
            root = refine(isolate(p, low, high)[wall.root], from_fraction(TINY / 4))
            for v, expected in (
                (to_fraction(root.high) + TINY, level + 1),
                (to_fraction(root.low) - TINY, level),
            ):
                found = result.locate(**{names[base]: stack.sample, names[1 - base]: v})
                assert found.status is Status.EXACT
                assert found.cell == stack.cells[expected]
                checked += 1
    assert checked == 2 * sum(len(stack.walls) for stack in result.stacks)


def test_on_the_variety_and_next_to_it() -> None:
    result = shipped("fig2")
    assert result.locate(L2="3/2", rho="1/4").status is Status.ON_VARIETY
    assert result.locate(L2="3/2", rho=Fraction(1, 4) + TINY).stable == 2
    assert result.locate(L2="3/2", rho=Fraction(1, 4) - TINY).stable == 1
    on = result.locate(L2="3/2", rho="1/4")
    assert (on.region, on.cell, on.total, on.stable, on.index) == (None,) * 5


@pytest.mark.parametrize(
    ("rho", "length"),
    [
        ("-1", "1"),
        ("3", "1"),
        ("0", "1"),
        ("2", "1"),
        ("1", "0"),
        ("1", "2"),
        ("0", "0"),
        ("1", "1e9"),
    ],
)
def test_outside_and_on_the_edge(rho: str, length: str) -> None:
    """The window is open: its edge is no part of the map."""
    found = shipped("fig4").locate(rho=rho, L2=length)
    on_edge = all(0 <= Fraction(value) <= 2 for value in (rho, length))
    assert found.status is (Status.ON_EDGE if on_edge else Status.OUTSIDE)
    assert found.region is None


@pytest.mark.parametrize("name", few(SHIPPED, "fig2", "fig3", "forces", "rods"))
@pytest.mark.slow_cases("fig3", "rods")
def test_on_rational_critical_abscissae(name: str) -> None:
    """Critical abscissae and their neighbourhood off the variety get the oracle's counts."""
    result = shipped(name)
    base, names = result.base, result.slice.axis_names
    fibre = result.slice.axes[1 - base]
    for value in result.critical_values:
        for k in (1, 4, 8):
            v = fibre.low + (fibre.high - fibre.low) * Fraction(k, 9)
            for u in {value.low, value.high, (value.low + value.high) / 2}:
                at = {names[base]: u, names[1 - base]: v}
                found = result.locate(**at)
                point = [at[n] for n in names]
                parameters = {n: e.evaluate(*point) for n, e in result.slice.parameters.items()}
                if found.status is Status.EXACT:
                    assert found.index == oracle.count(parameters)


def test_a_float_stands_for_its_shortest_decimal() -> None:
    """fig. 2 has a wall on 2 rho = L2 + 1, which the binary value of the float 0.7, a little less
    than 7/10, misses.
    """
    result = shipped("fig2")
    assert result.locate(rho=Fraction(0.7), L2="2/5").status is Status.EXACT
    for number in ("0.7", 0.7, np.float64(0.7), np.float32(0.7)):
        assert result.locate(rho=number, L2="2/5").status is Status.ON_VARIETY
    assert result.locate(rho=0.75, L2=np.float32(0.5)) == result.locate(rho="3/4", L2="1/2")
    assert result.locate(rho=np.int64(1), L2=np.int32(1)).status is Status.ON_VARIETY


def test_values_are_exact_numbers() -> None:
    result = shipped("fig4")
    assert result.locate(rho="7/10", L2="3/2") == result.locate(rho="0.7", L2=Fraction(3, 2))
    assert result.locate(rho="0.7" + "0" * 60, L2="1.5").stable == 2
    no_numbers = ("x", "nan", float("nan"), float("inf"), np.True_)
    for bad in (
        {"rho": 1},
        {"rho": 1, "L2": 1, "k": 1},
        {},
        *({"rho": value, "L2": 1} for value in no_numbers),
    ):
        with pytest.raises(ConfigError):
            result.locate(**bad)


@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.fast_cases("fig2", "fig3", "forces")
def test_json_round_trip(name: str) -> None:
    result = shipped(name)
    for text in (result.to_json(), result.to_json(timings=False)):
        again = RegionMap.from_json(text)
        assert again == result
        assert again.to_json(timings=False) == result.to_json(timings=False)
    assert RegionMap.from_json(result.to_json()).locate(**result.cells[0].sample) == result.locate(
        **result.cells[0].sample
    )
    assert "timings" not in result.to_json(timings=False)


@pytest.mark.parametrize(
    "text", ["{}", "[]", '{"format": "other"}', "3", '{"format": "ptmcad-region-map/1"}']
)
def test_other_json_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        RegionMap.from_json(text)


@pytest.mark.slow
def test_equal_bytes_in_other_processes() -> None:
    """Two processes with different hash seeds write the same text."""
    code = (
        "import sys, ptmcad; r = ptmcad.classify(ptmcad.load(sys.argv[1]), count='index');"
        "sys.stdout.write(r.to_json(timings=False))"
    )
    path = CONFIGS / "fig3.yaml"
    texts = [
        subprocess.run(
            [sys.executable, "-c", code, str(path)],
            capture_output=True,
            text=True,
            check=True,
            cwd=CONFIGS.parent,
            env={"PYTHONHASHSEED": seed, "PYTHONPATH": str(CONFIGS.parent)},
        ).stdout
        for seed in ("1", "2")
    ]
    assert texts[0] == texts[1]
    assert RegionMap.from_json(texts[0]).slice == load(path).__class__(
        **{
            f: getattr(RegionMap.from_json(texts[0]).slice, f)
            for f in load(path).__dataclass_fields__
        }
    )
