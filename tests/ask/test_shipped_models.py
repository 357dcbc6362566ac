"""Shipped mechanisms and systems: polynomials, counts and areas are those of the literature, or of
another computation.

What each figure rests on is said in the record itself, under ``reference``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml
from flint import Ordering, fmpq, fmpq_mpoly_ctx
from support.few import few
from support.shipped_records import LINES_ONLY, OTHER
from support.signatures import count_by_isolation, count_by_signature

from ptmcad import RegionMap, Slice, classify, load
from ptmcad.answer.counts import Counts
from ptmcad.answer.regionmap import Merge
from ptmcad.exact.point_system import solutions_at
from ptmcad.exact.stages import problem_of, variety_of
from ptmcad.question.slice import Count
from ptmcad.text.flint_numbers import from_fraction, to_fraction

ROOT = Path(__file__).resolve().parents[2]
RECORDS = list(OTHER)
SPURIOUS = {"two-x-joints"}
"""Its equations have two solutions more, which inequalities exclude; signatures of its forms take a
minute.
"""
MAPPED = [path for path in RECORDS if path.stem not in LINES_ONLY]
MECHANISMS = {
    "bistable-slider",
    "five-bar",
    "four-bar",
    "inverted-pendulum",
    "platform",
    "platform-loop",
    "slider-crank",
    "three-bar-chain",
    "three-rpr",
    "two-bar-chain",
    "two-dof-tensegrity",
    "two-dof-tensegrity-loaded",
    "two-x-joints",
    "x-joint",
}
SYSTEMS = {
    "cubic", "cubic-and-quadratic", "duffing", "escape", "kuramoto", "kuramoto-4", "orthogonal-3r", "schloegl",
    "stability-pair", "von-mises-truss",
}  # fmt: skip


def reference(path: Path) -> dict[str, Any]:
    return dict(yaml.safe_load(path.read_text(encoding="utf-8"))["reference"])


def tolerance(known: dict[str, Any]) -> Fraction:
    """How far areas may be from those of the record, relatively."""
    return Fraction(known.get("tolerance", "1/10000"))


@cache
def mapped(path: Path) -> RegionMap:
    """With areas that are finer than what they are compared with."""
    known = reference(path)
    return classify(load(path), area_tolerance=tolerance(known) / 4 if "areas" in known else "1/2")


def counts_at(slice: Slice, at: dict[str, Any], signature: bool) -> Counts:
    problem = problem_of(slice)
    x, y = (Fraction(at[name]) for name in slice.axis_names)
    values = problem.on.values((from_fraction(x), from_fraction(y)))
    return (count_by_signature if signature else count_by_isolation)(problem.system, values)


def test_all_are_shipped() -> None:
    assert {path.stem for path in RECORDS if path.parent.name == "mechanisms"} == MECHANISMS
    assert {path.stem for path in RECORDS if path.parent.name == "systems"} == SYSTEMS


@pytest.mark.parametrize(
    "path",
    few(RECORDS, *(p for p in RECORDS if p.stem not in LINES_ONLY)),
    ids=lambda path: path.stem,
)
@pytest.mark.slow_cases(
    "four-bar", "platform-loop", "slider-crank", "two-dof-tensegrity", "kuramoto-4"
)
def test_numbers_of_solutions(path: Path) -> None:
    """At the points of the record, by both methods; and complex ones."""
    slice, known = load(path), reference(path)
    for entry in known.get("counts", ()):
        for signature in (False,) if path.stem in SPURIOUS else (False, True):
            found = counts_at(slice, entry["at"], signature)
            told = {key: getattr(found, key) for key in entry if key != "at"}
            assert told == {
                key: tuple(v) if isinstance(v, list) else v
                for key, v in entry.items()
                if key != "at"
            }
    if "complex_solutions" in known:
        problem = problem_of(slice)
        at = tuple(fmpq(29, 100) * (b - a) + a for a, b in problem.window)
        values = problem.on.values((at[0], at[1]))
        assert (
            solutions_at(problem.system, values, path.stem in SPURIOUS)
            == (known["complex_solutions"],) * 2
        )


HEAVY = {
    "four-bar",
    "two-dof-tensegrity",
    "stability-pair",
    "kuramoto",
    "kuramoto-4",
    "orthogonal-3r",
}
"""The fast tests have the certified engine's areas of the three oscillators and of the manipulator.
"""


@pytest.mark.parametrize(
    "path", few(MAPPED, *(p for p in MAPPED if p.stem not in HEAVY)), ids=lambda path: path.stem
)
@pytest.mark.slow_cases("two-bar-chain", "platform", "slider-crank")
def test_areas_and_regions(path: Path) -> None:
    known, result = reference(path), mapped(path)
    stable = result.slice.count is Count.STABLE
    areas: Counter[int] = Counter()
    for region in result.regions:
        count = region.stable if stable else region.total
        assert count is not None
        areas[count] += float(sum(region.area) / 2)  # type: ignore[assignment]
    for count, area in known.get("areas", {}).items():
        assert areas[count] == pytest.approx(float(area), rel=float(tolerance(known)))
    if "regions" in known:
        assert len(result.regions) == known["regions"]
    if "parts" in known:
        assert len(set(parts(result))) == known["parts"]


def parts(result: RegionMap) -> Iterator[int]:
    """For each cell the first one of the part of the window, without the curves, that it lies in."""
    first = list(range(len(result.cells)))

    def root(cell: int) -> int:
        return cell if first[cell] == cell else root(first[cell])

    for adjacency in result.adjacencies:
        if adjacency.merge is Merge.PROVEN:
            first[root(adjacency.second)] = root(adjacency.first)
    yield from (root(cell) for cell in range(len(result.cells)))


STATED = [path for path in MAPPED if {"polynomials", "terms"} & reference(path).keys()]


@pytest.mark.parametrize(
    "path",
    few(STATED, *(path for path in STATED if path.stem != "kuramoto-4")),
    ids=lambda path: path.stem,
)
@pytest.mark.slow_cases("four-bar", "two-dof-tensegrity", "stability-pair")
def test_polynomials(path: Path) -> None:
    known = reference(path)
    problem = problem_of(load(path))
    names = problem.slice.axis_names
    found = [terms(c.polynomial.text(names), names) for c in variety_of(problem).components]
    for text in known.get("polynomials", ()):
        assert terms(text, names) in found or terms(f"-({text})", names) in found
    if "terms" in known:
        assert known["terms"] in {len(polynomial) for polynomial in found}


def terms(text: str, names: tuple[str, str]) -> dict[tuple[int, ...], Fraction]:
    """A polynomial, whatever the order of its terms in the text."""
    ring = fmpq_mpoly_ctx.get(names, Ordering.lex)
    value = eval(text.replace("^", "**"), dict(zip(names, ring.gens(), strict=True)))
    return {tuple(map(int, e)): to_fraction(c) for e, c in (value + ring.constant(0)).terms()}


def test_real_solutions_of_the_stability_pair_on_a_lattice() -> None:
    """Bouzidi and Rouillier: none at 59 points, two at 50 and four at 12."""
    path = ROOT / "configs" / "systems" / "stability-pair.yaml"
    slice, lattice = load(path), reference(path)["lattice"]
    steps = range(lattice["from"], lattice["to"] + 1)
    offsets = {name: Fraction(text) for name, text in lattice["offsets"].items()}
    found = Counter(
        counts_at(slice, {"u1": i + offsets["u1"], "u2": j + offsets["u2"]}, False).total
        for i in steps
        for j in steps
    )
    assert found == lattice["points"]
