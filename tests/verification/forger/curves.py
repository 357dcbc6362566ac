"""False claims about the variety and the decomposition: components, critical values, stacks and
walls.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import partial
from itertools import combinations

from support.replacing import replace

from forger.consistency import (
    Alteration,
    changed,
    composed,
    drop,
    put,
    renumbered_cells,
    settled,
    swapped,
    with_plan,
)
from forger.decompose import decomposed
from ptmcad.answer.regionmap import (
    HARMLESS,
    NO_POINT,
    Cell,
    Component,
    Continuum,
    CriticalValue,
    Kind,
    RegionMap,
    Stack,
    Wall,
)
from ptmcad.question.slice import Point
from ptmcad.text.plane import PlanePolynomial


def _times(p: PlanePolynomial, q: PlanePolynomial) -> PlanePolynomial:
    terms: dict[tuple[int, int], int] = {}
    for i, j, c in p.terms:
        for k, m, d in q.terms:
            terms[i + k, j + m] = terms.get((i + k, j + m), 0) + c * d
    return PlanePolynomial(tuple(sorted((i, j, c) for (i, j), c in terms.items() if c)))


def component_dropped(r: RegionMap) -> Iterator[Alteration]:
    """A curve is missing, used or not."""
    for k in range(len(r.components)):
        yield partial(decomposed, r, drop(r.components, k))


def _lines(r: RegionMap) -> Iterator[PlanePolynomial]:
    """Lines through the window's middle, across either axis and along its diagonal, and one
    outside.
    """
    x, y = r.slice.axes
    u, v = (x.low + x.high) / 2, (y.low + y.high) / 2
    yield PlanePolynomial.of([(1, 0, u.denominator), (0, 0, -u.numerator)])
    yield PlanePolynomial.of([(0, 1, v.denominator), (0, 0, -v.numerator)])
    far = x.high + 1
    yield PlanePolynomial.of([(1, 0, far.denominator), (0, 0, -far.numerator)])
    yield PlanePolynomial.of([(2, 0, 1), (0, 2, 1), (0, 0, 1)])


def component_invented(r: RegionMap) -> Iterator[Alteration]:
    """A line or conic that separates nothing, of any kind; left out where it has no point in the
    window.
    """
    known = {c.polynomial for c in r.components}
    for n, p in enumerate(_lines(r)):
        for kind in Kind if p not in known else ():
            new = Component(p, kind, "" if n < 2 else NO_POINT)
            yield partial(decomposed, r, (*r.components, new))


def component_of_another_kind(r: RegionMap) -> Iterator[Alteration]:
    """Its step of the plan follows."""
    for k, c in enumerate(r.components):
        for kind in Kind:
            if kind is not c.kind:
                yield partial(with_plan, replace(r, components=put(r.components, k, kind=kind)))


def continuum_invented(r: RegionMap) -> Iterator[Alteration]:
    """Solutions that are, or perhaps are, infinitely many on a component where they are not."""
    for k, c in enumerate(r.components):
        for many in Continuum if not c.left_out and c.continuum is None else ():
            yield partial(replace, r, components=put(r.components, k, continuum=many))


def component_altered(r: RegionMap) -> Iterator[Alteration]:
    """One coefficient differs by one or by a thousandth; walls and cells follow."""
    for k, c in enumerate(r.components):
        terms = c.polynomial.terms
        if len(terms) < 2:
            continue
        for t, (i, j, a) in enumerate(terms):
            for by in {1, abs(a) // 1000 + 1}:
                if a + by:
                    p = PlanePolynomial.of([*drop(terms, t), (i, j, a + by)])
                    yield partial(decomposed, r, put(r.components, k, polynomial=p))


def component_not_normal(r: RegionMap) -> Iterator[Alteration]:
    """Twice or minus the polynomial, or its square."""
    for k, c in enumerate(r.components):
        for factor in (2, -1):
            p = PlanePolynomial(tuple((i, j, factor * a) for i, j, a in c.polynomial.terms))
            yield partial(with_plan, replace(r, components=put(r.components, k, polynomial=p)))
        square = _times(c.polynomial, c.polynomial)
        yield partial(with_plan, replace(r, components=put(r.components, k, polynomial=square)))


def components_multiplied(r: RegionMap) -> Iterator[Alteration]:
    """Two curves are said to be a single one."""
    for j, k in combinations(range(len(r.components)), 2):
        one, two = r.components[j], r.components[k]
        if one.left_out == two.left_out:
            both = replace(one, polynomial=_times(one.polynomial, two.polynomial))
            # no decomposition ends over a line on which a curve is zero that is not said to be a
            # line
            lines = any(c.polynomial.degrees[1 - r.base] == 0 for c in (one, two))
            if one.left_out or lines:
                yield partial(
                    with_plan, replace(r, components=(*drop(drop(r.components, k), j), both))
                )
            else:
                yield partial(decomposed, r, (*drop(drop(r.components, k), j), both))


def component_twice(r: RegionMap) -> Iterator[Alteration]:
    for c in r.components:
        for left_out in {c.left_out, NO_POINT}:
            more = (*r.components, replace(c, left_out=left_out, separates=False))
            yield partial(with_plan, replace(r, components=more))


def component_that_is_constant(r: RegionMap) -> Iterator[Alteration]:
    for kind in Kind:
        for value in (1, 7):
            more = (*r.components, Component(PlanePolynomial(((0, 0, value),)), kind, NO_POINT))
            yield partial(with_plan, replace(r, components=more))


def component_left_out(r: RegionMap) -> Iterator[Alteration]:
    """One with points in the window, as one without or as harmless; or for a reason that does not
    exist.
    """
    for k, c in enumerate(r.components):
        if not c.left_out:
            yield partial(decomposed, r, put(r.components, k, left_out=NO_POINT, separates=False))
        for reason in (HARMLESS, "it separates nothing"):
            if reason == c.left_out:
                continue
            if (
                reason == HARMLESS
                and c.kind is Kind.INFINITY
                and (c.left_out == NO_POINT or not c.separates)
            ):
                continue  # it may be harmless as well
            yield partial(decomposed, r, put(r.components, k, left_out=reason, separates=False))


def component_used_without_reason(r: RegionMap) -> Iterator[Alteration]:
    """One without a point in the window is used, which the plan does not say."""
    for k, c in enumerate(r.components):
        if c.left_out == NO_POINT and 0 in c.polynomial.degrees:
            yield partial(decomposed, r, put(r.components, k, left_out=""))


def separating_component(r: RegionMap) -> Iterator[Alteration]:
    for k, c in enumerate(r.components):
        yield partial(replace, r, components=put(r.components, k, separates=not c.separates))


def critical_value_moved(r: RegionMap) -> Iterator[Alteration]:
    """Its interval is beside the root, or holds another one besides; or the window's edge."""
    for k, v in enumerate(r.critical_values):
        width = max(v.high - v.low, Fraction(1, 10**9))
        axis = r.slice.axes[r.base]
        for low, high in ((v.low + 3 * width, v.high + 3 * width), (v.low - 3 * width, v.high - 3 * width),
                          (v.high, v.low - width), (axis.low, v.high), (v.low, axis.high)):  # fmt: skip
            yield partial(replace, r, critical_values=put(r.critical_values, k, low=low, high=high))


