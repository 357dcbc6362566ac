"""Every branch by which a check of an exact map rejects it is reached, and says what is wrong."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache, partial
from typing import Any

import pytest
from flint import arb, arb_poly, arb_series, ctx, fmpq
from support.replacing import replace

from forger.consistency import drop, put, swapped, with_plan
from forger.maps import named
from ptmcad.answer.counts import Counts
from ptmcad.answer.regionmap import (
    HARMLESS,
    NO_POINT,
    Adjacency,
    Cell,
    Component,
    Continuum,
    CriticalValue,
    Kind,
    Merge,
    NonAdjacency,
    PlanStep,
    Reason,
    Region,
    RegionMap,
    Stack,
    Status,
    Wall,
)
from ptmcad.model import known_of
from ptmcad.question.slice import Axis, Count, Point
from ptmcad.text.expressions import axis, constant
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.parsing import parse
from ptmcad.text.plane import PlanePolynomial
from ptmcad.verification.adjacencies import (
    check_adjacencies,
    check_no_adjacency_missing,
    check_non_adjacencies,
)
from ptmcad.verification.areaclaims import check_areas
from ptmcad.verification.claims import Claims
from ptmcad.verification.disks import BallsTooWide, _series
from ptmcad.verification.equationtexts import check_system
from ptmcad.verification.fibrealgebra import SolutionAlgebra
from ptmcad.verification.merging import check_merges, check_regions, check_shape
from ptmcad.verification.norms import check_irreducible, check_norm
from ptmcad.verification.parameterclaims import check_boundary, check_text
from ptmcad.verification.planclaims import check_plan
from ptmcad.verification.projections import check_critical_values, check_stacks
from ptmcad.verification.report import Unchecked, Violation
from ptmcad.verification.solutions import check_counts, check_solutions
from ptmcad.verification.wallintegrals import IntegralEffort, _along
from ptmcad.verification.windowsigns import check_left_out

Change = Callable[[RegionMap], RegionMap]
Check = Callable[[Claims], str]
boundary: Check = partial(check_boundary, seed="branches")
norm: Check = partial(check_norm, seed="branches")


@cache
def the(name: str) -> RegionMap:
    return named(name)


def across(r: RegionMap, k: int = 0) -> int:
    """The number of the k-th adjacency of cells of neighbouring stacks."""
    return [n for n, a in enumerate(r.adjacencies) if a.segment is not None][k]


def inside(r: RegionMap) -> int:
    return next(n for n, a in enumerate(r.adjacencies) if a.segment is None)


def of(table: str, k: int, **changes: Any) -> Change:
    """An entry of a table with other values."""
    return lambda r: replace(r, **{table: put(getattr(r, table), k, **changes)})


def with_system(**changes: Any) -> Change:
    return lambda r: replace(r, system=replace(r.system, **changes))


def with_slice(**changes: Any) -> Change:
    return lambda r: replace(r, slice=replace(r.slice, **changes))


def with_text(name: str, text: str) -> Change:
    return lambda r: replace(r, slice=replace(r.slice, text={**r.slice.text, name: text}))


def with_values(**values: int) -> Change:
    """Parameters that are constants, with their texts."""

    def change(r: RegionMap) -> RegionMap:
        parameters = {**r.slice.parameters, **{n: constant(v) for n, v in values.items()}}
        text = {**r.slice.text, **{n: str(v) for n, v in values.items()}}
        return replace(r, slice=replace(r.slice, parameters=parameters, text=text))

    return change


def with_segment(*segment: Callable[[RegionMap, Any], Fraction]) -> Change:
    def change(r: RegionMap) -> RegionMap:
        k = across(r, 2)
        new = tuple(part(r, r.adjacencies[k].segment) for part in segment)
        return replace(r, adjacencies=put(r.adjacencies, k, segment=new))

    return change


def other_height(r: RegionMap) -> Fraction:
    return r.slice.axes[1 - r.base].high + 1


def height_on_the_way(r: RegionMap) -> RegionMap:
    """A segment from sample to sample of its stacks, at a height at which a curve crosses it."""
    claims = Claims(r)
    other = r.slice.axes[1 - r.base]
    for k, a in enumerate(r.adjacencies):
        if a.segment is not None:
            low, high = (r.cells[n].sample[r.base] for n in (a.first, a.second))
            for step in range(1, 40):
                v = other.low + (other.high - other.low) * Fraction(step, 40)
                if (
                    claims.met_by(from_fraction(low), from_fraction(high), from_fraction(v))
                    is not None
                ):
                    return replace(r, adjacencies=put(r.adjacencies, k, segment=(low, high, v)))
    raise AssertionError("no curve runs to a critical value")


def kind_of(k: int, kind: Kind) -> Change:
    return of("components", k, kind=kind)


def more_components(*more: Component) -> Change:
    return lambda r: replace(r, components=(*r.components, *more))


def first(r: RegionMap, **what: Any) -> int:
    """The number of the first component with these entries."""
    return next(
        k for k, c in enumerate(r.components) if all(getattr(c, n) == v for n, v in what.items())
    )


def bare(r: RegionMap) -> RegionMap:
    """A partial result without cells, and without components that would separate some."""
    return replace(
        r, status=Status.PARTIAL, undetermined=Fraction(1), critical_values=(), stacks=(), cells=(), adjacencies=(),
        non_adjacencies=(), regions=(), components=tuple(replace(c, separates=False) for c in r.components),
    )  # fmt: skip


def walled(r: RegionMap) -> int:
    """The number of the first stack that has walls."""
    return next(n for n, stack in enumerate(r.stacks) if stack.walls)


def half_said(change: str) -> Change:
    """That an involution made one half of the areas enough is added to the plan."""
    what = "areas on one half of the window"
    reason = f"its solutions are those of the other half, by {change}"
    return lambda r: replace(r, plan=(*r.plan, PlanStep(what, False, reason)))


NO_COUNTS: dict[str, None] = dict.fromkeys(("total", "stable", "index"))


def joined(r: RegionMap) -> RegionMap:
    """The cells of the second region are in the first one, and it is said to have them, with no
    counts in common; so as many are stored.
    """
    cells = tuple(replace(c, region=0 if c.region == 1 else c.region) for c in r.cells)
    members = tuple(n for n, c in enumerate(cells) if c.region == 0)
    return replace(
        r, cells=cells, regions=put(put(r.regions, 0, cells=members, **NO_COUNTS), 1, cells=())
    )


FOLD = {"L1": 1, "L2": 1, "rho": 1, "k1": 1, "k2": 1, "k3": 1, "F3": 0, "F4": 0, "F3x": 0, "F4x": 0}
"""Where three equilibria become one, so that det H vanishes at a solution."""
LINE = PlanePolynomial.of([(1, 0, 1), (0, 0, -1000)])
DIAGONAL = PlanePolynomial.of([(1, 0, 1), (0, 1, -1)])


@cache
def diagonal() -> RegionMap:
    """The unit square, parted by its diagonal into two triangles, which are exactly a half each."""
    r = the("fig2")
    names = r.slice.axis_names
    axes = (Axis(names[0], Fraction(0), Fraction(1)), Axis(names[1], Fraction(0), Fraction(1)))
    half = Fraction(1, 2)
    cells = tuple(
        Cell(0, n, Point(names, half, v), n, 4, 1 + n, (1 + n, 2, 1 - n))
        for n, v in enumerate((Fraction(1, 4), Fraction(3, 4)))
    )
    bounds = (half - Fraction(1, 1000), half + Fraction(1, 1000))
    regions = tuple(
        Region(c.stable, c.total, c.index, bounds, (n,), c.sample) for n, c in enumerate(cells)
    )
    return replace(
        r, slice=replace(r.slice, axes=axes), base=0, components=(Component(DIAGONAL, Kind.CRITICAL, "", True),),
        critical_values=(), stacks=(Stack(None, None, half, (Wall(0, 0),), (0, 1)),), cells=cells, regions=regions,
        adjacencies=(Adjacency(0, 1, 0, None, Merge.SEPARATED),), non_adjacencies=(),
    )  # fmt: skip


def halves() -> RegionMap:
    """The unit square, parted into a left and a right half by a line over a critical value: no wall
    is integrated.
    """
    r = diagonal()
    value = CriticalValue((-1, 2), HALF, HALF, "")
    return replace(
        r, critical_values=(value,), adjacencies=(),
        stacks=tuple(Stack(*ends, Fraction(1 + 2 * n, 4), (), (n,)) for n, ends in enumerate(((None, 0), (0, None)))),
    )  # fmt: skip


def point(r: RegionMap, u: Fraction, v: Fraction) -> Point:
    return Point(r.slice.axis_names, *((u, v) if r.base == 0 else (v, u)))


def sample_at(n: int, u: Fraction | None, v: Fraction | None) -> Change:
    """A cell's sample with another coordinate on the base axis, or the other one."""

    def change(r: RegionMap) -> RegionMap:
        old = r.cells[n].sample
        a, b = old[r.base] if u is None else u, old[1 - r.base] if v is None else v
        return replace(r, cells=put(r.cells, n, sample=point(r, a, b)))

    return change


