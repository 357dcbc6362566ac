"""Every branch by which a check of a certified map rejects it is reached, and says what is wrong.

The maps are made here by hand, each of two cells that a strip of the cover parts in a window
without a curve: so they need no compiled code, and there is one on every place that a proof stops
at.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache, partial
from typing import Any

import pytest
from flint import ctx
from support.counting import claims_of
from support.paper_energy import NAMES
from support.replacing import replace

import ptmcad
from forger.consistency import put
from ptmcad.answer.regionmap import (
    Adjacency,
    Cell,
    Component,
    CriticalValue,
    Kind,
    Merge,
    NonAdjacency,
    Reason,
    Region,
    RegionMap,
    Solution,
    Stack,
    Status,
    System,
)
from ptmcad.cover.rectangles import Cover, Rectangle
from ptmcad.model import known_of
from ptmcad.question.slice import Count, Point
from ptmcad.text.balls import ball_of
from ptmcad.text.expressions import axis
from ptmcad.text.parsing import parse
from ptmcad.text.plane import PlanePolynomial
from ptmcad.verification.certified.ballequations import BallEquations
from ptmcad.verification.certified.cellsamples import check_points
from ptmcad.verification.certified.counted import CellCounts, CountedPoint
from ptmcad.verification.certified.coverclaims import (
    CertifiedClaims,
    check_components,
    check_form,
    check_regions,
)
from ptmcad.verification.certified.krawczyk import zeros
from ptmcad.verification.certified.parameterdomain import check_domain
from ptmcad.verification.certified.sampling import check_boxes
from ptmcad.verification.equationtexts import check_potential
from ptmcad.verification.exclusion.places import SolutionPlaces
from ptmcad.verification.normalform.boxes import Box, Unproved
from ptmcad.verification.normalform.waves import form_of
from ptmcad.verification.report import Unchecked, Violation

Change = Callable[[RegionMap], RegionMap]
Check = Callable[[CertifiedClaims], str]

POTENTIAL = (
    "1/2*k1*(sqrt((rho - L2*cos(th2))^2 + (L2*sin(th2))^2) - l0_1)^2"
    " + 1/2*k2*(sqrt((rho - L1*cos(th1))^2 + (L1*sin(th1))^2) - l0_2)^2"
    " + 1/2*k3*(sqrt((rho - L1*cos(th1) - L2*cos(th2))^2 + (L2*sin(th2) - L1*sin(th1))^2) - l0_3)^2"
    " - F3x*L1*cos(th1) - F3*L1*sin(th1) - F4x*(rho - L2*cos(th2)) - F4*L2*sin(th2)"
)
STEPS = 8
UNEQUAL: tuple[Rectangle, ...] = ((2, 4, 0, STEPS),)
"""A strip from the window's lower to its upper edge, left of the middle: the first cell is the one
on the right.
"""
EQUAL: tuple[Rectangle, ...] = ((3, 5, 0, STEPS),)
WHERE: dict[str, tuple[str, str, dict[str, str]]] = {
    "springs": ("5/4", "1", {"L1": "1", "k": "100", "F3": "-10", "F4": "-10", "l0": "1/5"}),
    "pitchfork": ("19/20", "1", {"L1": "1", "k": "1"}),
    # with spring 3 of length 3, the others of length 5, no load and no pull
    "slack": ("3", "4", {"L1": "4", "k": "1", "l0_1": "5", "l0_2": "5", "l0_3": "3"}),
    "crease": ("1", "1", {"L1": "3/2", "k": "1", "l0": "1/5", "F3": "-1/10", "F4": "-5"}),
    "other-crease": (
        "1",
        "3/2",
        {"L1": "1.00075", "k": "1", "l0": "1/5", "F3": "-1/10", "F4": "-1/10"},
    ),
}
"""The lower left corner of the window, which has a width of a thousandth, and the parameters."""


@cache
def made(
    name: str, count: str = "stable", rectangles: tuple[Rectangle, ...] = UNEQUAL
) -> RegionMap:
    """A map near a place, with the counts and boxes that `ptmcad.verification` finds."""
    x, y, parameters = WHERE[name]
    sides = [[str(Fraction(c)), str(Fraction(c) + Fraction(1, 1000))] for c in (x, y)]
    slice = ptmcad.slice_from_mapping({
        "name": name, "mechanism": "ptm", "count": count, "parameters": parameters,
        "axes": {"rho": sides[0], "L2": sides[1]},
    })  # fmt: skip
    left, right = rectangles[0][0], STEPS - rectangles[0][1]
    window = Fraction(1, 10**6)
    r = RegionMap(
        slice=slice, status=Status.CERTIFIED, system=System(("th1", "th2"), (), POTENTIAL, (), ()),
        undetermined=1 - Fraction(left + right, STEPS), versions={}, cover=Cover(STEPS, rectangles),
    )  # fmt: skip
    claims = CertifiedClaims(r)
    cells, regions = [], []
    for n, (u, width) in enumerate(((STEPS - right + 1, right), (1, left))):
        sample = Point(("rho", "L2"), *claims.lattice.off(Fraction(u), Fraction(3)))
        there = claims.counting.at(*sample)
        c, found = there.counts, there.found
        further = {} if c.admissible is None else {"admissible": c.admissible}
        boxes = tuple(Solution((Fraction(e.center[0]), Fraction(e.center[1])), Fraction(1, 2**20), e.signs)
                      for e in found if slice.count in (Count.TOTAL, Count.INDEX) or e.signs == "++")  # fmt: skip
        cells.append(Cell(None, n, sample, n, c.total, c.stable, c.index, boxes, further))
        regions.append(
            Region(
                c.stable, c.total, c.index, (window * width / STEPS, window), (n,), sample, further
            )
        )
    return replace(r, cells=tuple(cells), regions=tuple(regions))


springs, total = partial(made, "springs"), partial(made, "springs", "total")
equal, pitchfork = partial(made, "springs", "stable", EQUAL), partial(made, "pitchfork", "total")
admissible = partial(made, "springs", "admissible")


@pytest.mark.parametrize("make", [springs, total, equal, pitchfork, admissible])
@pytest.mark.fast_cases("make0", "make4")
def test_the_maps_are_true(make: Callable[[], RegionMap]) -> None:
    report = ptmcad.verify(make(), boxes=1)
    assert report.ok, report.violation


def of(table: str, k: int, **changes: Any) -> Change:
    """An entry of a table with other values."""
    return lambda r: replace(r, **{table: put(getattr(r, table), k, **changes)})


def both(k: int, **changes: Any) -> Change:
    """A cell and its region, which have the same number here, with other counts."""
    return lambda r: of("regions", k, **changes)(of("cells", k, **changes)(r))


def having(**changes: Any) -> Change:
    return lambda r: replace(r, **changes)


def with_cover(*rectangles: Rectangle, steps: int = STEPS) -> Change:
    return having(cover=Cover(steps, rectangles))


def with_slice(**changes: Any) -> Change:
    return lambda r: replace(r, slice=replace(r.slice, **changes))


def with_axis(k: int, low: int, high: int) -> Change:
    return lambda r: with_slice(axes=put(r.slice.axes, k, low=Fraction(low), high=Fraction(high)))(
        r
    )


def without(name: str) -> Change:
    return lambda r: with_slice(
        parameters={n: e for n, e in r.slice.parameters.items() if n != name}
    )(r)


def with_parameter(name: str, text: str) -> Change:
    known = {"rho": axis(0), "L2": axis(1)}
    return lambda r: with_slice(parameters={**r.slice.parameters, name: parse(text, known)})(r)


def sample_at(n: int, u: Fraction | int, v: Fraction | int) -> Change:
    """A cell's sample at a place in lattice steps."""

    def change(r: RegionMap) -> RegionMap:
        return of(
            "cells",
            n,
            sample=Point(("rho", "L2"), *CertifiedClaims(r).lattice.off(Fraction(u), Fraction(v))),
        )(r)

    return change


