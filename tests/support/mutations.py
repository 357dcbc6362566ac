"""Alterations of a result that make it false, each in random ways.

Each takes a true result of any model and a source of randomness, and returns a result in which one kind of claim is
false; it raises `NOTHING` where a result makes no claim of this kind. Numbers are otherwise kept consistent where an
honest program would keep them so, to make the lie harder to see.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache

import sympy
from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_poly

from ptmcad.answer.regionmap import Cell, Component, Kind, Merge, NonAdjacency, Reason, RegionMap, Solution, Status
from ptmcad.text.expressions import constant
from ptmcad.text.plane import PlanePolynomial


def put(items: tuple, k: int, **changes: object) -> tuple:  # type: ignore[type-arg]
    """The items with the k-th one altered."""
    return (*items[:k], replace(items[k], **changes), *items[k + 1 :])


def drop(items: tuple, k: int) -> tuple:  # type: ignore[type-arg]
    return (*items[:k], *items[k + 1 :])


Mutation = Callable[[RegionMap, random.Random], RegionMap]
NOTHING = (IndexError, ValueError)
"""From an empty choice, or one of more than there are."""


def index_of(cell: Cell) -> tuple[int, ...]:
    """The cell's index.

    Raises
    ------
    IndexError
        When it has none.
    """
    if cell.index is None:
        raise IndexError("no index")
    return cell.index


def count(r: RegionMap, rng: random.Random) -> RegionMap:
    n = rng.randrange(len(r.cells))
    name = rng.choice([name for name in ("total", "stable") if getattr(r.cells[n], name) is not None])
    return replace(r, cells=put(r.cells, n, **{name: getattr(r.cells[n], name) + rng.choice([-2, -1, 1, 2])}))


def morse_index(r: RegionMap, rng: random.Random) -> RegionMap:
    """Consistent in itself, with a zero Euler sum, and false; with the region's counts changed too."""
    n = rng.randrange(len(r.cells))
    index = index_of(r.cells[n])
    new = (index[0] + 1, index[1] + 1, *index[2:])
    return replace(r, cells=put(r.cells, n, index=new, total=sum(new), stable=new[0]))


def swapped_index(r: RegionMap, rng: random.Random) -> RegionMap:
    """Minima and maxima exchanged, where they differ."""
    n = rng.choice([k for k, c in enumerate(r.cells) if c.index is not None and c.index[0] != c.index[-1]])
    new = index_of(r.cells[n])[::-1]
    return replace(r, cells=put(r.cells, n, index=new, stable=new[0]))


def sample_of_another_cell(r: RegionMap, rng: random.Random) -> RegionMap:
    n, m = rng.sample(range(len(r.cells)), 2)
    return replace(r, cells=put(r.cells, n, sample=r.cells[m].sample))


def sample_beyond_a_wall(r: RegionMap, rng: random.Random) -> RegionMap:
    s = rng.choice([k for k, stack in enumerate(r.stacks) if stack.walls])
    n = rng.choice(r.stacks[s].cells[1:])
    return replace(r, cells=put(r.cells, n, sample=r.cells[n - 1].sample))


def dropped_component(r: RegionMap, rng: random.Random) -> RegionMap:
    """The curve is gone, with all its numbers shifted as an honest program would write them."""
    k = rng.choice([n for n, c in enumerate(r.components) if c.kind is Kind.CRITICAL or c.kind is Kind.BOUNDARY])
    return replace(r, components=drop(r.components, k))