def area(k: int, low: Fraction, high: Fraction) -> Change:
    return of("regions", k, area=(low, high))


HALF = Fraction(1, 2)
NEAR = Fraction(1, 1000)
TINY = Fraction(1, 10**50)
ALMOST_ONE = 1 + Fraction(1, 10**15)
"""The most that an upper bound of an area may be in a window of area 1."""

SHAPE: list[tuple[str, Change, str]] = [
    ("fig3", lambda r: replace(r, status=Status.CERTIFIED), "the status 'certified' cannot be checked"),
    ("fig3", lambda r: replace(r, undetermined=HALF), "0.5 of the window is said to be undetermined, but all cells"),
    ("fig3", with_slice(model=known_of("other")), "the mechanism 'other' is not known"),
    ("fig3", with_slice(count=Count.ADMISSIBLE), "an exact map has no admissible counts"),
    *(("fig3", partial(lambda name, r: with_slice(parameters={n: e for n, e in {**r.slice.parameters, "L3": constant(1)
        }.items() if n != name})(r), name), "its parameters are others") for name in ("F3", "")),
    ("fig3", lambda r: replace(r, base=2), "the window is empty"),
    ("fig3", lambda r: with_slice(axes=put(r.slice.axes, 0, low=r.slice.axes[0].high))(r), "the window is empty"),
    ("fig3", of("cells", 0, further={"admissible": 0}), "counts of admissible equilibria"),
    ("fig3", of("regions", 0, further={"admissible": 0}), "counts of admissible equilibria"),
    ("fig3", lambda r: replace(bare(r), status=Status.EXACT), "there are no stacks"),
    *(("fig3", partial(lambda name, r: replace(bare(r), **{name: getattr(r, name)}), name), "there are no stacks")
      for name in ("critical_values", "cells", "adjacencies", "non_adjacencies", "regions")),
    ("fig3", lambda r: replace(bare(r), components=r.components), "said to separate regions"),
    ("fig3", lambda r: replace(r, critical_values=r.critical_values[1:]), "5 critical values do not part 7 stacks"),
    ("fig3", of("stacks", 1, left=4), "stack 1 is said to lie between critical values 4 and 1, not 0 and 1"),
    ("fig3", of("stacks", 0, cells=(7,)), "stack 0 has cells"),
    ("fig2", of("stacks", 0, walls=(Wall(99, 0),) * 2), "on component 99, which is not used"),
    ("fig3", lambda r: of("stacks", walled(r), walls=(Wall(first(r, left_out=NO_POINT), 0),) * len(
        r.stacks[walled(r)].walls))(r), "which is not used"),
    ("fig3", lambda r: replace(r, cells=r.cells[:-1]), "is not the one at level"),
    ("fig3", of("cells", 0, level=5), "cell 0 is not the one at level 0 of stack 0"),
    ("fig3", lambda r: replace(r, cells=(*r.cells, r.cells[0])), "12 cells are stored, the stacks have 11"),
    ("fig3", of("adjacencies", 0, first=99), "adjacency 0 joins cells 99 and"),
    ("fig3", of("adjacencies", 0, component=99), "adjacency 0 names component 99"),
    ("fig3", of("cells", 0, region=99), "cell 0 is in region 99, which is not there"),
]  # fmt: skip

