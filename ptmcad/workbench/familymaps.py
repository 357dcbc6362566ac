"""The region maps of a family's members, and where they change.

Guarantee: that of `ptmcad.ask.members`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal

from ptmcad.answer.family import TOLERANCE, Changes, FamilyMap
from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.members import Common, in_common, members_of
from ptmcad.errors import ConfigError, expect
from ptmcad.options import Options, Progress
from ptmcad.question.config import Family, family_from
from ptmcad.question.shipped import RecordSource
from ptmcad.text.parsing import number_for


def family(
    question: RecordSource | Family,
    values: Iterable[Any] | Literal["between"] | None = None,
    *,
    changes: bool = False,
    engine: str = "auto",
    areas: bool = True,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> FamilyMap:
    """The region maps of a family of slices, at values of its free parameter.

    Parameters
    ----------
    question : the file of a record with ``free``, or a mapping like one.
    values : of the free parameter; those that the record states when None. ``"between"`` stands for
        one between each two neighbouring changes.
    changes : whether to find where the arrangement of the regions changes, too; see
        `ptmcad.changes`.
    engine, areas, jobs, progress : as of `ptmcad.classify`, for each member.

    Raises
    ------
    ConfigError
        For anything wrong with the record, or a value outside of the free parameter's range.
    HypothesisError
        When a member is degenerate, has infinitely many equilibria, or leaves the domain of the
        geometry.

    >>> import ptmcad
    >>> found = ptmcad.family({"axes": {"rho": [0, 2], "L2": [0, 2]}, "parameters": {"F3": "F", "F4": "F"},
    ...                        "free": {"F": [-40, 0]}}, values=[-20, -10], areas=False)
    >>> [(int(value), len(map.regions)) for value, map in found]
    [(-20, 2), (-10, 2)]
    """
    asked = family_from(question)
    if values is not None and values != "between":
        expect(values, Iterable, "values", "values of the free parameter, such as [-20, -10]")
        chosen = sorted({number_for(asked.free.name, value) for value in values})
        if not chosen:
            raise ConfigError("give at least one value of the free parameter", key="values")
        asked = asked._replace(values=tuple(chosen))
    options = Options(engine=engine, areas=areas, jobs=jobs, progress=progress)
    common, found = prepared(asked, options, changes=changes, between=values == "between")
    members = tuple(result for _, result in members_of(common, options))
    return together(asked, common, members, found)


def prepared(
    asked: Family, options: Options, *, changes: bool, between: bool
) -> tuple[Common, Changes | None]:
    """What a family's members have in common, and where they change, if that is wanted.

    Parameters
    ----------
    between : whether the members are at values between neighbouring changes.
    """
    common = in_common(asked, options)
    if not (changes or between):
        return common, None
    from ptmcad.ask.changes import changes_of  # which loads the exact engine

    found = changes_of(common, options.tolerance or TOLERANCE, options)
    if between:
        common = common._replace(family=asked._replace(values=found.between))
    return common, found


def together(
    asked: Family, common: Common, members: tuple[RegionMap, ...], changes: Changes | None
) -> FamilyMap:
    """The maps of a family as one answer."""
    return FamilyMap(
        asked.name,
        asked.free,
        common.family.values,
        members,
        common.surfaces,
        asked.record.title,
        changes,
        asked.text,
    )
