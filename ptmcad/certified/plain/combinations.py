"""Which of some expressions the others follow from, by linear combination over Q.

Guarantee: exact.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from fractions import Fraction
from typing import TypeVar

_Term = TypeVar("_Term", bound=Hashable)


def independent(rows: Iterable[Mapping[_Term, Fraction]]) -> list[int]:
    """The numbers of rows, each no linear combination of earlier ones, of which all rows are linear combinations.

    Parameters
    ----------
    rows : coefficients by the terms that they belong to; no zeros.
    """
    reduced: list[tuple[_Term, dict[_Term, Fraction]]] = []
    chosen = []
    for n, row in enumerate(rows):
        rest = dict(row)
        for pivot, other in reduced:
            if factor := rest.get(pivot):
                rest = {t: c for t in rest.keys() | other.keys() if (c := rest.get(t, 0) - factor * other.get(t, 0))}
        if rest:
            pivot = next(iter(rest))
            reduced.append((pivot, {t: c / rest[pivot] for t, c in rest.items()}))
            chosen.append(n)
    return chosen
