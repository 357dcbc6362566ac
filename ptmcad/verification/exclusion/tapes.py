"""Formulas as arrays of operations, which compiled code evaluates.

Guarantee: constants are enclosed.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import inf, nextafter
from typing import Any, NamedTuple

import numpy as np

from ptmcad.verification.certified.formulas import MAX_VARIABLES, VARIABLE, Formulas


class IntervalTape(NamedTuple):
    """Operations in their order, in arrays.

    Attributes
    ----------
    code, first, second : of each value the operation and the numbers of its operands (of a variable
        its own number).
    low, high : enclosures of constants.
    """

    code: Any
    first: Any
    second: Any
    low: Any
    high: Any


def tape_of(
    formulas: Formulas, first: Sequence[int], wanted: Sequence[int]
) -> tuple[IntervalTape, int, list[int]]:
    """The operations that some values need, those of the first of them first.

    Returns
    -------
    The operations; how many of them the first values need; and the places of all.
    """
    early = formulas.needed(first)
    order = [*sorted(early), *sorted(formulas.needed(wanted) - early)]
    place = {n: k for k, n in enumerate(order)}
    low, high, rows = [], [], []
    for n in place:
        operation, a, b = formulas.rows[n]
        assert operation != VARIABLE or a < MAX_VARIABLES
        if operation > VARIABLE:
            a, b = place[a], place[b]
        rows.append((operation, a, b))
        below, above = enclosing(formulas.numbers.get(n, Fraction(0)))
        low.append(below)
        high.append(above)
    code, first_of, second = (np.array([row[k] for row in rows], dtype=np.int64) for k in range(3))
    tape = IntervalTape(code, first_of, second, np.array(low), np.array(high))
    return tape, len(early), [place[n] for n in (*first, *wanted)]


def enclosing(value: Fraction) -> tuple[float, float]:
    """Floats that a rational number lies between, or is equal to; infinite ones where there are no
    others.
    """
    try:
        near = float(value)
    except OverflowError:
        return (-inf, -1e308) if value < 0 else (1e308, inf)
    if Fraction(near) == value:
        return near, near
    return nextafter(near, -inf), nextafter(near, inf)
