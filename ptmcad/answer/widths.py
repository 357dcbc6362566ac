"""The width of the operation range against the other axis of a slice, as data.

Guarantee: what is proved of the place of the largest width is what `Maximum.place` says.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from ptmcad.answer import with_methods
from ptmcad.answer.intervals import End, OperationSpan
from ptmcad.mechanism import Model
from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure


class Place(Enum):
    """What is proved about the place of the largest width."""

    CRITICAL = "attained only at a critical value of the other axis"
    SMOOTH = "where the derivative vanishes, once in the enclosure"
    EDGE = "approached at the edge of the window, not attained in it"
    PLATEAU = "on a whole interval, where the width is constant"
    ENCLOSED = "somewhere in the enclosure"


@dataclass(frozen=True, slots=True)
class Maximum:
    """The largest width of an operation range.

    Attributes
    ----------
    at : encloses its place on the other axis; exact where the place is a rational number.
    width : encloses the width.
    critical : the critical value of the other axis at which the place is, or which alone the enclosure of it holds.
    ends : the range's ends there (its limits), where they are known exactly.
    """

    place: Place
    at: Enclosure
    width: Enclosure
    critical: AlgebraicNumber | None = None
    ends: tuple[End, End] | None = None


@dataclass(frozen=True, slots=True)
class WidthRow:
    """The operation ranges at one value of the other axis; ``remark`` says why there is no answer."""

    value: Fraction
    operation: tuple[OperationSpan, ...]
    remark: str = ""


@with_methods
@dataclass(frozen=True, slots=True)
class OperationWidths:
    """The answer of ``--over``; ``maxima`` is empty when there is no operation range in the window, and has several
    entries when places tie or could not be distinguished. ``working`` is the number of stable solutions in a range."""

    name: str
    along: Axis
    over: Axis
    rows: tuple[WidthRow, ...]
    maxima: tuple[Maximum, ...]
    model: Model
    working: int

    def __repr__(self) -> str:
        return f"<OperationWidths of {self.name} along {self.along.name} over {self.over.name}: {len(self.rows)} rows>"


@dataclass(frozen=True, slots=True)
class CertifiedRange:
    """An operation range whose ends are enclosed, exact at the window's edge."""

    low: Enclosure
    high: Enclosure

    @property
    def width(self) -> Enclosure:
        """Its length, as narrowly as the ends are enclosed."""
        return Enclosure(self.high.low - self.low.high, self.high.high - self.low.low)


@dataclass(frozen=True, slots=True)
class CertifiedRow:
    """The operation ranges at one value of the other axis; ``undecided`` when counts of a part are not known there,
    and ``remark`` says why there is no answer at all."""

    value: Fraction
    operation: tuple[CertifiedRange, ...]
    undecided: bool
    remark: str = ""


@dataclass(frozen=True, slots=True)
class CertifiedWidths:
    """The answer of ``--over`` with free lengths: a table, of which the widest row is no proof of the widest range.

    ``working`` is the number of stable solutions that there are in a range at least.
    """

    name: str
    along: Axis
    over: Axis
    rows: tuple[CertifiedRow, ...]
    model: Model
    working: int

    @property
    def widest(self) -> tuple[CertifiedRow, CertifiedRange] | None:
        """The row with the widest range, by the middles of what encloses the widths."""
        found = [(row, one) for row in self.rows for one in row.operation]
        return max(found, key=lambda pair: pair[1].width.low + pair[1].width.high, default=None)
