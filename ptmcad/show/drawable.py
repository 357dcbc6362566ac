"""What of a model's solutions can be drawn, and why other things cannot."""

from __future__ import annotations

from ptmcad.model import Model
from ptmcad.model.work import foreign


def no_drawing(model: Model) -> str:
    """Why there is no picture, or no film, of a model's solutions."""
    closed = model.whole
    if closed is not None:
        what = "X-joints" if closed.xjoints else "closed loops"
        return f"of {model.name}, a mechanism with {what}, solve and plot draw poses, and nothing more is drawn yet"
    return f"solutions of a {_named(model)} cannot be drawn, as it has no points, bars or springs"


def no_landscape(model: Model) -> str:
    """Why there is no picture of the energy; empty where there is one."""
    if what := foreign(model):
        return f"{what} of the {_named(model)} depends on another unknown: there is no potential, no energy to be drawn"
    if what := model.criterion.no_energy:
        return f"the {_named(model)} {what}"
    if len(model.unknowns) > 2:
        return f"an energy can be drawn over one unknown or two, and the {_named(model)} has {len(model.unknowns)}"
    return ""


def _named(model: Model) -> str:
    """A system or mechanism, with its name if it has one of its own."""
    kind = model.record_key
    return kind if model.name == kind else f"{kind} {model.name}"