def critical_polynomial(r: RegionMap) -> Iterator[Alteration]:
    """Another multiple, one with a further factor, one without this root, or a constant."""
    for k, v in enumerate(r.critical_values):
        p = v.polynomial
        shifted = (0, *p)  # times u, and less the polynomial below: times (u - 1)
        wrong = [tuple(2 * c for c in p), tuple(-c for c in p), (p[0] + 1, *p[1:]), (1,),
                 tuple(a - b for a, b in zip(shifted, (*p, 0), strict=True))]  # fmt: skip
        for polynomial in wrong:
            yield partial(
                replace, r, critical_values=put(r.critical_values, k, polynomial=polynomial)
            )


def critical_values_exchanged(r: RegionMap) -> Iterator[Alteration]:
    for k in range(len(r.critical_values) - 1):
        yield partial(replace, r, critical_values=swapped(r.critical_values, k, k + 1))


def critical_value_twice(r: RegionMap) -> Iterator[Alteration]:
    """With a stack between that has a copy of its neighbour's cells, or none."""
    for s, v in enumerate(r.critical_values):
        yield partial(
            _with_stack, r, s, (*r.critical_values[: s + 1], v, *r.critical_values[s + 1 :])
        )


def critical_value_invented(r: RegionMap) -> Iterator[Alteration]:
    """A number in the middle of a stack's part left of its sample, where nothing happens; the stack
    is stored twice.
    """
    axis = r.slice.axes[r.base]
    for s, stack in enumerate(r.stacks):
        low = axis.low if s == 0 else r.critical_values[s - 1].high
        q = (low + stack.sample) / 2
        new = CriticalValue(
            (-q.numerator, q.denominator), q, q, "component 0: turning or singular point"
        )
        yield partial(_split, r, s, new, (low + q) / 2)


def _with_stack(r: RegionMap, s: int, values: tuple[CriticalValue, ...]) -> RegionMap:
    """The map with a copy of stack s after it."""
    cells: list[int | Cell] = list(range(len(r.cells)))
    after = r.stacks[s].cells[-1] + 1
    copies: list[int | Cell] = [r.cells[n] for n in r.stacks[s].cells]
    stacks = (*r.stacks[: s + 1], r.stacks[s], *r.stacks[s + 1 :])
    return settled(
        replace(
            renumbered_cells(r, stacks, cells[:after] + copies + cells[after:]),
            critical_values=values,
        )
    )


