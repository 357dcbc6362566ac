"""What an exact map costs, foretold by the degrees in which axes enter."""

from __future__ import annotations

from pathlib import Path

import pytest

import ptmcad
from ptmcad.ask.checking import check
from ptmcad.ask.estimate import WORDS, cost, degrees
from ptmcad.exact.stages import problem_of
from ptmcad.question.config import load, slice_from_mapping
from ptmcad.text.expressions import constant

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
SQUARE = {"rho": [0, 2], "L2": [0, 2]}


def ptm(parameters: dict[str, str], axes: dict[str, list[int]]) -> ptmcad.Slice:
    return slice_from_mapping({"parameters": parameters, "axes": axes})


SLICES = [
    ptm({"F3": "u", "F4": "v"}, {"u": [-10, 10], "v": [-10, 10]}),
    ptm({"F3": "-10", "F4": "-10"}, SQUARE),
    ptm({"k1": "100*u", "F3": "-10"}, {"u": [0, 2], "L2": [0, 2]}),
    ptm({"L1": "u/(1 + v)", "F3": "-10", "F4": "-10"}, {"u": [0, 2], "v": [0, 2]}),
    load(CONFIGS / "stiffness.yaml"),
    load(CONFIGS / "mechanisms" / "platform.yaml"),
]


@pytest.mark.parametrize("slice", SLICES, ids=lambda s: s.name)
def test_the_degrees_of_the_curves_are_foretold(slice: ptmcad.Slice) -> None:
    found = ptmcad.discriminant_variety(slice)
    greatest = [max(c.polynomial.degrees[k] for c in found.components) for k in (0, 1)]
    foretold = degrees(problem_of(slice).system, slice.parameters)
    assert greatest == [2 * found.complex_solutions * d for d in foretold]


@pytest.mark.parametrize(
    ("slice", "known"),
    [
        # of degree 36 and 60 with 1696 terms: a minute
        (ptm({"F3": "u^2 + v", "F4": "v^3 - u", "L1": "1 + u/(1 + v)"}, {"u": [0, 1], "v": [0, 5]}), (3, 5)),
        (ptm({"F3": "F^4", "F4": "F"}, {"rho": [0, 2], "F": [0, 2]}), (2, 5)),
        (ptm({"F3": "u^3", "F4": "v^2"}, {"u": [-2, 2], "v": [-4, 4]}), (1, 1)),  # in u^3 and v^2 of degree 12
    ],
    ids=["linked", "powers", "nothing but powers"],
)
def test_the_degrees_of_linked_axes(slice: ptmcad.Slice, known: tuple[int, int]) -> None:
    assert degrees(problem_of(slice).system, slice.parameters) == known
    system = problem_of(slice).system
    assert cost(6, system, slice.parameters) == ("from seconds to minutes" if known != (1, 1) else "about a second")


@pytest.mark.parametrize(
    ("name", "word"),
    [("forces", "about a second"), ("fig4", "seconds"), ("systems/stability-pair", "from seconds to minutes")],
)
def test_shipped_slices(name: str, word: str) -> None:
    slice = load(CONFIGS / f"{name}.yaml")
    found = check(slice, sized=False)
    assert found.complex_solutions is not None
    assert cost(found.complex_solutions, problem_of(slice).system, slice.parameters) == found.cost == word


def test_many_solutions_cost_much_however_low_the_degrees() -> None:
    problem = problem_of(SLICES[0])
    fixed = dict.fromkeys(problem.system.ring.parameters, constant(1))
    words = [cost(n, problem.system, fixed) for n in (8, 9, 17, 21)]
    assert words == [WORDS[0], WORDS[2], WORDS[3], WORDS[4]]
