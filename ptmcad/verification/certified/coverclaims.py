"""Checks of a certified map's form: cover, cells and regions, and what there must not be.

Guarantee: exact; the components of the cover's complement are found by
`ptmcad.verification.certified.coversweep`.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise

from ptmcad.answer.regionmap import Status
from ptmcad.cover.rectangles import Cover
from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice
from ptmcad.text.numerals import approximate_text, text_of
from ptmcad.verification.certified.counted import checked_members, contradiction_in, numbers_in
from ptmcad.verification.certified.coversweep import CoverSweep, sweep
from ptmcad.verification.certified.models import ModelCounting
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import shorthands_of
from ptmcad.verification.kinds import kind_of, numbers_for
from ptmcad.verification.normalform.lattice import SliceLattice
from ptmcad.verification.report import Violation

MAX_STEPS = 2**40
MAX_UNKNOWNS = 3


Neighbours = dict[int, list[int]]


class CertifiedClaims(Claims):
    """The result, and what follows from its cover."""

    @property
    def cover(self) -> Cover:
        """The cover, which a certified map has (`check_form`)."""
        assert self.result.cover is not None
        return self.result.cover

    @cached_property
    def sweep(self) -> CoverSweep:
        return sweep(self.cover)

    @property
    def lattice(self) -> SliceLattice:
        """That of the cover."""
        return SliceLattice(self.result.slice, self.cover.steps)

    @cached_property
    def counting(self) -> ModelCounting:
        """How the solutions of the map's model are counted."""
        return ModelCounting(self.lattice)

    def counting_of(self, count: Count) -> ModelCounting:
        """The same, of another kind of count."""
        lattice = self.lattice
        return ModelCounting(lattice._replace(slice=replace(lattice.slice, count=count)))

    @cached_property
    def square(self) -> Fraction:
        """The area of a square of the lattice."""
        width, height = self.lattice.square
        return width * height

    def cell_at(self, u: Fraction, v: Fraction) -> int | None:
        """The cell of a point in lattice steps; None where it is in none."""
        component = self.sweep.locate(u, v)
        return None if component is None else self.cell_of.get(component)

    def room(self, u: Fraction, v: Fraction, half: Fraction, least: Fraction) -> Fraction:
        """Half the width of a free square around a point, halved until there is one; 0 where none
        is wide enough.
        """
        while not self.sweep.free_around(u, v, half):
            half /= 2
            if half < least:
                return Fraction(0)
        return half

    @cached_property
    def neighbours(self) -> tuple[Neighbours, Neighbours]:
        """The clusters beside each component, and the components around each cluster."""
        beside: Neighbours = defaultdict(list)
        around: Neighbours = defaultdict(list)
        for component, cluster in sorted(self.sweep.touching):
            beside[component].append(cluster)
            around[cluster].append(component)
        return beside, around

    @cached_property
    def cell_of(self) -> dict[int, int]:
        """The cell of each component that has one.

        Raises
        ------
        Violation
            When a sample is not in the free part of the window, or two are in one component.
        """
        found: dict[int, int] = {}
        for n, cell in enumerate(self.result.cells):
            u, v = self.lattice.on(*cell.sample)
            component = self.sweep.locate(u, v)
            if component is None:
                inside = min(u, v) > 0 and max(u, v) < self.sweep.steps
                where = "in a rectangle of the cover" if inside else "not in the window"
                raise Violation(f"the sample of cell {n} is {where}")
            if component in found:
                raise Violation(
                    f"the samples of cells {found[component]} and {n} are not parted by the cover"
                )
            found[component] = n
        return found


def check_form(claims: CertifiedClaims) -> str:
    """The entries that a certified map has, and those that it has not."""
    r = claims.result
    if r.cover is None or r.status not in (Status.CERTIFIED, Status.PARTIAL):
        raise Violation(
            f"the status is {r.status.value!r}, and there is {'no' if r.cover is None else 'a'} cover"
        )
    _check_model(r.slice)
    if any(axis.low >= axis.high for axis in r.slice.axes):
        raise Violation("the window is empty")
    for name in (
        *("components", "critical_values", "stacks", "adjacencies", "non_adjacencies"),
        *("base", "complex_solutions"),
    ):
        if getattr(r, name):
            raise Violation(f"a certified map has no {name.replace('_', ' ')}")
    steps = r.cover.steps
    if not 0 < steps <= MAX_STEPS or steps & (steps - 1):
        raise Violation(f"the lattice has {steps} steps, which is not a power of two up to 2^40")
    for left, right, bottom, top in r.cover.rectangles:
        if not (0 <= left < right <= steps and 0 <= bottom < top <= steps):
            raise Violation(f"{(left, right, bottom, top)} is not a rectangle of the lattice")
    for one, two in pairwise(r.cover.rectangles):
        if not one < two:
            raise Violation(f"the rectangles {one} and {two} are not sorted")
    needed = numbers_for(r.slice.count, claims.meaning)
    for n, cell in enumerate(r.cells):
        if (present := set(numbers_in(cell))) != needed:
            raise Violation(f"cell {n} has the counts {sorted(present)}, not {sorted(needed)}")
        if cell.stack is not None:
            raise Violation(f"cell {n} of a certified map has a stack")
        if wrong := contradiction_in(cell):
            raise Violation(f"cell {n} has {wrong}")
    return f"{len(r.cover.rectangles)} rectangles, {len(r.cells)} cells, {len(r.regions)} regions"