OTHERS: list[tuple[Check, str, Change, str]] = [
    (check_text, "fig3", lambda r: with_slice(text={**r.slice.text, "L9": "1"})(r), "lacks the text"),
    (check_text, "fig3", lambda r: replace(r, slice=replace(r.slice, parameters={**r.slice.parameters,
        r.slice.axes[0].name: constant(1)})) if r.slice.axes[0].name in r.slice.parameters
        else with_slice(axes=(replace(r.slice.axes[0], name="L1"), r.slice.axes[1]))(r), "is an axis, but"),
    (check_text, "fig3", lambda r: with_slice(parameters={**r.slice.parameters, "k": constant(3)},
        text={n: "3" if n == "k" else t.replace("k", "100") for n, t in {**r.slice.text, "k": "3"}.items()})(r),
     "the parameter k is stored, but nothing depends on it"),
    (check_text, "fig3", with_text("L1", "L9"), "the texts kept for L1 name what is not explained"),
    (check_text, "fig3", with_text("L1", "1/0"), "the text kept for 'L1', '1/0', is no expression"),
    (check_text, "fig3", with_text("L1", "$"), "the text kept for 'L1', '.', is no expression"),
    (check_text, "fig3", with_text("L1", "2"), "L1 was written as '2', but is 1"),
    (check_system, "fig3", with_system(potential="a b"), "the stored potential cannot be read: "),
    (check_system, "fig3", with_system(potential=" + ".join(["L1"] * 20_001)), "the stored potential differs"),
    (check_system, "fig3", with_system(potential="10*" + " + ".join(["L1"] * 20_000)), "the stored potential differs"),
    (check_system, "fig3", with_system(potential="100*" + " + ".join(["L1"] * 20_000)), "the stored potential differs"),
    (check_system, "fig3", with_system(potential="0*L1"), "the stored potential differs"),
    (check_system, "fig3", with_system(potential="L9"), "the stored potential names 'L9'"),
    (check_system, "fig3", with_system(unknowns=("a",)), "the unknowns are"),
    (check_system, "fig3", with_system(moments=("17*L1",)), "moments are stated, which are in the equations"),
    (check_system, "fig3", with_system(hessian=()), "there are 2 rows of derivatives"),
    (check_system, "fig3", lambda r: with_system(relations=r.system.relations[::-1])(r), "the relations are"),
    (check_system, "fig3", with_system(potential="L1"), "the stored potential differs from the mechanism's"),
    (check_irreducible, "fig3", more_components(Component(PlanePolynomial(((0, 0, 3),)), Kind.CRITICAL)), "a constant"),
    (check_irreducible, "fig3", more_components(Component(PlanePolynomial(()), Kind.CRITICAL)), "a constant"),
    (check_irreducible, "fig3", more_components(Component(PlanePolynomial(((1, 0, -2),)), Kind.CRITICAL)),
     "is not primitive with a positive first coefficient"),
    (check_irreducible, "fig3", more_components(Component(PlanePolynomial.of([(2, 0, 1), (0, 2, -1)]), Kind.CRITICAL)),
     "is not irreducible"),
    (check_irreducible, "fig3", lambda r: replace(r, components=(*r.components, r.components[0])), "is stored twice"),
    (norm, "fig3", lambda r: replace(r, complex_solutions=8), "complex solutions at .*, not 8"),
    (norm, "fig3", with_values(**FOLD), "det H vanishes at .*, which is on no stored component"),
    (norm, "fig3", more_components(Component(LINE, Kind.CRITICAL)), "is no factor of the norm of det H"),
    (norm, "fig3", kind_of(0, Kind.INFINITY), "component 0 is said to be at infinity, but det H vanishes on it"),
    (norm, "fig3", lambda r: replace(r, components=r.components[1:]), "a curve of the variety is missing or wrong"),
    (norm, "fig3", more_components(Component(LINE, Kind.INFINITY)), "solutions have no pole on it"),
    (norm, "fig3", of("components", 0, left_out=HARMLESS), "component 0 is said to be harmless, but det H may vanish"),
    (norm, "fig3", with_values(k1=0, k2=0, k3=0, F3=0, F4=0), "there are infinitely many solutions at"),
    (boundary, "fig3", lambda r: replace(r, components=drop(r.components, first(r, kind=Kind.BOUNDARY))),
     "is not stored, but it bounds the domain of|is not stored, but equation"),
    (boundary, "fig3", lambda r: kind_of(first(r, kind=Kind.BOUNDARY), Kind.CRITICAL)(r), "stored as critical,"),
    (boundary, "fig3", of("components", 0, continuum=Continuum.POSSIBLE), "component 0 is said to have perhaps"),
    (boundary, "fig3", kind_of(0, Kind.BOUNDARY), "component 0 is stored as boundary, but bounds nothing"),
    (check_left_out, "fig3", of("components", 0, left_out="it is ugly"), "for a reason that cannot be checked"),
    (check_left_out, "fig3", of("components", 0, left_out=NO_POINT), "is left out, but runs through the window"),
    (check_plan, "fig3", lambda r: replace(r, plan=r.plan[1:]), "the plan has 12 steps, not 13"),
    (check_plan, "fig3", of("plan", 0, reason="nobody asked"), "step 0 of the plan is not"),
    (check_plan, "fig3", half_said("nosuch -> -nosuch"), "the plan has 14 steps, not 13"),
    (check_plan, "fig3+no-areas", half_said("L1 -> -L1"), "the plan has 14 steps, not 13"),
    (check_plan, "fig3", of("plan", 0, what="nothing"), "step 0 of the plan is not"),
    (check_plan, "fig3", lambda r: with_plan(of("components", first(r, left_out=NO_POINT, kind=Kind.BOUNDARY),
                                                left_out="")(r)), "is used, but it has no point in the window"),
    (check_plan, "fig3+no-areas", of("regions", 0, area=(Fraction(0), HALF)), "areas are known, but"),
    (check_left_out, "fig3", kind_of(0, Kind.AUXILIARY), "is auxiliary, but no saving was"),
    (check_critical_values, "fig3", of("critical_values", 0, polynomial=(1, 2, 3)), "is no irreducible factor"),
    (check_critical_values, "fig3", lambda r: replace(r, critical_values=swapped(r.critical_values, 0, 1)),
     "is not above the one before it"),
    (check_critical_values, "fig3", lambda r: of("critical_values", 0, low=r.critical_values[0].low / 2 + r.slice.axes[
        r.base].low / 2, high=r.critical_values[0].low / 2 + r.slice.axes[r.base].low / 2)(r), "its polynomial has 0"),
    (check_critical_values, "fig3", lambda r: replace(r, critical_values=r.critical_values[:-1]), "not stored: "),
    (check_critical_values, "fig3", of("critical_values", 0, origin="a guess"), "the origin of critical value 0 is no"),
    (check_stacks, "fig3", lambda r: of("stacks", 0, sample=r.slice.axes[r.base].high)(r), "is not between its ends"),
    (check_stacks, "fig3", lambda r: sample_at(0, None, other_height(r))(r), "are not in order inside the window"),
    (check_stacks, "fig3", sample_at(0, Fraction(1, 10**9), None), "is not over the sample of its stack 0"),
    (check_stacks, "diagonal", sample_at(0, None, HALF), "the sample of cell 0 lies on component 0"),
    (check_stacks, "diagonal", of("components", 0, polynomial=LINE), "there are roots of components"),
    (check_stacks, "diagonal", of("stacks", 0, walls=(Wall(0, 1),)), "wall 0 of stack 0 is root 0 of component 0, not"),
    (check_counts, "fig3", with_values(L1=-1), "L1 is not positive at"),
    (check_counts, "fig3", with_values(F3=0, F4=0, F3x=0, F4x=0, rho=0), "an equilibrium is degenerate|infinitely man"),
    (check_counts, "fig3", of("cells", 0, stable=9), "cell 0 is said to have"),
    (check_solutions, "fig3", of("cells", 0, solutions=()), "has 0 boxes of solutions, but"),
    (check_solutions, "fig3", lambda r: of("cells", 0, solutions=put(r.cells[0].solutions, 0, radius=Fraction(2)))(r),
     "box 0 is not a box around a point of the torus"),
    *((check_solutions, "fig3", partial(lambda changes, r: of("cells", 0, solutions=put(r.cells[0].solutions, 0,
        **changes))(r), changes), "box 0 is not a box around a point of the torus")
      for changes in ({"radius": Fraction(0)}, {"radius": 1 + Fraction(1, 10**30)}, {"center": (Fraction(1),) * 3},
                      {"center": (Fraction(3),) * 4})),
    (check_solutions, "fig3", lambda r: of("cells", 0, solutions=r.cells[0].solutions[:1] * (r.cells[0].total or 0))(r),
     "the boxes 0 and 1 of its solutions meet"),
    (check_solutions, "fig3", lambda r: of("cells", 0, solutions=put(r.cells[0].solutions, 0,
        center=(Fraction(3, 5), Fraction(4, 5), Fraction(5, 13), Fraction(12, 13))))(r), "no solution found in it"),
    (check_solutions, "fig3", lambda r: of("cells", 0, solutions=put(r.cells[0].solutions, 0, signs="??"))(r),
     "has eigenvalues of signs"),
    (check_solutions, "fig3", of("cells", 0, total=None), "boxes of solutions, but None equilibria"),
    (check_solutions, "fig3", of("cells", 0, index=None), "the solutions have index .*, the cell None"),
    (check_solutions, "fig3", of("cells", 0, index=(9, 9, 9)), "the solutions have index .*, the cell"),
    (check_adjacencies, "fig3", lambda r: replace(r, adjacencies=(*r.adjacencies, r.adjacencies[0])), "is stored twic"),
    (check_adjacencies, "fig3", lambda r: of("adjacencies", across(r), segment=None)(r), "are not neighbours in one s"),
    (check_adjacencies, "fig3", lambda r: of("adjacencies", inside(r), component=1 - (r.adjacencies[inside(r)].component
                                                                                  or 0))(r), "the wall between the ce"),
    (check_adjacencies, "fig3", lambda r: replace(r, adjacencies=drop(r.adjacencies, inside(r))), "is missing"),
    (check_adjacencies, "fig3", lambda r: of("adjacencies", across(r), second=len(r.cells) - 1)(r), "neighbouring sta"),
    (check_adjacencies, "fig3", lambda r: of("adjacencies", across(r), component=0)(r), "the segment crosses componen"),
    (check_adjacencies, "fig3", with_segment(lambda r, s: s[0], lambda r, s: s[0], lambda r, s: s[2]), "does not join"),
    (check_adjacencies, "fig3", with_segment(lambda r, s: s[0], lambda r, s: s[1], lambda r, s: other_height(r)),
     "is outside the window"),
    *((check_adjacencies, "fig3", with_segment(lambda r, s: s[0], lambda r, s: s[1], edge), "is outside the window")
      for edge in (lambda r, s: r.slice.axes[1 - r.base].low, lambda r, s: r.slice.axes[1 - r.base].high)),
    (check_critical_values, "fig3", lambda r: of("critical_values", 0, low=r.slice.axes[r.base].low)(r), "in the win"),
    (check_critical_values, "fig3", lambda r: of("critical_values", len(r.critical_values) - 1,
        high=r.slice.axes[r.base].high)(r), "in the window"),
    (check_adjacencies, "fig3", height_on_the_way, "meets the segment"),
    (check_adjacencies, "fig4", lambda r: of("adjacencies", across(r, 1), segment=r.adjacencies[across(r)].segment)(r),
     "roots below it, so it is not in cell"),
    (check_no_adjacency_missing, "fig3", lambda r: replace(r, adjacencies=drop(r.adjacencies, across(r))), "is missin"),
    (check_non_adjacencies, "fig3", lambda r: replace(r, non_adjacencies=(*r.non_adjacencies, r.non_adjacencies[0])),
     "is stored twice"),
    (check_non_adjacencies, "fig3", lambda r: replace(r, non_adjacencies=r.non_adjacencies[1:]), "is not stored"),
    (check_non_adjacencies, "fig3", lambda r: replace(r, non_adjacencies=(*r.non_adjacencies, NonAdjacency(
        0, (0,), (1,), None, None, Reason.POINT))), "is stored, but does not follow"),
    (check_non_adjacencies, "fig4", lambda r: of("non_adjacencies", next(k for k, a in enumerate(r.non_adjacencies)
        if a.below and a.left[0] != r.stacks[a.critical_value].cells[0]), below=None)(r),
     "a segment is missing, and the cells do not reach the window's edge"),
    (check_non_adjacencies, "fig4", lambda r: of("non_adjacencies", next(k for k, a in enumerate(r.non_adjacencies)
        if a.above and a.left[-1] != r.stacks[a.critical_value].cells[-1]), above=None)(r),
     "a segment is missing, and the cells do not reach the window's edge"),
    (check_non_adjacencies, "fig4", lambda r: of("non_adjacencies", next(k for k, a in enumerate(r.non_adjacencies)
        if a.below and a.above), reason=Reason.EDGE)(r), "half-branches between cells .* are not closed because"),
    (check_merges, "fig2", lambda r: of("adjacencies", inside(r), component=None)(r), "crosses no component, but"),
    (check_merges, "fig2", of("adjacencies", 0, merge=Merge.PROVEN), "is 's?e?.*', not 'proven'"),
    (check_merges, "fig3", lambda r: of("components", 0, separates=not r.components[0].separates)(r), "separate two r"),
    (check_regions, "fig3", lambda r: of("cells", r.regions[0].cells[-1], region=1)(r), "are joined, but in regions"),
    (check_regions, "fig3", lambda r: replace(r, regions=(*r.regions, r.regions[0])), "4 regions are stored, the adja"),
    (check_regions, "fig3", of("regions", 0, cells=(0,)), "region 0 is said to have cells"),
    (check_regions, "fig3", joined, r"the cells \(.*\) of region 0 are not"),
    (check_regions, "fig3", of("regions", 0, stable=9), "region 0: stable is"),
    (check_regions, "fig3", lambda r: of("regions", 0, sample=r.regions[1].sample)(r), "the sample of region 0 is not"),
    (check_areas, "diagonal", area(0, Fraction(0), Fraction(2)), "no area in the window is between"),
    (check_areas, "diagonal", area(1, HALF, ALMOST_ONE + Fraction(1, 10**30)), "no area in the window is between"),
    (check_areas, "diagonal", lambda r: replace(r, regions=(replace(r.regions[0], area=(HALF, HALF)),)), "the only re"),
    (check_areas, "diagonal", area(0, HALF - TINY, HALF - TINY), "region 0: its area is"),
    (check_areas, "diagonal", area(0, HALF - Fraction(1, 10**3), HALF - Fraction(1, 10**9)), "region 0: its area is"),
    (check_areas, "diagonal", area(0, HALF + Fraction(1, 10**9), HALF + Fraction(1, 10**3)), "region 0: its area is"),
]  # fmt: skip


