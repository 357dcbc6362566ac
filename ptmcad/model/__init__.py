"""Mechanisms as data: a description, read from a record, compiled once into formulas for the
engines; the checker derives its own.

Guarantee: nothing here computes an equilibrium; a description that was read can be evaluated in any ring.
"""

from __future__ import annotations

from dataclasses import replace

from ptmcad.errors import ConfigError
from ptmcad.model.description import ClosedMechanism, Mechanism, Model, System, mechanism_in
from ptmcad.model.elements import Kind, Parameter, Support
from ptmcad.model.ptm import ptm
from ptmcad.model.record import described, read_mechanism
from ptmcad.model.systems import described_system, read_system

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
    "mechanism_in",
    "mechanism_of",
    "ptm",
    "read_mechanism",
    "read_system",
    "recognised",
    "without_loops",
]


def mechanism_of(name: str) -> Mechanism:
    """The built-in mechanism of a name.

    Raises
    ------
    KeyError
        When there is none; `ptmcad.question.config` refuses such names before.
    """
    return _BUILT_IN[name]()


def built_in() -> tuple[str, ...]:
    """The names of the mechanisms that `mechanism_of` has."""
    return tuple(_BUILT_IN)


def without_loops(model: Mechanism) -> Model:
    """The mechanism itself, or with closed loops or X-joints the equations of its equilibria.

    Raises
    ------
    ConfigError
        When these may have too many terms.
    """
    if not (model.closing or model.xjoints):
        return model
    from ptmcad.model.loops import equations_of_loops  # with all that only loops need

    return equations_of_loops(model)


def recognised(found: Mechanism) -> Mechanism:
    """A mechanism that was described, or the built-in one that it is, whether or not its symmetries were written down.

    Raises
    ------
    ConfigError
        When it has the name of a built-in one and is another.
    """
    if found.name not in _BUILT_IN:
        return found
    known = _BUILT_IN[found.name]()
    if replace(found, symmetries=known.symmetries) != known:
        raise ConfigError(f"'{found.name}' is the name of a built-in mechanism, which is another", key="name")
    return known


def known_of(name: str) -> Mechanism:
    """What is known of a mechanism by its name, as a stored result has it: nothing of one that is not built in."""
    return _BUILT_IN[name]() if name in _BUILT_IN else Mechanism(name, {}, {}, {}, (), {}, (), ())


_BUILT_IN = {"ptm": ptm}
