"""Alterations of certified maps, false ones and true ones: cover, cells, counts, boxes, areas,
slice.

A map with another cover is settled when its cells are those whose samples the cover leaves free and
parts from each other, with their levels, areas and the undetermined share as the cover asks for. An
upper bound is the window's area.

Not among the false ones is a single rectangle that is missing without joining two cells: only
random places may find that, and it need not be false.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import partial
from itertools import combinations
from typing import Any

from support.replacing import replace

from forger.consistency import Alteration, drop, put, swapped, window_area
from ptmcad.answer.regionmap import Cell, RegionMap, Status
from ptmcad.cover.rectangles import Cover, Rectangle
from ptmcad.model import known_of
from ptmcad.question.slice import Point
from ptmcad.text.expressions import constant
from ptmcad.verification.certified.coverclaims import CertifiedClaims


def cover_of(r: RegionMap) -> Cover:
    """The map's cover."""
    assert r.cover is not None
    return r.cover


def covered(r: RegionMap, rectangles: Sequence[Rectangle], steps: int | None = None) -> RegionMap:
    """The settled map with other rectangles; each cell that is left is a region of its own."""
    other = replace(r, cover=Cover(steps or cover_of(r).steps, tuple(sorted(set(rectangles)))))
    claims = CertifiedClaims(other)
    found, areas = claims.sweep, claims.sweep.areas
    component: dict[int, Cell] = {}
    for cell in r.cells:
        inside = found.locate(*claims.lattice.on(*cell.sample))
        if inside is not None:
            component.setdefault(inside, cell)
    cells, regions = [], []
    for n, (k, cell) in enumerate(component.items()):
        before = sum(area > areas[k] for area in areas.values())
        before += sum(areas[j] == areas[k] for j in list(component)[:n])
        cells.append(replace(cell, level=before, region=n))
        bounds = (areas[k] * claims.square, window_area(r))
        regions.append(replace(r.regions[cell.region], area=bounds, cells=(n,), sample=cell.sample))
    known = sum(areas[k] for k in component)
    return replace(
        other,
        cells=tuple(cells),
        regions=tuple(regions),
        undetermined=1 - Fraction(known, found.steps**2),
    )


def with_counts(r: RegionMap, n: int, **counts: Any) -> RegionMap:
    """Other counts of a cell and of all cells of its region."""
    region = r.cells[n].region
    cells = tuple(replace(c, **counts) if c.region == region else c for c in r.cells)
    return replace(r, cells=cells, regions=put(r.regions, region, **counts))


def counts(r: RegionMap) -> Iterator[Alteration]:
    """More, fewer, or none where some are asked for."""
    for n, c in enumerate(r.cells):
        for by in (-1, 1, 2):
            if c.index is None and c.stable is not None:
                yield partial(with_counts, r, n, stable=c.stable + by)
            elif c.index is not None:
                index = (c.index[0] + by, c.index[1] + by, c.index[2])
                yield partial(with_counts, r, n, index=index, total=sum(index), stable=index[0])
            if c.admissible is not None:
                yield partial(with_counts, r, n, further={"admissible": c.admissible + by})
        yield partial(with_counts, r, n, stable=None)
        if c.total is None:
            yield partial(with_counts, r, n, total=4)
    yield partial(replace, r, cells=(), regions=())


def counts_exchanged(r: RegionMap) -> Iterator[Alteration]:
    for (j, a), (k, b) in combinations(enumerate(r.cells), 2):
        names = ("total", "stable", "index", "further")
        one, two = ({n: getattr(c, n) for n in names} for c in (a, b))
        if one != two:
            yield partial(_exchanged, r, j, k, one, two)


def _exchanged(r: RegionMap, j: int, k: int, one: dict[str, Any], two: dict[str, Any]) -> RegionMap:
    return with_counts(with_counts(r, j, **two), k, **one)


def boxes(r: RegionMap) -> Iterator[Alteration]:
    """Missing, twice, moved, without width, too wide, beside the solution, with other signs."""
    for n, cell in enumerate(r.cells):
        for k, s in enumerate(cell.solutions):
            small = s.radius / 10**9
            beside = tuple(x + s.radius * Fraction(19, 20) for x in s.center)
            moved = (s.center[0] + Fraction(1, 3), s.center[1])
            other = "+-" if s.signs == "++" else "++"
            for new in (replace(s, center=moved), replace(s, radius=Fraction(0)), replace(s, radius=Fraction(4)),
                        replace(s, center=beside, radius=small), replace(s, signs=other),
                        replace(s, center=s.center[:1]), replace(s, center=(Fraction(9), Fraction(9)))):  # fmt: skip
                solutions = (*cell.solutions[:k], new, *cell.solutions[k + 1 :])
                yield partial(replace, r, cells=put(r.cells, n, solutions=solutions))
            yield partial(replace, r, cells=put(r.cells, n, solutions=drop(cell.solutions, k)))
            yield partial(replace, r, cells=put(r.cells, n, solutions=(*cell.solutions, s)))


