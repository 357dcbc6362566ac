"""Mechanisms as polynomial systems: compiled formulas expanded into a `ParametricSystem`."""

from __future__ import annotations

from ptmcad.exact.models.modelsystem import system_counted, system_from
from ptmcad.exact.models.system import ParametricSystem
from ptmcad.model import mechanism_of

__all__ = ["ParametricSystem", "system_counted", "system_from", "system_of"]


def system_of(mechanism: str) -> ParametricSystem:
    """The parametric system of a built-in mechanism by its name.

    Raises
    ------
    KeyError
        When there is none of that name; `config` refuses such names before.
    """
    return system_from(mechanism_of(mechanism))
