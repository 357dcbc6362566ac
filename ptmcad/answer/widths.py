"""The width of the operation range against the other axis of a slice, as data.

Guarantee: what is proved of the place of the largest width is what `Maximum.place` says.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from ptmcad.answer.intervals import CountInterval, End
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
    operation: tuple[CountInterval, ...]
    remark: str = ""


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
