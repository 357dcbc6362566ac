"""The region maps of a family's members, from the discriminant variety that they have in common.

Guarantee: a member's map is that of its slice alone, timings apart. What cannot be computed in common, is computed for
the member alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ptmcad.answer.family import FamilyMap, SpaceTerms
from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.classification import region_map
from ptmcad.ask.engines import is_certified
from ptmcad.errors import ConfigError, DegenerateSliceError, ExpressionError, InfiniteSolutionsError
from ptmcad.options import DEFAULTS, Options, Progress
from ptmcad.question.config import Family, family_from
from ptmcad.text.parsing import number_for

if TYPE_CHECKING:
    from ptmcad.algebra.polynomials import Ratio
    from ptmcad.exact.family import FamilyVariety
    from ptmcad.exact.models import ParametricSystem


class Common(NamedTuple):
    """A family with what its members have in common; nothing where there is no variety of its own."""

    family: Family
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


def family(
    question: str | Path | Mapping[str, Any] | Family,
    values: Iterable[Any] | None = None,
    *,
    engine: str = "auto",
    areas: bool = True,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> FamilyMap:
    """The region maps of a family of slices, at values of its free parameter.

    Parameters
    ----------
    question : the file of a record with ``free``, or a mapping like one.
    values : of the free parameter; those that the record states when None.
    engine, areas, jobs, progress : as of `ptmcad.classify`, for each member.

    Raises
    ------
    ConfigError
        For anything wrong with the record, or a value outside of the free parameter's range.
    HypothesisError
        When a member is degenerate, has infinitely many equilibria, or leaves the domain of the geometry.

    >>> import ptmcad
    >>> found = ptmcad.family({"axes": {"rho": [0, 2], "L2": [0, 2]}, "parameters": {"F3": "F", "F4": "F"},
    ...                        "free": {"F": [-40, 0]}}, values=[-20, -10], areas=False)
    >>> [(int(value), len(map.regions)) for value, map in found]
    [(-20, 2), (-10, 2)]
    """
    asked = family_from(question)
    if values is not None:
        chosen = sorted({number_for(asked.free.name, value) for value in values})
        if not chosen:
            raise ConfigError("give at least one value of the free parameter", key="values")
        asked = replace(asked, values=tuple(chosen))
    options = Options(engine=engine, areas=areas, jobs=jobs, progress=progress)
    common = in_common(asked, options)
    members = tuple(result for _, result in members_of(common, options))
    return FamilyMap(asked.name, asked.free, asked.values, members, common.surfaces, asked.record.title)


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
    from ptmcad.algebra.polynomials import from_fraction

    return region_map(slice, options, partial(common.variety.at, from_fraction(value)))


def in_common(asked: Family, options: Options = DEFAULTS) -> Common:
    """What the members of a family have in common, computed once.

    Nothing, where all members are certified, where the parameters are too large to be expanded in three variables, or
    where a generic member is exceptional; then each says so itself.
    """
    if all(is_certified(asked.member(value), options.engine) for value in asked.values):
        return Common(asked, None)
    from ptmcad.exact.family import family_variety

    try:
        return Common(asked, family_variety(*in_space(asked)))
    except (ExpressionError, DegenerateSliceError, InfiniteSolutionsError):
        return Common(asked, None)


def in_space(asked: Family) -> tuple[ParametricSystem, dict[str, Ratio]]:
    """The system, and its parameters over Z[x, y, z].

    Raises
    ------
    ExpressionError
        When they are too large to be expanded in three variables.
    """
    from ptmcad.exact.models import system_from
    from ptmcad.exact.models.space import space_parameters

    system = system_from(asked.model)
    x, y = (a.name for a in asked.axes)
    return system, space_parameters(system.ring.parameters, asked.text, (x, y, asked.free.name))
