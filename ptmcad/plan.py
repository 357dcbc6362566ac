"""The plan: what a slice needs, what is left out, and the reason for each.

Guarantee: each saving that is named here was really made in the computation that it accompanies.
"""

from __future__ import annotations

from collections.abc import Sequence

from ptmcad.regionmap import Component, PlanStep
from ptmcad.slice import Slice


def plan_of(
    slice: Slice, components: Sequence[Component], base: str, costs: tuple[int, int], keep: frozenset[str]
) -> tuple[PlanStep, ...]:
    """The steps of the exact engine for a slice.

    Parameters
    ----------
    base : name of the base axis.
    costs : predicted costs of the two axis orders.
    keep : savings that were switched off.
    """
    names = slice.axis_names
    zero = [n for n, e in slice.parameters.items() if e.is_constant and e.constant() == 0]
    steps = []
    if zero:
        steps.append(PlanStep("terms of " + ", ".join(zero), False, "they are zero on this slice"))
    steps.append(PlanStep("projection of H11 = 0", False, "where it vanishes off the critical curves, det H < 0"))
    for c in components:
        what = f"{c.kind.value} component {_short(c, names)}"
        steps.append(PlanStep(what, not c.left_out, c.left_out or f"degrees {c.polynomial.degrees}"))
    if "axis-order" in keep:
        reason = "the first axis, as asked for"
    elif costs[0] == costs[1]:
        reason = "both orders are predicted to cost the same"
    else:
        reason = f"predicted cost {min(costs):.3g} against {max(costs):.3g}"
    steps.append(PlanStep(f"decomposition over {base}", True, reason))
    steps.append(PlanStep("leading coefficients", False, "roots that leave through infinity do not cross the window"))
    return tuple(steps)


def _short(component: Component, names: tuple[str, str]) -> str:
    text = component.polynomial.text(names)
    return text if len(text) <= 40 else f"with {len(component.polynomial.terms)} terms"