def _split(r: RegionMap, s: int, value: CriticalValue, sample: Fraction) -> RegionMap:
    """The map with stack s parted at a value left of its sample; the left part has a sample and
    cells of its own.

    Only where the walls leave the old heights free over the new sample is every claim but the value
    true.
    """
    old = r.stacks[s]
    heights = [r.cells[n].sample[1 - r.base] for n in old.cells]
    fresh: list[int | Cell] = []
    for n, height in zip(old.cells, heights, strict=True):
        at = (sample, height) if r.base == 0 else (height, sample)
        fresh.append(replace(r.cells[n], sample=Point(r.slice.axis_names, *at)))
    before = old.cells[0]
    cells: list[int | Cell] = list(range(len(r.cells)))
    stacks = (*r.stacks[:s], replace(old, sample=sample), *r.stacks[s:])
    values = (*r.critical_values[:s], value, *r.critical_values[s:])
    found = renumbered_cells(r, stacks, cells[:before] + fresh + cells[before:])
    more = []
    size = len(old.cells)
    for a in found.adjacencies:
        # pairs across the stack's left end are now those of the copy
        if (
            a.segment is not None
            and found.cells[a.second].stack == s + 1
            and found.cells[a.first].stack == s - 1
        ):
            more.append(replace(a, second=a.second - size))
        elif a.segment is None and found.cells[a.first].stack == s + 1:
            more += [a, replace(a, first=a.first - size, second=a.second - size)]
        else:
            more.append(a)
    template = next((a for a in r.adjacencies if a.segment is None), None)
    for level, height in enumerate(heights):
        first = before + level
        if template is not None or r.adjacencies:
            a = template or r.adjacencies[0]
            more.append(
                replace(
                    a,
                    first=first,
                    second=first + size,
                    component=None,
                    segment=(sample, old.sample, height),
                )
            )
    return settled(replace(found, critical_values=values, adjacencies=tuple(more)))


def origin_of_a_critical_value(r: RegionMap) -> Iterator[Alteration]:
    """An origin that no critical value can have."""
    for k in range(len(r.critical_values)):
        for origin in (
            "a guess",
            "",
            "component 99: turning or singular point",
            "components 0 and 0 meet",
        ):
            yield partial(replace, r, critical_values=put(r.critical_values, k, origin=origin))


def stack_dropped(r: RegionMap) -> Iterator[Alteration]:
    """With the critical value on its left, or the one on its right; what its neighbours have in
    common stays.
    """
    for s in range(len(r.stacks) - 1):
        yield partial(_without, r, s)


def _without(r: RegionMap, s: int) -> RegionMap:
    gone = set(r.stacks[s].cells)
    more = composed(r, s - 1, s + 1, s) if s else []
    left = replace(
        r, adjacencies=(*r.adjacencies, *more), critical_values=drop(r.critical_values, s)
    )
    return settled(
        renumbered_cells(left, drop(r.stacks, s), [n for n in range(len(r.cells)) if n not in gone])
    )


def sample_of_a_stack(r: RegionMap) -> Iterator[Alteration]:
    """In another stack or outside of the window, with its cells' samples."""
    axis = r.slice.axes[r.base]
    for s, stack in enumerate(r.stacks):
        others = [t.sample for t in r.stacks if t is not stack]
        for u in (*others, axis.low, axis.high + 1):
            cells = list(r.cells)
            for n in stack.cells:
                height = cells[n].sample[1 - r.base]
                at = (u, height) if r.base == 0 else (height, u)
                cells[n] = replace(cells[n], sample=Point(r.slice.axis_names, *at))
            yield partial(changed, r, stacks=put(r.stacks, s, sample=u), cells=tuple(cells))


def sample_of_a_cell(r: RegionMap) -> Iterator[Alteration]:
    """In another cell, below or above the window, or not over the stack's sample."""
    other = r.slice.axes[1 - r.base]
    for n, cell in enumerate(r.cells):
        u, v = cell.sample[r.base], cell.sample[1 - r.base]
        beside = [r.cells[m].sample for m in (n - 1, n + 1) if 0 <= m < len(r.cells)]
        middle = (u + r.slice.axes[r.base].high) / 2
        for a, b in ((u, other.low), (u, other.high), (u, other.high + 1), (middle, v)):
            beside.append(Point(r.slice.axis_names, *((a, b) if r.base == 0 else (b, a))))
        for sample in beside:
            yield partial(changed, r, cells=put(r.cells, n, sample=sample))


