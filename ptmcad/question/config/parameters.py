"""The parameters of the built-in mechanism, from its description: what they measure, their defaults and usual windows.

Guarantee: every parameter of the mechanism is here, with its name in problem records.
"""

from __future__ import annotations

from collections.abc import Mapping

from ptmcad.mechanism import Parameter, ptm
from ptmcad.text.syntax import did_you_mean

PARAMETERS: Mapping[str, Parameter] = ptm().parameters


def unknown_parameter(name: str) -> str:
    """The message for a name that is none of them."""
    hint = did_you_mean(name, PARAMETERS) or f"; the parameters are {', '.join(PARAMETERS)}"
    return f"unknown parameter '{name[:40]}'{hint}"
