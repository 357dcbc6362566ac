"""What is designed: the question of `ptmcad.design`, with the slices and points of its designs.

Guarantee: the slice of a design is the one that the options ``--set`` would ask for with its
parameters' values.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from ptmcad.errors import ExpressionError, Place
from ptmcad.model import Model
from ptmcad.question.config.binding import with_numbers
from ptmcad.question.config.familyquestion import Family, family_of
from ptmcad.question.config.problemrecord import Record
from ptmcad.question.config.resolution import axis_of, point_of, slice_of
from ptmcad.question.config.scalars import Window
from ptmcad.question.inequalities import Bounds, Inequality, named
from ptmcad.question.slice import Axis, Slice
from ptmcad.text.entry import Scalar
from ptmcad.text.numerals import Numbers


class Aim(Enum):
    """What kind of number is made as large as possible."""

    RANGE = "range"
    AREA = "area"
    BARRIER = "barrier"
    EXPRESSION = "expression"


@dataclass(frozen=True, slots=True)
class Design:
    """The question that is put to `ptmcad.design`.

    Attributes
    ----------
    record : without its design.
    maximise : as it is written.
    along : the axis along which a range lies; empty for another aim.
    over : the design parameters with their bounds, the slice's axes among them first.
    working : the wanted number of stable solutions, or of all where nothing says what is stable.
    conditions : inequalities between the design parameters.
    tension : whether it is asked that all springs are in tension.
    pose : of what an expression or a barrier is one.
    """

    record: Record
    maximise: str
    along: str
    over: tuple[Axis, ...]
    working: int
    conditions: tuple[Inequality, ...] = ()
    tension: bool = False
    pose: str = "stable:1"

    @property
    def aim(self) -> Aim:
        """The kind of what is maximised."""
        return next(
            (a for a in Aim if a.value == self.maximise and a is not Aim.EXPRESSION), Aim.EXPRESSION
        )

    @property
    def name(self) -> str:
        """The start of the names of the files that are written."""
        return f"{self.record.name or 'design-' + '-'.join(a.name for a in self.over)}-design"

    @property
    def model(self) -> Model:
        return self.record.model

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The axes that vary in every design: that of a range's line, or those of an area's window."""
        names = {Aim.RANGE: (self.along,), Aim.AREA: tuple(self.record.axes)}.get(self.aim, ())
        return tuple(axis_of(name, self.record.axes[name], self.model) for name in names)

    @property
    def middle(self) -> dict[str, Fraction]:
        """The design in the middle of the bounds."""
        return {axis.name: axis.middle() for axis in self.over}

    @property
    def text(self) -> dict[str, str]:
        """The parameters that the record gives, as they are written, without those of the design."""
        return {
            name: scalar.text for name, scalar in _without(self.record, self.over).values.items()
        }

    @property
    def family(self) -> Family | None:
        """The family of which all designs are lines or members; None where there are fewer or more
        coordinates.
        """
        if self.aim is Aim.RANGE and len(self.over) == 2:
            return family_of(self._line_record()._replace(free=_free(self.over[1])))
        if self.aim is Aim.AREA and len(self.over) == 1:
            return family_of(_without(self.record, self.over)._replace(free=_free(self.over[0])))
        return None

    def slice(self, values: Numbers) -> Slice:
        """The slice of a design: for a range that in which the line lies, over the first design
        parameter.

        Parameters
        ----------
        values : of the design parameters; of one that is an axis none is needed.

        Raises
        ------
        ConfigError
            When the mechanism does not take such values.
        """
        record = self._line_record() if self.aim is Aim.RANGE else _without(self.record, self.over)
        given = {n: v for n, v in values.items() if n not in record.axes}
        return slice_of(with_numbers(record, given, {})._replace(title="", reference={}))

    def point(self, values: Numbers) -> dict[str, Fraction]:
        """Every parameter of the model at a design that leaves no axis free.

        Raises
        ------
        ConfigError
            When the mechanism does not take such values.
        """
        return point_of(with_numbers(_without(self.record, self.over), values, {}))

    def holds(self, values: Numbers) -> bool:
        """Whether a design satisfies the conditions."""
        return self.may_hold({name: (value, value) for name, value in values.items()})

    def may_hold(self, box: Mapping[str, Bounds]) -> bool:
        """Whether it is not excluded that a design with parameters in these intervals satisfies the
        conditions.
        """
        value = named(box, self._texts())
        for condition in self.conditions:
            try:
                if condition.bounds(value)[1] < 0:
                    return False
            except ExpressionError:
                if all(low == high for low, high in box.values()):
                    return False
        return True

    def _texts(self) -> dict[str, str]:
        known = {
            name: parameter.default
            for name, parameter in self.model.parameters.items()
            if parameter.default
        }
        return known | {name: scalar.text for name, scalar in self.record.values.items()}

    def _line_record(self) -> Record:
        """The slice of the line's parameter and the first design parameter."""
        windows = {
            self.along: self.record.axes[self.along],
            self.over[0].name: _window(self.over[0]),
        }
        return _without(self.record, self.over)._replace(axes=windows)


def _without(record: Record, over: Iterable[Axis]) -> Record:
    """The record without the values that design parameters have in it."""
    names = {axis.name for axis in over}
    return record._replace(values={n: v for n, v in record.values.items() if n not in names})


def _free(axis: Axis) -> tuple[str, Window]:
    return axis.name, _window(axis)


def _window(axis: Axis) -> Window:
    place = Place(f"design.over.{axis.name}")
    return Window(Scalar(str(axis.low), place), Scalar(str(axis.high), place), place)
