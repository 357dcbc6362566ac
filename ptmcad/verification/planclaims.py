"""Check of the plan: what it says was computed and left out is what the result shows.

Guarantee: the steps are those that the slice's parameters and the stored components ask for, in
their order, with every saving made; what a saving leaves out is not in the result.

Not guaranteed: what leaves no trace in a result. These are the predicted costs by which the base
axis was chosen; whether the savings "imports" and "equal-counts" were made; whether areas are twice
those on one half of the window, and by which symmetry (no other check believes one, and each area is
enclosed over the whole window); and that a harmless curve or one of both axes that is used could
not have been left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from ptmcad.answer.regionmap import HARMLESS, NO_POINT, Component, PlanStep, RegionMap
from ptmcad.errors import ConfigError
from ptmcad.verification.claims import Claims
from ptmcad.verification.report import Violation
from ptmcad.verification.rootcounts import roots_between

_COST = r"([0-9]+(?:\.[0-9]+)?(?:e\+[0-9]+)?)"
_CHOICE = re.compile(rf"predicted cost {_COST} against {_COST}", re.ASCII)
_SAME_COST = "both orders are predicted to cost the same"
_HALF = (
    r"left out: areas on one half of the window \(its solutions are those of the other half, "
    r"by ((, )?({0}) -> [-+ ]*({0})( [-+] [\w/]+)?)+\)"
)
"""With a place for the names of unknowns and axes."""
_NO_AREAS = PlanStep("areas of the regions", False, "not asked for")


def refuse_ablation(result: RegionMap) -> None:
    """Refuse a map that was made without some saving: it serves to measure what the saving is
    worth.

    Raises
    ------
    ConfigError
        That names the savings.
    """
    off = sorted({step.saving for step in result.plan if step.saving and step.done})
    if off:
        raise ConfigError(
            f"{result.slice.name} was computed without these savings, to measure what they are worth: "
            f"{', '.join(off)}. Such results are not checked: classify it anew"
        )


def check_plan(claims: Claims) -> str:
    """Every step of the plan."""
    result = claims.result
    expected, plan = list(_expected(claims)), list(result.plan)
    names = "|".join((*result.slice.axis_names, *claims.model.unknowns))
    half = plan and re.fullmatch(_HALF.format(names), str(plan[-1])) and not plan[-1].saving
    if half and _NO_AREAS not in plan:
        del plan[-1]  # areas are checked on the whole window, so that nothing rests on it
    if len(expected) != len(plan):
        raise Violation(f"the plan has {len(plan)} steps, not {len(expected)}")
    for n, (step, other) in enumerate(zip(plan, expected, strict=True)):
        reason = other.reason or (step.reason if _is_choice(step.reason) else _SAME_COST)
        if step != other._replace(reason=reason):
            raise Violation(f"step {n} of the plan is not {str(step)[:100]!r}, but {str(other)!r}")
    for c in (*claims.lines, *claims.curves):
        p, window = (c.in_u, claims.height) if c.degrees[1] else (c.in_v, claims.base)
        if 0 in c.degrees and not roots_between(p[0], *window):
            raise Violation(
                f"component {c.number} is used, but it has no point in the window, and the plan does not "
                "say that such are kept"
            )
    if _NO_AREAS in plan and any(
        region.area[0] or region.area[1] < result.slice.area for region in result.regions
    ):
        raise Violation("areas are known, but the plan says that they were not asked for")
    return f"{len(expected)} steps"


def _is_choice(reason: str) -> bool:
    """Whether a base axis was chosen for this reason: its cost is not the larger one."""
    costs = _CHOICE.fullmatch(reason)
    return costs is not None and float(costs[1]) <= float(costs[2])


def _expected(claims: Claims) -> Iterator[PlanStep]:
    """The plan; the reason is empty where predicted costs decided."""
    result = claims.result
    names = result.slice.axis_names
    yield from _general(claims)
    for c in result.components:
        yield _of_component(c, names)
    this, other = (f"decomposition over {names[axis]}" for axis in (result.base, 1 - result.base))
    yield PlanStep(this, True, "")
    yield PlanStep(other, False, "regions do not depend on it", "axis-order")
    powers = [
        f"{name}^{power} in component {c.number}"
        for c in claims.curves
        for axis, name in enumerate(names)
        if c.degrees[0] and (power := c.exponent_gcd(axis ^ result.base)) > 1
    ]
    if powers:
        why = f"computed in the power, where only such occur: {', '.join(powers)}"
        yield PlanStep("discriminants and resultants of full degree", False, why, "even-powers")


def _general(claims: Claims) -> list[PlanStep]:
    """What a plan says of every slice of a model by a kind of count."""
    result, true = claims.result, claims.derivation
    determinant, order = true.meaning.determinant, true.meaning.order
    zero = ", ".join(n for n, e in result.slice.parameters.items() if not e.numerator)
    said = (
        (
            True,
            "imports",
            "imports of numpy, matplotlib, sympy and numba",
            "nothing needs them before it asks",
        ),
        (zero, "", f"terms of {zero}", "they are zero on this slice"),
        (
            order == 2,
            "sign-curve",
            "projection of H11 = 0",
            "where it vanishes off the critical curves, det H < 0",
        ),
        (
            order > 2,
            "sign-curve",
            "projections of the leading minors of H",
            "no eigenvalue of H changes its sign off the critical curves",
        ),
        (
            True,
            "hermite-matrix",
            "determinant of the Hermite matrix",
            f"the norm of {determinant} has the same critical factors and no others",
        ),
        (_NO_AREAS in result.plan, "", *_NO_AREAS[::2]),
        (
            _NO_AREAS not in result.plan,
            "equal-counts",
            "areas beside walls that separate no regions",
            "what one cell has too much there its neighbour in the region has too little",
        ),
        (
            not (claims.model.reals or true.inequalities or true.stability),
            "infinity",
            "curves over which solutions leave every bounded set",
            f"near them {determinant} stays away from 0 at every solution, and real ones are bounded",
        ),
    )
    return [PlanStep(what, False, why, saving) for holds, saving, what, why in said if holds]


def _of_component(c: Component, names: tuple[str, str]) -> PlanStep:
    text = c.polynomial.text(names)
    shown = text if len(text) <= 40 else f"with {len(c.polynomial.terms)} terms"
    saving = {NO_POINT: "no-real-points", HARMLESS: "infinity"}.get(c.left_out, "")
    reason = c.left_out or f"degrees {c.polynomial.degrees}"
    return PlanStep(f"{c.kind.value} component {shown}", not c.left_out, reason, saving)
