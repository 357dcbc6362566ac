"""The size of the critical curve, predicted from lines, against the curves that are computed."""

from __future__ import annotations

from pathlib import Path

import pytest

import ptmcad
from ptmcad.answer.regionmap import Kind
from ptmcad.exact import curvesizes as module
from ptmcad.exact.curvesizes import CurveSizes, sizes, survey
from ptmcad.exact.stages import problem_of, variety_of
from ptmcad.question.config import load

CONFIGS = Path(__file__).resolve().parents[2] / "configs"


@pytest.mark.parametrize(
    ("name", "solutions", "known"),
    [
        ("fig5-text", 6, CurveSizes((24, 12), 24, (2, 1))),
        ("forces", 6, CurveSizes((12, 12), 24, (1, 1))),
        ("systems/kuramoto", 6, CurveSizes((10, 10), 12, (1, 1))),
        ("systems/kuramoto-4", 14, CurveSizes((32, 32), 42, (1, 1))),
        ("mechanisms/two-bar-chain", 6, CurveSizes((24, 24), 24, (2, 1))),
        ("mechanisms/four-bar", 12, CurveSizes((18, 18), 18, (1, 1))),
        (
            "mechanisms/two-dof-tensegrity",
            12,
            CurveSizes((10, 10), 12, (2, 2)),
        ),  # six lines, three curves at infinity
    ],
)
@pytest.mark.fast_cases("forces-6-known1", "systems/kuramoto-6-known2")
def test_degrees_are_those_of_the_computed_curves(
    name: str, solutions: int, known: CurveSizes
) -> None:
    """REFERENCE has these degrees, and `test_sizes_of_critical_curves` computes some of them."""
    found = sizes(problem_of(load(CONFIGS / f"{name}.yaml")), solutions, 60.0)
    assert found is not None
    assert found[:3] == known[:3]


def linked() -> ptmcad.Slice:
    """A slice whose lengths vanish, and bound its domain, on slanted lines."""
    axes = {"x": ["1/10", 2], "y": ["1/10", 2]}
    parameters = {"L1": 1, "k": 100, "L2": "x + y", "rho": "(1 + x)/2", "F3": "-10*y", "F4": -10}
    return ptmcad.slice_from_mapping({"axes": axes, "parameters": parameters, "count": "stable"})


def test_what_bounds_the_domain_is_no_part_of_the_curve() -> None:
    problem = problem_of(linked())
    critical = [c.polynomial for c in variety_of(problem).components if c.kind is Kind.CRITICAL]
    found = sizes(problem, 6, 60.0)
    assert found is not None
    assert found.degrees == tuple(sum(p.degrees[k] for p in critical) for k in (0, 1)) == (18, 12)
    assert found.total == sum(max(i + j for i, j, _ in p.terms) for p in critical) == 24


def test_a_difference_of_the_axes_takes_no_degree_away() -> None:
    """v^3 = 3 p v + 2 q is critical where p^3 = q^2: here a b^3 (a - b)^3 = 1, and the axis a = 0."""
    system = {"name": "s", "unknowns": {"v": "real"}, "equations": ["v^3 - 3*a*b*(a - b)*v - 2*a"]}
    slice = ptmcad.slice_from_mapping(
        {"system": system, "axes": {"a": [-2, 2], "b": [-2, 2]}, "count": "total"}
    )
    assert sizes(problem_of(slice), 3, 60.0) == CurveSizes(
        (4, 6), 7, (1, 1), (2, 2, 3), (True, False)
    )


@pytest.mark.parametrize(
    ("equation", "solutions", "known"),
    [
        ("z^2 - a*b", 2, CurveSizes((0, 0), 0, (1, 1), (1, 1, 2), (True, True))),
        ("z^3 - 3*b*z^2 + a^2*z + a", 3, CurveSizes((5, 3), 5, (1, 1), (2, 1, 2), (True, False))),
        ("a*z^2 + a*z + b", 2, CurveSizes((1, 1), 1, (1, 1), (1, 1, 1))),
    ],
    ids=["both axes alone", "an axis beside a curve", "an axis at infinity"],
)
def test_axes_are_told_where_solutions_meet_over_them(
    equation: str, solutions: int, known: CurveSizes
) -> None:
    """By hand: discriminants are 4 a b, -27 a (4 a^5 - 9 a^3 b^2 + 54 a^2 b + 27 a - 108 b^3) / 27
    and a (a - 4 b).
    """
    system = {"name": "s", "unknowns": {"z": "real"}, "equations": [equation]}
    slice = ptmcad.slice_from_mapping(
        {"system": system, "axes": {"a": [-1, 1], "b": [-1, 1]}, "count": "total"}
    )
    assert sizes(problem_of(slice), solutions, 60.0) == known
    critical = {c.polynomial.text(("a", "b")) for c in variety_of(problem_of(slice)).components
                if c.kind is Kind.CRITICAL}  # fmt: skip
    assert tuple(name in critical for name in ("a", "b")) == known.lines


@pytest.mark.parametrize("name", ["fig5-text", "systems/duffing"])
@pytest.mark.slow_cases("fig5-text")
def test_the_cells_of_a_survey_are_those_of_the_map(name: str) -> None:
    slice = load(CONFIGS / f"{name}.yaml")
    cells = ptmcad.classify(slice, areas=False).cells
    stacks = len({cell.stack for cell in cells})
    found = survey(problem_of(slice))
    assert (found.cells, found.walls) == (len(cells), len(cells) - stacks)


def test_terms_are_the_exponents_that_are_left() -> None:
    assert CurveSizes((32, 32), 42, (1, 1)).terms == sum(
        i + j <= 42 for i in range(33) for j in range(33)
    )
    assert CurveSizes((4, 3), 5, (2, 1)).terms == sum(
        i + j <= 5 for i in (0, 2, 4) for j in range(4)
    )


def test_a_curve_that_is_too_large_has_no_size(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = problem_of(load(CONFIGS / "fig5-text.yaml"))
    assert sizes(problem, 6, 0.0) is None
    # over points at which solutions are lost nothing is learnt
    assert sizes(problem, 7, 60.0) is None
    monkeypatch.setattr(module, "MAX_POINTS", 30)
    assert sizes(problem, 6, 60.0) is None
