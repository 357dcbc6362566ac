"""Mechanisms as polynomial systems: compiled formulas expanded into a `ParametricSystem`."""

from __future__ import annotations

from ptmcad.exact.models.modelsystem import system_counted, system_from
from ptmcad.exact.models.system import ParametricSystem

__all__ = ["ParametricSystem", "system_counted", "system_from"]
