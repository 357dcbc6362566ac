"""All checks of a certified map, in the order in which one rests on another."""

from __future__ import annotations

from collections.abc import Callable

from ptmcad.answer.regionmap import RegionMap
from ptmcad.options import Progress
from ptmcad.question.slice import Slice
from ptmcad.verification.certified.cellsamples import check_points
from ptmcad.verification.certified.coverclaims import (
    CertifiedClaims,
    check_components,
    check_form,
    check_regions,
)
from ptmcad.verification.certified.freearea import EFFORT, check_free_area
from ptmcad.verification.certified.parameterdomain import check_domain
from ptmcad.verification.certified.sampling import check_boxes
from ptmcad.verification.equationtexts import check_potential
from ptmcad.verification.normalform.waves import form_of
from ptmcad.verification.parameterclaims import check_text
from ptmcad.verification.report import (
    PROVENANCE,
    Check,
    CheckProgress,
    VerifyReport,
    Violation,
    checked,
    drawn,
)

BOXES = 16
PLAN = "what it says of curves and unknowns is no claim about the regions"


def verify_certified(
    result: RegionMap,
    seed: int | None,
    boxes: int | None,
    effort: int | None,
    progress: Progress | None = None,
) -> VerifyReport:
    """Check a map with a cover; see `ptmcad.verification.verify`."""
    claims = CertifiedClaims(result)
    chosen = drawn(seed)
    number = BOXES if boxes is None else boxes
    bar = CheckProgress(progress)
    within = bar.within
    steps: tuple[tuple[str, str, Callable[[CertifiedClaims], str]], ...] = (
        ("form", "comparison", check_form),
        ("parameters as written", "expressions compared", check_text),
        ("signs of parameters", "root counts, elimination", check_domain),
        (
            "equations",
            "residues at a random point",
            lambda of: check_potential(of, chosen, closed=_is_closed(result.slice)),
        ),
        ("components", "sweep over the rectangles", check_components),
        ("regions and areas", "sweep, breadth-first search", check_regions),
        (
            "counts and solutions",
            "Krawczyk's test and exclusion in balls",
            lambda of: check_points(of, within),
        ),
        (
            "random boxes",
            "Krawczyk's test over boxes of parameters",
            lambda of: check_boxes(of, chosen, number, within),
        ),
        (
            "the whole free area",
            "exclusion of critical points",
            lambda of: check_free_area(EFFORT if effort is None else effort, of, within),
        ),
    )
    checks = checked(claims, steps, bar=bar)
    checks += [Check("plan", "", None, PLAN), PROVENANCE]
    return VerifyReport(tuple(checks))


def _is_closed(slice: Slice) -> bool:
    """Whether there are closed loops and springs with free lengths."""
    return bool(form_of(slice).closing)


def contradiction(result: RegionMap) -> str:
    """What in a stored map contradicts the rest of it, by checks that take no time; empty when
    nothing does.

    It does not show whether the counts are right, nor whether rectangles are missing that no other
    entry points to.
    """
    claims = CertifiedClaims(result)
    for check in (check_form, check_components, check_regions):
        try:
            check(claims)
        except Violation as violation:
            return str(violation)
    return ""
