"""Checks of the map's shape, of merges and of regions, from the stored tables alone.

Guarantee: cells, stacks and regions refer to each other consistently; the regions are the connected
components of the joined adjacencies.
"""

from __future__ import annotations

from ptmcad.answer.regionmap import Cell, Merge, RegionMap, Status
from ptmcad.text.numerals import approximate_text
from ptmcad.verification.certified.counted import checked_members
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import parameters_of, shorthands_of
from ptmcad.verification.kinds import kind_of
from ptmcad.verification.report import Violation


def check_shape(claims: Claims) -> str:
    """Numbers refer to what exists, in order."""
    r = claims.result
    if r.status not in (Status.EXACT, Status.PARTIAL):
        raise Violation(
            f"the status {r.status.value!r} cannot be checked: only exact and partial results can"
        )
    if r.undetermined != (0 if r.stacks else 1):
        raise Violation(
            f"{approximate_text(r.undetermined)} of the window is said to be undetermined, but "
            f"{'all cells' if r.stacks else 'no cells'} are stored"
        )
    model = r.slice.model
    named = set(r.slice.parameters) - set(shorthands_of(model))
    if not model.unknowns or named != set(parameters_of(model)):
        raise Violation(
            f"the mechanism {r.slice.mechanism!r} is not known, or its parameters are others"
        )
    if any(a.low >= a.high for a in r.slice.axes) or r.base not in (0, 1):
        raise Violation("the window is empty")
    _check_count(claims)
    if not r.stacks:
        if (
            r.status is Status.EXACT
            or r.critical_values
            or r.cells
            or r.adjacencies
            or r.non_adjacencies
            or r.regions
        ):
            raise Violation("there are no stacks")
        if any(c.separates for c in r.components):
            raise Violation("a component is said to separate regions, but there are none")
        return "no stacks yet"
    if len(r.critical_values) != len(r.stacks) - 1:
        raise Violation(
            f"{len(r.critical_values)} critical values do not part {len(r.stacks)} stacks"
        )
    _check_references(r)
    return f"{len(r.stacks)} stacks, {len(r.cells)} cells, {len(r.adjacencies)} adjacencies, {len(r.regions)} regions"


def _check_references(r: RegionMap) -> None:
    """Stacks, cells, walls, adjacencies and regions refer to what exists, in order."""
    number = 0
    for s, stack in enumerate(r.stacks):
        ends = (s - 1 if s else None, s if s < len(r.stacks) - 1 else None)
        if (stack.left, stack.right) != ends:
            raise Violation(
                f"stack {s} is said to lie between critical values {stack.left} and {stack.right}, not "
                f"{ends[0]} and {ends[1]}"
            )
        expected = tuple(range(number, number + len(stack.walls) + 1))
        if stack.cells != expected:
            raise Violation(f"stack {s} has cells {stack.cells}, not {expected}")
        for wall in stack.walls:
            if (
                not _is_index(wall.component, len(r.components))
                or r.components[wall.component].left_out
            ):
                raise Violation(
                    f"a wall of stack {s} is on component {wall.component}, which is not used"
                )
        for level, n in enumerate(expected):
            if n >= len(r.cells) or (r.cells[n].stack, r.cells[n].level) != (s, level):
                raise Violation(f"cell {n} is not the one at level {level} of stack {s}")
        number += len(expected)
    if number != len(r.cells):
        raise Violation(f"{len(r.cells)} cells are stored, the stacks have {number}")
    for k, a in enumerate(r.adjacencies):
        if not (_is_index(a.first, number) and _is_index(a.second, number)):
            raise Violation(
                f"adjacency {k} joins cells {a.first} and {a.second}, which are not both there"
            )
        if a.component is not None and not _is_index(a.component, len(r.components)):
            raise Violation(f"adjacency {k} names component {a.component}, which is not there")
    for n, cell in enumerate(r.cells):
        if not _is_index(cell.region, len(r.regions)):
            raise Violation(f"cell {n} is in region {cell.region}, which is not there")


def _check_count(claims: Claims) -> None:
    """The model has counts of the kind, exact maps may be by it, and no others are stored."""
    r, count = claims.result, claims.result.slice.count
    kind = kind_of(count)
    if not kind.has_exact_maps or (kind.is_predicate and not claims.meaning.order):
        raise Violation(
            f"an exact map has no {count.value} counts by which its regions could be distinguished"
        )
    if not kind.is_of(claims.model):
        raise Violation(
            f"{claims.model.name} has no {count.value} counts by which regions could be distinguished"
        )
    known = {count.value} if kind.is_predicate else set()
    if further := {name for item in (*r.cells, *r.regions) for name in item.further} - known:
        raise Violation(f"an exact map has counts of {further.pop()} equilibria")


def _is_index(value: object, length: int) -> bool:
    return isinstance(value, int) and 0 <= value < length


def _counts(cell: Cell) -> object:
    """All that is counted, in few words."""
    return ((cell.total, cell.stable) if cell.index is None else cell.index) + (
        *cell.further.values(),
    )


def check_merges(claims: Claims) -> str:
    """The kind of every adjacency, and which components separate."""
    r = claims.result
    separating = set()
    for k, a in enumerate(r.adjacencies):
        first, second = r.cells[a.first], r.cells[a.second]
        equal = first.number(r.slice.count) == second.number(r.slice.count)
        if a.component is None:
            kind = Merge.PROVEN
            if (one := _counts(first)) != (other := _counts(second)):
                raise Violation(
                    f"adjacency {k} crosses no component, but cells {a.first} and {a.second} have "
                    f"different counts {one} and {other}"
                )
        else:
            kind = Merge.EQUAL_COUNT if equal else Merge.SEPARATED
        if kind is Merge.SEPARATED:
            separating.add(a.component)
        if a.merge is not kind:
            raise Violation(
                f"adjacency {k} of cells {a.first} and {a.second} is {kind.value!r}, not {a.merge.value!r}"
            )
    for n, c in enumerate(r.components):
        if c.separates != (n in separating):
            raise Violation(
                f"component {n} is said to {'' if c.separates else 'not '}separate two regions"
            )
    return f"{len(r.adjacencies)} adjacencies"


def check_regions(claims: Claims) -> str:
    """The partition, and each region's counts, cells and sample."""
    r = claims.result
    parts = {n: frozenset([n]) for n in range(len(r.cells))}
    for a in r.adjacencies:
        if a.merge is Merge.SEPARATED:
            continue
        one, two = (r.cells[n].region for n in (a.first, a.second))
        if one != two:
            raise Violation(
                f"cells {a.first} and {a.second} are joined, but in regions {one} and {two}"
            )
        if a.second not in parts[a.first]:
            joined = parts[a.first] | parts[a.second]
            parts |= dict.fromkeys(joined, joined)
    found = {*parts.values()}
    if len(found) != len(r.regions):
        raise Violation(f"{len(r.regions)} regions are stored, the adjacencies make {len(found)}")
    for number in range(len(r.regions)):
        if frozenset(members := checked_members(r, number)) not in found:
            raise Violation(f"the cells {members} of region {number} are not those that are joined")
    return f"{len(found)} regions"
