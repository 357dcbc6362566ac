"""Regions: cells merged across artefacts of the decomposition and across walls that separate equal
counts.

Guarantee: two cells are in one region exactly when a chain of neighbours with equal counts joins
them. *Open* links are proved free of the variety, so counts must agree there; *wall* links cross a
component of the variety. The regions do not depend on which axis was the base.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import NamedTuple


class Link(NamedTuple):
    """Cells ``first`` and ``second`` share an open arc; ``component`` is the variety's component on
    it, or None.
    """

    first: int
    second: int
    component: int | None


def merge(keys: Sequence[Hashable], links: Sequence[Link]) -> tuple[int, ...]:
    """The region of every cell, numbered from 0 in the order of their first cells.

    Parameters
    ----------
    keys : the count by which regions are distinguished, for each cell.

    Raises
    ------
    ArithmeticError
        When an open link joins cells of different counts: the decomposition contradicts itself.
    """
    parent = list(range(len(keys)))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for link in links:
        equal = keys[link.first] == keys[link.second]
        if link.component is None and not equal:
            raise ArithmeticError(
                f"cells {link.first} and {link.second} are joined off the variety but differ in count"
            )
        if equal:
            a, b = root(link.first), root(link.second)
            parent[max(a, b)] = min(a, b)
    numbers: dict[int, int] = {}
    return tuple(numbers.setdefault(root(i), len(numbers)) for i in range(len(keys)))


def members(region_of: Sequence[int]) -> tuple[tuple[int, ...], ...]:
    """The cells of every region."""
    cells: list[list[int]] = [[] for _ in range(1 + max(region_of))]
    for n, number in enumerate(region_of):
        cells[number].append(n)
    return tuple(map(tuple, cells))
