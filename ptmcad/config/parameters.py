"""The parameters of the paper's mechanism: what they measure, their defaults and usual windows.

Guarantee: every parameter of the model is here, with its name in problem records.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from ptmcad.syntax import did_you_mean


class Kind(Enum):
    """What a parameter measures; it decides which values make sense."""

    LENGTH = "length"
    BASE = "base length"
    STIFFNESS = "stiffness"
    FORCE = "force"
    FREE_LENGTH = "free length"


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of the paper's mechanism: its default and the window that ``--slice`` takes for it."""

    name: str
    kind: Kind
    default: str
    window: tuple[str, str]


PARAMETERS: Mapping[str, Parameter] = {
    parameter.name: parameter
    for parameter in (
        Parameter("L1", Kind.LENGTH, "1", ("0", "4")),
        Parameter("L2", Kind.LENGTH, "1", ("0", "4")),
        Parameter("rho", Kind.BASE, "1", ("0", "4")),
        Parameter("k", Kind.STIFFNESS, "100", ("0", "200")),
        Parameter("k1", Kind.STIFFNESS, "k", ("0", "200")),
        Parameter("k2", Kind.STIFFNESS, "k", ("0", "200")),
        Parameter("k3", Kind.STIFFNESS, "k", ("0", "200")),
        Parameter("F3", Kind.FORCE, "0", ("-30", "0")),
        Parameter("F4", Kind.FORCE, "0", ("-30", "0")),
        Parameter("F3x", Kind.FORCE, "0", ("-30", "30")),
        Parameter("F4x", Kind.FORCE, "0", ("-30", "30")),
        Parameter("l0", Kind.FREE_LENGTH, "0", ("0", "1")),
        Parameter("l0_1", Kind.FREE_LENGTH, "l0", ("0", "1")),
        Parameter("l0_2", Kind.FREE_LENGTH, "l0", ("0", "1")),
        Parameter("l0_3", Kind.FREE_LENGTH, "l0", ("0", "1")),
    )
}


def unknown_parameter(name: str) -> str:
    """The message for a name that is none of them."""
    hint = did_you_mean(name, tuple(PARAMETERS)) or f"; the parameters are {', '.join(PARAMETERS)}"
    return f"unknown parameter '{name[:40]}'{hint}"
