"""The kinds of count as one table: what is counted, what that asks of a model, where it changes,
and how it is called.

Guarantee: data and plain functions that look at no solution. The question, both engines, answers
with their documents, tables, pictures and pages read this table for words, colours and margins; a
new kind with a predicate is a new row, and one in the checker, which derives predicates by itself
(`ptmcad.verification.kinds`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from enum import Enum
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from ptmcad.model import Mechanism, Model
from ptmcad.model.builtinmechanisms import title_of
from ptmcad.model.elements import difference, squared
from ptmcad.model.trees import negative, total
from ptmcad.text.tree import Tree

if TYPE_CHECKING:
    from ptmcad.text.enclosure import Enclosure


V = TypeVar("V")


class Count(Enum):
    """Which count distinguishes two regions."""

    STABLE = "stable"
    TOTAL = "total"
    INDEX = "index"
    ADMISSIBLE = "admissible"
    """stable equilibria at which every spring is longer than its free length"""

    @property
    def kind(self) -> CountKind:
        """Its row of the table."""
        return KINDS[self]

    @property
    def is_of_stable(self) -> bool:
        """Whether no other solutions than stable ones matter."""
        return self.kind.is_of_stable


class Shades(Enum):
    """By what a count's colour is chosen."""

    NUMBER = "one number after the other"
    TOTAL = "even numbers, with others for odd ones"
    INDEX = "minima, with hatches for saddles and maxima"


class Margin(NamedTuple, Generic[V]):
    """A quantity that has to be positive at a solution; where it vanishes a solution begins or
    stops to count.

    Attributes
    ----------
    text : what it is, in words or as it is written.
    value : in the parameters and unknowns of a model, or over a slice.
    curve, reason : the name of the curve on which it vanishes, and why the count changes there;
        empty for those that are made of the text.
    squares : the value is the sum of their squares, less something. Where this is zero all over a
        window the value has no simple zeros, and these vanish in its place.
    """

    text: str
    value: V
    curve: str = ""
    reason: str = ""
    squares: tuple[V, ...] = ()


class Predicate(NamedTuple):
    """What a stable solution has to satisfy beyond a model's own conditions.

    Attributes
    ----------
    margins : of a mechanism, all positive where it holds.
    is_symmetric : whether each symmetry of a mechanism's energy takes solutions at which it holds
        to such.
    needs_free_lengths : whether it says nothing without any.
    of_systems, without_free_lengths : what is wrong with this count of a model that has no springs,
        or none with a free length.
    of_pose : numbers of a `Pose` that are positive exactly where the margins are.
    head, note, tally : above its column of a table of poses, its meaning, and what follows the
        number of poses at which it holds; all empty where poses say nothing of it.
    is_always_stored : whether each certified map has its number, or null where that was not asked
        for: so it has been since that form of documents was made. Of others a map has the number
        that its count is of.
    """

    margins: Callable[[Mechanism], Iterator[Margin[Tree]]]
    is_symmetric: bool
    needs_free_lengths: bool
    of_systems: str
    without_free_lengths: str = ""
    of_pose: Callable[[Any], Sequence[Enclosure]] = lambda _pose: ()
    head: str = ""
    note: str = ""
    tally: str = ""
    is_always_stored: bool = False


class CountKind(NamedTuple):
    """A row of the table. Braces hold words of a model's (`ptmcad.answer.words.count_words`).

    Attributes
    ----------
    phrase : what is counted, as a record's help says it.
    legend : above the legend of a picture.
    tail : after the number.
    page : after "by".
    shades : by what its colours are chosen.
    rank : 0 is the finest; of several counts of the same the first one says most.
    implied : the kinds of which two places have the same number where they have the same of this
        kind.
    is_of_stable : whether no other solutions than stable ones matter.
    needs : what a model's criterion counts for it.
    predicate : None where each (stable) solution counts.
    """

    phrase: str
    legend: str
    tail: str
    page: str
    shades: Shades
    rank: int
    implied: tuple[Count, ...]
    is_of_stable: bool = False
    needs: str = "stable"
    predicate: Predicate | None = None

    @property
    def is_symmetric(self) -> bool:
        """Whether each symmetry of a model's energy keeps the number."""
        return self.predicate is None or self.predicate.is_symmetric