def with_solution(k: int, **changes: Any) -> Change:
    """A box of the first cell."""
    return lambda r: of("cells", 0, solutions=put(r.cells[0].solutions, k, **changes))(r)


def with_system(**changes: Any) -> Change:
    return lambda r: replace(r, system=replace(r.system, **changes))


def plus(text: str) -> Change:
    """The true potential and something more."""
    return with_system(potential=f"{POTENTIAL} + {text}")


def instead(old: str, new: str) -> Change:
    assert old in POTENTIAL
    return with_system(potential=POTENTIAL.replace(old, new))


def beside(r: RegionMap) -> RegionMap:
    """The first box just touches its equilibrium, so that nobody can say whether it is in the box."""
    s = r.cells[0].solutions[0]
    return with_solution(0, center=(s.center[0] + s.radius, s.center[1]))(r)


def reaching(r: RegionMap) -> RegionMap:
    """The box of one equilibrium reaches to another one, and nobody can say whether this one is in
    it.
    """
    for j, one in enumerate(r.cells[0].solutions):
        for other in r.cells[0].solutions:
            far = max(abs(a - b) for a, b in zip(one.center, other.center, strict=True))
            if 0 < far < 1:
                return with_solution(j, radius=far)(r)
    raise AssertionError("no two equilibria are near each other")


