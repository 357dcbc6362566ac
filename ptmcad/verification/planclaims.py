"""Check of the plan: what it says was computed and left out is what the result shows.

Guarantee: the steps are those that the slice's parameters and the stored components ask for, in
their order, with every saving made; what a saving leaves out is not in the result.

Not guaranteed: what leaves no trace in a result. These are the predicted costs by which the base
axis was chosen; whether the savings "imports" and "equal-counts" were made; whether areas are twice
those on one half of the window, and by which symmetry (no other check believes one, and each area is
enclosed over the whole window); and that a harmless curve that is used could not have been left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from ptmcad.answer.regionmap import HARMLESS, NO_POINT, Component, Kind, PlanStep, RegionMap
from ptmcad.errors import ConfigError
from ptmcad.verification.claims import Claims, PlaneCurve
from ptmcad.verification.derivation import derivation_of
from ptmcad.verification.kinds import kind_of
from ptmcad.verification.report import Violation
from ptmcad.verification.windowsigns import plainly_outside

_COST = r"([0-9]+(?:\.[0-9]+)?(?:e\+[0-9]+)?)"
_CHOICE = re.compile(rf"predicted cost {_COST} against {_COST}", re.ASCII)
_SAME_COST = "both orders are predicted to cost the same"
_GENERAL = (
    (
        "imports",
        "imports of numpy, matplotlib, sympy and numba",
        "nothing needs them before it asks",
    ),
    ("", "terms of {zero}", "they are zero on this slice"),
    ("sign-curve", "projection of H11 = 0", "where it vanishes off the critical curves, det H < 0"),
    (
        "hermite-matrix",
        "determinant of the Hermite matrix",
        "the norm of det H has the same critical factors and no others",
    ),
    (
        "equal-counts",
        "areas beside walls that separate no regions",
        "what one cell has too much there its neighbour in the region has too little",
    ),
    (
        "infinity",
        "curves over which solutions leave every bounded set",
        "near them det H stays away from 0 at every solution, and real ones are bounded",
    ),
)
"""Names, subjects and reasons of the savings that are made on every slice, and of what needs no
saving.
"""


_NO_SIGN_CHANGE = "no eigenvalue of H changes its sign off the critical curves"
_NO_AREAS = PlanStep("areas of the regions", False, "not asked for")
_HALF = "areas on one half of the window"
_IMAGE = re.compile(
    r"its solutions are those of the other half, by [-+]?\w+ -> [^,>]+(, [-+]?\w+ -> [^,>]+)*"
)


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
            f"{result.slice.name} was computed without the saving{'s' * (len(off) > 1)} {', '.join(off)}, to measure "
            "what it is worth, and such results are not checked: classify it anew"
        )


def check_plan(claims: Claims) -> str:
    """Every step of the plan."""
    result = claims.result
    expected, plan = list(_expected(result)), list(result.plan)
    if plan and _is_of_half(plan[-1]):
        del plan[-1]  # areas are checked on the whole window, so that nothing rests on it
    if len(expected) != len(plan):
        raise Violation(f"the plan has {len(plan)} steps, not {len(expected)}")
    for n, (step, other) in enumerate(zip(plan, expected, strict=True)):
        same = (step.what, step.done, step.saving) == (other.what, other.done, other.saving)
        if not same or not (
            step.reason == other.reason if other.reason else _is_choice(step.reason)
        ):
            done = "computed" if other.done else "left out"
            raise Violation(
                f"step {n} of the plan is not {str(step)[:100]!r}, but {other.what!r}, {done}: "
                f"{other.reason or 'by predicted cost'}"
            )
    _check_left_out(claims)
    return f"{len(expected)} steps"


def _is_of_half(step: PlanStep) -> bool:
    """Whether a step says by which change of axes and unknowns one half of the areas is enough."""
    said = (step.what, step.done, step.saving) == (_HALF, False, "")
    return said and _IMAGE.fullmatch(step.reason) is not None


def _is_choice(reason: str) -> bool:
    """Whether a base axis was chosen for this reason: its cost is not the larger one."""
    costs = _CHOICE.fullmatch(reason)
    return reason == _SAME_COST if costs is None else float(costs[1]) <= float(costs[2])


def _expected(result: RegionMap) -> Iterator[PlanStep]:
    """The plan; the reason is empty where predicted costs decided."""
    names = result.slice.axis_names
    yield from _general(result)
    for c in result.components:
        yield _of_component(c, names)
    this, other = (f"decomposition over {names[axis]}" for axis in (result.base, 1 - result.base))
    yield PlanStep(this, True, "")
    yield PlanStep(other, False, "regions do not depend on it", "axis-order")
    powers = ", ".join(_even_powers(result))
    if powers:
        why = f"computed in the power, where only such occur: {powers}"
        yield PlanStep("discriminants and resultants of full degree", False, why, "even-powers")


def _general(result: RegionMap) -> Iterator[PlanStep]:
    """What a plan says of every slice of a model by a kind of count."""
    slice, model = result.slice, result.slice.model
    true = kind_of(slice.count).with_margins(derivation_of(model))
    zero = ", ".join(n for n, e in slice.parameters.items() if not e.numerator)
    is_made = {
        "": bool(zero),
        "sign-curve": true.meaning.order > 1,
        "infinity": not (model.reals or true.inequalities or true.stability),
    }
    for saving, what, why in _GENERAL:
        if not is_made.get(saving, True):
            continue
        if saving == "equal-counts" and _NO_AREAS in result.plan:
            yield _NO_AREAS
            continue
        if saving == "sign-curve" and len(model.unknowns) > 2:
            subject, reason = "projections of the leading minors of H", _NO_SIGN_CHANGE
        else:
            subject, reason = what.format(zero=zero), why.replace("det H", true.meaning.determinant)
        yield PlanStep(subject, False, reason, saving)


def _of_component(c: Component, names: tuple[str, str]) -> PlanStep:
    text = c.polynomial.text(names)
    shown = text if len(text) <= 40 else f"with {len(c.polynomial.terms)} terms"
    saving = {NO_POINT: "no-real-points", HARMLESS: "infinity"}.get(c.left_out, "")
    reason = c.left_out or f"degrees {c.polynomial.degrees}"
    return PlanStep(f"{c.kind.value} component {shown}", not c.left_out, reason, saving)


def _even_powers(result: RegionMap) -> Iterator[str]:
    for n, c in enumerate(result.components):
        for axis, name in enumerate(result.slice.axis_names):
            power = PlaneCurve(n, c.polynomial.terms).exponent_gcd(axis)
            if power > 1 and not c.left_out and 0 not in c.polynomial.degrees:
                yield f"{name}^{power} in component {n}"


def _check_left_out(claims: Claims) -> None:
    """What savings leave out against the components and the areas."""
    result = claims.result
    for n, c in enumerate(result.components):
        if c.kind is Kind.AUXILIARY:
            raise Violation(
                f"component {n} is auxiliary, but no saving was switched off that leaves it out"
            )
        if not c.left_out and plainly_outside(PlaneCurve.of(n, c.polynomial, result.base), claims):
            raise Violation(
                f"component {n} is used, but it has no point in the window, and the plan does not say "
                "that such are kept"
            )
    if _NO_AREAS in result.plan:
        x, y = result.slice.axes
        window = (x.high - x.low) * (y.high - y.low)
        if any(region.area[0] != 0 or region.area[1] < window for region in result.regions):
            raise Violation("areas are known, but the plan says that they were not asked for")
