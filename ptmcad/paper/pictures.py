"""The figures of the paper as files' contents: the region map, and all poses at the figure's point.

Guarantee: the pictures are those that `ptmcad classify` and `ptmcad solve` draw of the same results.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from ptmcad.poses import Poses
from ptmcad.regionmap import RegionMap
from ptmcad.render import draw
from ptmcad.render.poses import draw_poses
from ptmcad.render.printing import save


def picture_bytes(figure: str, result: RegionMap, poses: Poses, suffixes: Sequence[str]) -> dict[str, bytes]:
    """File names, such as ``fig4.png`` and ``fig4-poses.svg``, and their contents."""
    found = {}
    with TemporaryDirectory() as folder:
        for suffix in suffixes:
            path = Path(folder) / f"{figure}.{suffix}"
            draw(result, path)
            found[path.name] = path.read_bytes()
            path = Path(folder) / f"{figure}-poses.{suffix}"
            save(draw_poses(poses), path)
            found[path.name] = path.read_bytes()
    return found
