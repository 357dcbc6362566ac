"""What is said of a name that is no parameter of the model in hand."""

from __future__ import annotations

from ptmcad.mechanism import Model
from ptmcad.text.syntax import did_you_mean


def unknown_parameter(name: str, model: Model) -> str:
    """The message for a name that is none of the model's parameters."""
    if not model.parameters:
        return f"unknown parameter '{name[:40]}': {model.name} has none"
    hint = did_you_mean(name, model.parameters) or f"; the parameters are {', '.join(model.parameters)}"
    return f"unknown parameter '{name[:40]}'{hint}"