def changed_component(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.choice([n for n, c in enumerate(r.components) if c.kind is Kind.CRITICAL])
    terms = list(r.components[k].polynomial.terms)
    t = rng.randrange(len(terms))
    i, j, c = terms[t]
    terms[t] = (i, j, c + rng.choice([-1, 1]) * rng.choice([1, abs(c) // 1000 + 1]))
    return replace(r, components=put(r.components, k, polynomial=PlanePolynomial.of(terms)))


def component_left_out(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.choice([n for n, c in enumerate(r.components) if not c.left_out])
    return replace(r, components=put(r.components, k, left_out="no point in the window"))


def critical_kind(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.choice([n for n, c in enumerate(r.components) if c.kind is Kind.CRITICAL])
    return replace(r, components=put(r.components, k, kind=Kind.INFINITY))


def separates(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.randrange(len(r.components))
    return replace(r, components=put(r.components, k, separates=not r.components[k].separates))


def moved_critical_value(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.randrange(len(r.critical_values))
    v = r.critical_values[k]
    shift = max(v.high - v.low, Fraction(1, 10**6)) * rng.choice([-1, 1]) * rng.randint(2, 50)
    return replace(r, critical_values=put(r.critical_values, k, low=v.low + shift, high=v.high + shift))


def invented_critical_value(r: RegionMap, rng: random.Random) -> RegionMap:
    """A rational number near the true one, with its own polynomial."""
    k = rng.randrange(len(r.critical_values))
    v = r.critical_values[k]
    q = (v.low + v.high) / 2 + Fraction(rng.choice([-1, 1]), 10**9 + rng.randrange(10**6))
    polynomial = (-q.numerator, q.denominator)
    return replace(r, critical_values=put(r.critical_values, k, polynomial=polynomial, low=q, high=q))


def critical_polynomial(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.randrange(len(r.critical_values))
    p = list(r.critical_values[k].polynomial)
    p[0] += rng.choice([-1, 1])
    return replace(r, critical_values=put(r.critical_values, k, polynomial=tuple(p)))


def root_index(r: RegionMap, rng: random.Random) -> RegionMap:
    s = rng.choice([k for k, stack in enumerate(r.stacks) if stack.walls])
    walls = r.stacks[s].walls
    w = rng.randrange(len(walls))
    return replace(r, stacks=put(r.stacks, s, walls=put(walls, w, root=walls[w].root + rng.choice([-1, 1]))))


def wall_component(r: RegionMap, rng: random.Random) -> RegionMap:
    s = rng.choice([k for k, stack in enumerate(r.stacks) if stack.walls])
    walls = r.stacks[s].walls
    w = rng.randrange(len(walls))
    return replace(r, stacks=put(r.stacks, s, walls=put(walls, w, component=walls[w].component + 1)))


def stack_sample(r: RegionMap, rng: random.Random) -> RegionMap:
    s, t = rng.sample(range(len(r.stacks)), 2)
    return replace(r, stacks=put(r.stacks, s, sample=r.stacks[t].sample))


def adjacency_removed(r: RegionMap, rng: random.Random) -> RegionMap:
    return replace(r, adjacencies=drop(r.adjacencies, rng.randrange(len(r.adjacencies))))


def adjacency_added(r: RegionMap, rng: random.Random) -> RegionMap:
    """A copy between other cells of the same two stacks, with a segment that proves another pair."""
    known = {(a.first, a.second) for a in r.adjacencies}
    choices = []
    for k, a in enumerate(r.adjacencies):
        if a.segment is not None:
            first, second = (r.stacks[r.cells[n].stack].cells for n in (a.first, a.second))
            choices += [(k, i, j) for i in first for j in second if (i, j) not in known]
    k, i, j = rng.choice(choices)
    new = replace(r.adjacencies[k], first=i, second=j)
    return replace(r, adjacencies=(*r.adjacencies, new))


def adjacency_component(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.randrange(len(r.adjacencies))
    new = None if r.adjacencies[k].component is not None else 0
    return replace(r, adjacencies=put(r.adjacencies, k, component=new))


def segment_end(r: RegionMap, rng: random.Random) -> RegionMap:
    """The segment no longer reaches the other stack."""
    k = rng.choice([n for n, a in enumerate(r.adjacencies) if a.segment is not None])
    low, high, height = r.adjacencies[k].segment or (Fraction(0),) * 3
    return replace(r, adjacencies=put(r.adjacencies, k, segment=(low, low + (high - low) / 10**30, height)))


def merge_kind(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.randrange(len(r.adjacencies))
    new = rng.choice([m for m in Merge if m is not r.adjacencies[k].merge])
    return replace(r, adjacencies=put(r.adjacencies, k, merge=new))


def area_bound(r: RegionMap, rng: random.Random) -> RegionMap:
    """One region takes from another what the enclosure's width does not hide: 0.1 % of the window."""
    x, y = r.slice.axes
    amount = (x.high - x.low) * (y.high - y.low) / 1000
    n, m = rng.sample(range(len(r.regions)), 2)
    if r.regions[m].area[0] < amount:
        n, m = m, n
    move = {n: amount, m: -amount}
    regions = tuple(
        replace(region, area=(region.area[0] + move.get(k, 0), region.area[1] + move.get(k, 0)))
        for k, region in enumerate(r.regions)
    )
    return replace(r, regions=regions)


def area_order(r: RegionMap, rng: random.Random) -> RegionMap:
    n = rng.choice([k for k, region in enumerate(r.regions)])
    low, high = r.regions[n].area
    return replace(r, regions=put(r.regions, n, area=(high + Fraction(1, 100), low)))


def region_number(r: RegionMap, rng: random.Random) -> RegionMap:
    n = rng.randrange(len(r.cells))
    new = rng.choice([k for k in range(len(r.regions)) if k != r.cells[n].region])
    return replace(r, cells=put(r.cells, n, region=new))


def region_cells(r: RegionMap, rng: random.Random) -> RegionMap:
    n = rng.choice([k for k, region in enumerate(r.regions)])
    cells = r.regions[n].cells
    return replace(r, regions=put(r.regions, n, cells=drop(cells, rng.randrange(len(cells)))))


def region_count(r: RegionMap, rng: random.Random) -> RegionMap:
    n = rng.randrange(len(r.regions))
    return replace(r, regions=put(r.regions, n, stable=(r.regions[n].stable or 0) + 1))


def region_sample(r: RegionMap, rng: random.Random) -> RegionMap:
    n, m = rng.sample(range(len(r.regions)), 2)
    return replace(r, regions=put(r.regions, n, sample=r.regions[m].sample))


def complex_solutions(r: RegionMap, rng: random.Random) -> RegionMap:
    return replace(r, complex_solutions=r.complex_solutions + rng.choice([-2, -1, 1, 2]))


def undetermined(r: RegionMap, rng: random.Random) -> RegionMap:
    return replace(r, undetermined=Fraction(1, rng.randint(2, 100)))


def base_axis(r: RegionMap, rng: random.Random) -> RegionMap:
    return replace(r, base=1 - r.base)


def another_slice(r: RegionMap, rng: random.Random) -> RegionMap:
    """All claims of one slice, said of another: one parameter that is not an axis differs by a thousandth."""
    constants = [n for n, e in r.slice.parameters.items() if n != "k" and e.is_constant and e.constant() != 0]
    name = rng.choice(constants)
    parameters = {**r.slice.parameters, name: r.slice.parameters[name] * Fraction(1001, 1000)}
    return replace(r, slice=replace(r.slice, parameters=parameters))


def window(r: RegionMap, rng: random.Random) -> RegionMap:
    """The same claims for a window that is a little larger."""
    x, y = r.slice.axes
    k = rng.randrange(2)
    axes = [x, y]
    axes[k] = replace(axes[k], high=axes[k].high * Fraction(5, 4) if axes[k].high else Fraction(1, 4))
    return replace(r, slice=replace(r.slice, axes=(axes[0], axes[1])))


def a_cell(r: RegionMap, rng: random.Random) -> int:
    return rng.randrange(len(r.cells))


def with_solutions(r: RegionMap, n: int, solutions: tuple[Solution, ...]) -> RegionMap:
    return replace(r, cells=put(r.cells, n, solutions=solutions))


def a_solution(r: RegionMap, rng: random.Random) -> tuple[int, int, Solution]:
    n = rng.choice([k for k, cell in enumerate(r.cells) if cell.solutions])
    k = rng.randrange(len(r.cells[n].solutions))
    return n, k, r.cells[n].solutions[k]


def box_moved(r: RegionMap, rng: random.Random) -> RegionMap:
    """By a few of its own widths, or far away, in one coordinate."""
    n, k, s = a_solution(r, rng)
    axis = rng.randrange(len(s.center))
    shift = s.radius * rng.choice([3, 10, 10**6]) * rng.choice([-1, 1])
    center = tuple(x + shift if i == axis else x for i, x in enumerate(s.center))
    return with_solutions(r, n, put(r.cells[n].solutions, k, center=center))


def box_shrunk(r: RegionMap, rng: random.Random) -> RegionMap:
    """A part of the box in which the solution, which is near the box's center, is not."""
    n, k, s = a_solution(r, rng)
    axis = rng.randrange(len(s.center))
    center = tuple(x + s.radius * Fraction(19, 20) if i == axis else x for i, x in enumerate(s.center))
    return with_solutions(r, n, put(r.cells[n].solutions, k, center=center, radius=s.radius / 10**9))


def box_blown_up(r: RegionMap, rng: random.Random) -> RegionMap:
    """So large that it contains other solutions."""
    n, k, _ = a_solution(r, rng)
    return with_solutions(r, n, put(r.cells[n].solutions, k, radius=Fraction(3)))


def box_dropped(r: RegionMap, rng: random.Random) -> RegionMap:
    n, k, _ = a_solution(r, rng)
    return with_solutions(r, n, drop(r.cells[n].solutions, k))


def box_twice(r: RegionMap, rng: random.Random) -> RegionMap:
    """One box in place of another: their number is right."""
    n = rng.choice([k for k, cell in enumerate(r.cells) if len(cell.solutions) > 1])
    k = rng.randrange(len(r.cells[n].solutions))
    s, other = r.cells[n].solutions[k], (k + 1) % len(r.cells[n].solutions)
    return with_solutions(r, n, put(r.cells[n].solutions, other, center=s.center, radius=s.radius, signs=s.signs))


def box_invented(r: RegionMap, rng: random.Random) -> RegionMap:
    """A further solution, with counts to match."""
    n = a_cell(r, rng)
    cell = r.cells[n]
    assert cell.total is not None
    circles = [(Fraction(n * n - 4, n * n + 4), Fraction(4 * n, n * n + 4)) for n, _ in enumerate(r.slice.model.angles)]
    center = [x for circle in circles for x in circle] + [Fraction(7, 3)] * len(r.slice.model.reals)
    fake = Solution(tuple(center), Fraction(1, 10**9), cell.solutions[0].signs if cell.solutions else "+-")
    return replace(r, cells=put(r.cells, n, solutions=(*cell.solutions, fake), total=cell.total + 1))


def box_dropped_and_counts(r: RegionMap, rng: random.Random) -> RegionMap:
    """A solution is gone, with counts to match."""
    n, k, s = a_solution(r, rng)
    cell = r.cells[n]
    assert cell.total is not None
    index = cell.index
    if index is not None:
        index = tuple(number - (i == s.signs.count("-")) for i, number in enumerate(index))
    stable = None if cell.stable is None else cell.stable - (not s.signs.strip("+"))
    return replace(
        r, cells=put(r.cells, n, solutions=drop(cell.solutions, k), total=cell.total - 1, stable=stable, index=index)
    )


def solutions_of_another_cell(r: RegionMap, rng: random.Random) -> RegionMap:
    n, m = rng.choice(
        [(i, j) for i, c in enumerate(r.cells) for j, d in enumerate(r.cells) if c.index == d.index and differ(c, d)]
    )
    return with_solutions(r, n, r.cells[m].solutions)


def differ(c: Cell, d: Cell) -> bool:
    """Whether some solution of d is in none of c's boxes (an unloaded mechanism has the same flat ones everywhere)."""
    return not all(
        any(all(abs(x - y) <= a.radius for x, y in zip(a.center, b.center, strict=True)) for a in c.solutions)
        for b in d.solutions
    )


def sign(r: RegionMap, rng: random.Random) -> RegionMap:
    n, k, s = a_solution(r, rng)
    new = rng.choice([x for x in ("++", "+-", "--", "-+", "+", "", "00") if x != s.signs])
    return with_solutions(r, n, put(r.cells[n].solutions, k, signs=new))


def signs_exchanged(r: RegionMap, rng: random.Random) -> RegionMap:
    """Between two solutions of a cell: the cell's index stays right."""
    n = a_cell(r, rng)
    found = r.cells[n].solutions
    i, j = rng.choice([(i, j) for i, a in enumerate(found) for j, b in enumerate(found) if a.signs != b.signs])
    return with_solutions(r, n, put(put(found, i, signs=found[j].signs), j, signs=found[i].signs))


def altered(text: str, rng: random.Random) -> str:
    """A polynomial with another sign, parameter or factor in one place."""
    terms = text.split(" ")
    k = rng.choice([i for i, t in enumerate(terms) if t not in "+-"])
    change = rng.choice(["sign", "factor", "more"])
    if change == "sign":
        if k == 0:
            terms[0] = terms[0][1:] if terms[0].startswith("-") else "-" + terms[0]
        else:
            terms[k - 1] = "+" if terms[k - 1] == "-" else "-"
    elif change == "factor":
        terms[k] += "*rho"
    else:
        terms += ["+", "1/1000000*L1*cos_th1"]
    return " ".join(terms)


def potential(r: RegionMap, rng: random.Random) -> RegionMap:
    if not r.system.potential:
        raise IndexError("no potential")
    return replace(r, system=replace(r.system, potential=altered(r.system.potential, rng)))


def equation(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.randrange(len(r.system.gradient))
    gradient = tuple(altered(g, rng) if i == k else g for i, g in enumerate(r.system.gradient))
    return replace(r, system=replace(r.system, gradient=gradient))


def hessian(r: RegionMap, rng: random.Random) -> RegionMap:
    i, j = rng.randrange(len(r.system.hessian)), rng.randrange(len(r.system.hessian))
    rows = [list(row) for row in r.system.hessian]
    rows[i][j] = altered(rows[i][j], rng)
    return replace(r, system=replace(r.system, hessian=tuple(tuple(row) for row in rows)))


def relation(r: RegionMap, rng: random.Random) -> RegionMap:
    first, *others = r.system.relations or rng.choice([])
    new = rng.choice([(*others, first), tuple(others), (first + " + 1", *others)][0 if others else 1 :])
    return replace(r, system=replace(r.system, relations=new))


def unknowns(r: RegionMap, rng: random.Random) -> RegionMap:
    names = list(r.system.unknowns)
    i, j = rng.sample(range(len(names)), 2)
    names[i], names[j] = names[j], names[i]
    return replace(r, system=replace(r.system, unknowns=tuple(names)))


def parameter_text(r: RegionMap, rng: random.Random) -> RegionMap:
    name = rng.choice(sorted(r.slice.text))
    text = {**r.slice.text, name: rng.choice(["", "("]) + r.slice.text[name] + rng.choice([" + 1/1000", " - 7"])}
    return replace(r, slice=replace(r.slice, text=text))


def non_adjacency_dropped(r: RegionMap, rng: random.Random) -> RegionMap:
    return replace(r, non_adjacencies=drop(r.non_adjacencies, rng.randrange(len(r.non_adjacencies))))


def non_adjacency_twice(r: RegionMap, rng: random.Random) -> RegionMap:
    return replace(r, non_adjacencies=(*r.non_adjacencies, rng.choice(r.non_adjacencies)))


def non_adjacency_invented(r: RegionMap, rng: random.Random) -> RegionMap:
    """Two cells that are adjacent are said not to be."""
    a = rng.choice([a for a in r.adjacencies if a.segment is not None])
    new = NonAdjacency(r.cells[a.first].stack, (a.first,), (a.second,), None, None, Reason.POINT)
    return replace(r, non_adjacencies=(*r.non_adjacencies, new))


def non_adjacency_reason(r: RegionMap, rng: random.Random) -> RegionMap:
    """To a reason that does not hold: one half-branch at an edge, or a pair of them elsewhere."""
    k = rng.randrange(len(r.non_adjacencies))
    a = r.non_adjacencies[k]
    new = Reason.PAIR if None in (a.below, a.above) else Reason.EDGE
    return replace(r, non_adjacencies=put(r.non_adjacencies, k, reason=new))


def non_adjacency_cells(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.randrange(len(r.non_adjacencies))
    a = r.non_adjacencies[k]
    name = rng.choice([n for n in ("left", "right") if len(getattr(a, n)) > 1])
    return replace(r, non_adjacencies=put(r.non_adjacencies, k, **{name: getattr(a, name)[:-1]}))


def non_adjacency_segment(r: RegionMap, rng: random.Random) -> RegionMap:
    """A segment that ends before the critical value, or is at another height, beyond the next wall."""
    k, name = rng.choice(
        [(k, n) for k, a in enumerate(r.non_adjacencies) for n in ("below", "above") if getattr(a, n) is not None]
    )
    a = r.non_adjacencies[k]
    low, high, height = getattr(a, name)
    other = a.above if name == "below" else a.below
    new = (low, low + (high - low) / 10**30, height) if other is None or rng.random() < 0.5 else other
    return replace(r, non_adjacencies=put(r.non_adjacencies, k, **{name: new}))


def origin(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.randrange(len(r.critical_values))
    texts = {v.origin for v in r.critical_values} | {"vertical line", "components 0 and 1 meet", "a guess", ""}
    texts |= {f"component {n}: {what}" for n in range(3) for what in ("crosses the window's edge",
              "turning or singular point", "turning point on the axis")}  # fmt: skip
    true = origins_of(r, k)
    return replace(r, critical_values=put(r.critical_values, k, origin=rng.choice(sorted(texts - true))))


def origins_of(r: RegionMap, k: int) -> set[str]:
    """Every origin that would be true for a critical value."""
    value = r.critical_values[k]
    own = fmpz_poly(list(value.polynomial))
    curves = tuple((n, c.polynomial.terms) for n, c in enumerate(r.components) if not c.left_out)
    axis = r.slice.axes[1 - r.base]
    return {
        text
        for p, text in projected(curves, r.base, (axis.low, axis.high))
        if (common := p.gcd(own)).degree() > 0
        and sympy.Poly([int(c) for c in reversed(common.coeffs())], sympy.Symbol("u")).count_roots(
            *(sympy.Rational(e.numerator, e.denominator) for e in (value.low, value.high))
        ) > 0
    }  # fmt: skip


@lru_cache(maxsize=32)
def projected(
    curves: tuple[tuple[int, tuple[tuple[int, int, int], ...]], ...], base: int, edges: tuple[Fraction, Fraction]
) -> tuple[tuple[fmpz_poly, str], ...]:
    """The polynomials of the projection with their origins, by FLINT's eliminations in Z[u, v]."""
    ring = fmpz_mpoly_ctx.get(("u", "v"), Ordering.lex)
    found: list[tuple[fmpz_poly, str]] = []
    plane = {n: ring.from_dict({(m[base], m[1 - base]): c for *m, c in terms}) for n, terms in curves}
    for n, p in plane.items():
        high = p.degrees()[1]
        if not high:
            found.append((_along(p), "vertical line"))
            continue
        power = math.gcd(*(int(m[1]) for m, _ in p.terms()))
        deflated = ring.from_dict({(m[0], m[1] // power): c for m, c in p.terms()})
        if high > power:
            found.append((_along(deflated.discriminant("v")), f"component {n}: turning or singular point"))
        if power > 1 and edges[0] < 0 < edges[1]:
            found.append((_along(p.subs({"v": 0})), f"component {n}: turning point on the axis"))
        for edge in edges:
            scaled = {(m[0], 0): 0 for m, _ in p.terms()}
            for m, c in p.terms():
                scaled[m[0], 0] += int(c) * edge.numerator ** int(m[1]) * edge.denominator ** (high - int(m[1]))
            found.append((_along(ring.from_dict(scaled)), f"component {n}: crosses the window's edge"))
        for other, q in plane.items():
            if other > n and q.degrees()[1]:
                found.append((_along(p.resultant(q, "v")), f"components {n} and {other} meet"))
    return tuple(found)


def _along(p: fmpz_mpoly) -> fmpz_poly:
    """A polynomial in u alone."""
    row = {int(m[0]): int(c) for m, c in p.to_dict().items()}
    return fmpz_poly([row.get(i, 0) for i in range(max(row, default=-1) + 1)])


def component_invented(r: RegionMap, rng: random.Random) -> RegionMap:
    """A curve without points, of any kind, that is said to have been left out."""
    kind = rng.choice(list(Kind))
    curve = PlanePolynomial.of([(2, 0, 1), (0, 2, 1), (0, 0, rng.randint(1, 9))])
    return replace(r, components=(*r.components, Component(curve, kind, "no point in the window")))


def any_kind(r: RegionMap, rng: random.Random) -> RegionMap:
    """Any component, used or left out, is said to be of another kind."""
    k = rng.randrange(len(r.components))
    new = rng.choice([kind for kind in Kind if kind is not r.components[k].kind])
    return replace(r, components=put(r.components, k, kind=new))


def left_out_reason(r: RegionMap, rng: random.Random) -> RegionMap:
    k = rng.choice([n for n, c in enumerate(r.components) if c.left_out and c.kind is not Kind.INFINITY])
    return replace(r, components=put(r.components, k, left_out=rng.choice(["separates nothing", "costly", " "])))


def component_repeated(r: RegionMap, rng: random.Random) -> RegionMap:
    return replace(r, components=(*r.components, rng.choice(r.components)))


def area_shifted(r: RegionMap, rng: random.Random) -> RegionMap:
    """By hardly more than the width of the bounds, so that the true area is just outside of them."""
    n = rng.randrange(len(r.regions))
    low, high = r.regions[n].area
    shift = ((high - low) or Fraction(1, 10**9)) * Fraction(101, 100) * rng.choice([-1, 1])
    return replace(r, regions=put(r.regions, n, area=(low + shift, high + shift)))


def area_too_narrow(r: RegionMap, rng: random.Random) -> RegionMap:
    """Bounds of a thousandth of the width at one end of the stored ones, which leave room there."""
    n = rng.choice([n for n, region in enumerate(r.regions) if region.area[0] < region.area[1]])
    low, high = r.regions[n].area
    part = (high - low) / 1000
    area = rng.choice([(low, low + part), (high - part, high)])
    return replace(r, regions=put(r.regions, n, area=area))


def area_beyond_the_window(r: RegionMap, rng: random.Random) -> RegionMap:
    """An upper bound that says nothing, because nothing in the window is as large."""
    x, y = r.slice.axes
    n = rng.randrange(len(r.regions))
    window = (x.high - x.low) * (y.high - y.low)
    return replace(r, regions=put(r.regions, n, area=(r.regions[n].area[0], window * rng.choice([2, 10**9]))))


def plan_cost(r: RegionMap, rng: random.Random) -> RegionMap:
    """Costs that are no numbers."""
    n = next(k for k, step in enumerate(r.plan) if "predicted" in step.reason or "the first axis" in step.reason)
    reason = f"predicted cost {rng.choice(['+++', '1e', '..', 'e+5'])} against 1e+3"
    return replace(r, plan=put(r.plan, n, reason=reason))


def axes_exchanged(r: RegionMap, rng: random.Random) -> RegionMap:
    """The axes' names are exchanged and the parameters make up for it; or an axis stands for twice itself."""
    x, y = r.slice.axes
    first, second = r.slice.axis_names
    parameters = dict(r.slice.parameters)
    if rng.random() < 0.5 and {first, second} <= set(parameters):
        parameters[first], parameters[second] = parameters[second], parameters[first]
        text = {**r.slice.text, first: second, second: first}
        return replace(
            r,
            slice=replace(
                r.slice, axes=(replace(x, name=second), replace(y, name=first)), parameters=parameters, text=text
            ),
        )
    name = rng.choice([n for n in (first, second) if n in parameters])
    parameters[name] = 2 * parameters[name]
    return replace(r, slice=replace(r.slice, parameters=parameters, text={**r.slice.text, name: f"2*{name}"}))


def text_dropped(r: RegionMap, rng: random.Random) -> RegionMap:
    name = rng.choice(sorted(r.slice.text))
    return replace(r, slice=replace(r.slice, text={n: t for n, t in r.slice.text.items() if n != name}))


def unused_stiffness(r: RegionMap, rng: random.Random) -> RegionMap:
    """A k that nothing depends on."""
    if "k" in r.slice.model.variables:
        raise IndexError("something depends on k")
    parameters = {**r.slice.parameters, "k": constant(rng.randint(1, 99))}
    text = {n: (t if t != "k" else "100") for n, t in r.slice.text.items()}
    text["k"] = parameters["k"].to_text()
    return replace(r, slice=replace(r.slice, parameters=parameters, text=text))


def sum_without_signs(r: RegionMap, rng: random.Random) -> RegionMap:
    which = rng.choice(["potential", "gradient"][0 if " + " in r.system.potential else 1 :])
    if which == "potential":
        return replace(r, system=replace(r.system, potential=r.system.potential.replace(" + ", " ")))
    return replace(r, system=replace(r.system, gradient=tuple(g.replace(" + ", " ") for g in r.system.gradient)))


def number_that_is_none(r: RegionMap, rng: random.Random) -> RegionMap:
    if not r.system.potential:
        raise IndexError("no potential")
    head = rng.choice(["1/0*", "1e*", "1L*", "0*", "^2*", "*"])
    return replace(r, system=replace(r.system, potential=head + r.system.potential))


def smooth_line_at_infinity(r: RegionMap, rng: random.Random) -> RegionMap:
    """A line outside of the window whose values are small and have small factors more often than not."""
    x, y = r.slice.axes
    far = int(max(x.high, y.high)) + rng.randint(1, 10**4)
    line = PlanePolynomial.of([rng.choice([(1, 0, 1), (0, 1, 1)]), (0, 0, -far)])
    return replace(r, components=(*r.components, Component(line, Kind.INFINITY, "no point in the window")))


def partial_with_false_areas(r: RegionMap, rng: random.Random) -> RegionMap:
    return replace(area_shifted(r, rng), status=Status.PARTIAL)


ALL: tuple[Mutation, ...] = (
    count, morse_index, swapped_index, sample_of_another_cell, sample_beyond_a_wall, dropped_component,
    changed_component, component_left_out, critical_kind, separates, moved_critical_value, invented_critical_value,
    critical_polynomial, root_index, wall_component, stack_sample, adjacency_removed, adjacency_added,
    adjacency_component, segment_end, merge_kind, area_bound, area_order, region_number, region_cells, region_count,
    region_sample, complex_solutions, undetermined, base_axis, another_slice, window, box_moved, box_shrunk,
    box_blown_up, box_dropped, box_dropped_and_counts, box_twice, box_invented, solutions_of_another_cell, sign,
    signs_exchanged, potential,
    equation, hessian, relation, unknowns, parameter_text, non_adjacency_dropped, non_adjacency_twice,
    non_adjacency_invented, non_adjacency_reason, non_adjacency_cells, non_adjacency_segment, origin,
    component_invented, any_kind, left_out_reason, component_repeated, area_shifted, area_too_narrow,
    area_beyond_the_window, plan_cost, axes_exchanged, text_dropped, unused_stiffness, sum_without_signs,
    number_that_is_none, smooth_line_at_infinity, partial_with_false_areas,
)  # fmt: skip

LIKELY = {
    "walls and samples": "sample_of_another_cell sample_beyond_a_wall root_index stack_sample",
    "variety complete": "changed_component critical_kind complex_solutions smooth_line_at_infinity",
    "counts": "count morse_index swapped_index box_invented",
    "merges": "separates merge_kind",
    "critical values": "moved_critical_value invented_critical_value critical_polynomial",
    "adjacencies": "adjacency_removed adjacency_added adjacency_component segment_end",
    "areas": "area_bound area_order area_shifted area_too_narrow area_beyond_the_window "
             "partial_with_false_areas",
    "regions": "region_number region_cells region_count region_sample",
    "plan": "plan_cost",
    "solutions": "box_moved box_shrunk box_blown_up box_dropped box_dropped_and_counts box_twice "
                 "solutions_of_another_cell sign signs_exchanged",
    "non-adjacencies": "non_adjacency_dropped non_adjacency_twice non_adjacency_invented non_adjacency_reason "
                       "non_adjacency_cells non_adjacency_segment",
}  # fmt: skip
"""The alterations that a check is likely to reject: it is tried first, which makes the tests faster, and no weaker."""
FIRST = {name: check for check, names in LIKELY.items() for name in names.split()}
