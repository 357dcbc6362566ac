"""Moments and loads where the parameters have values: on what they work, and how strongly.

Of a moment that depends on its own unknown that is its constant part: the rest is the slope of an energy (`work`). A
constant moment M on an angle does the work M times the angle, another one after each turn: the energy less that work
has many values on the circle, so that whatever is said of an energy's descent has to ask for moments first.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import NamedTuple

from ptmcad.model.description import Mechanism, Model
from ptmcad.model.evaluate import value_at
from ptmcad.model.work import split_moments
from ptmcad.text.tree import names_of


def acting(model: Model, unknowns: Iterable[str]) -> str:
    """What works on some unknowns, in words: moments on angles, forces on what is no angle."""
    names = [name for name in model.unknowns if name in set(unknowns)]
    angles = [name for name in names if name in model.angles]
    lengths = [name for name in names if name not in model.angles]
    parts = ["moments" if len(angles) > 1 else "moment"] if angles else []
    if lengths:
        parts.append(f"force{'s' * (len(lengths) > 1)} on {' and '.join(lengths)}")
    return " and the ".join(parts)


def foreign(mechanism: Mechanism) -> str:
    """What depends on another unknown than its own, so that there is no potential."""
    found = {m.unknown for m in mechanism.moments if mechanism.unknowns.keys() & set(names_of(m.value)) - {m.unknown}}
    if any(name in mechanism.angles for name in found):
        return "a moment"
    return f"the force on {next(name for name in mechanism.unknowns if name in found)}"


def moments_at(model: Model, parameters: Mapping[str, Fraction]) -> dict[str, Fraction]:
    """The unknowns on which a moment that is not zero works, to the moment.

    Parameters
    ----------
    model : one that has a potential: no moment depends on another unknown than its own.
    parameters : all of the model's; free lengths are zero where they are not among them.

    Raises
    ------
    ExpressionError
        When a moment depends on another unknown.
    """
    if not isinstance(model, Mechanism):
        return {}
    known = dict.fromkeys(model.free_lengths, Fraction(0)) | dict(parameters)
    found = {unknown: value_at(tree, known) for unknown, tree in split_moments(model).steady}
    return {unknown: value for unknown, value in found.items() if value}


class PointForce(NamedTuple):
    """A load where the parameters have values: its point, and its components across and up by their names."""

    point: str
    names: tuple[str, str]
    force: tuple[Fraction, Fraction]


def loads_at(mechanism: Mechanism, parameters: Mapping[str, Fraction]) -> tuple[PointForce, ...]:
    """The loads in the description's order; variables that are not among the parameters are zero."""
    known = dict.fromkeys(mechanism.variables, Fraction(0)) | dict(parameters)
    return tuple(
        PointForce(load.point, load.names, (value_at(load.x, known), value_at(load.y, known)))
        for load in mechanism.loads
    )
