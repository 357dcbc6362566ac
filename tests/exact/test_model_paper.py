"""The model against the paper: its corrected equations hold, the printed ones that are in error do
not.

Source of the corrections: docs/errata.md. All comparisons are identities of polynomials in exact
arithmetic.
"""

from __future__ import annotations

import math
from fractions import Fraction
from math import cos, sin
from types import SimpleNamespace

import pytest
from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx
from support.counting import system_of
from support.free_length_equilibria import free_length_equilibria
from support.paper_energy import bent

from ptmcad.text.flint_numbers import to_fraction

NAMES = ("L1", "L2", "rho", "k", "F3", "F4", "F3x", "F4x", "c1", "s1", "c2", "s2", "t1", "t2")
RING = fmpq_mpoly_ctx.get(NAMES, Ordering.degrevlex)
V = SimpleNamespace(**dict(zip(NAMES, RING.gens(), strict=True)))
ZERO = RING.constant(0)
SYSTEM = system_of("ptm")


def with_equal_springs(p: fmpq_mpoly) -> fmpq_mpoly:
    """A trigonometric polynomial of the model in the paper's symbols: k1 = k2 = k3 = k."""
    symbols = [
        V.k if name in ("k1", "k2", "k3") else getattr(V, name) for name in SYSTEM.ring.parameters
    ]
    total = ZERO
    for powers, part in SYSTEM.ring.split(p).items():
        for exponents, coefficient in part.items():
            term = RING.constant(coefficient)
            for symbol, e in zip(
                (*symbols, V.c1, V.s1, V.c2, V.s2), (*exponents, *powers), strict=True
            ):
                term *= symbol**e
            total += term
    return total


def substituted(p: fmpq_mpoly, **values: fmpq_mpoly | int) -> fmpq_mpoly:
    return p.compose(*[RING.constant(0) + values.get(n, getattr(V, n)) for n in NAMES], ctx=RING)


def half_angles(p: fmpq_mpoly) -> fmpq_mpoly:
    """p (1 + t1^2)(1 + t2^2) with cos = (1 - t^2)/(1 + t^2), sin = 2t/(1 + t^2), p of degree 1 in
    each angle.
    """
    total = ZERO
    for exponents, coefficient in p.terms():
        power = dict(zip(NAMES, exponents, strict=True))
        term = RING.from_dict(
            {
                tuple(
                    0 if n in ("c1", "s1", "c2", "s2") else e for n, e in power.items()
                ): coefficient
            }
        )
        for c, s, t in (("c1", "s1", V.t1), ("c2", "s2", V.t2)):
            assert power[c] + power[s] <= 1
            term *= 1 - t**2 if power[c] else 2 * t if power[s] else 1 + t**2
        total += term
    return total


U = with_equal_springs(SYSTEM.potential)
G1, G2 = (with_equal_springs(g) for g in SYSTEM.equations)
S12, C12 = V.s1 * V.c2 + V.c1 * V.s2, V.c1 * V.c2 - V.s1 * V.s2
VERTICAL = {"F3x": 0, "F4x": 0}


def on_circles(p: fmpq_mpoly) -> fmpq_mpoly:
    """A normal form modulo c^2 + s^2 = 1."""
    for c, s in (("c1", "s1"), ("c2", "s2")):
        index, total = NAMES.index(c), ZERO
        for exponents, coefficient in p.terms():
            rest = tuple(e % 2 if i == index else e for i, e in enumerate(exponents))
            total += RING.from_dict({rest: coefficient}) * (1 - getattr(V, s) ** 2) ** (
                int(exponents[index]) // 2
            )
        p = total
    return p


def potential_2(factor: fmpq_mpoly) -> fmpq_mpoly:
    """The paper's (2), with the given factor at the work of the loads."""
    lengths = (
        3 * V.rho**2 - 4 * V.L1 * V.rho * V.c1 + 2 * V.L1**2 + 2 * V.L2**2 - 4 * V.L2 * V.rho * V.c2
        + 2 * V.L1 * V.L2 * C12
    )  # fmt: skip
    return V.k * lengths / 2 - V.F3 * V.L1 * factor * V.s1 - V.F4 * V.L2 * factor * V.s2


def test_potential_2_without_the_factor_rho() -> None:
    ours = on_circles(substituted(U, **VERTICAL))
    assert on_circles(potential_2(RING.constant(1))) == ours
    assert on_circles(potential_2(V.rho)) != ours


def test_equations_3_and_4() -> None:
    """-G2/(L2 k) is (3), -G1/(L1 k) is (4) with F3' in place of the printed F4'."""
    equation_3 = V.L1 * S12 * V.k - 2 * V.rho * V.s2 * V.k + V.F4 * V.c2
    equation_4 = V.L2 * S12 * V.k - 2 * V.rho * V.s1 * V.k + V.F3 * V.c1
    printed_4 = V.L2 * S12 * V.k - 2 * V.rho * V.s1 * V.k + V.F4 * V.c1
    assert substituted(G2, **VERTICAL) == -V.L2 * equation_3
    assert substituted(G1, **VERTICAL) == -V.L1 * equation_4
    assert substituted(G1, **VERTICAL) != -V.L1 * printed_4


