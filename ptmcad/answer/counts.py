"""How many solutions there are, in all and by their kinds."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

from ptmcad.model import Model
from ptmcad.question.slice import Count

MorseIndex = tuple[int, ...]
"""Numbers of critical points by their number of negative eigenvalues: of two unknowns minima, saddles and maxima."""


@dataclass(frozen=True, slots=True)
class Counts:
    """Numbers of the solutions that count.

    Attributes
    ----------
    stable : None where nothing says what a stable solution is.
    index : numbers of solutions by the number of negative eigenvalues of the Hessian; None without a potential. On a
        torus their alternating sum is zero.
    """

    total: int
    stable: int | None
    index: MorseIndex | None

    @property
    def working(self) -> int:
        """The number by which an operation range is found: of stable solutions, or of all where none is told stable."""
        return self.total if self.stable is None else self.stable


class Counted(Protocol):
    """What has all kinds of counts: a region or a cell of a map; None where one varies or is not known."""

    @property
    def stable(self) -> int | None: ...

    @property
    def total(self) -> int | None: ...

    @property
    def index(self) -> MorseIndex | None: ...

    @property
    def admissible(self) -> int | None: ...


def counted_by(counted: Counted, count: Count) -> tuple[int, ...]:
    """The count that distinguishes regions, as something to compare and sort by; (-1,) where it is not known."""
    value = {
        Count.STABLE: counted.stable,
        Count.TOTAL: counted.total,
        Count.INDEX: counted.index,
        Count.ADMISSIBLE: counted.admissible,
    }[count]
    return (-1,) if value is None else value if isinstance(value, tuple) else (value,)


def operation_number(model: Model, found: Iterable[Counts]) -> int:
    """The number of stable solutions that there are in an operation range: the greatest one that occurs.

    A mechanism needs two of them at least: one that works in one stable pose everywhere has no range to be in. Those of
    the paper's mechanism are never more, so that its ranges are where two are stable.
    """
    return max((1, model.nouns.usual, *(counts.working for counts in found)))