def not_asked_for(r: RegionMap) -> RegionMap:
    """The box of a saddle among those of the minima, which are as many as there should be."""
    saddle = next(s for s in total().cells[0].solutions if s.signs == "+-")
    return of("cells", 0, solutions=(saddle, *r.cells[0].solutions[1:]))(r)


def area(k: int, low: Fraction, high: Fraction) -> Change:
    return of("regions", k, area=(low, high))


WINDOW = Fraction(1, 10**6)
"""The area of the windows of all maps."""
TINY = Fraction(1, 10**30)
LINE = Component(PlanePolynomial.of([(1, 0, 1)]), Kind.CRITICAL)
POWER = "(" * 6 + "(F3/4)" + "^9)" * 6
"""Less than 10^-20000 where the load is from 0 to 3.6, and more than 10^200000 where it is -10."""

ROWS: list[tuple[Check, Callable[[], RegionMap], Change, str]] = [
    (check_form, springs, having(status=Status.EXACT), "the status is 'exact', and there is a cover"),
    (check_form, springs, having(cover=None), "the status is 'certified', and there is no cover"),
    (check_form, springs, with_slice(model=known_of("other")), "the mechanism 'other' is not known, or its"),
    (check_form, springs, without("F3"), "the mechanism 'ptm' is not known, or its parameters are others"),
    (check_form, springs, with_parameter("L3", "1"), "the mechanism 'ptm' is not known, or its parameters are others"),
    (check_form, springs, with_axis(0, 1, 1), "the window is empty"),
    (check_form, springs, with_axis(1, 2, 1), "the window is empty"),
    (check_form, springs, having(components=(LINE,)), "a certified map has no components"),
    (check_form, springs, having(critical_values=(CriticalValue((0, 1), Fraction(0), Fraction(0), ""),)),
     "a certified map has no critical values"),
    (check_form, springs, having(stacks=(Stack(None, None, Fraction(1), (), (0,)),)), "a certified map has no stacks"),
    (check_form, springs, having(adjacencies=(Adjacency(0, 1, None, None, Merge.PROVEN),)), "map has no adjacencies"),
    (check_form, springs, having(non_adjacencies=(NonAdjacency(0, (0,), (1,), None, None, Reason.POINT),)),
     "a certified map has no non adjacencies"),
    (check_form, springs, having(base=1), "a certified map has no base"),
    (check_form, springs, having(complex_solutions=6), "a certified map has no complex solutions"),
    (check_form, springs, with_cover(*UNEQUAL, steps=0), "the lattice has 0 steps, which is not a power of two"),
    (check_form, springs, with_cover(*UNEQUAL, steps=12), "the lattice has 12 steps"),
    (check_form, springs, with_cover(*UNEQUAL, steps=2**41), "the lattice has 2199023255552 steps"),
    *((check_form, springs, with_cover(q), rf"\({', '.join(map(str, q))}\) is not a rectangle of the lattice")
      for q in ((-1, 4, 0, 8), (4, 4, 0, 8), (4, 2, 0, 8), (2, 9, 0, 8), (2, 4, -1, 8), (2, 4, 3, 3), (2, 4, 0, 9))),
    (check_form, springs, with_cover(*UNEQUAL, *UNEQUAL), r"the rectangles \(2, .*\) and \(2, .*\) are not sorted"),
    (check_form, springs, with_cover(*UNEQUAL, (0, 1, 0, 1)), r"the rectangles \(2, .*\) and \(0, .*\) are not sorted"),
    (check_form, springs, of("cells", 1, total=4), r"cell 1 has the counts \['stable', 'total'\], not \['stable'\]"),
    (check_form, admissible, of("cells", 0, further={}), r"cell 0 has the counts \['stable'\], not \['admiss"),
    (check_form, total, of("cells", 0, index=None), r"cell 0 has the counts \['stable', 'total'\], not \['index'"),
    (check_form, springs, of("cells", 1, stack=0), "cell 1 of a certified map has a stack"),
    (check_form, springs, of("cells", 1, stable=-1), "cell 1 has a negative count"),
    (check_form, admissible, of("cells", 0, further={"admissible": -1}), "cell 0 has a negative count"),
    *((check_components, springs, sample_at(1, u, v), "the sample of cell 1 is not in the window")
      for u, v in ((0, 3), (8, 3), (-1, 3), (1, 0), (1, 8), (1, 9))),
    (check_components, springs, sample_at(1, 3, 3), "the sample of cell 1 is in a rectangle of the cover"),
    (check_components, springs, sample_at(1, 2, 3), "the sample of cell 1 is in a rectangle of the cover"),
    (check_components, springs, sample_at(1, 6, 2), "the samples of cells 0 and 1 are not parted by the cover"),
    (check_components, springs, of("cells", 0, level=1), "cell 0 is said to be component 1 by area, but 0 are larger"),
    (check_components, springs, of("cells", 1, level=0), "cell 1 is said to be component 0 by area, but 1 are larger"),
    (check_components, equal, of("cells", 1, level=0), "two cells are said to be the same component"),
    (check_components, springs, having(undetermined=Fraction(1, 5)), "share of the window is 0.25, not 0.2"),
    (check_regions, springs, of("regions", 0, stable=None), "region 0: stable is 1, not None"),
    (check_regions, springs, of("regions", 0, cells=(1,)), r"region 0 is said to have cells \(1,\), not \(0,\)"),
    (check_regions, springs, of("regions", 0, cells=(0, 1)), r"region 0 is said to have cells \(0, 1\), not \(0,\)"),
    (check_regions, springs, lambda r: replace(r, regions=(*r.regions, replace(r.regions[0], cells=()))),
     r"region 2 is said to have cells \(\), not \(\)"),
    (check_regions, springs, lambda r: of("regions", 0, cells=(0, 1))(of("cells", 1, region=0)(r)),
     r"region 0 joins cells \(0, 1\), which are not proved to be connected"),
    (check_regions, springs, of("regions", 1, stable=7), "region 1: stable is ., not 7"),
    (check_regions, total, of("regions", 1, index=(1, 1, 0)), r"region 1: index is .*, not \(1, 1, 0\)"),
    (check_regions, springs, lambda r: of("regions", 0, sample=r.regions[1].sample)(r),
     "the sample of region 0 is not the sample of one of its cells"),
    (check_regions, springs, area(0, -TINY, WINDOW), "region 0 is said to have at least the area -"),
    (check_regions, springs, area(0, WINDOW / 2 + TINY, WINDOW),
     "region 0 is said to have at least .*, but only 0.0000005 is"),
    (check_regions, springs, area(0, WINDOW / 4, WINDOW * 3 / 4 - TINY), "region 0 is said to have at most the area"),
    (check_regions, springs, area(1, WINDOW / 4, WINDOW / 2 - TINY), "region 1 is said to have at most the area"),
    (check_regions, springs, lambda r: having(regions=r.regions[:1])(r), "a cell is in no region"),
    (check_domain, springs, with_parameter("F3", "1/(rho - 1.2503)"), "F3 has a pole in the window"),
    (check_domain, springs, with_parameter("L1", "rho - 1.2503"), "L1 is not positive somewhere in the window"),
    (check_domain, springs, with_parameter("l0_1", "rho - 1.2503"), "l0_1 is negative somewhere in the window"),
    (check_domain, springs, with_parameter("rho", "rho - 1.2503"), "rho is not positive somewhere in the window"),
    (check_potential, springs, with_system(unknowns=("th2", "th1")), "the unknowns are"),
    (check_potential, springs, with_system(relations=("1",)), "there are 0 of the kind relation n, not 1"),
    (check_potential, springs, with_system(gradient=("1",)), "there are 0 of the kind equation n, not 1"),
    (check_potential, springs, with_system(hessian=(("1",),)), "a Hessian is stated"),
    *((check_potential, springs, plus(text), "the stored potential cannot be read: ")
      for text in ("0*\N{GREEK SMALL LETTER ALPHA}", "1.5.2", "0 # L1", "0\n", "0\0", "0x0", "0*1_0", "L1 % L2",
                   "cos(th1, th2)", "0if L1 else 0", "0*L1[0]", "0*L1.real", "exit()", "(0 if L1 else 0)", "01", "1 +",
                   "((1)", "+L1", "0*L1**2", "tan(th1)", "1" * 4400, "(" * 250 + "0" + ")" * 250)),
    *((check_potential, springs, with_system(potential=text), "the stored potential differs")
      for text in ("+".join("1" * 2000), " + ".join(["L1"] * 20_000))),
    *((check_potential, springs, plus(text), "the stored potential has a part that is no formula")
      for text in ("sin(th1/2)", "sin(th1^2)", "1/(L1 - L1)", "1/(1 - 1)", "1/L1", "L1^0.5", "L1^F3", "2^3^2", "L1^-1")),
    *((check_potential, springs, plus(text), "the stored potential names '")
      for text in ("True", "L9", "th1 - th1", "sin(L1)", "l1")),
    (check_potential, springs, instead("F3*L1", "sqrt(F3^2)*L1"), "a root of what is no spring's length: 'sqrt"),
    (check_potential, springs, instead("1/2*k1", "1/2*k2"), "the stored potential differs from the mechanism's"),
    (check_potential, springs, instead("- F3*", "+ F3*"), "the stored potential differs from the mechanism's"),
    *((check_potential, springs, plus(text), "the stored potential differs from the mechanism's")
      for text in ("sin(2*th1)", "sin(99*th1)", "L1^10", "L1^61", "((L1 + L2)^9)^9", POWER)),
    (check_potential, springs, plus("F3/1" + "0" * 300), "the stored potential differs from the mechanism's"),
    (check_potential, springs, plus("(F3 - 1)*(F3 - 2)*(F3 - 3)"), "the stored potential differs from the mechanism's"),
    (check_points, springs, both(0, stable=0), "cell 0, at .*: said to have stable 0; there are stable [1-9]"),
    (check_points, admissible, both(0, further={"admissible": 0}),
     "said to have stable .*; there are stable ., admissible [1-9]"),
    (check_points, total, both(0, index=(0, 0, 0)), r"said to have .* index \(0, 0, 0\); there are total"),
    (check_points, springs, of("cells", 0, solutions=()), "0 boxes of solutions for [1-9] equilibria"),
    (check_points, springs, lambda r: of("cells", 0, solutions=r.cells[0].solutions * 2)(r), "boxes of solutions for"),
    (check_points, total, lambda r: with_solution(1, center=r.cells[0].solutions[0].center)(r),
     r"the solution 1 near \(.*\) is stored twice, or not asked for"),
    (check_points, springs, not_asked_for, r"the solution 0 near \(.*\) is stored twice, or not asked for"),
    (check_points, springs, with_solution(0, signs="--"), r"at the solution 0 has eigenvalues of signs \+\+, not '--'"),
    *((check_points, springs, with_solution(0, **changes), "box of 2 unknowns|turns away")
      for changes in ({"center": (Fraction(0),)}, {"radius": Fraction(0)}, {"radius": 1 + TINY},
                      {"center": (Fraction(0), Fraction(9))})),
    (check_points, springs, with_solution(0, center=(Fraction(3), Fraction(3))), "has 0 equilibria, not one"),
    (check_points, pitchfork, reaching, "wider than boxes of one solution"),
    (check_points, springs, beside, "has 0 equilibria, not one"),
    (check_points, springs, with_parameter("L1", "-1"), "cell 0, at rho=.*: L1 is not positive"),
    (check_points, springs, with_parameter("k3", "0"), "cell 0, at rho=.*: k3 is not positive"),
    (check_points, springs, with_parameter("rho", "-1"), "cell 0, at rho=.*: rho is negative"),
    (check_points, springs, with_parameter("l0_2", "-1"), "cell 0, at rho=.*: l0_2 is negative"),
    (check_points, springs, lambda r: with_parameter("F3", f"1/(rho - {r.cells[0].sample[0]})")(r), "zero|pole"),
    # on a crease, where the counts are those beside the sample, and the boxes are those of another
    # one
    (check_points, partial(made, "crease", "total"), sample_at(0, 6, 6), "has 0 equilibria, not one"),
    (check_points, partial(made, "other-crease", "total"), sample_at(0, 6, 3), "has 0 equilibria, not one"),
    # and at a pitchfork, where nothing else is decided
    (check_points, partial(made, "pitchfork"), sample_at(0, 400, 0), "has 0 equilibria, not one"),
    (partial(check_boxes, seed="branches", number=1), springs, both(0, stable=7), "in cell 0, which is said to have"),
    (partial(check_boxes, seed="branches", number=1), total, both(0, total=7), "in cell 0, which is said to have"),
]  # fmt: skip
TOO_LARGE = [
    ("(L1^99999)^99999", "too high a degree or too long numbers"),
    ("(9^99999)^99999", "too high a degree or too long numbers"),
    ("sin(20000*th1)", "too large a multiple of an angle"),
    ("sin(th1*(9^9)^9)", "too large a multiple of an angle"),
    (" + ".join(["L1"] * 300_000), "longer than 1000000 letters"),
]


