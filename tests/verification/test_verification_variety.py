"""The variety's check at random points: no true claim is rejected at any of them, and false ones
are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import prod
from random import Random

import pytest
import yaml
from flint import fmpq, fmpq_mpoly
from support.replacing import replace
from support.shipped_records import EXACT

import ptmcad
from ptmcad.answer.regionmap import HARMLESS, Component, Kind, RegionMap
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.plane import PlanePolynomial
from ptmcad.verification import norms
from ptmcad.verification.claims import Claims
from ptmcad.verification.norms import check_norm
from ptmcad.verification.report import Violation

Shipped = Callable[..., RegionMap]

OFTEN_SMOOTH = (70, 121, 244, 430, 431, 450, 454, 597, 680, 682, 688)
"""Seeds below 700 at whose first point some line's value has small primes, or those of another
line's value, only.
"""


def test_values_without_large_primes_reject_no_true_map(shipped: Shipped) -> None:
    claims = Claims(shipped("fig2"))
    for seed in OFTEN_SMOOTH:
        assert check_norm(claims, str(seed)).endswith("multiplicities [3, 3, 3, 3, 4, 4]")


def test_a_map_is_accepted_with_the_points_of_its_own_hash() -> None:
    """Parallel lines, whose values at the first point have small primes only."""
    record = yaml.safe_load("""
        name: lines
        parameters: {L1: 1, L2: 1, rho: 1 + (y - x)/16}
        axes: {x: [0, 1], y: [0, 1]}
    """)
    report = ptmcad.verify(ptmcad.classify(ptmcad.slice_from_mapping(record)))
    assert report.ok, report.violation


# ------------------------------------------------------------------------------------- varieties known by construction


@dataclass(frozen=True)
class KnownFibre:
    """What is asked of a fibre, by formula."""

    product: Fraction
    dimension: int
    denominators: Sequence[int]
    coefficients: Sequence[Fraction]
    conditions: Sequence[fmpq_mpoly] = ()

    def norm(self) -> fmpq:
        return from_fraction(self.product)

    def form_traces(self, form: Sequence[int]) -> list[fmpq]:
        assert all(form)
        return [fmpq(1, d) for d in self.denominators]

    @property
    def jacobian(self) -> KnownFibre:
        return self

    def charpoly(self) -> KnownFibre:
        return self

    def coeffs(self) -> list[fmpq]:
        return [from_fraction(c) for c in self.coefficients]


def lines(*terms: tuple[int, int, int]) -> list[PlanePolynomial]:
    """a x + b y + c for each."""
    return [PlanePolynomial.of(((1, 0, a), (0, 1, b), (0, 0, c))) for a, b, c in terms]


FAMILIES = {
    "parallel": lines((1, -1, 0), (1, -1, -32), (1, -1, -16)),
    "axes": lines((1, 0, 0), (0, 1, 0), (1, 0, -1), (1, 0, 1), (1, 0, -6)),
    "pencil": lines((1, 1, 0), (1, -1, 0), (1, 2, 0), (2, 1, 0), (30, 7, 0)),
    "one line": lines((1, 0, 0)),
    "curves": [
        PlanePolynomial.of(((2, 0, 1), (0, 2, 1), (0, 0, -1))),
        *lines((1, 0, -1), (1, 0, 1)),
    ],
}


@dataclass(frozen=True)
class KnownClaims:
    """Components whose norm is ``constant`` times their powers, and of which some are poles."""

    result: RegionMap
    exponents: Sequence[int]
    constant: Fraction
    foreign: PlanePolynomial | None = None
    hidden: Callable[[int], bool] = lambda _: False

    def place(self, x: Fraction, y: Fraction) -> str:
        return f"{x}, {y}"

    def fibre_at(self, x: Fraction, y: Fraction) -> KnownFibre:
        components = self.result.components
        values = [c.polynomial(x, y) for c in components]
        assert 0 not in values
        poles = [int(v) for v, c in zip(values, components, strict=True) if c.kind is Kind.INFINITY]
        poles = [1 if self.hidden(p) else p for p in poles] + (
            [int(self.foreign(x, y))] if self.foreign else []
        )
        return KnownFibre(
            self.constant * prod(v**e for v, e in zip(values, self.exponents, strict=True)),
            self.result.complex_solutions,
            [int(self.constant.denominator), *map(abs, poles)],
            [Fraction(1, prod(poles)), Fraction(1, prod(poles)), Fraction(1)],
        )


def known(
    shipped: Shipped, name: str, exponents: Sequence[int], constant: Fraction = Fraction(1)
) -> KnownClaims:
    components = [
        Component(p, Kind.CRITICAL if e > 0 else Kind.INFINITY)
        for p, e in zip(FAMILIES[name], exponents, strict=True)
    ]
    return KnownClaims(replace(shipped("fig2"), components=tuple(components)), exponents, constant)


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.fast_cases("parallel", "one line")
def test_exponents_are_those_of_the_construction(name: str, shipped: Shipped) -> None:
    dice = Random(name)
    for seed in range(60):
        exponents = [dice.choice([1, 2, 3, 4, 7, 0, -1, -4]) for _ in FAMILIES[name]]
        primes = dice.choice([1, 6, 10_007 * 65_537, 2**61 - 1])
        claims = known(
            shipped,
            name,
            exponents,
            Fraction(dice.choice([primes, -1]), dice.choice([primes, 5, 1])),
        )
        assert check_norm(claims, str(seed)).endswith(f"multiplicities {exponents}")  # type: ignore[arg-type]


def test_points_on_components_are_drawn_again(shipped: Shipped) -> None:
    """Of the first point and all others with its abscissa nothing can be decided."""
    for bits in (norms.BITS, norms.FAR_BITS):
        x = Random(f"{bits} 0").getrandbits(bits) - 2 ** (bits - 1)
        components = (Component(PlanePolynomial.of(((1, 0, 1), (0, 0, -x))), Kind.CRITICAL),)
        claims = KnownClaims(replace(shipped("fig2"), components=components), [1], Fraction(3))
        assert check_norm(claims, "0").endswith("multiplicities [1]")  # type: ignore[arg-type]


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.slow_cases("pencil")
def test_false_exponents_and_missing_curves_are_rejected(name: str, shipped: Shipped) -> None:
    """Whichever component is dropped or foreign, at whatever points."""
    for seed in range(20):
        claims = known(shipped, name, [1 + k % 3 for k in range(len(FAMILIES[name]))])
        for k, c in enumerate(claims.result.components):
            rest = tuple(d for d in claims.result.components if d != c)
            dropped = SimpleReplacement(claims, replace(claims.result, components=rest))
            with pytest.raises(Violation, match="no constant times powers"):
                check_norm(dropped, str(seed))  # type: ignore[arg-type]
            foreign = replace(
                claims, exponents=[0 if j == k else e for j, e in enumerate(claims.exponents)]
            )
            with pytest.raises(Violation, match="is no factor of the norm"):
                check_norm(foreign, str(seed))  # type: ignore[arg-type]
            infinite = tuple(
                replace(d, kind=Kind.INFINITY) if d == c else d for d in claims.result.components
            )
            with pytest.raises(Violation, match="but det H vanishes on it"):
                check_norm(
                    replace(claims, result=replace(claims.result, components=infinite)), str(seed)
                )  # type: ignore[arg-type]


@dataclass(frozen=True)
class SimpleReplacement:
    """Claims with other components over the fibres of the true ones."""

    true: KnownClaims
    result: RegionMap

    def place(self, x: Fraction, y: Fraction) -> str:
        return self.true.place(x, y)

    def fibre_at(self, x: Fraction, y: Fraction) -> KnownFibre:
        return self.true.fibre_at(x, y)


# ---------------------------------------------------------------------------------------------------------------- poles


def test_a_pole_that_does_not_show_at_one_point_is_no_contradiction(shipped: Shipped) -> None:
    """A numerator that vanishes there modulo the value's primes hides it."""
    shown = iter([False, True, False, True, True, True] * 10)
    claims = replace(known(shipped, "one line", [-2]), hidden=lambda _: next(shown))
    check_norm(claims, "1")  # type: ignore[arg-type]
    claims = replace(claims, hidden=lambda _: True)
    with pytest.raises(Violation, match="solutions have no pole on it"):
        check_norm(claims, "1")  # type: ignore[arg-type]


