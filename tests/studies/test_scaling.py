"""The scaling study: its families give what they claim, and its fits find planted laws."""

from __future__ import annotations

import json
import math
import random
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples
from support.structure import check_structure

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.question.config import slice_from_mapping
from ptmcad.studies.bench import __main__ as command
from ptmcad.studies.bench import growth as scaling
from ptmcad.studies.bench.growth import FAMILIES, exponent

# --------------------------------------------------------------------------------------------- what is known of folds


@given(st.integers(0, 32), st.fractions(-3, 3, max_denominator=9).filter(bool))
def test_chebyshev_polynomials_by_their_definition(n: int, z: Fraction) -> None:
    """T_n((z + 1/z)/2) = (z^n + z^-n)/2."""
    folded = slice_from_mapping(scaling.fold(n)).parameters["L2"]
    assert folded.evaluate((z + 1 / z) / 2, Fraction(0)) == 1 + (z**n + z**-n) / 4


FOLDED = [("fold", 1), ("fold", 2), ("fold", 3), ("fold", 5)]
_maps: dict[tuple[str, int], RegionMap] = {}


def folded(name: str, n: int) -> RegionMap:
    if (name, n) not in _maps:
        _maps[name, n] = ptmcad.classify(slice_from_mapping(FAMILIES[name][2](n, 1)))
    return _maps[name, n]


@pytest.mark.parametrize(("name", "n"), FOLDED)
@pytest.mark.fast_cases("fold-1", "fold-2")
def test_the_engine_finds_the_regions_of_folds(name: str, n: int) -> None:
    result = folded(name, n)
    check_structure(result)
    assert len(result.regions) == FAMILIES[name][3](n)
    assert sorted({region.stable for region in result.regions}) == [1, 2]
    assert sum(region.stable == 2 for region in result.regions) == 1


@settings(max_examples=examples(40))
@given(
    st.sampled_from(FOLDED),
    st.fractions(0, 1, max_denominator=997),
    st.fractions(0, 1, max_denominator=991),
)
def test_folds_have_the_known_count_everywhere(
    which: tuple[str, int], s: Fraction, t: Fraction
) -> None:
    """2 stable poses where |L2 - L1| < 2 rho < L2 + L1 (REFERENCE: unloaded), at any point off
    these lines.
    """
    result = folded(*which)
    slice = result.slice
    at = tuple(a.low + (a.high - a.low) * u for a, u in zip(slice.axes, (s, t), strict=True))
    rho, bar = (slice.parameters[p].evaluate(*at) for p in ("rho", "L2"))
    if 0 < s < 1 and 0 < t < 1 and 2 * rho not in (abs(bar - 1), bar + 1):
        found = result.locate(**dict(zip(slice.axis_names, at, strict=True)))
        if (
            found.stable is not None
        ):  # on a wall of the decomposition that is none of the variety, none is asked
            assert found.stable == (2 if abs(bar - 1) < 2 * rho < bar + 1 else 1)


# ------------------------------------------------------------------------------------------------ degrees and heights


@pytest.mark.parametrize(("n", "seed"), [(1, 1), (2, 2), (5, 1)])
@pytest.mark.slow_cases("5-1")
def test_the_curves_of_bent_slices_have_the_degree_asked_for(n: int, seed: int) -> None:
    result = ptmcad.classify(slice_from_mapping(scaling.unloaded(n, seed)))
    assert [c.polynomial.total_degree for c in result.components if not c.left_out] == [n] * 3
    assert len(result.regions) == 4


@pytest.mark.parametrize("name", FAMILIES)
def test_every_size_is_a_record_and_another_seed_draws_another(name: str) -> None:
    _, sizes, record, _ = FAMILIES[name]
    for n in sizes:
        slice_from_mapping(record(n, 1))
    drawn = [record(sizes[0], seed) for seed in (1, 1, 2)]
    assert drawn[0] == drawn[1]
    assert (drawn[0] != drawn[2]) == (name == "degree")


# ---------------------------------------------------------------------------------------------------------------- fits


def fitted(points: Mapping[float, float]) -> float | None:
    return exponent(
        pd.DataFrame({"setting": points.keys(), "computing": points.values()}, dtype=float)
    )


@settings(max_examples=examples(40))
@given(st.floats(-3, 6), st.floats(1e-6, 1e3), st.sets(st.integers(1, 500), min_size=4, max_size=9))
def test_an_exact_power_law_gives_its_exponent(p: float, c: float, sizes: set[int]) -> None:
    found = fitted({x: c * x**p for x in sizes})
    assert found is not None and math.isclose(found, p, rel_tol=1e-3, abs_tol=1e-6)


@settings(max_examples=examples(30))
@given(st.floats(0.7, 5), st.integers(0, 10**6))
def test_noise_does_not_become_another_law(p: float, seed: int) -> None:
    """Noise of 5 %, as on a shared machine: the exponent is right to 0.1."""
    source = random.Random(seed)
    found = fitted({x: x**p * math.exp(source.gauss(0, 0.05)) for x in (2, 4, 8, 16, 32, 64)})
    assert found is not None and abs(found - p) < 0.1


@pytest.mark.parametrize("points", [{}, {1: 2}])
def test_without_two_sizes_there_is_no_fit(points: dict[float, float]) -> None:
    assert fitted(points) is None


# ---------------------------------------------------------------------------------------------------------- the study


def test_the_study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows for each size and for the fits; another number of regions is a failure; the picture is
    drawn.
    """
    title, _, record, _ = FAMILIES["fold"]
    small = title, (1, 2, 3), record, lambda n: n + 3 if n < 3 else 4
    monkeypatch.setattr(scaling, "FAMILIES", {"small": small})
    assert command.main(["scaling", "small", "--rounds", "1", "--out", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"scaling.json", "scaling.svg"}
    rows = json.loads((tmp_path / "scaling.json").read_text(encoding="utf-8"))["rows"]
    measured = {row["setting"]: row for row in rows if not row["setting"].startswith("fit")}
    assert measured.keys() == {"1", "2", "3"}
    assert measured["3"]["reason"] == "failed: 6 regions"
    assert measured["1"]["seconds"] > measured["1"]["computing"] > 0
    (fit,) = (row for row in rows if row["setting"] == "fit")
    assert isinstance(fit["exponent"], float)