@pytest.mark.parametrize(("text", "words"), TOO_LARGE, ids=[text[:20] for text, _ in TOO_LARGE])
def test_texts_that_are_too_large_are_not_checked(text: str, words: str) -> None:
    found = check_potential(CertifiedClaims(plus(text)(springs())))
    assert isinstance(found, Unchecked)
    assert words in found


@pytest.mark.slow
def test_a_spring_as_long_as_its_free_length_is_not_told() -> None:
    r = made("slack", "admissible")
    with pytest.raises(Unproved, match="a spring may be as long as its free"):
        CertifiedClaims(r).counting.at(*(axis.low for axis in r.slice.axes))


@pytest.mark.parametrize(
    ("check", "make", "change", "words"), ROWS, ids=lambda x: x[:40] if isinstance(x, str) else ""
)
def test_rejecting_branches(
    check: Check, make: Callable[[], RegionMap], change: Change, words: str
) -> None:
    with pytest.raises(Violation, match=words):
        check(CertifiedClaims(change(make())))


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("L1", "rho - 1.2505", "L1 may be outside"), ("k2", "-1", "k2 may be outside"),
        ("rho", "rho - 1.2505", "rho may be outside"), ("l0_3", "-1", "l0_3 may be outside"),
        ("F3", "1/(rho - 1.2505)", "a parameter may have a pole"),
    ],
)  # fmt: skip
def test_no_box_is_proved_outside_of_the_domain(name: str, text: str, words: str) -> None:
    """And a place where all boxes are like that is counted as not checked."""
    r = with_parameter(name, text)(springs())
    claims = CertifiedClaims(r)
    with pytest.raises(Unproved, match=words):
        claims.counting.over(*[claims.lattice.window] * 2, CountedPoint(CellCounts(), ()))


