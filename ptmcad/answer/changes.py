"""The values of a family's free parameter at which the arrangement of its members' regions changes,
as plain data.

Guarantee: an `AlgebraicNumber` is the change, exactly; an `Enclosure` has members of different
arrangements at its ends, and so contains a change. That there is no other change is said by
``complete``, and only with proof.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from ptmcad.answer import with_methods
from ptmcad.answer.arrangement import Arrangement
from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure

TOLERANCE = Fraction(1, 10**6)
"""Where no other one is asked for."""


@dataclass(frozen=True, slots=True)
class Change:
    """A value at which the arrangement changes.

    Attributes
    ----------
    value : exact, or enclosed between two members.
    words : what changes as the parameter grows, a sentence each. They describe: nothing rests on
        them.
    """

    value: AlgebraicNumber | Enclosure
    words: tuple[str, ...]

    @property
    def is_exact(self) -> bool:
        """Whether the value itself is known, and not two members between which it lies."""
        return isinstance(self.value, AlgebraicNumber)


@with_methods
@dataclass(frozen=True, slots=True, repr=False)
class Changes:
    """All changes that were found in the open range of the free parameter.

    Attributes
    ----------
    free : the free parameter with its range.
    changes : in increasing order.
    between : a value in each interval between neighbouring changes, or a change and an end of the
        range.
    arrangements : of the members at these values.
    others : further values at which curves meet, turn or pass the window's edge; on both sides of
        each the arrangement is the same.
    at_ends : what is otherwise at the lower and at the upper end of the range than beside it, a
        sentence each.
    complete : whether it is proved that the arrangement is the same from each change to the next.
    reason : how the changes were found, and why that is a proof or why it is none.
    tolerance : of the range, how near to a change members are compared in words, and how wide
        enclosures are.
    """

    free: Axis
    changes: tuple[Change, ...]
    between: tuple[Fraction, ...]
    arrangements: tuple[Arrangement, ...]
    others: tuple[AlgebraicNumber, ...]
    at_ends: tuple[tuple[str, ...], tuple[str, ...]]
    complete: bool
    reason: str
    tolerance: Fraction = TOLERANCE

    def __iter__(self) -> Iterator[Change]:
        return iter(self.changes)

    def __len__(self) -> int:
        return len(self.changes)

    def __repr__(self) -> str:
        known = "complete" if self.complete else "not proved complete"
        return f"<Changes of {self.free}: {len(self)}, {known}>"

    if TYPE_CHECKING:  # `ptmcad.methods` has it

        def table(self) -> str: ...

        def _repr_html_(self) -> str: ...