def rejected(check: Check, r: RegionMap, words: str) -> None:
    with pytest.raises(Violation, match=words):
        check(Claims(r))


@pytest.mark.parametrize(
    ("name", "change", "words"), SHAPE, ids=lambda x: x[:40] if isinstance(x, str) else None
)
def test_references_of_tables_to_each_other(name: str, change: Change, words: str) -> None:
    rejected(check_shape, change(the(name)), words)


@pytest.mark.parametrize(
    ("check", "name", "change", "words"),
    OTHERS,
    ids=lambda x: x[:40] if isinstance(x, str) else None,
)
def test_rejecting_branches(check: Check, name: str, change: Change, words: str) -> None:
    true = diagonal() if name == "diagonal" else the(name)
    rejected(check, change(true), words)


@pytest.mark.parametrize(
    ("made", "change"),
    [
        (diagonal, area(0, Fraction(0), HALF + NEAR)),
        (diagonal, area(1, HALF - NEAR, ALMOST_ONE)),
        (halves, area(0, HALF, HALF + NEAR)),
        (halves, area(1, HALF - NEAR, HALF)),
    ],
)
def test_bounds_of_areas_may_be_at_the_very_edge(
    made: Callable[[], RegionMap], change: Change
) -> None:
    """At nothing, at the window's area with its rounding, and at the region's own area where it is
    found exactly.
    """
    assert check_areas(Claims(change(made()))).startswith("2 enclosures within the stored bounds")


