"""A mechanism with closed loops as data: what `ptmcad.model.loops` makes of a description that has any."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

from ptmcad.model.description import Mechanism, Model, System
from ptmcad.text.tree import Tree


@dataclass(frozen=True, eq=False)  # equal where the systems are: nothing more is compared
class ClosedMechanism(System):
    """A mechanism with closed loops, or with X-joints, as the equations of its equilibria; without its springs' free
    lengths, as `without_free_lengths` has none of their parameters.

    Its conditions for stability hold together where a symmetric matrix is positive definite, and the last one is the
    determinant of that matrix, times what is positive: so off its zeros no other one matters where it changes its sign.

    Attributes
    ----------
    mechanism : as it was described.
    tangent : the direction in which loops with one degree of freedom let the unknowns move; zero where one folds flat.
    multipliers : the last unknowns, where more degrees of freedom are left: of each closing bar its tension divided by
        its length.
    """

    mechanism: Mechanism = field(kw_only=True, compare=False)
    tangent: tuple[Tree, ...] = field(kw_only=True, compare=False)
    multipliers: tuple[str, ...] = field(default=(), kw_only=True, compare=False)

    __hash__ = Model.__hash__
    __repr__ = Model.__repr__

    @property
    def record_key(self) -> str:
        return "mechanism"

    @cached_property
    def whole(self) -> Mechanism:
        """The mechanism with the bars that close its loops among the bars, and their tensions among the unknowns, for
        what shows its poses."""
        closing = tuple((closing.start, closing.end) for closing in self.mechanism.closing)
        return replace(self.mechanism, bars=self.mechanism.bars + closing, unknowns=self.unknowns)

    def _trees(self) -> Iterator[Tree]:
        yield from super()._trees()
        yield from self.mechanism._trees()


def looped(model: Model) -> Mechanism | None:
    """The mechanism whose loops a model closes, as it was described; None where there are none."""
    return model.mechanism if isinstance(model, ClosedMechanism) else None


def mechanism_in(model: Model) -> Mechanism | None:
    """The mechanism that a model is, or of whose poses it has the equations; None of another system."""
    if isinstance(model, ClosedMechanism):
        return model.whole
    return model if isinstance(model, Mechanism) else None


def equations_in(model: Model) -> System | None:
    """The system that a model is, also in the place of closed loops; None of another mechanism."""
    return model if isinstance(model, System) else None
