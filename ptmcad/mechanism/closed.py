"""A mechanism with closed loops as data: what `ptmcad.mechanism.loops` makes of a description that has any."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

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

    @cached_property
    def whole(self) -> Mechanism:
        """The mechanism with the bars that close its loops among the bars, for what shows its poses."""
        closing = tuple((closing.start, closing.end) for closing in self.mechanism.closing)
        return replace(self.mechanism, bars=self.mechanism.bars + closing)

    def _trees(self) -> Iterator[Tree]:
        yield from super()._trees()
        yield from self.mechanism._trees()


def mechanism_in(model: Model) -> Mechanism | None:
    """The mechanism that a model is, or of whose poses it has the equations; None of another system."""
    if isinstance(model, ClosedMechanism):
        return model.whole
    return model if isinstance(model, Mechanism) else None
