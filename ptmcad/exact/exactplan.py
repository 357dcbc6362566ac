"""The plan of the exact engine: what a slice needs, what is left out, and the reason for each.

Guarantee: each saving that is named here was really made in the computation that it accompanies, or
is said to have been switched off.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import gcd

from ptmcad.answer.plan import saving_step, zero_parameters, zero_terms
from ptmcad.answer.regionmap import HARMLESS, Component, PlanStep
from ptmcad.model import Model
from ptmcad.model.compile import compiled
from ptmcad.question.savings import BY_NAME
from ptmcad.question.slice import Slice

LATER = ("infinity", "no-real-points", "axis-order", "even-powers")
"""Savings of which nothing can be said before the curves are known."""


def beforehand(slice: Slice, without: frozenset[str], areas: bool = True) -> tuple[PlanStep, ...]:
    """What is known of the plan before anything is computed.

    Parameters
    ----------
    areas : whether they are asked for.
    """
    return (
        saving_step("imports", without),
        *zero_terms(zero_parameters(slice)),
        *_sign_curve(slice.model, without),
        saving_step("hermite-matrix", without, why=_of_jacobian(slice.model, "hermite-matrix")),
        saving_step("equal-counts", without)
        if areas
        else PlanStep("areas of the regions", False, "not asked for"),
    )


def plan_of(
    slice: Slice,
    components: Sequence[Component],
    base: int,
    costs: tuple[int, int],
    without: frozenset[str],
    areas: bool = True,
) -> tuple[PlanStep, ...]:
    """The steps of the exact engine for a slice.

    Parameters
    ----------
    base : number of the base axis.
    costs : predicted costs of the two axis orders.
    without : savings that were switched off.
    areas : whether they are asked for.
    """
    steps = list(beforehand(slice, without, areas))
    # on the line real solutions may leave every bounded set, and conditions change signs: all such
    # curves are used
    if not slice.model.reals and not _has_conditions(slice):
        steps.append(saving_step("infinity", without, why=_of_jacobian(slice.model, "infinity")))
    if "no-real-points" in without:
        steps.append(saving_step("no-real-points", without))
    for c in components:
        what = f"{c.kind.value} component {_short(c, slice.axis_names)}"
        steps.append(
            PlanStep(
                what, not c.left_out, c.left_out or f"degrees {c.polynomial.degrees}", _saving_of(c)
            )
        )
    steps += _axis_order(slice.axis_names, base, costs, without)
    powers = ", ".join(_even_powers(components, slice.axis_names))
    if powers:
        steps.append(
            saving_step(
                "even-powers",
                without,
                why=f"computed in the power, where only such occur: {powers}",
            )
        )
    return tuple(steps)


def _has_conditions(slice: Slice) -> bool:
    known = compiled(slice.model)
    return bool(known.inequalities or known.stability or slice.count.kind.predicate)


def _sign_curve(model: Model, without: frozenset[str]) -> Iterator[PlanStep]:
    """What else than det H could distinguish indices: nothing of one unknown, and equations have no
    index.
    """
    order = model.criterion.order
    if order == 2:
        yield saving_step("sign-curve", without)
    elif order > 2:
        why = "no eigenvalue of H changes its sign off the critical curves"
        yield saving_step("sign-curve", without, "projections of the leading minors of H", why)


def _of_jacobian(model: Model, name: str) -> str:
    """The saving's reason, with the name of the Jacobian's determinant."""
    return BY_NAME[name][1].replace("det H", model.criterion.determinant)


def _saving_of(c: Component) -> str:
    if not c.left_out:
        return ""
    return "infinity" if c.left_out == HARMLESS else "no-real-points"


def _axis_order(
    names: tuple[str, str], base: int, costs: tuple[int, int], without: frozenset[str]
) -> Iterator[PlanStep]:
    if "axis-order" in without:
        yield PlanStep(
            f"decomposition over {names[base]}", True, "the first axis, as asked for", "axis-order"
        )
        return
    if costs[0] == costs[1]:
        reason = "both orders are predicted to cost the same"
    else:
        reason = f"predicted cost {min(costs):.3g} against {max(costs):.3g}"
    yield PlanStep(f"decomposition over {names[base]}", True, reason)
    yield saving_step("axis-order", without, f"decomposition over {names[1 - base]}")


def _even_powers(components: Sequence[Component], names: tuple[str, str]) -> Iterator[str]:
    """Such as ``rho^2 in component 0``, for the components that are used."""
    for n, c in enumerate(components):
        for axis in (0, 1):
            power = gcd(*(t[axis] for t in c.polynomial.terms))
            if power > 1 and not c.left_out and min(c.polynomial.degrees) > 0:
                yield f"{names[axis]}^{power} in component {n}"


def _short(component: Component, names: tuple[str, str]) -> str:
    text = component.polynomial.text(names)
    return text if len(text) <= 40 else f"with {len(component.polynomial.terms)} terms"
