"""The members of a family, from the discriminant variety that they have in common.

Guarantee: a member's map is that of its slice alone, timings apart. What cannot be computed in
common, is computed for the member alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from ptmcad.answer.family import FamilyMap, SpaceTerms
from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.classification import region_map
from ptmcad.errors import ConfigError, DegenerateSliceError, ExpressionError, InfiniteSolutionsError
from ptmcad.model import Model
from ptmcad.options import DEFAULTS, Options, is_certified
from ptmcad.question.config import Family, member_like
from ptmcad.question.slice import Axes, Axis, Slice
from ptmcad.text.numerals import text_of

if TYPE_CHECKING:
    from ptmcad.exact.familyvariety import FamilyVariety
    from ptmcad.exact.models.system import SystemOnAxes


class _FamilyOfMaps(NamedTuple):
    """A family as a question, read off its maps."""

    free: Axis
    values: tuple[Fraction, ...]
    axes: Axes
    text: Mapping[str, str]
    model: Model
    member: Callable[[Fraction], Slice]


AskedFamily = Family | _FamilyOfMaps


def restored(maps: FamilyMap) -> _FamilyOfMaps:
    """The family whose maps are given.

    A member is a `ConfigError` when the maps do not say of what the family's parameters are made,
    or that divides by zero at its value.
    """
    slice = maps.members[0].slice

    def member(value: Fraction) -> Slice:
        try:
            return member_like(slice, maps.text, maps.free.name, value)
        except ExpressionError as error:
            raise ConfigError(
                f"{error.message} (at {maps.free.name} = {text_of(value)})"
            ) from error

    return _FamilyOfMaps(maps.free, maps.values, maps.axes, maps.text, slice.model, member)


class Common(NamedTuple):
    """A family with what its members have in common; nothing where there is no variety of its own."""

    family: AskedFamily
    variety: FamilyVariety | None

    @property
    def surfaces(self) -> tuple[SpaceTerms, ...]:
        """The polynomials of the surfaces on which solutions meet."""
        if self.variety is None:
            return ()
        return tuple(
            tuple((tuple(map(int, powers)), int(c)) for powers, c in p.terms())  # type: ignore[misc]
            for p in self.variety.critical
        )


def members_of(common: Common, options: Options = DEFAULTS) -> Iterator[tuple[Fraction, RegionMap]]:
    """The maps at the family's values, one by one."""
    for value in common.family.values:
        yield value, member_map(common, value, options)


def member_map(common: Common, value: Fraction, options: Options = DEFAULTS) -> RegionMap:
    """The region map at a value of the free parameter.

    Raises
    ------
    ConfigError, HypothesisError, LimitReached
        As `ptmcad.classify` does.
    """
    slice = common.family.member(value)
    if common.variety is None or is_certified(slice, options.engine):
        return region_map(slice, options)
    from ptmcad.text.flint_numbers import from_fraction

    return region_map(slice, options, partial(common.variety.at, from_fraction(value)))


def in_common(asked: AskedFamily, options: Options = DEFAULTS) -> Common:
    """What the members of a family have in common, computed once.

    Nothing, where all members are certified, where the parameters are too large to be expanded in
    three variables, or where a generic member is exceptional; then each says so itself.
    """
    if all(is_certified(asked.member(value), options.engine) for value in asked.values):
        return Common(asked, None)
    from ptmcad.exact.familyvariety import family_variety

    try:
        return Common(asked, family_variety(in_space(asked)))
    except (ExpressionError, DegenerateSliceError, InfiniteSolutionsError):
        return Common(asked, None)


def in_space(asked: AskedFamily) -> SystemOnAxes:
    """The system on the axes x, y and z.

    Raises
    ------
    ExpressionError
        When they are too large to be expanded in three variables.
    """
    from ptmcad.exact.models import system_from
    from ptmcad.exact.models.familyparameters import space_parameters
    from ptmcad.exact.models.system import SystemOnAxes

    system = system_from(asked.model)
    x, y = (a.name for a in asked.axes)
    return SystemOnAxes(
        system, space_parameters(system.ring.parameters, asked.text, (x, y, asked.free.name))
    )
