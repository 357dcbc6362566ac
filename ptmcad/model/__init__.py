"""Mechanisms as data: a description, read from a record, compiled once into formulas for all but
the checker.

Guarantee: nothing here computes an equilibrium; a description that was read can be evaluated in any
ring.
"""

from __future__ import annotations

from ptmcad.model.builtin import built_in, known_of, mechanism_of, ptm, recognised
from ptmcad.model.description import ClosedMechanism, Mechanism, Model, System
from ptmcad.model.elements import Kind, Parameter, Support
from ptmcad.model.mechanismrecord import described, read_mechanism
from ptmcad.model.systemrecord import described_system, read_system

__all__ = [
    "ClosedMechanism",
    "Kind",
    "Mechanism",
    "Model",
    "Parameter",
    "Support",
    "System",
    "built_in",
    "described",
    "described_system",
    "known_of",
    "mechanism_of",
    "ptm",
    "read_mechanism",
    "read_system",
    "recognised",
]
