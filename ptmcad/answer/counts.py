"""How many solutions there are, in all and by their kinds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

from ptmcad.model import Model
from ptmcad.model.criterion import Criterion
from ptmcad.question.counts import Count

MorseIndex = tuple[int, ...]
"""Numbers of critical points by their number of negative eigenvalues: of two unknowns minima,
saddles and maxima.
"""


class Counted:
    """What has counts of all kinds, such as a region or a cell of a map; None where one varies or
    is not known.

    Its classes have fields ``stable``, ``total`` and ``index``, and ``further`` where numbers of
    solutions at which a predicate of `ptmcad.question.counts` holds are known: those by the names
    of their counts.
    """

    __slots__ = ()

    if TYPE_CHECKING:  # dataclasses would take what is here for defaults of their fields

        @property
        def total(self) -> int | None: ...

        @property
        def stable(self) -> int | None: ...

        @property
        def index(self) -> MorseIndex | None: ...

    @property
    def further(self) -> Mapping[str, int]:
        return _NOTHING

    @property
    def admissible(self) -> int | None:
        """The number of stable equilibria with every spring longer than its free length."""
        return self.further.get(Count.ADMISSIBLE.value)

    def number(self, count: Count) -> int | MorseIndex | None:
        """The count of a kind."""
        numbers = {"stable": self.stable, "total": self.total, "index": self.index, **self.further}
        return numbers.get(count.value)


_NOTHING: Mapping[str, int] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Counts(Counted):
    """Numbers of the solutions that count.

    Attributes
    ----------
    stable : None where nothing says what a stable solution is.
    index : numbers of solutions by the number of negative eigenvalues of the Hessian; None without
        a potential. On a torus their alternating sum is zero.
    """

    total: int
    stable: int | None
    index: MorseIndex | None

    @property
    def working(self) -> int:
        """The number by which an operation range is found: of stable solutions, or of all where
        stability is not defined.
        """
        return self.total if self.stable is None else self.stable


def counts_of_signs(signs: Sequence[str], criterion: Criterion) -> Counts:
    """The counts of solutions by the signs of their Hessians' eigenvalues, or of conditions for
    stability.
    """
    return Counts(
        len(signs), criterion.number(map(criterion.is_stable, signs)), criterion.indices(signs)
    )


def counted_by(counted: Counted, count: Count) -> tuple[int, ...]:
    """The count that distinguishes regions, as something to compare and sort by; (-1,) where it is
    not known.
    """
    value = counted.number(count)
    return (-1,) if value is None else value if isinstance(value, tuple) else (value,)


def key_text(key: Sequence[int]) -> str:
    """What `counted_by` has, as text."""
    if len(key) > 1:
        return f"({', '.join(map(str, key))})"
    return "?" if key[0] < 0 else str(key[0])


def euler_sum(index: Sequence[int]) -> int:
    """The alternating sum of numbers by index."""
    return sum(index[::2]) - sum(index[1::2])


def operation_number(model: Model, found: Iterable[Counts]) -> int:
    """The number of stable solutions that there are in an operation range: the greatest one that
    occurs.

    A mechanism needs two of them at least: one that works in one stable pose everywhere has no
    range to be in. Those of the paper's mechanism are never more, so that its ranges are where two
    are stable.
    """
    return max((1, model.nouns.usual, *(counts.working for counts in found)))
