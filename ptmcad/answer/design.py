"""The best design within bounds as data: where it is, what it attains, and what no other exceeds.

Guarantee: ``value`` is the exact evaluation at ``best``, enclosed. ``bound`` is exceeded by no
design within the bounds that satisfies the conditions, but for designs on a set without interior
(docs/method.md says which); where there is no such bound it is None, and ``proved`` is False.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from ptmcad.answer import with_methods
from ptmcad.answer.widths import Maximum
from ptmcad.model import Model
from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import Enclosure


@dataclass(frozen=True, slots=True)
class Evaluation:
    """A design that was looked at; ``value`` is None where it has none: conditions or the count are
    not met.
    """

    at: tuple[Fraction, ...]
    value: Enclosure | None


@dataclass(frozen=True, slots=True)
class BoundedBox:
    """A box of designs, by the ranges of its parameters, with a bound that none of them exceeds."""

    ranges: tuple[tuple[Fraction, Fraction], ...]
    bound: Fraction


@with_methods
@dataclass(frozen=True, slots=True, repr=False)
class BestDesign:
    """The answer of ``ptmcad design``.

    Attributes
    ----------
    maximise : what was made as large as possible: range, area, barrier, or an expression.
    along : the parameter along which a range lies, with its window; None for another aim.
    fixed : the axes of the window of an area; none for another aim.
    over : the design parameters with their bounds.
    working : the number of stable solutions that there are in a range, a region or at a point.
    conditions : inequalities that every design satisfies.
    best : the best design that was found; None when none has a value.
    value : what it attains, enclosed; exact where the ends are equal.
    span : of a range the enclosures of its two ends; None for another aim.
    bound : what no design exceeds; None where nothing is proved of it.
    tolerance : of the bound over the value, as a share of the value.
    proved : whether the bound is at most (1 + tolerance) times the value.
    reason : in words what is proved, and how.
    evaluations : so many designs were evaluated exactly.
    seed : of the global search.
    points : the designs that were evaluated, in that order.
    boxes : those on which the bound rests, without those on which a condition fails; none where
        there is no bound or it does not rest on boxes.
    parameters : of every design, as they are written.
    maxima : where one parameter's widest ranges are, and whether they are attained there; empty
        where the bound does not rest on exact critical values.
    """

    name: str
    model: Model
    maximise: str
    along: Axis | None
    fixed: tuple[Axis, ...]
    over: tuple[Axis, ...]
    working: int
    conditions: tuple[str, ...]
    best: Mapping[str, Fraction] | None
    value: Enclosure | None
    span: tuple[Enclosure, Enclosure] | None
    bound: Fraction | None
    tolerance: Fraction
    proved: bool
    reason: str
    seed: int
    points: tuple[Evaluation, ...]
    boxes: tuple[BoundedBox, ...]
    parameters: Mapping[str, str]
    maxima: tuple[Maximum, ...] = ()

    @property
    def evaluations(self) -> int:
        return len(self.points)

    def __repr__(self) -> str:
        if self.best is None or self.value is None:
            return f"<BestDesign of {self.name}: none was found>"
        place = ", ".join(f"{name} = {float(value):.6g}" for name, value in self.best.items())
        known = (
            "proved"
            if self.proved
            else "bounded"
            if self.bound is not None
            else "no bound elsewhere"
        )
        return f"<BestDesign of {self.name}: {self.maximise} {float(self.value):.6g} at {place}, {known}>"

    if TYPE_CHECKING:  # `ptmcad.methods` has them

        def table(self) -> str: ...

        def to_json(self) -> str: ...

        @classmethod
        def from_json(cls, text: str) -> BestDesign: ...

        def save(self, path: object) -> None: ...
