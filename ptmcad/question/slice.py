"""A slice: a two-parameter family of mechanisms over a rectangular window, with exact rational
data.

A slice carries what is known of the signs of its quantities in its window. A `Finding` says of which
function and in which window it holds, so that it cannot be taken for that of another one: a slice
whose parameters or axes were changed by hand carries none of the new ones.

Guarantee: a `Slice` that `config` has built is complete (every parameter of the mechanism has a
value as a rational function of the two axes), its window is a nonempty rectangle, and no number in
it was rounded.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, NamedTuple, TypeVar

from ptmcad.errors import ConfigError
from ptmcad.model import Kind, Model
from ptmcad.model.evaluate import value_among
from ptmcad.model.work import foreign, split_moments
from ptmcad.question.counts import USUAL, Count
from ptmcad.text.expressions import Expression, Expressions, constant
from ptmcad.text.numerals import Texts
from ptmcad.text.plane import Names

QUANTITIES = ("length", "force")
"""Whose units a record may declare."""
MAX_UNIT = 20
"""Characters of one."""


class Axis(NamedTuple):
    """One axis of the window: the open interval ``low < name < high`` (its ends belong to the
    picture's edge).
    """

    name: str
    low: Fraction
    high: Fraction

    def __str__(self) -> str:
        return f"{self.name} in [{self.low}, {self.high}]"

    @property
    def width(self) -> Fraction:
        """The length of the range."""
        return self.high - self.low

    def at(self, share: Fraction) -> Fraction:
        """The value that lies at a share of the range, from the lower end."""
        return self.low + self.width * share

    def middle(self, number: int = 0, parts: int = 1) -> Fraction:
        """The middle of one of so many equal parts of the range, counted from 0."""
        return self.at(Fraction(2 * number + 1, 2 * parts))

    def share(self, value: Fraction) -> Fraction:
        """At which share of the range a value lies."""
        return (value - self.low) / self.width

    def holds(self, value: Fraction) -> bool:
        """Whether a value lies inside of the range, and not at its ends."""
        return self.low < value < self.high


Axes = tuple[Axis, Axis]
"""Those of a window, the horizontal one first."""

Corner = tuple[Fraction, Fraction]
Interval = tuple[Fraction, Fraction]
Box = tuple[Interval, Interval]


class Witness(NamedTuple):
    """A point of the open window at which the function is not what was asked for.

    Attributes
    ----------
    value : of the function there, or of its denominator when a pole is the matter.
    other : for a pole, a point at which the denominator has the other sign, if one was found.
    """

    point: Corner
    value: Fraction
    other: Corner | None = None


Verdict = Witness | tuple[Box, ...]
"""A witness, or the boxes that hide all dips to zero or below; their number is zero for a proof."""
PROVED: tuple[Box, ...] = ()
"""The function is what was asked for at every point of the open window."""


class Subject(NamedTuple):
    """A parameter, or a stiffness or a length that is written where a spring or a bar has it.

    Attributes
    ----------
    text : the parameter's name, or the expression as a message shows it.
    kind : what it measures, which decides what sign it needs.
    value : as a function of the axes.
    part : where it is written in the description, such as ``springs.2.k``; empty of a parameter.
    """

    text: str
    kind: Kind
    value: Expression
    part: str = ""


class Finding(NamedTuple):
    """Whether a subject is in the whole open window what its kind asks for.

    Attributes
    ----------
    problem : what is wrong or not proved, in words; empty where it is proved.
    is_final : whether more work would find nothing else.
    """

    subject: Subject
    window: Box
    verdict: Verdict
    problem: str = ""
    is_final: bool = True


@dataclass(frozen=True, slots=True)
class Slice:
    """The question that is put to `ptmcad.classify`.

    Attributes
    ----------
    name : used for the names of the files that are written.
    model : the mechanism, or another parametric system.
    axes : the two axes, first the horizontal one.
    parameters : every parameter of the model as an `Expression` (a rational function in the two
        axes, exponent pairs in the order of ``axes``). An axis that is itself a parameter maps to
        itself. The free lengths are among them unless all of them are zero everywhere.
    count : which count distinguishes two regions.
    title : the picture's title, the name when empty.
    reference : published answers, as read from the record; never used by the computation.
    text : each parameter as the user wrote it, for reports; and any of k, l0, l0_1, l0_2 and l0_3
        that such a text names, even where it is not among the parameters. An axis has only the text
        of the parameter that it is.
    units : of ``length`` and ``force``, where they are declared; nothing but text depends on them.
    signs : what is proved of these parameters in this window, and what is not
        (`ptmcad.question.domain`).
    """

    name: str
    model: Model
    axes: Axes
    parameters: Expressions
    count: Count = USUAL
    title: str = ""
    reference: Mapping[str, Any] = field(default_factory=dict)
    text: Texts = field(default_factory=dict)
    units: Texts = field(default_factory=dict)
    signs: tuple[Finding, ...] = field(default=(), compare=False, repr=False)

    @property
    def axis_names(self) -> Names:
        return (self.axes[0].name, self.axes[1].name)

    @property
    def area(self) -> Fraction:
        """Of the window."""
        return self.axes[0].width * self.axes[1].width

    @property
    def mechanism(self) -> str:
        """The model's name, ``"ptm"`` for the paper's mechanism."""
        return self.model.name

    def __repr__(self) -> str:
        window = ", ".join(map(str, self.axes))
        return f"<Slice {self.name} of {self.mechanism}: {window}, counted by {self.count.value}>"

    @property
    def has_free_lengths(self) -> bool:
        """Whether some spring has a free length that is not zero everywhere; algebra cannot answer
        then.
        """
        return have_free_lengths(self.model, self.parameters)

    @property
    def heading(self) -> str:
        """The title; without one, what is fixed and how parameters depend on the axes, such as
        "L1 = 1, k = 100".
        """
        return self.title or ", ".join(self.fixed) or self.name

    @property
    def fixed(self) -> tuple[str, ...]:
        """What is fixed and how parameters depend on the axes, one by one, such as "L1 = 1"."""
        values = {
            name: expression.to_text(self.axis_names)
            for name, expression in self.parameters.items()
        }
        values = merged(values, self.model)
        found = []
        for name, value in values.items():
            if value not in (name, "0"):
                shown = value if len(value) <= MAX_HEADING_VALUE else self.text.get(name, value)
                if len(shown) > MAX_HEADING_VALUE:
                    shown = f"{shown[: MAX_HEADING_VALUE - 1]}…"
                found.append(f"{name} = {shown}")
        if {values[name] for name in values if name in self.model.forces} == {"0"}:
            found.append("no load")
        return tuple(found)


_Value = TypeVar("_Value", bound=Hashable)


def merged(values: Mapping[str, _Value], model: Model) -> dict[str, _Value]:
    """Values as shown: a shorthand in place of its parameters where these agree, and not beside
    them where not.
    """
    shown = dict(values)
    for shorthand, names in model.shorthands.items():
        own = {shown[name] for name in names if name in shown}
        if len(own) == 1:
            shown = {name: value for name, value in shown.items() if name not in names} | {
                shorthand: own.pop()
            }
        else:
            shown.pop(shorthand, None)
    return shown


def check_names(model: Model, parameters: Mapping[str, object]) -> None:
    """Check that there is a value of each parameter that the model uses, but of free lengths, and
    of no others.

    Of a mechanism that is known by its name alone nothing is said.

    Raises
    ------
    ValueError
    """
    for name in model.variables:
        if name not in parameters and name not in model.free_lengths:
            raise ValueError(f"there is no value of {name}")
    for name in parameters:
        if model.parameters and name not in model.parameters:
            raise ValueError(f"there is no parameter {name}")


def have_free_lengths(model: Model, parameters: Expressions) -> bool:
    """Whether some spring has a free length that is not zero everywhere; a parameter that is
    missing is zero.
    """
    return bool(relaxed_springs(model, parameters))


def relaxed_springs(model: Model, parameters: Expressions) -> tuple[int, ...]:
    """The numbers of those springs."""
    known = dict.fromkeys(model.parameters, constant(0)) | dict(parameters)
    free = () if model.whole is None else model.whole.written(Kind.FREE_LENGTH)
    return tuple(k for k, tree in enumerate(free) if value_among(tree, known, constant).numerator)


def count_fault(count: Count, model: Model, parameters: Expressions) -> str:
    """Why a count makes no sense for a model; empty where it does."""
    kind, mechanism, predicate = count.kind, model.whole, count.kind.predicate
    if predicate is not None and mechanism is None:
        return predicate.of_systems
    if (
        predicate is not None
        and predicate.needs_free_lengths
        and not have_free_lengths(model, parameters)
    ):
        return predicate.without_free_lengths
    if (
        predicate is not None and mechanism is not None and mechanism.followers
    ):  # margins are in the unknowns alone
        return f"with x-joints {count.value} is not counted yet: count stable or total"
    if kind.needs in model.criterion.counts:
        return ""
    if not kind.is_of_stable:
        return "solutions of equations have no index, which is that of a potential's Hessian: count total"
    if mechanism is None:
        return "nothing says what a stable solution is: add conditions as 'stable:' to the system, or count total"
    return f"{foreign(mechanism)} that depends on another unknown has no potential, which says what is stable: count total"


def moved(model: Model, parameters: Expressions) -> tuple[str, ...]:
    """The unknowns on which a moment, or a force on a length, does work that is in no stored
    energy.
    """
    known = dict.fromkeys(model.parameters, constant(0)) | dict(parameters)
    # a moment that depends on another unknown is none of the axes alone
    return tuple(
        unknown
        for unknown, moment in split_moments(model)[0]
        if model.coupled or value_among(moment, known, constant).numerator
    )


def without_free_lengths(
    model: Model,
    parameters: Expressions,
    what: str,
    instead: str = "ptmcad classify encloses them",
) -> dict[str, Expression]:
    """The parameters for algebra, which would leave free lengths out: they have to be zero.

    Parameters
    ----------
    what : that is not computed otherwise, as the start of a sentence.
    instead : what is computed, for the same sentence.

    Raises
    ------
    ConfigError
        When a spring has a free length.
    """
    if have_free_lengths(model, parameters):
        raise ConfigError(
            f"{what} not computed for springs with a free length, which bring in square roots and curves of degree "
            f"over 1000; {instead}"
        )
    return {name: value for name, value in parameters.items() if name not in model.free_lengths}


MAX_HEADING_VALUE = 24
"""Longer values are cut in a heading."""


class Point(tuple[Fraction, Fraction]):
    """A point of the window: a pair of exact rationals, indexed by position or by the axis's name.

    >>> p = Point(("rho", "L2"), Fraction(7, 10), Fraction(3, 2))
    >>> p[0], p["L2"], dict(p)
    (Fraction(7, 10), Fraction(3, 2), {'rho': Fraction(7, 10), 'L2': Fraction(3, 2)})
    """

    names: Names

    def __new__(cls, names: Names, x: Fraction, y: Fraction) -> Point:
        point = super().__new__(cls, (x, y))
        point.names = names
        return point

    def __getnewargs__(self) -> tuple[Names, Fraction, Fraction]:
        return (self.names, tuple.__getitem__(self, 0), tuple.__getitem__(self, 1))

    def keys(self) -> Iterator[str]:
        """The axes' names, so that ``dict(point)`` and ``locate(**point)`` work."""
        return iter(self.names)

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str):
            if key not in self.names:
                raise KeyError(key)
            return tuple.__getitem__(self, self.names.index(key))
        return tuple.__getitem__(self, key)


@contextmanager
def within_doubles(slice: Slice) -> Iterator[None]:
    """Numbers are small enough inside.

    Raises
    ------
    ConfigError
        When one is not.
    """
    try:
        yield
    except OverflowError as error:
        raise ConfigError(
            f"{slice.name} has numbers beyond doubles, 1.8e308: there are no arrays of it"
        ) from error
