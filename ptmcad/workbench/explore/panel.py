"""The sliders of a record: which parameters one drags, between which ends, and the slice at given
values of them.

Guarantee: a value is an exact rational between its slider's ends; the slice at the values is the
one that a person gets who writes them into the record. No value is rounded.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from ptmcad.errors import ConfigError, ExpressionError, Place, shown
from ptmcad.model import Kind, Model
from ptmcad.question.config.binding import bound, member_name, written_in
from ptmcad.question.config.familyquestion import family_of
from ptmcad.question.config.problemrecord import Record
from ptmcad.question.config.resolution import slice_of
from ptmcad.question.config.scalars import number_of
from ptmcad.question.config.typed import ranges_of
from ptmcad.question.slice import Slice
from ptmcad.text.entry import Scalar
from ptmcad.text.numerals import Numbers, magnitude, text_of
from ptmcad.text.parsing import rational
from ptmcad.text.syntax import names_in

POSITIONS = 400
"""A slider has at most about so many, at round decimals."""
MAX_TEXT = 80
"""Characters of a number that the page may send."""
MAX_NAME = 100


@dataclass(frozen=True, slots=True)
class _Slider:
    """A parameter that one drags.

    Attributes
    ----------
    step : between neighbouring positions, which are its multiples; a round decimal.
    value : where it stands at first, which need be no multiple.
    free : whether it is the family's third parameter, so that its members have a variety in common.
    """

    name: str
    low: Fraction
    high: Fraction
    step: Fraction
    value: Fraction
    free: bool = False


@dataclass(frozen=True, slots=True)
class SliderPanel:
    """A record with its sliders; the free parameter, if there is one, comes first."""

    record: Record
    sliders: tuple[_Slider, ...]

    @property
    def model(self) -> Model:
        """Of the record."""
        return self.record.model

    def start(self) -> dict[str, Fraction]:
        """The values at first."""
        return {slider.name: slider.value for slider in self.sliders}

    def values(self, given: Mapping[str, str]) -> dict[str, Fraction]:
        """All sliders' values, of which some are given as text.

        Raises
        ------
        ConfigError
            For a name that no slider has, a text that is no number, or a number beyond the slider's
            ends.
        """
        values = self.start()
        known = {slider.name: slider for slider in self.sliders}
        for name, text in given.items():
            if name not in known:
                raise ConfigError(f"{shown(name, 40)} has no slider")
            values[name] = number_within(name, text, known[name].low, known[name].high)
        return values

    def record_at(self, values: Numbers) -> Record:
        """The record with the values of all sliders but the free one's."""
        changed = {
            slider.name: values[slider.name]
            for slider in self.sliders
            if not slider.free and values[slider.name] != slider.value
        }
        if not changed:
            return self.record
        scalars = {name: Scalar(text_of(value), Place(name)) for name, value in changed.items()}
        name = self.record.name + "".join(
            f"-{n}-{text_of(v).replace('/', '_')}" for n, v in changed.items()
        )
        return self.record._replace(
            name=name if len(name) <= MAX_NAME else f"{self.record.name[: MAX_NAME - 9]}-explored",
            values={**self.record.values, **scalars},
            title="",
            reference={},
        )

    def slice(self, values: Numbers) -> Slice:
        """The slice at the values, complete.

        Raises
        ------
        ConfigError
            When there is none.
        """
        record = self.record_at(values)
        if record.free is None:
            return slice_of(record)
        name, value = record.free[0], values[record.free[0]]
        return slice_of(
            bound(record, name, value)._replace(name=member_name(record, name, value)[:MAX_NAME])
        )