def _check_model(slice: Slice) -> None:
    """The model is one that the certified engine answers, and the parameters are its own."""
    model = slice.model
    needed, known = set(model.without_free_lengths), {*shorthands_of(model), *model.variables}
    if not needed <= set(slice.parameters) <= known:
        raise Violation(
            f"the mechanism {slice.mechanism!r} is not known, or its parameters are others"
        )
    if not 1 <= len(model.unknowns) <= MAX_UNKNOWNS:
        raise Violation(f"no certified map is of {len(model.unknowns)} unknowns")
    if not kind_of(slice.count).is_of(model):
        raise Violation(f"no certified map of {model.name!r} counts {slice.count.value}")


def check_components(claims: CertifiedClaims) -> str:
    """Every cell is a component of the cover's complement; the undetermined share is what the cells
    leave.
    """
    r, found = claims.result, claims.sweep
    cells = claims.cell_of
    areas = found.areas.values()
    for component, n in cells.items():
        area, level = found.areas[component], r.cells[n].level
        before = sum(other > area for other in areas)
        if not before <= level < sum(other >= area for other in areas):
            raise Violation(
                f"cell {n} is said to be component {level} by area, but {before} are larger"
            )
    levels = [cell.level for cell in r.cells]
    if len(set(levels)) != len(levels):
        raise Violation("two cells are said to be the same component")
    known = sum(found.areas[component] for component in cells)
    true = 1 - Fraction(known, found.steps**2)
    if r.undetermined != true:
        raise Violation(
            f"the undetermined share of the window is {approximate_text(true)}, not {approximate_text(r.undetermined)}"
        )
    return f"{len(found.areas)} components, {len(found.areas) - len(cells)} of them undetermined"


def check_regions(claims: CertifiedClaims) -> str:
    """Regions part the cells; each has its cells' counts, a cell's sample, and area bounds that
    hold.
    """
    r, found = claims.result, claims.sweep
    component_of = {n: component for component, n in claims.cell_of.items()}
    for number, region in enumerate(r.regions):
        members = checked_members(r, number)
        if len(members) > 1:
            raise Violation(
                f"region {number} joins cells {members}, which are not proved to be connected"
            )
        component = component_of[members[0]]
        reach, least = _reach(claims, component), found.areas[component]
        low, high = region.area
        if not (0 <= low <= least * claims.square):
            raise Violation(
                f"region {number} is said to have at least the area {text_of(low)}, but "
                f"only {approximate_text(least * claims.square)} is proved"
            )
        if high < reach * claims.square:
            raise Violation(
                f"region {number} is said to have at most the area {approximate_text(high)}, but with "
                f"what is undetermined beside it, it may have "
                f"{approximate_text(reach * claims.square)}"
            )
    if sorted(n for region in r.regions for n in region.cells) != list(range(len(r.cells))):
        raise Violation("a cell is in no region")
    return f"{len(r.regions)} regions"


def _reach(claims: CertifiedClaims, component: int) -> int:
    """The area that a region, which is a cell, has if all that is undetermined beside it belongs to
    it, in squares.

    Not its neighbours' cells, but components without a cell that only undetermined rectangles part
    from it.
    """
    found, cells = claims.sweep, claims.cell_of
    beside, around = claims.neighbours
    components, clusters, waiting = {component}, set[int](), [component]
    while waiting:
        for cluster in {*beside[waiting.pop()]} - clusters:
            clusters.add(cluster)
            more = {c for c in around[cluster] if c not in cells} - components
            components |= more
            waiting += more
    return sum(found.areas[c] for c in components) + sum(found.cluster_areas[c] for c in clusters)
