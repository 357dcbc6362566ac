"""The width of the operation range against the other axis of a slice, as data.

Guarantee: what is proved of the largest width is what `Maximum.place` and `Maximum.attainment` say;
`Maximum.words` is the one text of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from ptmcad.answer import with_methods
from ptmcad.answer.intervals import End, OperationSpan
from ptmcad.answer.words import listed
from ptmcad.model import Model
from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import DIGITS, AlgebraicNumber, Enclosure


class Place(Enum):
    """Where the largest width is."""

    CRITICAL = "a critical value of the other axis"
    SMOOTH = "where the derivative vanishes, once in the enclosure"
    EDGE = "the edge of the window"
    PLATEAU = "a whole interval, where the width is constant"
    ENCLOSED = "somewhere in the enclosure"


class Attainment(Enum):
    """Whether a supremum is a value: what is counted on the line itself decides, not a limit from
    beside it.
    """

    ATTAINED = "attained"
    APPROACHED = "approached but not attained"
    EXCEPT = "attained except at"
    UNDECIDED = "attainment not decided"


@dataclass(frozen=True, slots=True)
class Maximum:
    """The largest width of an operation range.

    Attributes
    ----------
    at : encloses its place on the other axis; exact where the place is a rational number.
    width : encloses the width.
    critical : the critical value of the other axis at which the place is, or which alone the
        enclosure of it holds.
    ends : the range's ends there, or their limits, where they are known exactly.
    attained : whether the width is that of a range, of an interval at all values but ``exceptions``
        and ``doubtful`` ones; None where that is not decided.
    exceptions : values in an interval, or at its ends, at which it is not attained.
    doubtful : those at which that is not decided.
    """

    place: Place
    at: Enclosure
    width: Enclosure
    critical: AlgebraicNumber | None = None
    ends: tuple[End, End] | None = None
    attained: bool | None = None
    exceptions: tuple[End, ...] = ()
    doubtful: tuple[End, ...] = ()

    @property
    def attainment(self) -> Attainment:
        if self.attained is None:
            return Attainment.UNDECIDED
        if not self.attained:
            return Attainment.APPROACHED
        return Attainment.EXCEPT if self.exceptions else Attainment.ATTAINED

    def words(self, over: str, digits: int = DIGITS) -> str:
        """Where on the other axis the width is attained, or approached."""
        if self.place is Place.PLATEAU:
            low, high = (
                AlgebraicNumber.of(end).text(digits) for end in (self.at.low, self.at.high)
            )
            parts = [f"attained on the interval {over} from {low} to {high}"]
            if self.exceptions:
                parts.append(f"except at {_listed(over, self.exceptions, digits)}")
            if self.doubtful:
                parts.append(f"(attainment not decided at {_listed(over, self.doubtful, digits)})")
            return " ".join(parts)
        if self.place is Place.CRITICAL and self.critical is not None:
            at = self.critical.text(digits)
        elif self.at.settles(digits):
            at = self.at.text(digits)
        else:
            low, high = (AlgebraicNumber.of(end).text(3) for end in (self.at.low, self.at.high))
            at = f"a value between {low} and {high}"
        what = self.place.value.replace("the other axis", over)
        if self.critical is not None and self.critical.exact is None:
            held = ", which holds one critical value" if self.place is Place.ENCLOSED else ""
            what += f"{held}, a root of a polynomial of degree {self.critical.degree}"
        return f"{self.attainment.value} at {over} = {at}, {what}"


def overall(maxima: Sequence[Maximum]) -> Attainment:
    """Whether the largest width is attained anywhere: where places differ, one that certainly has
    it decides.
    """
    most = max(m.width.high for m in maxima)
    certain = [m.attainment for m in maxima if m.attained and m.width.low == most]
    if len({m.attainment for m in maxima}) == 1:
        return maxima[0].attainment
    return certain[0] if certain else Attainment.UNDECIDED


def _listed(over: str, values: tuple[End, ...], digits: int) -> str:
    """Values of an axis, such as b = 0 and b = 1."""
    texts = [f"{over} = {AlgebraicNumber.of(v).text(digits)}" for v in values]
    return listed(texts)


@dataclass(frozen=True, slots=True)
class WidthRow:
    """The operation ranges at one value of the other axis; ``undecided`` where counts of a part are
    not known there, and ``remark`` says why there is no answer at all."""

    value: Fraction
    operation: tuple[OperationSpan, ...]
    undecided: bool = False
    remark: str = ""


@with_methods
@dataclass(frozen=True, slots=True)
class OperationWidths:
    """The answer of ``--over``.

    Attributes
    ----------
    maxima : where the range is widest; empty when there is none in the window, and several when
        places tie or could not be distinguished.
    working : the number of stable solutions in a range.
    enclosed : whether ends are enclosures, as springs have free lengths. Then ``working`` is the
        least number, and there are no maxima: the widest row is no proof of the widest range.
    """

    name: str
    along: Axis
    over: Axis
    rows: tuple[WidthRow, ...]
    maxima: tuple[Maximum, ...]
    model: Model
    working: int
    enclosed: bool = False

    @property
    def widest(self) -> tuple[WidthRow, OperationSpan] | None:
        """The row with the widest range, by the middles of what encloses the widths."""
        found = [(row, one) for row in self.rows for one in row.operation]
        return max(found, key=lambda pair: pair[1].width.center, default=None)

    def __repr__(self) -> str:
        return f"<OperationWidths of {self.name} along {self.along.name} over {self.over.name}: {len(self.rows)} rows>"
