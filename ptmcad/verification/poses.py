"""Checks of the poses at a point: none is missing or stored twice, in each box is one, with its
index and stability.

They are those of a map's cell (`ptmcad.verification.solutions`, and with free lengths
`certified.plain.pointcounts`): a window of two axes on which nothing depends has the point as its sample.

Guarantee: that of these checks. Where a pose is degenerate, the number of different ones alone is
checked.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import Cell, RegionMap, Solution, Status, System
from ptmcad.cover.rectangles import Cover
from ptmcad.options import Progress
from ptmcad.question.counts import Count
from ptmcad.question.slice import Axis, Point, Slice
from ptmcad.text.expressions import constant
from ptmcad.verification.certified.boxes import Unproved
from ptmcad.verification.certified.points import check_cell, check_listed, counting_of
from ptmcad.verification.certified.structure import CertifiedClaims
from ptmcad.verification.derivation import meaning_of, parameters_of
from ptmcad.verification.report import CheckProgress, Unchecked, VerifyReport, Violation, checked
from ptmcad.verification.solutions import check_disjoint, signs_of

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


def _check_poses(claims: CertifiedClaims, found: Poses) -> str:
    result, model = claims.result, found.model
    (cell,) = result.cells
    for name in parameters_of(model):
        if name not in found.parameters:
            raise Violation(f"nothing says what {name} is")
    if result.slice.has_free_lengths and found.equilibria:
        try:
            if found.status is Status.UNDECIDED:
                number = check_listed(claims, counting_of(claims), cell)
                return Unchecked(f"whether there are more than the {number} listed, which hold")
            number = check_cell(claims, counting_of(claims), cell)
            untold = (
                ""
                if cell.stable == found.stable
                else ", of whose stability nothing is checked here"
            )
            return f"{number} poses{untold}"
        except Unproved as reason:
            return Unchecked(str(reason))
    try:
        number = claims.fibre_at(*cell.sample).number_of_real_solutions()
    except Violation:  # infinitely many
        number = -1
    if found.status is Status.UNDECIDED and not found.equilibria:
        return Unchecked("nothing is said of them")
    if number != len(found.equilibria):
        raise Violation(
            f"{len(found.equilibria)} poses are listed; there are {max(number, 0) or 'infinitely many'}"
        )
    check_disjoint(0, cell, model)
    regular = [
        (k, pose, box)
        for k, (pose, box) in enumerate(zip(found.equilibria, cell.solutions, strict=True))
        if pose.multiplicity == 1
    ]
    for k, pose, box in regular:
        try:
            signs = signs_of(claims, cell, box)
        except Violation as violation:
            raise Violation(f"the box of pose {k + 1}: {violation}") from None
        index, stable = claims.meaning.index(signs), claims.meaning.is_stable(signs)
        if (index, stable) != (pose.index, pose.stable):
            raise Violation(f"pose {k + 1} has index {index}, and that it is stable is {stable}")
    if len(regular) < number:
        return Unchecked(
            f"{number} different poses; {number - len(regular)} of them are degenerate"
        )
    return f"{number} poses"


def map_of(slice: Slice, cells: tuple[Cell, ...], status: Status = Status.EXACT) -> RegionMap:
    """A map of a slice that has cells only, for what is checked of points."""
    return RegionMap(
        slice=slice,
        status=status,
        system=System((), (), "", (), ()),
        cells=cells,
        undetermined=Fraction(0),
        versions={},
        cover=Cover(2, ()),
    )


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
    return Solution(
        tuple(x.center for x in numbers),
        max((x.radius for x in numbers), default=_EXACT) or _EXACT,
        signs,
    )