def root_of_a_wall(r: RegionMap) -> Iterator[Alteration]:
    for s, w, wall in _walls(r):
        for by in (-1, 1, 7):
            yield partial(_with_walls, r, s, put(r.stacks[s].walls, w, root=wall.root + by))


def component_of_a_wall(r: RegionMap) -> Iterator[Alteration]:
    """Another curve, used or not, or none that exists; the adjacency across the wall follows."""
    for s, w, wall in _walls(r):
        for n in (*range(len(r.components)), len(r.components), -1):
            if n != wall.component:
                other = _with_walls(r, s, put(r.stacks[s].walls, w, component=n))
                first = r.stacks[s].cells[w]
                k = next(
                    k
                    for k, a in enumerate(r.adjacencies)
                    if (a.first, a.second) == (first, first + 1)
                )
                if 0 <= n < len(r.components):
                    yield partial(changed, other, adjacencies=put(r.adjacencies, k, component=n))
                else:
                    yield partial(replace, other)


def walls_exchanged(r: RegionMap) -> Iterator[Alteration]:
    for s, stack in enumerate(r.stacks):
        for j, k in combinations(range(len(stack.walls)), 2):
            yield partial(_with_walls, r, s, swapped(stack.walls, j, k))


def _walls(r: RegionMap) -> Iterator[tuple[int, int, Wall]]:
    for s, stack in enumerate(r.stacks):
        for w, wall in enumerate(stack.walls):
            yield s, w, wall


def _with_walls(r: RegionMap, s: int, walls: Sequence[Wall]) -> RegionMap:
    return replace(r, stacks=put(r.stacks, s, walls=tuple(walls)))


def wall_dropped(r: RegionMap) -> Iterator[Alteration]:
    """With the cell above it, or the one below it; pairs of that cell with others are gone."""
    for s, w, _ in _walls(r):
        for side in (0, 1):
            yield partial(_without_wall, r, s, w, side)


def _without_wall(r: RegionMap, s: int, w: int, side: int) -> RegionMap:
    gone = r.stacks[s].cells[w + side]
    stays = r.stacks[s].cells[w + 1 - side]
    pairs = {(a.first, a.second) for a in r.adjacencies}
    moved = []
    for a in r.adjacencies:
        ends = tuple(stays if n == gone else n for n in (a.first, a.second))
        if ends == (a.first, a.second):
            moved.append(a)
        elif ends[0] != ends[1] and ends not in pairs:
            pairs.add((ends[0], ends[1]))
            moved.append(replace(a, first=ends[0], second=ends[1]))
    stack = replace(r.stacks[s], walls=drop(r.stacks[s].walls, w))
    cells = [n for n in range(len(r.cells)) if n != gone]
    return settled(
        renumbered_cells(replace(r, adjacencies=tuple(moved)), put_stack(r.stacks, s, stack), cells)
    )


def put_stack(stacks: Sequence[Stack], s: int, stack: Stack) -> tuple[Stack, ...]:
    return (*stacks[:s], stack, *stacks[s + 1 :])


def wall_invented(r: RegionMap) -> Iterator[Alteration]:
    """A wall above a cell's sample, with a copy of the cell above it."""
    for s, stack in enumerate(r.stacks):
        for level, n in enumerate(stack.cells):
            for component, c in enumerate(r.components):
                if not c.left_out:
                    yield partial(_with_wall, r, s, level, n, component)


def _with_wall(r: RegionMap, s: int, level: int, n: int, component: int) -> RegionMap:
    other = r.slice.axes[1 - r.base]
    above = (*(r.cells[m].sample[1 - r.base] for m in r.stacks[s].cells), other.high)[level + 1]
    u, v = r.cells[n].sample[r.base], r.cells[n].sample[1 - r.base]
    height = v + (above - v) / 1000
    at = (u, height) if r.base == 0 else (height, u)
    copy = replace(r.cells[n], sample=Point(r.slice.axis_names, *at))
    walls = r.stacks[s].walls
    root = sum(w.component == component for w in walls[:level])
    stack = replace(r.stacks[s], walls=(*walls[:level], Wall(component, root), *walls[level:]))
    cells: list[int | Cell] = [*range(n + 1), copy, *range(n + 1, len(r.cells))]
    return settled(renumbered_cells(r, put_stack(r.stacks, s, stack), cells))


KINDS = (
    component_dropped, component_invented, component_of_another_kind, component_altered, component_not_normal,
    components_multiplied, component_twice, component_that_is_constant, component_left_out,
    component_used_without_reason, separating_component, critical_value_moved, critical_polynomial,
    critical_values_exchanged, critical_value_twice, critical_value_invented, origin_of_a_critical_value, stack_dropped,
    sample_of_a_stack, sample_of_a_cell, root_of_a_wall, component_of_a_wall, walls_exchanged, wall_dropped,
    wall_invented, continuum_invented,
)  # fmt: skip
