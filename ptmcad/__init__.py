"""Exact region maps of planar tensegrity mechanisms.

>>> import ptmcad
>>> result = ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho"))
>>> result.locate(L2="3/2", rho=1).stable
2
"""

from __future__ import annotations

from ptmcad.version import __version__

TYPE_CHECKING = False  # type checkers take it for true; the module typing would be half of the way to `__main__.main`
if TYPE_CHECKING:
    from typing import Any

    from ptmcad.config import load, slice_from_mapping, slice_from_options
    from ptmcad.enclosure import AlgebraicNumber, Enclosure
    from ptmcad.exactmap import slice_variety
    from ptmcad.pipeline import classify
    from ptmcad.poses import Pose, Poses, solve
    from ptmcad.ranges import intervals, operation_widths, pose_paths
    from ptmcad.regionmap import RegionMap
    from ptmcad.slice import Count, Point, Slice
    from ptmcad.slicevariety import SliceVariety
    from ptmcad.verification import VerifyReport, verify

_HOMES = {
    "load": "config",
    "slice_from_mapping": "config",
    "slice_from_options": "config",
    "AlgebraicNumber": "enclosure",
    "Enclosure": "enclosure",
    "classify": "pipeline",
    "slice_variety": "exactmap",
    "Pose": "poses",
    "Poses": "poses",
    "solve": "poses",
    "intervals": "ranges",
    "operation_widths": "ranges",
    "pose_paths": "ranges",
    "RegionMap": "regionmap",
    "Count": "slice",
    "Point": "slice",
    "Slice": "slice",
    "SliceVariety": "slicevariety",
    "VerifyReport": "verification",
    "verify": "verification",
}

__all__ = [
    "AlgebraicNumber",
    "Count",
    "Enclosure",
    "Point",
    "Pose",
    "Poses",
    "RegionMap",
    "Slice",
    "SliceVariety",
    "VerifyReport",
    "__version__",
    "classify",
    "intervals",
    "load",
    "operation_widths",
    "pose_paths",
    "slice_from_mapping",
    "slice_from_options",
    "slice_variety",
    "solve",
    "verify",
]


def __getattr__(name: str) -> Any:
    """Import public names when they are first used: a command that only reads a record loads no algebra."""
    if name in _HOMES:
        from importlib import import_module

        return getattr(import_module(f"ptmcad.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'ptmcad' has no attribute {name!r}")
