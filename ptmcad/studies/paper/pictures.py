"""The figures of the paper as files' contents: the region map beside the stable poses, and all poses at that point.

Guarantee: the pictures are drawn from the exact map and poses that are given, by the functions that draw any others.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.figure import draw_figure
from ptmcad.show.render.poses import draw_poses
from ptmcad.show.render.printing import save


def picture_bytes(figure: str, result: RegionMap, poses: Poses, suffixes: Sequence[str]) -> dict[str, bytes]:
    """File names, such as ``fig4.png`` and ``fig4-poses.svg``, and their contents."""
    found = {}
    with TemporaryDirectory() as folder:
        for suffix in suffixes:
            path = Path(folder) / f"{figure}.{suffix}"
            save(draw_figure(result, poses), path)
            found[path.name] = path.read_bytes()
            path = Path(folder) / f"{figure}-poses.{suffix}"
            save(draw_poses(poses), path)
            found[path.name] = path.read_bytes()
    return found