DEGENERATE: Box = ((0.0, 0.0), (2.0**-20, 2.0**-20))
"""Around the equilibrium that three equilibria become at the pitchfork."""


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"start": [DEGENERATE], "smallest": 2.0**-6}, r"a solution near \(.*\) may be degenerate"),
        ({"budget": 3}, "3 boxes were not enough"),
    ],
)
def test_a_search_that_gives_up(options: dict[str, Any], words: str) -> None:
    given = {n: Fraction(int(n in ("L1", "L2", "rho", "k1", "k2", "k3"))) for n in NAMES}
    field = BallEquations(
        form_of(claims_of(given, Count.TOTAL).result.slice),
        {n: ball_of(v) for n, v in given.items()},
    )
    whole: dict[str, Any] = {
        "start": [((0.0, 0.0), (3.2, 3.2))],
        "budget": 1000,
        "whole": (3.2, 3.2),
    }
    with ctx.workprec(53), pytest.raises(Unproved, match=words):
        zeros(field, **{**whole, **options})


def test_equilibria_that_are_gone_on_with_are_different_and_persist() -> None:
    r = total()
    claims = CertifiedClaims(r)
    counting = claims.counting
    there = counting.at(*r.cells[0].sample)
    field = BallEquations(
        counting.form, {n: ball_of(v) for n, v in claims.parameters_at(*r.cells[0].sample).items()}
    )
    whole, found = (3.2, 3.2), there.found
    (start,) = SolutionPlaces(claims.lattice)(
        *((c, c) for c in claims.lattice.on(*r.cells[0].sample))
    )
    again = zeros(field, start, whole, 20_000, near=found)
    assert len(again) == len(found)
    with pytest.raises(Unproved, match="two solutions may meet"):
        zeros(field, start, whole, 20_000, near=[*found, found[0]])
    with pytest.raises(Unproved, match=r"the solution near \(.*\) may not persist"):
        away = replace(found[0], center=(found[0].center[0] + 0.5, found[0].center[1]))
        zeros(field, start, whole, 20_000, near=[away])
