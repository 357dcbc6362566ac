"""All checks of a result, in the order in which one rests on another."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from ptmcad.regionmap import RegionMap
from ptmcad.verification.areas import check_areas
from ptmcad.verification.claims import Claims
from ptmcad.verification.counts import check_counts
from ptmcad.verification.merging import check_merges, check_regions, check_shape
from ptmcad.verification.report import Check, VerifyReport, Violation
from ptmcad.verification.structure import (
    check_adjacencies,
    check_critical_values,
    check_no_adjacency_missing,
    check_stacks,
)
from ptmcad.verification.variety import check_boundary, check_irreducible, check_left_out, check_norm

NOT_CHECKED = (
    ("provenance", "plan, versions, timings, reference, title and origin texts are not claims about the regions"),
)


def verify(result: RegionMap, seed: int = 20231) -> VerifyReport:
    """Check a result without the code that made it.

    Parameters
    ----------
    seed : of the random points at which the variety is compared with the norm of det H.

    Guarantee
    ---------
    When the report is ``ok``, every claim in its table holds; the variety's completeness up to an error probability
    that its line's method names.

    Not guaranteed
    --------------
    What the table lists as not checked.
    """
    claims = Claims(result)
    steps: tuple[tuple[str, str, Callable[[Claims], str]], ...] = (
        ("shape", "cross references", check_shape),
        ("irreducible components", "factorization", check_irreducible),
        ("variety complete", "norm of det H at random points", partial(check_norm, seed=seed)),
        ("boundary components", "factors of the parameters", check_boundary),
        ("left out", "Sturm counts over samples", check_left_out),
        ("critical values", "FLINT discriminants, Sturm", check_critical_values),
        ("walls and samples", "Sturm counts between samples", check_stacks),
        ("counts", "signatures of trace forms", check_counts),
        ("adjacencies", "Sturm counts on segments", check_adjacencies),
        ("no adjacency missing", "parity, resultants, Sturm", check_no_adjacency_missing),
        ("merges", "comparison of counts", check_merges),
        ("regions", "breadth-first search", check_regions),
        ("areas", "midpoint rule with slope balls", check_areas),
    )
    checks: list[Check] = []
    failed = False
    for name, method, check in steps:
        if failed:
            checks.append(Check(name, method, None, "not reached"))
            continue
        try:
            checks.append(Check(name, method, True, check(claims)))
        except Violation as violation:
            failed = True
            checks.append(Check(name, method, False, str(violation)))
    checks += [Check(name, "", None, reason) for name, reason in NOT_CHECKED]
    return VerifyReport(tuple(checks))