def equation_5(extra: int = 0) -> fmpq_mpoly:
    """k times the paper's (5); 5.1 adds 2 F3x at t2^2 t1 and t1."""
    t1, t2 = V.t1, V.t2
    return (
        V.F3 * t1**2 * t2**2 + 2 * V.k * V.L2 * (t1**2 * t2 + t2**2 * t1) + 4 * V.k * V.rho * t2**2 * t1
        + V.F3 * t1**2 - V.F3 * t2**2 - 2 * V.k * V.L2 * (t1 + t2) + 4 * V.k * V.rho * t1 - V.F3
        + extra * V.F3x * (t2**2 * t1 + t1)
    )  # fmt: skip


def equation_6(sign: int, extra: int = 0) -> fmpq_mpoly:
    """k times the paper's (6) with sign (F4' t2^2 - F4' t1^2); 5.1 adds extra F4x at t1^2 t2 and
    t2.
    """
    t1, t2 = V.t1, V.t2
    return (
        V.F4 * t1**2 * t2**2 + 2 * V.k * V.L1 * (t1**2 * t2 + t2**2 * t1) + 4 * V.k * V.rho * t1**2 * t2
        + sign * V.F4 * (t2**2 - t1**2) - 2 * V.k * V.L1 * (t1 + t2) + 4 * V.k * V.rho * t2 - V.F4
        + extra * V.F4x * (t1**2 * t2 + t2)
    )  # fmt: skip


def test_equation_5() -> None:
    assert half_angles(substituted(G1, **VERTICAL)) == V.L1 * equation_5()


def test_equation_6_with_the_signs_of_11() -> None:
    ours = half_angles(substituted(G2, **VERTICAL))
    assert ours == V.L2 * equation_6(1)
    assert ours != V.L2 * equation_6(-1)  # as printed


def test_horizontal_forces_5_1() -> None:
    """+ 2 F3x in (5); in (6) it is - 2 F4x, not + 2 F4x, when x points to the right."""
    assert half_angles(G1) == V.L1 * equation_5(2)
    assert half_angles(G2) == V.L2 * equation_6(1, -2)
    assert half_angles(G2) != V.L2 * equation_6(1, 2)


SYMMETRIC = {"L2": V.L1, "F3": V.F4, **VERTICAL}


def difference_10() -> fmpq_mpoly:
    return (V.t1 - V.t2) * (V.F4 * (V.t1 + V.t2) + 2 * V.k * V.rho * (1 - V.t1 * V.t2))


def equation_11() -> fmpq_mpoly:
    t1, t2, k, rho = V.t1, V.t2, V.k, V.rho
    return (
        V.F4 * (t1**2 * t2**2 - 1) + 2 * V.L1 * k * (t1**2 * t2 + t1 * t2**2) + 4 * k * rho * (t1**2 * t2 + t2)
        + V.F4 * (t2**2 - t1**2) - 2 * V.L1 * k * (t1 + t2)
    )  # fmt: skip


def test_symmetric_equations_10_and_11() -> None:
    first, second = (half_angles(substituted(g, **SYMMETRIC)) for g in (G1, G2))
    assert first - second == 2 * V.L1 * difference_10()
    assert second == V.L1 * equation_11()


def test_at_most_two_solutions_are_not_symmetric_12() -> None:
    """Eliminating t1 from the second factor of (10) and (11) gives (12), of degree 2: not 4, as the
    conclusions say.
    """
    k, rho, f, t2, length = V.k, V.rho, V.F4, V.t2, V.L1
    equation_12 = (
        4 * f * k**2 * t2**2 * (length * rho + rho**2) + 16 * k**3 * rho**3 * t2 + f**3 * (t2**2 - 1)
        + 4 * f**2 * k * rho * t2 + 4 * f * k**2 * (length * rho - rho**2)
    )  # fmt: skip
    second_factor = f * (V.t1 + t2) + 2 * k * rho * (1 - V.t1 * t2)
    eliminated = second_factor.resultant(equation_11(), "t1")
    by_t2 = [
        (q / q.leading_coefficient(), e)
        for q, e in eliminated.factor()[1]
        if q.degrees()[NAMES.index("t2")]
    ]
    assert len(by_t2) == 2
    assert (equation_12 / equation_12.leading_coefficient(), 1) in by_t2
    assert t2**2 + 1 in [q for q, _ in by_t2]
    assert equation_12.degrees()[NAMES.index("t2")] == 2


