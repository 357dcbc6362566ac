"""The parameters of a slice at a point of its two axes, exactly."""

from __future__ import annotations

from fractions import Fraction

from ptmcad.question.slice import Slice


def values_at(slice: Slice, x: Fraction, y: Fraction) -> dict[str, Fraction]:
    """All variables of the slice's description at a point; free lengths that the slice does not
    have are zero.
    """
    given = slice.parameters
    return {
        name: given[name].evaluate(x, y) if name in given else Fraction(0)
        for name in slice.model.variables
    }
