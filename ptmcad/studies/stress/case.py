"""A stress case: a question with extreme numbers, its tame sibling, and the answer with where it comes from.

Guarantee: all numbers are exact. An expected answer says what is known beforehand; what it leaves open is None.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from ptmcad.studies.slices import Exact


@dataclass(frozen=True, slots=True)
class PointQuestion:
    """All equilibria at a point: `ptmcad.solve`."""

    parameters: Mapping[str, Fraction]


@dataclass(frozen=True, slots=True)
class SliceQuestion:
    """The region map of a slice: `ptmcad.classify`, by the certified engine where springs have free lengths.

    Attributes
    ----------
    parameters : exact numbers, or text of them or of expressions in the axes.
    tolerance : the share of the window that the certified engine may leave undetermined.
    along, at : where an axis is named, the intervals of constant count along it at a value of the other one are asked
        instead: `ptmcad.intervals`.
    """

    parameters: Mapping[str, Exact]
    axes: Mapping[str, tuple[Fraction, Fraction]]
    tolerance: Fraction | None = None
    along: str = ""
    at: Mapping[str, Fraction] = field(default_factory=dict)


Question = PointQuestion | SliceQuestion


@dataclass(frozen=True, slots=True)
class PointAnswer:
    """Numbers of equilibria and of stable ones.

    Attributes
    ----------
    pose : the angles' cosines and sines at one of the equilibria (c1, s1, c2, s2), where one is known exactly.
    """

    total: int | None = None
    stable: int | None = None
    pose: tuple[Fraction, Fraction, Fraction, Fraction] | None = None


@dataclass(frozen=True, slots=True)
class MapAnswer:
    """Stable counts of the regions, in increasing order, and bounds for the area where two equilibria are stable.

    Of a certified map only the different counts are compared: what it leaves open may part a region.
    """

    stable: tuple[int, ...]
    area_of_two: tuple[Fraction, Fraction] | None = None


@dataclass(frozen=True, slots=True)
class LineAnswer:
    """Stable counts of the intervals in their order, and bounds for the ends between intervals of different counts."""

    stable: tuple[int, ...]
    ends: tuple[tuple[Fraction, Fraction], ...]


Answer = PointAnswer | MapAnswer | LineAnswer


@dataclass(frozen=True, slots=True)
class Case:
    """One stress case.

    Attributes
    ----------
    stiffness : what is extreme, as one positive number: a ratio of stiffnesses, lengths or forces, or the distance from
        a fold; the plot's horizontal axis.
    sibling : the tame question that costs are compared with.
    source : where the expected answer comes from.
    slow : whether it takes more than about a second.
    """

    name: str
    family: str
    stiffness: Fraction
    question: Question
    sibling: Question
    expected: Answer
    source: str
    slow: bool = field(default=False)

    @property
    def has_free_lengths(self) -> bool:
        """Whether a question is for the certified engine."""
        given = (*self.question.parameters.items(), *self.sibling.parameters.items())
        return any(name.startswith("l0") and value not in (0, "0") for name, value in given)