def _longer_than_free(mechanism: Mechanism) -> Iterator[Margin[Tree]]:
    """|d|^2 - l0^2 of each spring, d being the vector between its ends: of the sign of |d| - l0, as
    no free length is negative. Lengths that are constant are in no description."""
    for spring in mechanism.springs:
        name = title_of(spring, mechanism)
        vector = difference(mechanism.points[spring.start], mechanism.points[spring.end])
        yield Margin(
            text=f"the length of spring {name} less its free length",
            curve=f"point where spring {name} has its free length",
            reason=f"spring {name} of a stable equilibrium has its free length",
            value=total(*map(squared, vector), negative(squared(spring.free))),
            squares=vector,
        )


KINDS = {
    Count.STABLE: CountKind(
        phrase="stable equilibria",
        legend="Stable {noun}",
        tail="stable",
        page="the number of stable {noun}",
        shades=Shades.NUMBER,
        rank=2,
        implied=(Count.STABLE,),
        is_of_stable=True,
    ),
    Count.TOTAL: CountKind(
        phrase="all of them",
        legend="{Noun}",
        tail="{in_all}",
        page="the number of {noun}",
        shades=Shades.TOTAL,
        rank=1,
        implied=(Count.TOTAL,),
        needs="total",
    ),
    Count.INDEX: CountKind(
        phrase="minima/saddles/maxima",
        legend="({index})",
        tail="({index})",
        page="the numbers of {indices}",
        shades=Shades.INDEX,
        rank=0,
        implied=(Count.STABLE, Count.TOTAL, Count.INDEX),
        needs="index",
    ),
    Count.ADMISSIBLE: CountKind(
        phrase="stable equilibria with every spring longer than its free length",
        legend="Stable, all springs taut",
        tail="stable and admissible",
        page="the number of stable equilibria with every spring longer than its free length",
        shades=Shades.NUMBER,
        rank=3,
        implied=(Count.ADMISSIBLE,),
        is_of_stable=True,
        predicate=Predicate(
            margins=_longer_than_free,
            is_symmetric=True,
            needs_free_lengths=True,
            of_systems="a system has no springs whose lengths would be admissible: count stable or total",
            without_free_lengths="admissible asks that every spring is longer than its free length, and none has a "
            "free length here: choose stable",
            of_pose=lambda pose: pose.forces,
            head="tense",
            note="stable, and every spring longer than its free length; a negative force pushes",
            tally="stable with every spring longer than its free length",
            is_always_stored=True,
        ),
    ),
}
"""The table."""
USUAL = Count.STABLE
"""The count of a slice that names none."""
PREDICATES = {
    count.value: kind.predicate for count, kind in KINDS.items() if kind.predicate is not None
}
"""Those of the table by the names of their counts."""
POSE_COLUMNS = {name: predicate for name, predicate in PREDICATES.items() if predicate.head}
"""Those of which poses and their tables say whether they hold."""


def further_names(count: Count) -> tuple[str, ...]:
    """The predicates of which a certified map by this count has a number, or null, for each cell
    and region.
    """
    return tuple(
        name for name, each in PREDICATES.items() if each.is_always_stored or name == count.value
    )


def phrases() -> str:
    """What is counted, all kinds in their order."""
    *first, last = (kind.phrase for kind in KINDS.values())
    return f"{', '.join(first)}, or {last}"


def usual_count(model: Model) -> Count:
    """Where none is asked for, that of stable solutions, where it is known what these are."""
    return Count(model.criterion.counts[:2][-1])
