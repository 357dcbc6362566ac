"""A mechanism with closed loops as data: what `ptmcad.mechanism.loops` makes of a description that has any."""

from __future__ import annotations

from dataclasses import dataclass, field

from ptmcad.mechanism.description import Mechanism, Model, System
from ptmcad.text.tree import Tree


@dataclass(frozen=True)
class ClosedMechanism(System):
    """A mechanism with closed loops and one degree of freedom, as the equations of its equilibria.

    Attributes
    ----------
    mechanism : as it was described.
    tangent : a direction in which the loops let the unknowns move; zero where a loop folds flat.
    """

    mechanism: Mechanism = field(kw_only=True, compare=False)
    tangent: tuple[Tree, ...] = field(kw_only=True, compare=False)

    __hash__ = Model.__hash__
    __repr__ = Model.__repr__

    @property
    def record_key(self) -> str:
        return "mechanism"
