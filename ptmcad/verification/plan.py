"""Check of the plan: what it says was computed and left out is what the result shows.

Guarantee: the steps are those that the slice's parameters and the stored components ask for, in their order. Only the
predicted costs, by which the base axis was chosen, are not computed again.
"""

from __future__ import annotations

import re

from ptmcad.regionmap import Component, PlanStep
from ptmcad.verification.claims import Claims
from ptmcad.verification.report import Violation

_COST = r"[0-9]+(?:\.[0-9]+)?(?:e\+[0-9]+)?"
_CHOICE = re.compile(
    rf"predicted cost {_COST} against {_COST}"
    r"|both orders are predicted to cost the same"
    r"|the first axis, as asked for",
    re.ASCII,
)


def check_plan(claims: Claims) -> str:
    """Every step of the plan."""
    result = claims.result
    names = result.slice.axis_names
    expected: list[tuple[str, bool, str | None]] = []
    zero = [n for n, e in result.slice.parameters.items() if not e.numerator]
    if zero:
        expected.append(("terms of " + ", ".join(zero), False, "they are zero on this slice"))
    expected.append(("projection of H11 = 0", False, "where it vanishes off the critical curves, det H < 0"))
    expected += [_of_component(c, names) for c in result.components]
    expected.append((f"decomposition over {names[result.base]}", True, None))
    expected.append(("leading coefficients", False, "roots that leave through infinity do not cross the window"))
    if len(expected) != len(result.plan):
        raise Violation(f"the plan has {len(result.plan)} steps, not {len(expected)}")
    for n, (step, (what, done, reason)) in enumerate(zip(result.plan, expected, strict=True)):
        if (step.what, step.done) != (what, done) or not _holds(step, reason):
            raise Violation(f"step {n} of the plan is not {str(step)[:100]!r}, but {what!r}, "
                            f"{'computed' if done else 'left out'}: {reason or 'by predicted cost'}")  # fmt: skip
    return f"{len(expected)} steps"


def _holds(step: PlanStep, reason: str | None) -> bool:
    return step.reason == reason if reason is not None else _CHOICE.fullmatch(step.reason) is not None


def _of_component(c: Component, names: tuple[str, str]) -> tuple[str, bool, str]:
    text = c.polynomial.text(names)
    shown = text if len(text) <= 40 else f"with {len(c.polynomial.terms)} terms"
    return f"{c.kind.value} component {shown}", not c.left_out, c.left_out or f"degrees {c.polynomial.degrees}"
