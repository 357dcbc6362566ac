"""Mechanisms: each model turns its geometry into a `ParametricSystem`."""

from __future__ import annotations

from ptmcad.models.ptm import ptm_system
from ptmcad.models.system import ParametricSystem

__all__ = ["ParametricSystem", "system_of"]


def system_of(mechanism: str) -> ParametricSystem:
    """The parametric system of a mechanism by its name.

    Raises
    ------
    KeyError
        When no model has that name; `config` refuses such names before.
    """
    return {"ptm": ptm_system}[mechanism]()