def test_constants_in_denominators_are_no_poles(shipped: Shipped) -> None:
    for constant in (
        Fraction(1, 6**400),
        Fraction(1, 2**61 - 1),
        Fraction(1, (2**521 - 1) * (2**61 - 1) ** 3),
    ):
        check_norm(known(shipped, "one line", [1], constant), "1")  # type: ignore[arg-type]


def test_poles_on_no_stored_component_are_rejected(shipped: Shipped) -> None:
    for (line,) in ([p] for name in ("axes", "pencil") for p in FAMILIES[name][1:]):
        claims = replace(known(shipped, "one line", [1], Fraction(1, 2**521 - 1)), foreign=line)
        with pytest.raises(Violation, match="pole on no stored component"):
            check_norm(claims, "1")  # type: ignore[arg-type]


def test_what_is_harmless_is_told_from_what_is_not(shipped: Shipped) -> None:
    """The constant coefficient of the characteristic polynomial, made integral, keeps or loses the
    curve's primes.
    """
    claims = known(shipped, "one line", [-1])
    harmless = tuple(replace(c, left_out=HARMLESS) for c in claims.result.components)
    claims = replace(claims, result=replace(claims.result, components=harmless))
    check_norm(claims, "1")  # type: ignore[arg-type]

    class Vanishing(KnownClaims):
        def fibre_at(self, x: Fraction, y: Fraction) -> KnownFibre:
            return replace(
                super().fibre_at(x, y), coefficients=[Fraction(1), Fraction(1, int(x)), Fraction(1)]
            )

    with pytest.raises(Violation, match="det H may vanish at solutions near it"):
        check_norm(Vanishing(claims.result, claims.exponents, claims.constant), "1")  # type: ignore[arg-type]


# ------------------------------------------------------------------------------------------------------------- campaign


@pytest.mark.slow
@pytest.mark.parametrize("name", [path.stem for path in EXACT])
def test_no_seed_rejects_a_shipped_map_as_a_whole(name: str, shipped: Shipped) -> None:
    for seed in range(3):
        report = ptmcad.verify(shipped(name), seed=seed)
        assert report.ok, (seed, report.violation)


def test_factors_with_long_coefficients() -> None:
    """A parameter of two factors whose coefficients are no machine integers; seen as a crash of
    verify.
    """
    record = {
        "parameters": {"L1": "((1e30*x+z+1)*(x+1e30*z+3))*1e-60", "L2": "1", "rho": "1+z/7"},
        "axes": {"x": ["0", "1"], "z": ["0", "1"]},
    }
    report = ptmcad.verify(ptmcad.classify(ptmcad.slice_from_mapping(record)))
    assert report.ok, report.violation
