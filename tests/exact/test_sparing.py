"""Counts made once for all cells that are proved to be joined: those that are counted in each cell."""

from __future__ import annotations

from fractions import Fraction

import pytest
from support.maps import CONFIGS, shipped
from support.replacing import replace

from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.classification import region_map
from ptmcad.ask.members import in_common, member_map
from ptmcad.exact import stages
from ptmcad.options import Options
from ptmcad.question.config import family_from, load
from ptmcad.show.render.outline import outline

WITHOUT_AREAS = Options(areas=False)
SPARING = replace(WITHOUT_AREAS, sparing=True)
CHECKED = ("fig2", "fig3", "fig4", "forces", "stiffness", "rods", "horizontal")


def _same_but_solutions(few: RegionMap, all_of_them: RegionMap) -> None:
    """Every cell has the same counts, every region the same cells; what is proved by more solutions
    is left out.
    """
    bare = tuple(replace(cell, solutions=()) for cell in all_of_them.cells)
    assert tuple(replace(cell, solutions=()) for cell in few.cells) == bare
    assert (few.regions, few.adjacencies, few.stacks) == (
        tuple(replace(r, area=few.regions[0].area) for r in all_of_them.regions),
        all_of_them.adjacencies,
        all_of_them.stacks,
    )


@pytest.mark.parametrize("name", CHECKED)
@pytest.mark.fast_cases("fig2", "fig3")
def test_sparing_counts_are_those_of_each_cell(name: str) -> None:
    few = region_map(load(CONFIGS / f"{name}.yaml"), SPARING)
    _same_but_solutions(few, shipped(name))
    counted = sum(bool(cell.solutions) for cell in few.cells)
    assert counted < sum(bool(cell.solutions) for cell in shipped(name).cells)


def test_members_of_a_family_too() -> None:
    common = in_common(family_from(CONFIGS / "families" / "equal-loads.yaml"), WITHOUT_AREAS)
    for value in (Fraction(-40), Fraction(-17, 3), Fraction(0)):
        _same_but_solutions(
            member_map(common, value, SPARING), member_map(common, value, WITHOUT_AREAS)
        )


def test_only_what_is_proved_to_be_joined_shares_a_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fig. 4 has regions that a curve parts although counts are equal: these are counted apart."""
    found: list[tuple[int, ...]] = []
    whole = stages.counts_of_parts

    def noted(
        problem: object, stacks: object, component_of: tuple[int, ...], report: object
    ) -> object:
        found.append(component_of)
        return whole(problem, stacks, component_of, report)  # type: ignore[arg-type]

    monkeypatch.setattr("ptmcad.exact.exactmap.counts_of_parts", noted)
    result = region_map(load(CONFIGS / "fig4.yaml"), SPARING)
    (component_of,) = found
    for link in result.adjacencies:
        if link.component is None:
            assert component_of[link.first] == component_of[link.second]
    assert max(component_of) + 1 >= len(result.regions)
    assert len(set(component_of)) == sum(bool(cell.solutions) for cell in result.cells)


def test_a_coarser_outline_has_fewer_vertices_and_all_of_them_on_the_curves() -> None:
    result = shipped("fig4")
    fine, coarse = outline(result), outline(result, None, 1e-3)
    assert sum(s.lines.size for s in coarse.stacks) < 0.7 * sum(s.lines.size for s in fine.stacks)
    for many, few in zip(fine.stacks, coarse.stacks, strict=True):
        places = {column[0, result.base]: column for column in many.lines.swapaxes(0, 1)}
        for column in few.lines.swapaxes(0, 1):
            assert places[column[0, result.base]] == pytest.approx(column, abs=2**-13)
