"""Checks of the poses at a point, as `ptmcad solve` has them.

They are checked as the solutions of a map's cell (`solutions`), and with free lengths as in
`certified.cellsamples`: a window of two axes on which nothing depends has the point as its sample.

Guarantee: poses that pass are all that there are, each once, with their index, stability and
predicates; what was not decided is said. A pose that is called degenerate is: trace forms give the
sign 0 for the Jacobian's determinant there. Its multiplicity is not checked.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import combinations

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import Cell, RegionMap, Solution, Status
from ptmcad.options import Progress
from ptmcad.question.counts import Count
from ptmcad.question.slice import Axis, Point, Slice
from ptmcad.text.expressions import constant
from ptmcad.verification.certified.cellsamples import check_cell, why_not_listed
from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.certified.models import BUDGETS
from ptmcad.verification.derivation import parameters_of
from ptmcad.verification.kinds import kind_of, meaning_of
from ptmcad.verification.normalform.boxes import Unproved
from ptmcad.verification.report import CheckProgress, Unchecked, VerifyReport, Violation, checked
from ptmcad.verification.solutions import check_disjoint, map_of, place_of, signs_in

_EXACT = Fraction(1, 2**100)
"""Half the width of the box of a pose whose coordinates are all known exactly."""


def verify_poses(found: Poses, progress: Progress | None = None) -> VerifyReport:
    """Check stored poses without the code that made them."""
    claims = CertifiedClaims(_map_of(found))
    steps = (
        (
            "poses",
            "signatures and interval Newton, or a search in balls",
            partial(_check_poses, found=found),
        ),
    )
    return VerifyReport(tuple(checked(claims, steps, (), CheckProgress(progress))))


RIGHTLY = frozenset({"bits", "flat", "remark", "undecided"})
"""What another version may have written otherwise of the same poses."""


def in_same_order(stored: Poses, found: Poses) -> tuple[Poses, Poses, int]:
    """Both with their poses in the order of the stored ones, where energies leave that open.

    Where one of them is undecided, those that the other one has not are left out; how many, comes
    last. Both as they are where that does not pair them.
    """
    rest, pairs = list(found.equilibria), list[tuple[Pose, Pose]]()
    for pose in stored.equilibria:
        if (match := next((other for other in rest if _meet(pose, other)), None)) is not None:
            rest.remove(match)
            pairs.append((pose, match.as_known_to(pose)))
    alone = len(stored.equilibria) - len(pairs)
    if (alone and found.status is not Status.UNDECIDED) or (
        rest and stored.status is not Status.UNDECIDED
    ):
        return stored, found, 0
    ordered = [other for _, other in pairs]
    if any(_is_before(two, one) for one, two in combinations(ordered, 2)):
        return stored, found, 0
    kept = tuple(pose for pose, _ in pairs)
    return (
        replace(stored, equilibria=kept),
        replace(found, equilibria=tuple(ordered)),
        alone + len(rest),
    )


def _meet(one: Pose, other: Pose) -> bool:
    """Whether two poses may be the same by their unknowns."""
    return all(
        a.low <= b.high and b.low <= a.high
        for a, b in zip(
            one.cosines_sines + one.reals, other.cosines_sines + other.reals, strict=True
        )
    )


def _is_before(one: Pose, other: Pose) -> bool:
    """Whether a pose has to come before another one."""
    if (one.stable is True) != (other.stable is True):
        return one.stable is True
    if one.energy is None or other.energy is None:
        return False
    return one.energy.high < other.energy.low


def _check_poses(claims: CertifiedClaims, found: Poses) -> str:
    result, model = claims.result, found.model
    (cell,) = result.cells
    for name in parameters_of(model):
        if name not in found.parameters:
            raise Violation(f"nothing says what {name} is")
    if result.slice.has_free_lengths:
        return _check_with_free_lengths(claims, cell, found)
    return _check_without_free_lengths(claims, cell, found)


def _check_with_free_lengths(claims: CertifiedClaims, cell: Cell, found: Poses) -> str:
    """Their number, and what is said of each, by a search in balls.

    Raises
    ------
    Violation
    """
    if found.status not in (Status.CERTIFIED, Status.UNDECIDED):
        raise Violation(f"with free lengths poses are certified, not {found.status.value}")
    untold: dict[str, None] = {}
    for k, (pose, box) in enumerate(zip(found.equilibria, cell.solutions, strict=True)):
        try:
            untold |= dict.fromkeys(_check_in_balls(claims, cell, k, pose, box))
        except Unproved as reason:
            untold[str(reason)] = None
    try:
        if found.status is Status.UNDECIDED:
            if (doubt := why_not_listed(claims, cell)) is not None:
                raise doubt
            more = f"whether there are more than the {len(cell.solutions)} listed"
            return Unchecked("; ".join((more if untold else f"{more}, which hold", *untold)))
        if len(found.model.unknowns) > len(BUDGETS):
            untold["whether there are more"] = None
        else:
            check_cell(claims, cell)
    except Unproved as reason:
        return Unchecked("; ".join(dict.fromkeys((str(reason), *untold))))
    number = len(found.equilibria)
    return Unchecked(f"{number} poses; {'; '.join(untold)}") if untold else f"{number} poses"


def _check_in_balls(
    claims: CertifiedClaims, cell: Cell, k: int, pose: Pose, box: Solution
) -> Iterator[str]:
    """What is said of a pose holds at the only solution in its box; gives what is not decided.

    Raises
    ------
    Violation, Unproved
    """
    counting, meaning = claims.counting, claims.meaning
    zero = counting.in_box(*cell.sample, box, k)
    if pose.multiplicity != 1:
        raise Violation(f"pose {k + 1} is called degenerate; it is regular")
    signs = zero.signs if meaning.order else counting.stability_at(*cell.sample, zero)
    is_told = bool(signs) or meaning.about_stability(True) is None
    stable = meaning.is_stable(signs) if is_told else None
    if not is_told and pose.stable is not None:
        yield f"whether pose {k + 1} is stable"
    _check_said(k, pose, meaning.index(signs), stable if is_told else pose.stable)
    for name, said in pose.further.items():
        count = Count(name)
        if not kind_of(count).is_predicate:
            continue
        if stable is False:
            true = False
        elif stable is None or not kind_of(count).is_of(claims.model):
            yield f"whether pose {k + 1} is {name}"
            continue
        else:
            try:
                true = claims.counting_of(count).has_margins(*cell.sample, zero)
            except Unproved:
                yield f"whether pose {k + 1} is {name}"
                continue
        if said != true:
            raise Violation(f"that pose {k + 1} is {name} is {true}, not {said}")


def _check_said(k: int, pose: Pose, index: int | None, stable: bool | None) -> None:
    """Index and stability of a pose are these.

    Raises
    ------
    Violation
    """
    if (index, stable) != (pose.index, pose.stable):
        raise Violation(
            f"pose {k + 1} has index {index}, and that it is stable is {stable}; "
            f"it is said to have {pose.index}, and {pose.stable}"
        )


def _check_without_free_lengths(claims: CertifiedClaims, cell: Cell, found: Poses) -> str:
    """Their number, and what is said of each, by signatures and interval Newton.

    Raises
    ------
    Violation
    """
    listed, undecided = len(found.equilibria), found.status is Status.UNDECIDED
    try:
        number = claims.fibre_at(*cell.sample).number_of_real_solutions()
    except Violation:  # infinitely many
        number = -1
    if undecided and not listed:
        return Unchecked("nothing is said of them")
    if number < listed or (number > listed and not undecided):
        raise Violation(
            f"{listed} poses are listed; there are {max(number, 0) or 'infinitely many'}"
        )
    degenerate = sum(pose.multiplicity > 1 for pose in found.equilibria)
    if not undecided and (found.status is Status.ON_VARIETY) != (degenerate > 0):
        raise Violation(f"the status is {found.status.value}, with {degenerate} degenerate poses")
    check_disjoint(0, cell, found.model)
    for k, (pose, box) in enumerate(zip(found.equilibria, cell.solutions, strict=True)):
        index = stable = None
        try:
            if pose.multiplicity == 1:
                signs, _ = signs_in(claims, cell, box)
                index, stable = claims.meaning.index(signs), claims.meaning.is_stable(signs)
            elif not (fibre := claims.fibre_at(*cell.sample)).is_degenerate(place_of(fibre, box)):
                raise Violation("the solution in it is called degenerate; it is regular")
        except Violation as violation:
            raise Violation(f"the box of pose {k + 1}: {violation}") from None
        _check_said(k, pose, index, stable)
    if number > listed:
        return Unchecked(f"{listed} poses hold, and {number - listed} more are not listed")
    if degenerate:
        return Unchecked(
            f"{number} different poses; of the degenerate ones ({degenerate}) the multiplicity"
        )
    return f"{number} poses"


def _map_of(found: Poses) -> RegionMap:
    """The map of one cell that has the point as its sample."""
    expressions = {name: constant(value) for name, value in found.parameters.items()}
    axes = (Axis("x", Fraction(0), Fraction(1)), Axis("y", Fraction(0), Fraction(1)))
    slice = Slice("", found.model, axes, expressions, Count.TOTAL)
    boxes = tuple(_box(pose, slice.has_free_lengths) for pose in found.equilibria)
    meaning = meaning_of(found.model)
    index = meaning.indices([pose.index for pose in found.equilibria])
    # a map of all counts with a cover has no stable ones where conditions say which are; each pose
    # is asked below
    stable = (
        meaning.about_stability(found.stable)
        if meaning.order or not slice.has_free_lengths
        else None
    )
    sample = Point(slice.axis_names, Fraction(1, 2), Fraction(1, 2))
    return map_of(
        slice, (Cell(None, 0, sample, 0, len(boxes), stable, index, boxes),), found.status
    )


def _box(pose: Pose, in_angles: bool) -> Solution:
    numbers = (pose.angles if in_angles else pose.cosines_sines) + pose.reals
    signs = (
        "" if pose.index is None else "+" * (len(pose.eigenvalues) - pose.index) + "-" * pose.index
    )
    widest = max((x.radius for x in numbers), default=Fraction(0))
    return Solution(tuple(x.center for x in numbers), widest or _EXACT, signs)
