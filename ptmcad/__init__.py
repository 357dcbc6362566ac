"""Proved region maps of planar mechanisms and parametric systems.

>>> import ptmcad
>>> result = ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho"))
>>> result.locate(L2="3/2", rho=1).stable
2
"""

from __future__ import annotations

from ptmcad import methods as _methods  # noqa: F401 - first: it enters the methods that the answers' classes take
from ptmcad.version import __version__

TYPE_CHECKING = False  # type checkers take it for true; the module typing would be half of the way to `__main__.main`
if TYPE_CHECKING:
    from typing import Any

    from ptmcad.answer.design import BestDesign
    from ptmcad.answer.family import Change, Changes, FamilyMap
    from ptmcad.answer.poses import Pose, Poses
    from ptmcad.answer.regionmap import RegionMap
    from ptmcad.answer.slicevariety import SliceVariety
    from ptmcad.answer.sweep import Sweep
    from ptmcad.ask.changes import changes
    from ptmcad.ask.classification import classify
    from ptmcad.ask.lines.along import intervals, operation_widths
    from ptmcad.ask.lines.follower import pose_paths
    from ptmcad.ask.solving import solve
    from ptmcad.ask.stepwise import counts_at, discriminant_variety, open_cad
    from ptmcad.exact.eliminationsystem import slice_variety
    from ptmcad.question.config import load, slice_from_mapping, slice_from_options
    from ptmcad.question.config import make_mechanism as Mechanism
    from ptmcad.question.config import make_system as System
    from ptmcad.question.counts import Count
    from ptmcad.question.slice import Point, Slice
    from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
    from ptmcad.verification import VerifyReport, verify
    from ptmcad.workbench.designs.bestdesign import design
    from ptmcad.workbench.familymaps import family
    from ptmcad.workbench.sweeps.run import sweep

_HOMES = {
    "load": "question.config",
    "slice_from_mapping": "question.config",
    "slice_from_options": "question.config",
    "Mechanism": "question.config:make_mechanism",
    "System": "question.config:make_system",
    "counts_at": "ask.stepwise",
    "discriminant_variety": "ask.stepwise",
    "open_cad": "ask.stepwise",
    "AlgebraicNumber": "text.enclosure",
    "Enclosure": "text.enclosure",
    "changes": "ask.changes",
    "Change": "answer.family",
    "Changes": "answer.family",
    "classify": "ask.classification",
    "BestDesign": "answer.design",
    "design": "workbench.designs.bestdesign",
    "family": "workbench.familymaps",
    "FamilyMap": "answer.family",
    "slice_variety": "exact.eliminationsystem",
    "Pose": "answer.poses",
    "Poses": "answer.poses",
    "solve": "ask.solving",
    "Sweep": "answer.sweep",
    "sweep": "workbench.sweeps.run",
    "intervals": "ask.lines.along",
    "operation_widths": "ask.lines.along",
    "pose_paths": "ask.lines.follower",
    "RegionMap": "answer.regionmap",
    "Count": "question.counts",
    "Point": "question.slice",
    "Slice": "question.slice",
    "SliceVariety": "answer.slicevariety",
    "VerifyReport": "verification",
    "verify": "verification",
}

__all__ = [
    "AlgebraicNumber",
    "BestDesign",
    "Change",
    "Changes",
    "Count",
    "Enclosure",
    "FamilyMap",
    "Mechanism",
    "Point",
    "Pose",
    "Poses",
    "RegionMap",
    "Slice",
    "SliceVariety",
    "Sweep",
    "System",
    "VerifyReport",
    "__version__",
    "changes",
    "classify",
    "counts_at",
    "design",
    "discriminant_variety",
    "family",
    "intervals",
    "load",
    "open_cad",
    "operation_widths",
    "pose_paths",
    "slice_from_mapping",
    "slice_from_options",
    "slice_variety",
    "solve",
    "sweep",
    "verify",
]


def __dir__() -> list[str]:
    """The public names, also those that are not loaded yet."""
    return sorted(__all__)


def __getattr__(name: str) -> Any:
    """Import public names when they are first used: a command that only reads a record loads no
    algebra.
    """
    if name in _HOMES:
        from importlib import import_module

        home, _, other = _HOMES[name].partition(":")
        return getattr(import_module(f"ptmcad.{home}"), other or name)
    raise AttributeError(f"module 'ptmcad' has no attribute {name!r}")
