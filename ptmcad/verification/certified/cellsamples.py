"""Checks of the counts of a certified map: at every cell's sample, proved once more.

Guarantee: exact at the samples. That the counts hold in the whole cells rests on the cover, of
which `ptmcad.verification.certified.sampling` tries points.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from fractions import Fraction

from ptmcad.answer.regionmap import Cell
from ptmcad.verification.certified.counted import stored
from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.kinds import kind_of, numbers_for
from ptmcad.verification.normalform.boxes import Unproved, Zero, in_words
from ptmcad.verification.normalform.waves import form_of
from ptmcad.verification.report import Unchecked, Violation, Within

HOPELESS = 16
"""Samples or random points whose counts were not decided, after which no more are tried."""
MAX_NEAR = 2
"""Points beside a sample whose counts were not decided, at which they are tried."""


_PLACES = ((3, 2), (-2, 3), (2, -1), (-1, -3))
"""Where points beside a sample are, in quarters of a square around it: on no line with it through
two of them.
"""
_PARTS = 8
"""Of the window's width, half the width of the largest such square: what is nearly degenerate takes
many boxes ...
"""
_MIN_PARTS = 2**60
"""... and of the smallest one."""


class _InBoxes(Unproved):
    """The counts are true, but not that each stored box holds one solution: other cells' counts
    tell more.
    """


def check_points(
    claims: CertifiedClaims,
    report: Within = lambda *_: None,
) -> str:
    """Counts and stored solutions of every cell; and for how many cells nothing was proved.

    Where a sample cannot be decided, the counts beside it are those of its cell.
    """
    number = uncounted = 0
    undecided: list[str] = []
    for n, cell in enumerate(claims.result.cells):
        report(n, len(claims.result.cells))
        where = f"at {claims.place(*cell.sample)}"
        try:
            found = check_cell(claims, cell)
        except Unproved as reason:
            undecided.append(f"cell {n} {where}: {reason}")
            uncounted += not isinstance(reason, _InBoxes)
            if uncounted == HOPELESS:
                break
            continue
        except Violation as violation:
            raise Violation(f"cell {n}, {where}: {violation}") from None
        number += found
    samples = len(claims.result.cells)
    if undecided:
        most = " or more" if uncounted == HOPELESS else ""
        return Unchecked(
            f"{len(undecided)}{most} of {samples} samples were not decided, the first one {undecided[0]}"
        )
    return f"{samples} samples, {number} equilibria"


def check_cell(claims: CertifiedClaims, cell: Cell) -> int:
    """Counts and stored solutions of one cell; how many these are.

    Raises
    ------
    Violation, Unproved
    """
    try:
        there = claims.counting.at(*cell.sample)
    except Unproved as reason:
        return _check_beside(claims, cell, reason)
    if stored(cell) != there.counts:
        raise Violation(f"said to have {stored(cell)}; there are {there.counts}")
    kept = [
        e
        for e in there.found
        if not kind_of(claims.result.slice.count).is_of_stable or "-" not in e.signs
    ]
    if len(cell.solutions) != len(kept):
        raise Violation(f"{len(cell.solutions)} boxes of solutions for {len(kept)} equilibria")
    try:
        _check_boxes(claims, cell, kept)
    except Unproved as reason:
        raise _InBoxes(str(reason)) from reason
    return len(kept)


def _near(claims: CertifiedClaims, cell: Cell) -> list[tuple[Fraction, Fraction]]:
    """Points of a sample's cell near the sample; none where it is very near to a rectangle of the
    cover.
    """
    u, v = claims.lattice.on(*cell.sample)
    half = claims.room(
        u, v, Fraction(claims.sweep.steps, _PARTS), Fraction(claims.sweep.steps, _MIN_PARTS)
    )
    return [
        claims.lattice.off(u + half * i / 4, v + half * j / 4) for i, j in (_PLACES if half else ())
    ]


def _decided(claims: CertifiedClaims, cell: Cell) -> tuple[Fraction, Fraction] | None:
    """The first point next to an undecided sample at which the counts are decided.

    Raises
    ------
    Violation
        When these are not the cell's.
    """
    for at in _near(claims, cell)[:MAX_NEAR]:
        try:
            there = claims.counting.at(*at)
        except Unproved:
            continue
        if stored(cell) != there.counts:
            raise Violation(
                f"said to have {stored(cell)}; at {claims.place(*at)}, in the same cell, there are {there.counts}"
            )
        return at
    return None


def _check_boxes(claims: CertifiedClaims, cell: Cell, kept: Sequence[Zero]) -> None:
    """Each stored box holds one solution, each another one, and these are those that are kept.

    Raises
    ------
    Violation, Unproved
    """
    taken = set[int]()
    for k, solution in enumerate(cell.solutions):
        e = claims.counting.in_box(*cell.sample, solution, k)
        match = [i for i, other in enumerate(kept) if claims.counting.same(e, other)]
        if len(match) != 1 or match[0] in taken:
            near = in_words(e.center)
            raise Violation(f"the solution {k} near ({near}) is stored twice, or not asked for")
        _check_signs(claims, kept[match[0]].signs, solution.signs, k)
        taken.add(match[0])


def _check_signs(claims: CertifiedClaims, true: str, said: str, k: int) -> None:
    """The signs of the Hessian's eigenvalues at a solution, or of the conditions for stability.

    Raises
    ------
    Violation, Unproved
    """
    if numbers_for(claims.result.slice.count, claims.meaning) == {"total"}:
        if not said:
            return  # of solutions that are all counted nothing need be said
        if not true and len(said) == form_of(claims.result.slice).conditions_for_stability:
            raise Unproved(f"a condition for stability may be zero at the solution {k}")
    if true != said:
        raise Violation(claims.meaning.at_solution.format(k, true, said))


def _check_beside(claims: CertifiedClaims, cell: Cell, reason: Unproved) -> int:
    """The counts are those at a point beside the sample, and each stored box holds one solution,
    each another one.

    Raises
    ------
    Unproved
        When nothing beside the sample is decided, then for the reason given, or not what is in the
        boxes.
    Violation
    """
    said = cell.stable if cell.total is None else cell.total
    if len(cell.solutions) != said:
        raise Violation(f"{len(cell.solutions)} boxes of solutions for {said} that are counted")
    negative = Counter(solution.signs.count("-") for solution in cell.solutions)
    if cell.index is not None and any(negative[k] != number for k, number in enumerate(cell.index)):
        raise Violation(
            f"the signs of the listed solutions are not those of the index {cell.index}"
        )
    in_boxes = why_not_listed(claims, cell)
    if (found := _decided(claims, cell)) is None:
        raise reason
    if in_boxes is not None:
        raise _InBoxes(f"{reason}; the counts are those at {claims.place(*found)}") from in_boxes
    return len(cell.solutions)


def why_not_listed(claims: CertifiedClaims, cell: Cell) -> Unproved | None:
    """Why it is not decided of a stored box that it holds one solution of its signs; None where all
    do.

    Raises
    ------
    Violation
        When one does not, or two hold the same.
    """
    counting = claims.counting
    undecided: Unproved | None = None
    known = list[Zero]()
    for k, solution in enumerate(cell.solutions):
        try:
            zero = counting.in_box(*cell.sample, solution, k)
            if counting.form.is_gradient:
                _check_signs(claims, zero.signs, solution.signs, k)
            if any(counting.same(zero, other) for other in known):
                raise Violation(f"the solution {k} is stored twice")
        except Unproved as reason:
            undecided = undecided or reason
            continue
        known.append(zero)
    return undecided
