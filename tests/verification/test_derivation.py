"""The checker's own derivation of the potential: by polynomials and by jets, on the built-in mechanism and another."""

from __future__ import annotations

import pytest
from flint import Ordering, arb, ctx, fmpq, fmpq_mpoly, fmpq_mpoly_ctx
from support.jets import circle

from ptmcad.exact.models import system_from
from ptmcad.model import Mechanism, described, ptm
from ptmcad.verification.derivation import Configuration, potential
from ptmcad.verification.equations import equations_of

# coordinates with quotients, powers and sums of three angles, which the built-in mechanism does not have
CHAIN = described(
    {
        "name": "chain",
        "parameters": {"a": {"default": 1}, "k": {"kind": "stiffness", "default": 1}, "F": {"kind": "force"}},
        "unknowns": {"u": "angle", "v": "angle", "w": "angle"},
        "points": {
            "O": [0, 1],
            "P": ["a*cos(u) + 2*cos(u + v)/3", "a*sin(u) - sin(2*v - u)^2"],
            "Q": ["-(a - cos(w + u - v))", "sin(-w)*(a + 1)^2"],
        },
        "springs": [{"between": ["O", "P"], "k": "2*k"}, {"between": ["Q", "P"], "k": "k"}],
        "loads": {"Q": ["-F", "F/2"]},
    }
)


def polynomial_and_ring(m: Mechanism) -> tuple[fmpq_mpoly, list[str]]:
    names = [*m.without_free_lengths, *(f"{f}_{a}" for a in m.angles for f in ("cos", "sin"))]
    ring = fmpq_mpoly_ctx.get(names, Ordering.lex)
    gens = dict(zip(names, ring.gens(), strict=True))
    circles = {a: (gens[f"cos_{a}"], gens[f"sin_{a}"]) for a in m.angles}
    return potential(Configuration({n: gens[n] for n in m.without_free_lengths}, circles), m), names


POINTS = ((3, 4, 5), (-5, 12, 13), (8, -15, 17))
"""Of the circles: cosine, sine and radius."""


def place(m: Mechanism) -> list[fmpq]:
    """Values of the parameters and rational points of the circles."""
    values = [fmpq(3 + n, 7) for n in range(len(m.without_free_lengths))]
    return values + [fmpq(c, r) for x, y, r in POINTS[: len(m.angles)] for c in (x, y)]


@pytest.mark.parametrize("m", [ptm(), CHAIN], ids=lambda m: m.name)
def test_the_engine_and_the_checker_derive_the_same_potential(m: Mechanism) -> None:
    """By two readers of the same trees."""
    engines = system_from(m).potential
    assert engines is not None
    assert polynomial_and_ring(m)[0](*place(m)) == engines(*place(m))


@pytest.mark.parametrize("m", [ptm(), CHAIN], ids=lambda m: m.name)
def test_the_polynomials_have_the_derivatives_by_jets(m: Mechanism) -> None:
    """At rational points of the circles, where the polynomials are exact."""
    found, exact = equations_of(m), place(m)
    count = len(m.without_free_lengths)
    at = [*exact[count:], *exact[:count]]  # the ring has the coordinates first
    with ctx.workprec(200):
        balls = [arb(x) for x in exact]
        circles = {a: circle(k, *balls[count + 2 * k : count + 2 * k + 2]) for k, a in enumerate(m.angles)}
        jet = potential(Configuration(dict(zip(m.without_free_lengths, balls, strict=False)), circles), m)
        for i, equation in enumerate(found.equations):
            assert close(jet.slopes.get(i, arb(0)), equation(*at))
            for j, entry in enumerate(found.jacobian[i]):
                assert close(jet.bends.get((min(i, j), max(i, j)), arb(0)), entry(*at))
        assert found.energy is not None
        assert close(jet.value, found.energy(*at))


def close(ball: arb, true: fmpq) -> bool:
    return bool((ball - true).contains(0)) and bool((ball - true).rad() < 1e-40)
