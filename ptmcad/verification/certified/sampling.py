"""Checks of the free area of a certified map: at random places, that counts are what they should be and stay so nearby.

Guarantee: over each box that is counted as proved, every equilibrium that the map counts persists with nonzero
determinant of its Hessian, and there are no others; so no curve at which the count changes enters the box. A place
where this was not proved is counted apart, and never as proved.

Half of the places are uniform in the cells, half beside rectangles of the cover. The boxes do not meet the cover.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from fractions import Fraction

from ptmcad.cover import Rectangle
from ptmcad.numerals import text_of
from ptmcad.slice import Count
from ptmcad.verification.certified.equilibria import Equilibrium, Unproved, equilibria
from ptmcad.verification.certified.parameters import energy_over, exact, values_at
from ptmcad.verification.certified.points import MINIMA, Counts, admissible, all_equilibria, counts_of, differs, stored
from ptmcad.verification.certified.structure import CertifiedClaims
from ptmcad.verification.report import Violation

WIDEST = 512
"""The first box tried has at most this part of the window's width on each side of its middle."""
ATTEMPTS = 9
BUDGET = 12_000
"""Squares of the torus for one box."""
_LOOKS = 400
"""Random places looked at for one that is free."""


@dataclass(frozen=True, slots=True)
class Place:
    """A box in lattice steps, within one cell: its middle and half its width."""

    u: int
    v: int
    half: int
    cell: int


def check_boxes(claims: CertifiedClaims, seed: str, number: int) -> str:
    """Try so many random boxes; what was found, and for how many places nothing was proved."""
    rng = random.Random(seed)
    proved = points = missing = 0
    area = Fraction(0)
    if not claims.result.cells:
        return "there are no cells"
    for k in range(number):
        place = _place(claims, rng, beside=k % 2 == 1)
        if place is None:
            missing += 1
            continue
        there = _check_point(claims, place, place.u, place.v)
        points += 1
        half = _constant_over(claims, place, there)
        if half is not None:
            proved += 1
            area += Fraction((2 * half) ** 2, claims.sweep.steps**2)
            continue
        # where constancy is not proved, a change of the count would show in a corner
        for side1 in (-1, 1):
            for side2 in (-1, 1):
                _check_point(claims, place, place.u + side1 * place.half, place.v + side2 * place.half)
        missing += 1
    share = f"{100 * float(area):.2g} % of the window"
    text = f"{proved} boxes, {share}, {points} points; seed {seed}"
    return text + f"; {missing} places not checked" if missing else text


def _place(claims: CertifiedClaims, rng: random.Random, beside: bool) -> Place | None:
    """A random free place in a cell; None when none was met with."""
    cover = claims.result.cover
    assert cover is not None
    steps = cover.steps
    beside = beside and bool(cover.rectangles)
    for _ in range(_LOOKS):
        if beside:
            u, v = _outside(cover.rectangles[rng.randrange(len(cover.rectangles))], rng)
        else:
            u, v = rng.randrange(1, steps), rng.randrange(1, steps)
        if not (0 < u < steps and 0 < v < steps):
            continue
        component = claims.sweep.locate(Fraction(u), Fraction(v))
        if component is None or component not in claims.cell_of:
            continue
        half = max(1, steps // WIDEST)
        while half and not claims.sweep.free_around(u, v, half):
            half //= 2
        return Place(u, v, half, claims.cell_of[component])
    return None


def _outside(rectangle: Rectangle, rng: random.Random) -> tuple[int, int]:
    """A point near an edge of a rectangle, outside of it."""
    left, right, bottom, top = rectangle
    away = 1 + int(max(right - left, top - bottom) * 2 ** rng.uniform(-3, 4))
    u, v = rng.randint(left, right), rng.randint(bottom, top)
    return rng.choice([(left - away, v), (right + away, v), (u, bottom - away), (u, top + away)])


def _check_point(claims: CertifiedClaims, place: Place, u: int, v: int) -> list[Equilibrium]:
    """The counts at a lattice point are those of the cell; its equilibria, none if they were not proved."""
    x, y = claims.off_lattice(Fraction(u), Fraction(v))
    values = values_at(claims, x, y)
    cell = claims.result.cells[place.cell]
    try:
        energy, found = all_equilibria(values, claims.result.slice.count)
        true = counts_of(energy, values, found, claims.result.slice.count)
    except Unproved:
        return []
    if differs(cell, true):
        one, two = claims.result.slice.axis_names
        raise Violation(f"at {one}={text_of(x)}, {two}={text_of(y)} in cell {place.cell}, which is said to have "
                        f"{stored(cell)}, there are {true}")  # fmt: skip
    return found


def _constant_over(claims: CertifiedClaims, place: Place, there: list[Equilibrium]) -> int | None:
    """Half the width of the box over which the counts were proved; None when none was small enough."""
    half = place.half
    for _ in range(ATTEMPTS):
        if half == 0:
            return None
        try:
            _prove(claims, place, half, there)
        except Unproved:
            half //= 4
            continue
        return half
    return None


def _prove(claims: CertifiedClaims, place: Place, half: int, there: list[Equilibrium]) -> None:
    """Prove the cell's counts for every point of the box.

    Raises
    ------
    Unproved
        When the box is too large, or the counts change in it.
    Violation
        When they are proved to be others.
    """
    slice = claims.result.slice
    low, high = (claims.off_lattice(Fraction(place.u + d), Fraction(place.v + d)) for d in (-half, half))
    x, y = (exact(low[i]).union(exact(high[i])) for i in (0, 1))
    energy = energy_over(slice, x, y)
    # squares much smaller than the box of parameters are excluded no better than larger ones
    smallest = float(max(x.rad(), y.rad())) / 64
    found, _ = equilibria(energy, slice.count in MINIMA, budget=BUDGET, smallest=max(smallest, 2.0**-30), near=there)
    kinds = [e.signs for e in found]
    stable = kinds.count("++")
    cell = claims.result.cells[place.cell]
    if slice.count is Count.STABLE:
        true = Counts(None, stable, None, None)
    elif slice.count is Count.ADMISSIBLE:
        true = Counts(None, stable, None, sum(admissible(energy, e) for e in found if e.signs == "++"))
    else:
        index = (stable, kinds.count("+-"), kinds.count("--"))
        true = Counts(len(kinds), stable, index, None)
    if differs(cell, true):
        raise Violation(f"cell {place.cell} does not have {true}, as is proved for the box around "
                        f"({float(x.mid()):.9g}, {float(y.mid()):.9g})")  # fmt: skip
