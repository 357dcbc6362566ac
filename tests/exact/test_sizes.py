"""The size of the critical curve, foretold from lines, against the curves that are computed."""

from __future__ import annotations

from pathlib import Path

import pytest

from ptmcad.algebra.ratios import Numerator, numerator
from ptmcad.algebra.residues import primes
from ptmcad.exact import sizes as module
from ptmcad.exact.sizes import Sizes, sizes
from ptmcad.exact.stages import problem_of
from ptmcad.question.config import load

CONFIGS = Path(__file__).resolve().parents[2] / "configs"


@pytest.mark.parametrize(
    ("name", "solutions", "known"),
    [
        ("fig5-text", 6, Sizes((24, 12), 24, (2, 1))),
        ("forces", 6, Sizes((12, 12), 24, (1, 1))),
        ("systems/kuramoto", 6, Sizes((10, 10), 12, (1, 1))),
        ("systems/kuramoto-4", 14, Sizes((32, 32), 42, (1, 1))),
        ("mechanisms/two-bar-chain", 6, Sizes((24, 24), 24, (2, 1))),
        ("mechanisms/four-bar", 12, Sizes((18, 18), 18, (1, 1))),
    ],
)
@pytest.mark.fast_cases("forces-6-known1", "systems/kuramoto-6-known2")
def test_degrees_are_those_of_the_computed_curves(name: str, solutions: int, known: Sizes) -> None:
    """REFERENCE has these degrees, and `test_sizes_of_critical_curves` computes some of them."""
    assert sizes(problem_of(load(CONFIGS / f"{name}.yaml")), solutions, 60.0) == known


def test_terms_are_the_exponents_that_are_left() -> None:
    assert Sizes((32, 32), 42, (1, 1)).terms == sum(i + j <= 42 for i in range(33) for j in range(33))
    assert Sizes((4, 3), 5, (2, 1)).terms == sum(i + j <= 5 for i in (0, 2, 4) for j in range(4))


def test_a_curve_that_is_too_large_has_no_size(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = problem_of(load(CONFIGS / "fig5-text.yaml"))
    assert sizes(problem, 6, 0.0) is None
    # over points at which solutions are lost nothing is learnt
    assert sizes(problem, 7, 60.0) is None
    monkeypatch.setattr(module, "MOST_POINTS", 30)
    assert sizes(problem, 6, 60.0) is None


def test_numerators_are_found_from_values_that_suffice() -> None:
    prime = next(primes())

    def value(x: int) -> int:  # x (x^4 + 5 x^2 + 3)^2 / (2 x + 1)
        return x * (x**4 + 5 * x**2 + 3) ** 2 * pow(2 * x + 1, -1, prime) % prime

    points = [(x, value(x)) for x in range(20)]
    assert numerator(points, prime) == Numerator(4, True, 2)
    assert numerator(points[:14], prime) is None
