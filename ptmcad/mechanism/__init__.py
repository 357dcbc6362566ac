"""Mechanisms as data: a description, read from a record, that engines and checkers derive their formulas from.

Guarantee: nothing here computes an equilibrium; a description that was read can be evaluated in any ring.
"""

from __future__ import annotations

from ptmcad.mechanism.description import Kind, Mechanism, Parameter, described
from ptmcad.mechanism.ptm import ptm

__all__ = ["Kind", "Mechanism", "Parameter", "described", "mechanism_of", "ptm"]


def mechanism_of(name: str) -> Mechanism:
    """The built-in mechanism of a name.

    Raises
    ------
    KeyError
        When there is none; `ptmcad.config` refuses such names before.
    """
    return {"ptm": ptm}[name]()