def test_unloaded_angles_9() -> None:
    """The triangle with sides L1, L2, 2 rho solves the unloaded equations; with sines of unlike
    sign it does not.
    """
    length1, length2, rho = (
        Fraction(13),
        Fraction(20),
        Fraction(21, 2),
    )  # 13, 20, 21 is a triangle with area 126
    c1 = (4 * rho**2 + length1**2 - length2**2) / (4 * rho * length1)
    c2 = (4 * rho**2 + length2**2 - length1**2) / (4 * rho * length2)
    s1, s2 = 12 / length1, 12 / length2
    assert c1**2 + s1**2 == c2**2 + s2**2 == 1
    values = {
        "L1": length1,
        "L2": length2,
        "rho": rho,
        "k": 1,
        "F3": 0,
        "F4": 0,
        "t1": 0,
        "t2": 0,
        **VERTICAL,
    }
    for sign1, sign2, holds in ((1, 1, True), (-1, -1, True), (1, -1, False)):
        at = {**values, "c1": c1, "s1": sign1 * s1, "c2": c2, "s2": sign2 * s2}
        numbers = [Fraction(at[n]) for n in NAMES]
        zero = [
            sum(
                (to_fraction(c) * _power(numbers, e) for e, c in g.terms()), Fraction(0)
            ) == 0
            for g in (G1, G2)
        ]  # fmt: skip
        assert all(zero) == holds
    assert length1 * c1 - (rho - length2 * c2) == rho  # a parallelogram: x3 - x4 = rho


def _power(numbers: list[Fraction], exponents: tuple[int, ...]) -> Fraction:
    result = Fraction(1)
    for x, e in zip(numbers, exponents, strict=True):
        result *= x ** int(e)
    return result


def test_hessian() -> None:
    (h11, h12), (h21, h22) = (tuple(with_equal_springs(h) for h in row) for row in SYSTEM.jacobian)
    k, rho = V.k, V.rho
    assert h11 == V.L1 * ((2 * k * rho + V.F3x) * V.c1 + V.F3 * V.s1 - k * V.L2 * C12)
    assert h22 == V.L2 * ((2 * k * rho - V.F4x) * V.c2 + V.F4 * V.s2 - k * V.L1 * C12)
    assert h12 == h21 == -k * V.L1 * V.L2 * C12


def test_gradient_is_the_slope_of_the_potential() -> None:
    """A third way, by difference quotients of the lengths themselves: through no formula of the
    paper or of ours.
    """
    values = (1.0, 1.5, 0.7, 100.0, 150.0, 80.0, -10.0, 7.0, 3.0, -5.0)
    given = dict(
        zip(("L1", "L2", "rho", "k1", "k2", "k3", "F3", "F4", "F3x", "F4x"), values, strict=True)
    )

    def energy(a: float, b: float) -> float:
        return float(bent(given, a, b, math).energy)

    def ours(p: fmpq_mpoly, a: float, b: float) -> float:
        at = dict(zip((*SYSTEM.ring.parameters, "c1", "s1", "c2", "s2"), (*values, cos(a), sin(a), cos(b), sin(b)),
                      strict=True))  # fmt: skip
        total = 0.0
        for e, c in p.terms():
            term = int(c.p) / int(c.q)
            for x, n in zip(at.values(), e, strict=True):
                term *= x ** int(n)
            total += term
        return total

    h = 1e-5
    for a in (0.3, 1.7, 4.0):
        for b in (0.1, 2.2, 5.5):
            assert ours(SYSTEM.potential, a, b) == pytest.approx(energy(a, b), rel=1e-12)
            slope = (
                (energy(a + h, b) - energy(a - h, b)) / (2 * h),
                (energy(a, b + h) - energy(a, b - h)) / (2 * h),
            )
            assert tuple(ours(g, a, b) for g in SYSTEM.equations) == pytest.approx(slope, abs=1e-4)


def test_more_than_six_solutions_with_free_lengths_5_2() -> None:
    """REFERENCE: 12 equilibria at (rho, L1, L2, l0, f3, f4) = (.96859, 1, 1.00609, .2, -.1, -.1)."""
    assert free_length_equilibria(0.96859, 1, 1.00609, 0.2, -0.1, -0.1) == 12
    assert free_length_equilibria(0.7, 1, 1.5, 0.2, -0.1, -0.1) == 6
    assert free_length_equilibria(0.7, 1, 1.5, 0.0, -0.1, -0.1) == 6


def test_two_slices_of_fig_5(shipped) -> None:  # type: ignore[no-untyped-def]
    """The text's and the caption's values of fig. 5 give different maps."""
    text, caption = shipped("fig5-text"), shipped("fig5-caption")
    assert text.components[0].polynomial != caption.components[0].polynomial


def test_one_curve_in_4_3(shipped) -> None:  # type: ignore[no-untyped-def]
    """Not three curves with hundreds of terms."""
    curves = [c for c in shipped("fig4").components if not c.left_out]
    assert [(c.polynomial.degrees, len(c.polynomial.terms)) for c in curves] == [((24, 12), 70)]