def test_a_box_may_be_as_wide_as_a_circle() -> None:
    """It has one solution as long as no other box meets it: of radius 1 about one of six, the
    others far away.
    """
    r = the("fig3")
    check_solutions(
        Claims(of("cells", 0, solutions=put(r.cells[0].solutions, 0, radius=Fraction(1)))(r))
    )


@pytest.mark.parametrize("above", [Fraction(1, 10**90), Fraction(1, 1000)])
def test_bounds_that_begin_with_the_area_itself_are_not_checked(above: Fraction) -> None:
    """No enclosure is within them, and none is off them."""
    assert isinstance(check_areas(Claims(area(0, HALF, HALF + above)(diagonal()))), Unchecked)


def test_a_base_that_is_the_second_axis_is_no_fault() -> None:
    check_plan(Claims(the("7")))


def test_the_diagonal_is_true_where_it_is_used() -> None:
    for check in (
        check_stacks,
        check_areas,
        check_adjacencies,
        check_merges,
        check_regions,
        check_irreducible,
    ):
        check(Claims(diagonal()))


def test_a_point_at_a_pole() -> None:
    r = the("fig3")
    known = {name: axis(k) for k, name in enumerate(r.slice.axis_names)}
    parameters = {**r.slice.parameters, "L1": parse(f"1/{r.slice.axis_names[0]}", known)}
    with pytest.raises(Violation, match=r"zero|pole"):
        Claims(with_slice(parameters=parameters)(r)).fibre_at(Fraction(0), Fraction(1))


