"""The conformance battery on random mechanisms and systems: a map agrees with that of exchanged
axes, with that of the mirrored model, with counts at points and with Euler's sum; it is accepted,
and every alteration of it is rejected.

Mechanisms of three bars have varieties of degree 120, which no exact map is made of: they are held
at points.
"""

from __future__ import annotations

import random
import re
from copy import deepcopy
from fractions import Fraction
from typing import Any

import pytest
from flint import fmpq
from forger.judge import judged
from support.random_models import random_mechanism, random_system
from support.signatures import count_by_isolation, count_by_signature

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.errors import DegenerateSliceError, HypothesisError
from ptmcad.exact.models import system_from
from ptmcad.text.flint_numbers import from_fraction

POINTS = 30
SEEDS = range(30)


def mirrored(record: dict[str, Any]) -> dict[str, Any]:
    """The record with -a for the parameter a wherever an expression names it."""

    def changed(value: Any) -> Any:
        if isinstance(value, dict):
            return {
                key: entry if key in ("name", "parameters") else changed(entry)
                for key, entry in value.items()
            }
        if isinstance(value, list):
            return [changed(entry) for entry in value]
        return re.sub(r"\ba\b", "(-a)", value) if isinstance(value, str) else value

    key = "system" if "system" in record else "mechanism"
    return {**deepcopy(record), key: changed(record[key])}


def exchanged(record: dict[str, Any]) -> dict[str, Any]:
    """The record with its axes the other way round."""
    return {**record, "axes": dict(reversed(record["axes"].items()))}


def areas(
    result: RegionMap,
) -> dict[tuple[int, tuple[int, ...] | None], list[tuple[Fraction, Fraction]]]:
    """Bounds of the regions' areas, by their counts, the smallest first."""
    found: dict[tuple[int, tuple[int, ...] | None], list[tuple[Fraction, Fraction]]] = {}
    for region in result.regions:
        assert region.total is not None
        found.setdefault((region.total, region.index), []).append(region.area)
    return {counts: sorted(bounds) for counts, bounds in found.items()}


def same_regions(one: RegionMap, other: RegionMap) -> bool:
    """As many of each count, with areas that may be the same."""
    a, b = areas(one), areas(other)
    return a.keys() == b.keys() and all(
        len(a[k]) == len(b[k])
        and all(x[0] <= y[1] and y[0] <= x[1] for x, y in zip(a[k], b[k], strict=True))
        for k in a
    )  # fmt: skip


def made(record: dict[str, Any]) -> RegionMap:
    """The map as a reader of its file has it, accepted."""
    result = ptmcad.classify(
        ptmcad.slice_from_mapping({"name": "map", **record}), area_tolerance="1/1000"
    )
    found = RegionMap.from_json(result.to_json())
    report = ptmcad.verify(found)
    assert report.ok, report.violation
    return found


def check_points(record: dict[str, Any], result: RegionMap, number: int, seed: int) -> None:
    """The map's counts, by signatures, and with the mirrored model's at mirrored points; Euler's
    sum on a torus.
    """
    slice, other = (ptmcad.slice_from_mapping(r) for r in (record, mirrored(record)))
    system, image = system_from(slice.model), system_from(other.model)
    source = random.Random(seed)
    for _ in range(number):
        at = {
            a.name: a.low + (a.high - a.low) * Fraction(source.randint(1, 9972), 9973)
            for a in slice.axes
        }
        values = {name: from_fraction(v) for name, v in at.items()}
        try:
            counts = count_by_signature(system, values)
        except HypothesisError:
            continue
        located = result.locate(**at)
        assert (located.total, located.index) == (counts.total, counts.index)
        assert count_by_isolation(image, {**values, "a": -values["a"]}) == counts
        if system.is_on_torus and counts.index is not None:
            assert sum(counts.index[::2]) == sum(counts.index[1::2])


def run_battery(record: dict[str, Any], name: str) -> None:
    """All of it; of a slice inside its variety, that no point has counts."""
    try:
        result = made(record)
    except DegenerateSliceError:
        system, source = system_from(ptmcad.slice_from_mapping(record).model), random.Random(name)
        for _ in range(POINTS):
            with pytest.raises(HypothesisError):
                count_by_isolation(
                    system, {n: fmpq(source.randint(-99, 99), 50) for n in system.ring.parameters}
                )
        return
    assert same_regions(result, made(exchanged(record)))
    assert same_regions(result, made(mirrored(record)))
    check_points(record, result, POINTS, 0)
    tally = judged(name, result, 1, 0)
    assert not tally.wrong, "\n".join(tally.wrong)


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_battery_of_random_systems(seed: int) -> None:
    run_battery(random_system(seed), f"system {seed}")


@pytest.mark.slow
@pytest.mark.parametrize("seed", [seed for seed in SEEDS if seed % 3 != 2])
def test_battery_of_random_mechanisms(seed: int) -> None:
    run_battery(random_mechanism(seed), f"mechanism {seed}")


@pytest.mark.parametrize(
    "record", [random_system(0), random_mechanism(0)], ids=["system 0", "mechanism 0"]
)
def test_battery_of_two_small_models(record: dict[str, Any]) -> None:
    """All but the alterations, which tests of models try on these maps."""
    result = made(record)
    assert same_regions(result, made(exchanged(record)))
    assert same_regions(result, made(mirrored(record)))
    check_points(record, result, 5, 0)
