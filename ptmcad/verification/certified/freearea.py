"""The check of the free area: how much of it is proved free of critical curves, and where that
could not be done.

Guarantee: of the free area, which is what the map's cells are, at least the reported share has no
critical point over it. A violation is a point of a cell with other counts than the cell's.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

from ptmcad.verification.certified.coverclaims import CertifiedClaims
from ptmcad.verification.certified.sampling import check_point
from ptmcad.verification.exclusion.pieces import Pieces, pieces_in
from ptmcad.verification.normalform.boxes import Unproved
from ptmcad.verification.report import Unchecked, Within

EFFORT, MAX_EFFORT = 2, 10
BOXES_AT_FIRST, GROWTH = 10_000, 4
"""Boxes of the first effort, and how many times more each further one has; the last one has no
limit.
"""
MIN_BOX = 2.0**-20
"""Share of the window: boxes over less are not halved ..."""
FINER = 2.0**-28
"""... but for those that are left then, in a further search of some boxes more."""
_FINER_BOXES = 20_000
_PLACES = 12
_STEPS_AWAY = (4, 64)
_SQUARES = 1024
"""Of the window's width: boxes that are left in one square are one place."""


def check_free_area(
    effort: int,
    claims: CertifiedClaims,
    report: Within = lambda *_: None,
) -> str:
    """Exclude critical points over the free area; what share of it is proved, and where nothing
    was.

    Parameters
    ----------
    effort : from 0, nothing, to `MAX_EFFORT`, all.

    Raises
    ------
    Violation
        With a point whose counts are not those of its cell.
    """
    if not claims.result.cells:
        return "there are no cells"
    if effort <= 0:
        return Unchecked("not asked for (effort 0)")
    # here, as they load numba
    from ptmcad.verification.exclusion.criticalsystems import systems_of
    from ptmcad.verification.exclusion.running import search

    try:
        systems = systems_of(claims.lattice)
    except Unproved as reason:
        return Unchecked(str(reason))
    pieces = pieces_of(claims)
    budget = (
        BOXES_AT_FIRST * GROWTH ** (effort - 1) // len(systems) if effort < MAX_EFFORT else 2**62
    )
    left, looked = list[Any](), 0
    for k, system in enumerate(systems):

        def progress(share: float, k: int = k) -> None:
            report(int(1000 * (k + share)), 1000 * len(systems))

        unseen, stuck, number = search(
            system, pieces, system.start[None], budget, MIN_BOX, progress
        )
        looked += number
        left.append(unseen)
        if len(stuck):
            _refute(claims, stuck)
            unseen, stuck, number = search(system, pieces, stuck, _FINER_BOXES, FINER)
            _refute(claims, stuck)
            left += [unseen, stuck]
            looked += number
    return _in_words(claims, left, pieces, f"{looked} boxes, effort {effort}")


def _in_words(claims: CertifiedClaims, left: Sequence[Any], pieces: Pieces, text: str) -> str:
    """What share of the free area is proved, with boxes left by the searches."""
    from ptmcad.verification.exclusion.running import share_over  # loads numba

    places = [boxes for boxes in left if len(boxes)]
    if not places:
        return f"100 % of the free area is proved free of critical curves; {text}"
    free = sum(claims.sweep.areas[component] for component in claims.cell_of)
    share = 1 - share_over(places, pieces) * claims.sweep.steps**2 / float(max(free, 1))
    text = f"{_percent(share)} % of the free area is proved free of critical curves; {text}"
    largest = max(places, key=lambda boxes: float((boxes[:, 0, 1] - boxes[:, 0, 0]).max()))
    where = _where(claims, *_middle(largest[(largest[:, 0, 1] - largest[:, 0, 0]).argmax()]))
    return Unchecked(f"{text}; not, among others, around {where}")


def _percent(share: float) -> str:
    """Rounded down, with so many digits that it is not 100."""
    share = max(0.0, share)
    for digits in range(1, 13):
        scale = 10**digits
        floor = int(share * 100 * scale) / scale
        if 100 - floor > 2 / scale or floor == 0:
            return f"{floor:.{digits}f}"
    return "99.999999999"


def _where(claims: CertifiedClaims, u: Fraction, v: Fraction) -> str:
    x, y = claims.lattice.off(u, v)
    one, two = claims.result.slice.axis_names
    return f"{one}={float(x):.9g}, {two}={float(y):.9g}"


def _middle(box: Any) -> tuple[Fraction, Fraction]:
    return Fraction(float(box[0].mean())), Fraction(float(box[1].mean()))


def _refute(claims: CertifiedClaims, boxes: Any) -> None:
    """Look at the counts on all sides of places at which critical points could not be excluded.

    Raises
    ------
    Violation
        With a point whose counts are not those of its cell.
    """
    for u, v, width in _places(boxes, claims.sweep.steps):
        for steps in _STEPS_AWAY:
            away = steps * width
            for du, dv in ((away, 0), (-away, 0), (0, away), (0, -away)):
                _check_at(claims, u + du, v + dv)


def _places(boxes: Any, steps: int) -> Iterator[tuple[Fraction, Fraction, Fraction]]:
    """Boxes in the midst of some squares: a point, and the box's width.

    Half of the squares are those with most boxes, and the others are from all over the rest: many
    boxes are also left along lines at which nothing changes.
    """
    squares: dict[tuple[int, int], list[Any]] = {}
    for box in boxes:
        u, v = (int(box[k].mean() * _SQUARES / steps) for k in (0, 1))
        squares.setdefault((u, v), []).append(box)
    ranked, half = sorted(squares.values(), key=len, reverse=True), _PLACES // 2
    rest = ranked[half:]
    for some in ranked[:half] + rest[:: max(1, len(rest) // half)][:half]:
        box = sorted(some, key=lambda b: (b[0, 0], b[1, 0]))[len(some) // 2]
        width = max(box[0, 1] - box[0, 0], box[1, 1] - box[1, 0], steps * FINER)
        yield (*_middle(box), Fraction(float(width)))


def _check_at(claims: CertifiedClaims, u: Fraction, v: Fraction) -> None:
    """The counts at a point are those of its cell, if it is in one and they can be proved."""
    if (cell := claims.cell_at(u, v)) is not None:
        check_point(claims, cell, u, v, reason="; a critical curve was found there")


def pieces_of(claims: CertifiedClaims) -> Pieces:
    """The rectangles of a map's cover, and what is free but in no cell."""
    cells, found = claims.cell_of, claims.sweep
    open_parts = [
        (item.left, item.right, low, high)
        for (low, high), row in zip(pairwise(found.lines), found.rows, strict=True)
        for item in row
        if item.free and found.component_of[item.node] not in cells
    ]
    return pieces_in([*claims.cover.rectangles, *open_parts], claims.cover.steps)