def test_counts_without_a_zero_euler_sum_are_a_fault_of_the_check(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(SolutionAlgebra, "counts", lambda self: Counts(3, 2, (2, 1, 0)))
    rejected(check_counts, the("fig3"), "the Euler sum of")


def test_a_degenerate_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SolutionAlgebra, "counts", lambda self: None)
    rejected(check_counts, the("fig3"), "an equilibrium is degenerate at")


def test_branches_that_are_not_told_apart_ask_for_more_precision() -> None:
    """Of (v - 1)^2 = u^2 + d^2: where the slope by v is zero, halfway between them; and on one that
    rounding blurs.
    """
    distance = arb(2) ** -20
    rows = [arb_poly([1 - distance * distance, 0, -1]), arb_poly([-2]), arb_poly([1])]
    blurred = [rows[0] + arb(0, 2.0**-40), *rows[1:]]
    effort = IntegralEffort(arb(2) ** -20, fmpq(1, 2**20), (fmpq(0), fmpq(2)), (fmpq(0), fmpq(1)))
    with ctx.workprec(64):
        with pytest.raises(BallsTooWide):
            _series(rows, arb_series([arb(1)], prec=3), 3)
        with pytest.raises(BallsTooWide):
            _along(blurred, fmpq(1, 8), 1 + distance, 2, effort)
        assert (
            _along(rows, fmpq(1, 8), 1 + distance, 2, effort) is None
        )  # but not where it is known well