def cover_with_a_gap(r: RegionMap) -> Iterator[Alteration]:
    """Rectangles over a stretch of an axis are gone, so that cells run together; the cells stay as
    they were.
    """
    cover = cover_of(r)
    for axis in (0, 2):
        for k in range(16):
            low, high = cover.steps * k // 16, cover.steps * (k + 1) // 16
            left = tuple(q for q in cover.rectangles if q[axis + 1] < low or q[axis] > high)
            other = replace(r, cover=Cover(cover.steps, left))
            if len(covered(r, left).cells) < len(r.cells) and left:
                yield partial(replace, other)


def cover_left_out(r: RegionMap) -> Iterator[Alteration]:
    """No rectangle is left, and one cell; all else agrees, so only places in the free area can
    tell.
    """
    for n in range(len(r.cells)):
        yield partial(covered, replace(r, cells=r.cells[n : n + 1]), ())


def cover_not_normal(r: RegionMap) -> Iterator[Alteration]:
    """Twice, out of order, out of the lattice, empty, on another lattice, or none."""
    cover = cover_of(r)
    steps, own = cover.steps, cover.rectangles
    for rectangles in ((*own[:1], *own), own[::-1], (*own, (steps, steps + 1, 0, 1)), ((0, 0, 0, 1), *own),
                       ((-1, 1, 0, 1), *own)):  # fmt: skip
        yield partial(replace, r, cover=Cover(steps, tuple(rectangles)))
    for other in (steps * 2, steps + 1, 2**41, 0):
        yield partial(replace, r, cover=Cover(other, own))
    yield partial(replace, r, cover=None)


def shares_and_levels(r: RegionMap) -> Iterator[Alteration]:
    """The undetermined share; a cell's number among the components."""
    for share in (
        r.undetermined * Fraction(99, 100),
        Fraction(0),
        r.undetermined + Fraction(1, 10**9),
        Fraction(1),
    ):
        yield partial(replace, r, undetermined=share)
    for n, cell in enumerate(r.cells):
        for level in (cell.level + 1, cell.level + 1000, -1):
            yield partial(replace, r, cells=put(r.cells, n, level=level))


def areas(r: RegionMap) -> Iterator[Alteration]:
    """Bounds that are out of order, or claim more than the cover does, by as little as can be."""
    tiny = Fraction(1, 2**60)
    for k, g in enumerate(r.regions):
        low, high = g.area
        claims = CertifiedClaims(r)
        inner = sum(
            area for c, area in claims.sweep.areas.items() if claims.cell_of.get(c) in g.cells
        ) * claims.square  # fmt: skip
        for area in ((inner + tiny, high), (-tiny, high), (low, inner - tiny), (high, low)):
            yield partial(replace, r, regions=put(r.regions, k, area=area))


