"""Members of families equal the slices that are classified alone, to the byte."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
import yaml
from flint import fmpq

import ptmcad
from ptmcad.algebra.groebner import groebner_basis
from ptmcad.algebra.polynomials import SPACE, UnknownPolynomial, at_third
from ptmcad.ask.members import Common, in_common, member_map
from ptmcad.errors import PtmcadError
from ptmcad.exact.models.familyparameters import space_parameters
from ptmcad.options import Options
from ptmcad.question.config import Family, family_from

FAMILIES = yaml.safe_load("""
equal loads: {axes: {rho: [0, 2], L2: [0, 2]}, parameters: {F3: F, F4: F}, free: {F: [-40, 0]}}
two loads, 446 terms:
  axes: {rho: [0, 2], F3: [-30, 0]}
  parameters: {L2: 3/2}
  free: {F4: [-30, 0]}
chain:
  mechanism: chain
  axes: {a: [0, 3], F: [-2, 2]}
  parameters: {k1: 1, k2: K}
  free: {K: [1/4, 4]}
system with a condition:
  system: {unknowns: {x: real}, equations: [x^3 + a*x + b], positive: [x - c]}
  axes: {a: [-2, 2], b: [-2, 2]}
  free: {c: [-1, 1]}
""")
WITHOUT_AREAS = Options(areas=False)


def _alone(family: Family, value: Fraction, areas: bool) -> str:
    try:
        return ptmcad.classify(family.member(value), areas=areas).to_json(timings=False)
    except PtmcadError as error:
        return f"{type(error).__name__}: {error}"


def _of_family(common: Common, value: Fraction, areas: bool) -> str:
    try:
        return member_map(common, value, Options(areas=areas)).to_json(timings=False)
    except PtmcadError as error:
        return f"{type(error).__name__}: {error}"


def _check(name: str, values: list[Fraction], areas: bool = False) -> None:
    family = family_from(FAMILIES[name])
    common = in_common(family, WITHOUT_AREAS)
    assert common.variety is not None
    for value in values:
        assert _of_family(common, value, areas) == _alone(family, value, areas), value


def _random_values(name: str, number: int) -> list[Fraction]:
    free = family_from(FAMILIES[name]).free
    source = random.Random(name)
    return [
        free.low + (free.high - free.low) * Fraction(source.randint(0, bottom), bottom)
        for bottom in (source.choice((4, 7, 40, 1000, 99991)) for _ in range(number))
    ]


@pytest.mark.parametrize(
    ("name", "values"),
    [
        (
            "equal loads",
            [Fraction(-10), Fraction(-1, 3), Fraction(0)],
        ),  # without load a component splits off
        ("two loads, 446 terms", [Fraction(-10), Fraction(0)]),
        ("system with a condition", [Fraction(0), Fraction(1, 3), Fraction(-1)]),
        pytest.param("chain", [Fraction(1)], marks=pytest.mark.slow),
    ],
)
@pytest.mark.fast_cases("system with a condition-values2")
def test_members_are_their_slices_alone(name: str, values: list[Fraction]) -> None:
    _check(name, values)


@pytest.mark.slow
@pytest.mark.parametrize("name", FAMILIES)
def test_a_hundred_members_are_their_slices_alone(name: str) -> None:
    _check(name, _random_values(name, 100), areas=True)


def test_the_surface_has_as_many_terms_as_is_known() -> None:
    """REFERENCE: 252 terms under equal loads, 446 in (rho, F3, F4) at L2 = 3/2."""
    for name, terms in (("equal loads", 252), ("two loads, 446 terms", 446)):
        common = in_common(family_from(FAMILIES[name]), WITHOUT_AREAS)
        assert max(len(surface) for surface in common.surfaces) == terms


def test_a_basis_that_does_not_specialise_is_not_used() -> None:
    """At c = 0 the first equation is lost, of the others three solutions remain in place of one."""
    record = yaml.safe_load("""
        system:
          unknowns: {x: real, y: real}
          equations: [c*(x - a) + (x - 1)*(x - 2)*(x - 3)*0 + c*0*y, y^2 - b + x*c]
        axes: {a: [-2, 2], b: [-2, 2]}
        free: {c: [-1, 1]}
        members: [1/2, 1]
    """)
    family = family_from(record)
    common = in_common(family, WITHOUT_AREAS)
    for value in (Fraction(0), Fraction(1, 2)):
        assert _of_family(common, value, False) == _alone(family, value, False)
    assert "infinitely many" in _of_family(common, Fraction(0), False)


def test_divisions_on_the_way_are_noted() -> None:
    """z (u^2 - 1) and (u - 1)(u - 2)(u - 3) meet in u = 1 but where z = 0: there the second one has
    three zeros.
    """
    z, one = SPACE.gens()[2], SPACE.constant(1)
    first: UnknownPolynomial = {(2,): z, (0,): -z}
    second: UnknownPolynomial = {(3,): one, (2,): -6 * one, (1,): 11 * one, (0,): -6 * one}
    basis = groebner_basis([first, second], (0,))
    assert basis.leading == ((1,),)
    leading = [g[m] for g, m in zip(basis.elements, basis.leading, strict=True)]
    assert any(at_third(unit, fmpq(0)).is_zero() for unit in (*basis.removed, *leading))
    assert not any(at_third(unit, fmpq(1, 2)).is_zero() for unit in (*basis.removed, *leading))


def test_parameters_in_three_variables_are_the_members_own() -> None:
    text = {"p": "(x + 2*z)^2/(1 - y*z) - q^3", "q": "-z/3 + 1e-2", "x": "x"}
    names = ("x", "y", "z")
    found = space_parameters(("p", "q"), {k: v for k, v in text.items() if k not in names}, names)
    for value in (Fraction(2, 3), Fraction(-5)):
        record = {
            "system": {"unknowns": {"u": "real"}, "equations": ["u^3 + p*u + q + x + y"],
    },
            "axes": {"x": [1, 2], "y": ["1/100", "1/50"]}, "parameters": {"p": text["p"], "q": text["q"]},
            "free": {"z": [-6, 6]}, "members": [str(value)],
        }  # fmt: skip
        member = family_from(record).member(value)
        x, y = Fraction(7, 5), Fraction(1, 70)
        for name, (above, below) in found.items():
            top, bottom = (
                sum(
                    int(c) * x ** int(i) * y ** int(j) * value ** int(k)
                    for (i, j, k), c in p.terms()
                )
                for p in (above, below)
            )
            assert Fraction(top) / bottom == member.parameters[name].evaluate(x, y)


def test_springs_with_free_lengths_have_no_variety_in_common() -> None:
    stretched = yaml.safe_load("""
        axes: {rho: [1, 2], L2: [1, 2]}
        parameters: {l0: l}
        free: {l: [1/10, 1]}
    """)
    family = family_from(stretched)
    assert in_common(family).variety is None
