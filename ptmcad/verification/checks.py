"""All checks of a result, in the order in which one rests on another."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from ptmcad.answer.design import BestDesign
from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.errors import A_MAP, expect
from ptmcad.options import Progress
from ptmcad.verification.adjacencies import (
    check_adjacencies,
    check_no_adjacency_missing,
    check_non_adjacencies,
)
from ptmcad.verification.areaclaims import check_areas
from ptmcad.verification.certified.parameterdomain import check_domain
from ptmcad.verification.claims import Claims
from ptmcad.verification.designclaims import verify_design
from ptmcad.verification.equationtexts import check_system
from ptmcad.verification.merging import check_merges, check_regions, check_shape
from ptmcad.verification.norms import check_conditions, check_irreducible, check_norm
from ptmcad.verification.parameterclaims import check_boundary, check_text
from ptmcad.verification.planclaims import check_plan, refuse_ablation
from ptmcad.verification.poseclaims import verify_poses
from ptmcad.verification.projections import check_critical_values, check_stacks
from ptmcad.verification.report import (
    PROVENANCE,
    Check,
    CheckProgress,
    VerifyReport,
    checked,
    drawn,
)
from ptmcad.verification.solutions import check_counts, check_solutions
from ptmcad.verification.windowsigns import check_left_out

PLAN = "predicted costs; symmetries and other savings that leave no trace in this file"

CheckOf = tuple[str, str, Callable[[Claims], str]]
"""The name of a check, its method, and the function that raises `Violation` or says what it
checked.
"""

_SINCE_VARIETY: tuple[CheckOf, ...] = (
    ("critical values", "discriminants, resultants, roots", check_critical_values),
    ("walls and samples", "root counts between samples", check_stacks),
    ("counts", "signatures of trace forms", check_counts),
    ("solutions", "interval Newton in each box", check_solutions),
    ("adjacencies", "root counts on segments", check_adjacencies),
    ("no adjacency missing", "parity, resultants, Sturm", check_no_adjacency_missing),
    ("non-adjacencies", "segments, parity, root counts", check_non_adjacencies),
    ("merges", "comparison of counts", check_merges),
    ("regions", "breadth-first search", check_regions),
    ("areas", "power series, Cauchy's bound", check_areas),
)


def verify(
    result: RegionMap | BestDesign | Poses,
    seed: int | None = None,
    boxes: int | None = None,
    progress: Progress | None = None,
    effort: int | None = None,
) -> VerifyReport:
    """Check a result without the code that made it: a map, a design, or the poses at a point.

    Parameters
    ----------
    seed : of the random points at which texts and the norm of det H are compared, and of the random
        boxes of a certified map; a fresh one when None, which the report has, so that nobody can
        fit claims to the points.
    boxes : number of random boxes of a certified map, `ptmcad.verification.certified.certificate.BOXES`
        when None.
    progress : called as progress(what, done, total), with numbers that never fall.
    effort : how much of a certified map's free area is to be proved free of critical curves: 0 none
        of it, each number more four times as many boxes, 10 all;
        `ptmcad.verification.certified.freearea.EFFORT` when None.

    Raises
    ------
    ConfigError
        For a map that was made without some saving, for an ablation study.

    Guarantee
    ---------
    Every claim in a row that says ok holds; the variety's completeness up to an error probability
    below 1e-10 (`ptmcad.verification.norms`), and a random sample as far as its row says. The
    report is ``ok`` when no row is false. Of a partial result, what it has is checked.

    Not guaranteed
    --------------
    What the table lists as not checked.
    """
    if isinstance(result, BestDesign):
        return verify_design(result, seed, progress)
    if isinstance(result, Poses):
        return verify_poses(result, progress)
    expect(result, RegionMap, "result", A_MAP)
    refuse_ablation(result)
    if result.cover is not None or result.status is Status.CERTIFIED:
        from ptmcad.verification.certified.certificate import verify_certified  # loads numpy

        return verify_certified(result, seed, boxes, effort, progress)
    steps = checks_of(seed)
    missing: set[str] = set()
    if result.status is Status.PARTIAL:
        missing = set() if result.stacks else {name for name, _, _ in _SINCE_VARIETY}
    checks = checked(Claims(result), steps, missing, CheckProgress(progress))
    checks += [Check("plan without trace", "", None, PLAN), PROVENANCE]
    return VerifyReport(tuple(checks))


def checks_of(number: int | None) -> tuple[CheckOf, ...]:
    """The checks of an exact map, in the order in which one rests on another: name, method and
    function.

    Parameters
    ----------
    number : the seed, as for `verify`.
    """
    seed = drawn(number)
    return (
        ("shape", "cross references", check_shape),
        ("parameters as written", "expressions compared", check_text),
        ("signs of parameters", "root counts, elimination", check_domain),
        ("equations", "residues at a random point", partial(check_system, seed=seed)),
        ("irreducible components", "factorization", check_irreducible),
        ("variety complete", "norm of det H at random points", partial(check_norm, seed=seed)),
        ("conditions", "norms at random points", partial(check_conditions, seed=seed)),
        ("boundary components", "factors of the parameters", partial(check_boundary, seed=seed)),
        ("left out", "root counts, resultants", check_left_out),
        ("plan", "built once more", check_plan),
        *_SINCE_VARIETY,
    )