def panel_of(record: Record, ranges: Iterable[str] = ()) -> SliderPanel:
    """The sliders of a record: its free parameter, then every parameter that is a number; there may
    be none.

    Parameters
    ----------
    ranges : texts ``NAME=LO:HI``, the ends of sliders.

    Raises
    ------
    ConfigError
        For anything wrong with the record, or an end.
    """
    if not record.name:
        record = record._replace(name="-".join(("explored", *record.axes)))
    if record.free is None:
        member, first = slice_of(record), None
    else:
        family = family_of(record)
        axis = family.free
        first = min(family.values, key=lambda v: abs(2 * v - axis.low - axis.high))
        member = family.member(first)
    ends = dict(_ends(ranges))
    sliders = []
    if record.free is not None:
        assert first is not None
        low, high = ends.pop(axis.name, (axis.low, axis.high))
        if not axis.low <= low <= first <= high <= axis.high:
            low, high = axis.low, axis.high
        sliders.append(_Slider(axis.name, low, high, _step(low, high), first, free=True))
    for name, value in _numbers(record, member).items():
        low, high = ends.pop(name) if name in ends else _around(record.model, name, value)
        sliders.append(_Slider(name, min(low, value), max(high, value), _step(low, high), value))
    if ends:
        names = ", ".join(slider.name for slider in sliders) or "none, as no parameter is a number"
        raise ConfigError(
            f"{shown(next(iter(ends)), 40)} has no slider; sliders are {names}", key="--slider"
        )
    return SliderPanel(record, tuple(sliders))


def _numbers(record: Record, member: Slice) -> dict[str, Fraction]:
    """The parameters that are written as numbers, in the order of the model's; an alias is not
    beside its own.
    """
    texts = written_in(record, member)
    known = record.model.parameters
    for name in tuple(texts):  # of free lengths, which a slice has by the springs' own names alone
        if name not in record.values and known[name].alias_of in record.values:
            del texts[name]
            texts[known[name].alias_of] = record.values[known[name].alias_of].text
    free = None if record.free is None else record.free[0]
    return {
        name: number_of(Scalar(texts[name], Place(name)))
        for name in known
        if name in texts and name != free and not names_in(texts[name])
    }


def number_within(name: str, text: str, low: Fraction, high: Fraction) -> Fraction:
    """A number between two ends, which may be met.

    Raises
    ------
    ConfigError
        For a text that is none.
    """
    if len(text) > MAX_TEXT:
        raise ConfigError(f"the value of {name} has more than {MAX_TEXT} characters")
    try:
        value = rational(text)
    except ExpressionError as error:
        raise ConfigError(
            f"{name}: {shown(repr(text), 60)} is no number ({error.message})"
        ) from error
    if not low <= value <= high:
        raise ConfigError(f"{name} is between {text_of(low)} and {text_of(high)} here")
    return value


def _ends(ranges: Iterable[str]) -> Iterator[tuple[str, tuple[Fraction, Fraction]]]:
    """Texts ``NAME=LO:HI`` of sliders."""
    for name, window in ranges_of(ranges, "--slider").items():
        low, high = number_of(window.low), number_of(window.high)
        if low >= high:
            raise window.place.error("the range is empty or reversed")
        yield name, (low, high)


def _around(model: Model, name: str, value: Fraction) -> tuple[Fraction, Fraction]:
    """Where a parameter is dragged: the range that its description gives, or around its value."""
    parameter = model.parameters[name]
    kind = model.kind(name)
    if kind.is_positive:
        low, high = value / 10, 2 * value
    elif kind.may_vanish:
        low, high = Fraction(0), 2 * value or Fraction(1)
    elif value:
        low, high = sorted((Fraction(0), 2 * value))
    else:
        low, high = (
            (Fraction(-10), Fraction(10)) if kind is Kind.FORCE else (Fraction(-1), Fraction(1))
        )
    if parameter.window is not None:
        stated = [number_of(Scalar(text, Place(name))) for text in parameter.window]
        low, high = min(stated[0], value), max(stated[1], value)
    if low <= 0 and kind.is_positive:  # where the geometry ends, which is no value
        low = min(high / POSITIONS, value)
    return low, high


def _step(low: Fraction, high: Fraction) -> Fraction:
    """The least of 1, 2, 5 times a power of ten that gives at most `POSITIONS` positions."""
    least = (high - low) / POSITIONS
    unit = Fraction(10) ** magnitude(least)
    return next(f * unit for f in (1, 2, 5, 10) if f * unit >= least)
