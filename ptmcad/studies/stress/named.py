"""All named stress cases, in the order of their families.

Guarantee: names are unique.
"""

from __future__ import annotations

from collections.abc import Sequence

from ptmcad.errors import ConfigError, shown
from ptmcad.studies.stress.case import Case
from ptmcad.studies.stress.points import point_cases
from ptmcad.studies.stress.slices import slice_cases
from ptmcad.text.syntax import did_you_mean

ALL = "all"
"""The name that stands for every named case."""


def named_cases() -> tuple[Case, ...]:
    """Every named case."""
    return (*point_cases(), *slice_cases())


def chosen(names: Sequence[str]) -> tuple[Case, ...]:
    """The cases of these names and families; all of them for ``all`` and when none is given.

    Raises
    ------
    ConfigError
        For a name that is neither.
    """
    cases = named_cases()
    known = {case.name for case in cases} | {case.family for case in cases} | {ALL}
    for name in names:
        if name not in known:
            raise ConfigError(
                f"{shown(repr(name), 60)} is no stress case and no family: ptmcad stress --list shows them"
                f"{did_you_mean(name, tuple(sorted(known)))}",
                key="NAMES",
            )
    return tuple(c for c in cases if not names or ALL in names or c.name in names or c.family in names)
