"""The members of a sweep and what was found of each, as data.

Guarantee: parameters' values are exact texts; areas and widths are decimals that bound the exact
numbers from outside. Seconds and attempts aside, a member is the same whatever the order, the
number of processes or the interruptions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING

from ptmcad.answer import with_methods
from ptmcad.answer.widths import Attainment
from ptmcad.errors import ConfigError
from ptmcad.text.numerals import Texts, equalities

if TYPE_CHECKING:
    from pandas import DataFrame

    from ptmcad.answer.regionmap import RegionMap


class State(Enum):
    """What has become of a member."""

    DONE = "done"
    REFUSED = "refused"
    """no engine takes these values, or a hypothesis fails; asking again would give the same answer
    """
    FAILED = "failed"
    """its process died or a limit stopped it, as many times as was to be tried; another run tries
    again
    """
    WAITING = "waiting"


Bounds = tuple[str, str]
"""Decimals below and above a number."""


@dataclass(frozen=True, slots=True)
class CountedArea:
    """The regions of one count: how many, and the bounds of their areas' sum.

    Attributes
    ----------
    count : the count that distinguishes regions, as text: ``2``, or ``2-3-1`` of an index; ``?``
        where it is not known.
    """

    count: str
    regions: int
    area: Bounds


@dataclass(frozen=True, slots=True)
class Widest:
    """The widest operation range along an axis.

    Attributes
    ----------
    width : of the range; None where there is none in the window, or the ``remark`` says why there
        is no answer.
    places : the values of the other axis at which it is attained or approached.
    proof : in words where it is attained or approached (`ptmcad.answer.widths.Maximum.words`).
    attainment : of the width (`ptmcad.answer.widths.overall`); of an older index not decided.
    """

    along: str
    width: Bounds | None = None
    places: tuple[Bounds, ...] = ()
    proof: str = ""
    remark: str = ""
    attainment: str = Attainment.UNDECIDED.value


@dataclass(frozen=True, slots=True)
class Summary:
    """What an index holds of a map.

    Attributes
    ----------
    status : of the map, such as ``exact``.
    undetermined : share of the window, an exact number as text.
    """

    status: str
    cells: int
    regions: int
    undetermined: str
    areas: tuple[CountedArea, ...]
    widest: Widest | None = None


@dataclass(frozen=True, slots=True)
class Member:
    """One member of a sweep.

    Attributes
    ----------
    parameters : names of what is swept to exact values as text.
    same_as : the first member with the same slice, whose result this one shares.
    error : why there is no result.
    file : the result's JSON, below the sweep's folder.
    digest : SHA-256 of that file.
    seconds : that the member took, in the process that computed it; not part of equality, as
        attempts are not.
    """

    number: int
    parameters: Texts
    state: State
    summary: Summary | None = None
    same_as: int | None = None
    error: str = ""
    file: str = ""
    digest: str = ""
    seconds: float | None = field(default=None, compare=False)
    attempts: int = field(default=0, compare=False)

    def __repr__(self) -> str:
        values = equalities(self.parameters)
        found = "" if self.summary is None else f", {self.summary.regions} regions"
        return f"<Member {self.number}: {values[:100]}; {self.state.value}{found}>"


@with_methods
@dataclass(frozen=True, slots=True, repr=False)
class Sweep:
    """A sweep that has run, wholly or in part; its members are read from the index in its folder
    when asked for.

    Attributes
    ----------
    folder : where the index and the results are.
    names : what is swept.
    states : numbers of members by what has become of them.
    """

    name: str
    folder: Path
    names: tuple[str, ...]
    states: Mapping[State, int]

    @property
    def complete(self) -> bool:
        """Whether every member has a result."""
        return self.states.get(State.DONE, 0) == len(self)

    def __len__(self) -> int:
        return sum(self.states.values())

    def __repr__(self) -> str:
        try:
            return self.table()
        except ConfigError:  # the folder is gone, or its index is damaged: a repr fails of nothing
            return (
                f"<Sweep {self.name}: {len(self)} members, which cannot be read in {self.folder}>"
            )

    if TYPE_CHECKING:  # `ptmcad.methods` has them

        def __iter__(self) -> Iterator[Member]: ...

        def __getitem__(self, number: int) -> Member: ...

        def table(self) -> str: ...

        def result(self, number: int) -> RegionMap: ...

        def to_csv(self) -> str: ...

        def to_dataframe(self) -> DataFrame: ...
