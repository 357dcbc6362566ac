"""The variety of every shipped slice against Singular: eliminations over Q, from the nodes'
coordinates.
"""

from __future__ import annotations

from fractions import Fraction

import pytest
from support.programs import ProgramError, needs_singular, singular
from support.replacing import replace
from support.singular_slice import (
    SHIPPED,
    SOLUTIONS,
    axes,
    critical_curves,
    improper_curves,
    solutions_over,
)

from ptmcad.answer.regionmap import Component, Kind
from ptmcad.text.plane import PlanePolynomial

pytestmark = needs_singular

EXPENSIVE = {"stiffness"}
"""Slices whose elimination takes longer than all the others together."""

SINGULAR_EVERYWHERE = {
    "fig2": {"L2", "rho"},
    "fig4": {"L2"},
    "horizontal": {"L2"},
    "rods": {"L1", "L2"},
    "unequal-springs": {"L2"},
}
"""BOUNDARY lines over which some equilibrium is singular, so that the elimination has them too.

Where a rod has no length its angle drops out of the energy; and on fig. 2, where there are no
loads, with rho = 0 the energy depends on th1 + th2 alone. Along such a line each equilibrium lies
on a whole curve of equilibria.
"""

ALL = [
    pytest.param(name, marks=pytest.mark.slow) if name in EXPENSIVE else name for name in SHIPPED
]


def curves(components: tuple[Component, ...], kind: Kind) -> set[PlanePolynomial]:
    return {component.polynomial for component in components if component.kind is kind}


def differences_of_critical(name: str, components: tuple[Component, ...]) -> set[PlanePolynomial]:
    """Curves that only one of both has: Singular's elimination ideal; the CRITICAL components with
    the lines above.
    """
    boundary = {
        p
        for p in curves(components, Kind.BOUNDARY)
        if p.text(axes(name)) in SINGULAR_EVERYWHERE.get(name, ())
    }
    assert len(boundary) == len(SINGULAR_EVERYWHERE.get(name, ())), (
        "a line of the list is no BOUNDARY component"
    )
    return (curves(components, Kind.CRITICAL) | boundary) ^ critical_curves(name)


@pytest.mark.parametrize("name", ALL)
@pytest.mark.fast_cases("fig2", "fig3", "rods")
def test_critical_components_are_the_curves_of_the_elimination_ideal(name: str, shipped) -> None:  # type: ignore[no-untyped-def]
    assert not differences_of_critical(name, shipped(name).components)


@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.fast_cases("fig2", "fig4", "forces", "rods")
def test_infinity_components_are_the_curves_over_which_a_solution_is_lost(  # type: ignore[no-untyped-def]
    name: str, shipped
) -> None:
    """The projection is proper off the stored components, and each INFINITY component is needed."""
    components = shipped(name).components
    improper = improper_curves(name)
    assert improper <= curves(components, Kind.INFINITY) | curves(components, Kind.BOUNDARY)
    assert curves(components, Kind.INFINITY) <= improper


@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.fast_cases("fig2", "fig3", "forces", "rods")
def test_number_of_solutions_drops_exactly_over_improper_curves(name: str, shipped) -> None:  # type: ignore[no-untyped-def]
    """The same by another way: dimensions of the fibres over algebraic points of the curves, with
    multiplicity.
    """
    for component in shipped(name).components:
        if component.kind is Kind.CRITICAL:
            continue  # solutions meet there; fibres over algebraic numbers of degree 24 would take minutes
        number = solutions_over(name, component.polynomial, Fraction(3, 7))
        drops = number is None or number < SOLUTIONS
        assert number is None or number <= SOLUTIONS
        assert drops == (component.polynomial in improper_curves(name)), component.polynomial.text(
            axes(name)
        )


def dropped(components: tuple[Component, ...]) -> tuple[Component, ...]:
    return components[1:]


def changed(components: tuple[Component, ...]) -> tuple[Component, ...]:
    first = components[0]
    *terms, (i, j, c) = first.polynomial.terms
    return (replace(first, polynomial=PlanePolynomial.of((*terms, (i, j, c + 1)))), *components[1:])


def added(components: tuple[Component, ...]) -> tuple[Component, ...]:
    return (
        replace(components[0], polynomial=PlanePolynomial.of(((1, 1, 7), (0, 0, -3)))),
        *components,
    )


def retagged(components: tuple[Component, ...]) -> tuple[Component, ...]:
    return (replace(components[0], kind=Kind.INFINITY), *components[1:])


@pytest.mark.parametrize("mutation", [dropped, changed, added, retagged])
@pytest.mark.parametrize("name", ["fig2", "fig3", "rods", "fig4"])
def test_false_critical_components_are_noticed(name: str, mutation, shipped) -> None:  # type: ignore[no-untyped-def]
    components = shipped(name).components
    assert components[0].kind is Kind.CRITICAL
    assert differences_of_critical(name, mutation(components))


def test_a_missing_infinity_component_is_noticed() -> None:
    """Fig. 4 has 400 rho^2 + 1, over which two of six solutions are lost; over a random line none
    is.
    """
    assert {p.text(axes("fig4")) for p in improper_curves("fig4")} == {"400*rho^2 + 1", "L2"}
    pole, line = (
        PlanePolynomial.parse(text, axes("fig4")) for text in ("400*rho^2 + 1", "7*rho - 3")
    )
    assert [solutions_over("fig4", p, Fraction(3, 7)) for p in (pole, line)] == [4, 6]


@pytest.mark.parametrize(
    "script", ["poly p = x;", "ring R = 0, x, dp; ideal I = y;", "quit;", 'LIB "nowhere.lib";']
)
def test_what_singular_can_not_do_is_an_error(script: str) -> None:
    with pytest.raises(ProgramError):
        singular(script)