def samples(r: RegionMap) -> Iterator[Alteration]:
    """In another cell, in a rectangle, outside of the window; the region's sample follows or not."""
    cover, claims = cover_of(r), CertifiedClaims(r)
    names = r.slice.axis_names
    left, right, bottom, top = cover.rectangles[len(cover.rectangles) // 2]
    hidden = Point(names, *claims.lattice.off(Fraction(left + right, 2), Fraction(bottom + top, 2)))
    out = Point(names, r.slice.axes[0].high, r.slice.axes[1].high)
    for n, cell in enumerate(r.cells):
        for sample in (hidden, out, *(c.sample for k, c in enumerate(r.cells) if k != n)):
            moved = replace(r, cells=put(r.cells, n, sample=sample))
            yield partial(replace, moved, regions=put(r.regions, cell.region, sample=sample))
            yield partial(replace, r, regions=put(r.regions, cell.region, sample=sample))


def partition(r: RegionMap) -> Iterator[Alteration]:
    """Regions merged, dropped, with other cells; cells without a region."""
    for j, k in combinations(range(len(r.regions)), 2):
        both = tuple(sorted(r.regions[j].cells + r.regions[k].cells))
        regions = drop(
            put(r.regions, j, cells=both, area=(r.regions[j].area[0], window_area(r))), k
        )
        cells = tuple(
            replace(c, region=j if c.region == k else c.region - (c.region > k)) for c in r.cells
        )
        yield partial(replace, r, cells=cells, regions=regions)
        yield partial(replace, r, regions=put(r.regions, j, cells=both))
        same = {n: getattr(r.regions[j], n) for n in ("total", "stable", "index", "admissible")}
        yield partial(replace, r, cells=tuple(replace(c, **same) for c in cells), regions=regions)
    for k, g in enumerate(r.regions):
        yield partial(replace, r, regions=drop(r.regions, k))
        yield partial(replace, r, cells=put(r.cells, g.cells[0], region=len(r.regions)))


def frame(r: RegionMap) -> Iterator[Alteration]:
    """Entries that a certified map has not; another status, slice, potential; a negative count."""
    names = {"status": Status.EXACT, "base": 1, "complex_solutions": 6}
    for name, value in names.items():
        yield partial(replace, r, **{name: value})
    yield partial(replace, r, stacks=(0,))
    yield partial(replace, r, cells=put(r.cells, 0, stack=0))
    yield partial(with_counts, r, 0, stable=-1)
    yield partial(replace, r, slice=replace(r.slice, model=known_of("other")))
    yield partial(replace, r, slice=replace(r.slice, axes=r.slice.axes[::-1]))
    x = r.slice.axes[0]
    yield partial(
        replace, r, slice=replace(r.slice, axes=put(r.slice.axes, 0, low=x.high, high=x.low))
    )
    for name, e in r.slice.parameters.items():
        if name not in r.slice.axis_names and name != "k":
            text = {**r.slice.text, name: "7/9"}
            yield partial(replace, r, slice=replace(r.slice, text=text))
            fewer = {n: t for n, t in r.slice.parameters.items() if n != name}
            yield partial(replace, r, slice=replace(r.slice, parameters=fewer))
        if name in ("F3", "l0_3"):
            new = e + constant(3)
            changed = replace(r.slice, parameters={**r.slice.parameters, name: new},
                              text={**r.slice.text, name: new.to_text(r.slice.axis_names)})  # fmt: skip
            yield partial(replace, r, slice=changed)
    for right, wrong in (("1/2*k1", "1/2*k2"), (" - F3*", " + F3*"), ("1/2*k3", "1/3*k3"),
                         (" - F3*", " - sqrt(F3^2)*"), (" - F4*", f" - F3/{10**45} - F4*")):  # fmt: skip
        yield partial(
            replace, r, system=replace(r.system, potential=r.system.potential.replace(right, wrong))
        )
    yield partial(replace, r, system=replace(r.system, unknowns=swapped(r.system.unknowns, 0, 1)))


def potentials(r: RegionMap) -> Iterator[Alteration]:
    """Potentials that agree with the true one where all parameters are small and positive, or
    nearly everywhere.
    """
    true = r.system.potential
    tower = "(" * 6 + "(F3/4)" + "^9)" * 6
    for text in (
        true.replace("- F3*", "- sqrt(F3^2)*"), f"{true} + {tower}", f"{true} + F3/1{'0' * 200}",
        f"{true} + (F3 - 1)*(F3 - 2)*(F3 - 3)", f"{true} + sqrt(sin(th1)^2) - sin(th1)",
        f"{true} + sqrt((rho - L2)^2) + rho - L2",
    ):  # fmt: skip
        assert text != true
        yield partial(replace, r, system=replace(r.system, potential=text))


def true_covers(r: RegionMap) -> Iterator[Alteration]:
    """Rectangles in halves, on a finer lattice, more of them, all cells but one."""
    cover = cover_of(r)
    double = [(2 * a, 2 * b, 2 * c, 2 * d) for a, b, c, d in cover.rectangles]
    yield partial(covered, r, double, 2 * cover.steps)
    halves = [
        half for a, b, c, d in double for half in ((a, (a + b) // 2, c, d), ((a + b) // 2, b, c, d))
    ]
    yield partial(covered, r, halves, 2 * cover.steps)
    eighth = cover.steps // 8
    for corner in ((0, eighth, 0, eighth), (3 * eighth, 4 * eighth, 5 * eighth, 6 * eighth)):
        yield partial(covered, r, (*cover.rectangles, corner))
    for n in range(len(r.cells)):
        yield partial(covered, replace(r, cells=drop(r.cells, n)), cover.rectangles)


def true_words(r: RegionMap) -> Iterator[Alteration]:
    """Another order of regions, wider areas, another title, a partial status, boxes in another
    order.
    """
    last = len(r.regions) - 1
    turned = tuple(replace(c, region=last - c.region) for c in r.cells)
    yield partial(replace, r, cells=turned, regions=r.regions[::-1])
    wide = tuple(replace(g, area=(g.area[0] / 2, window_area(r))) for g in r.regions)
    yield partial(replace, r, regions=wide)
    yield partial(replace, r, slice=replace(r.slice, title="another"), status=Status.PARTIAL)
    yield partial(replace, r, cells=tuple(replace(c, solutions=c.solutions[::-1]) for c in r.cells))


FALSE = (
    counts, counts_exchanged, boxes, cover_with_a_gap, cover_left_out, cover_not_normal, shares_and_levels, areas,
    samples, partition, frame, potentials,
)  # fmt: skip
TRUE = (true_covers, true_words)
