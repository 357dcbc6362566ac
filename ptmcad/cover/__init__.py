"""A cover: closed rectangles on a lattice of the window that contain everything a certified map
leaves open.

Guarantee: all its numbers are integers, so what lies in a rectangle, and what is connected outside
all of them, is decided exactly.

The geometry is in the modules of this package, which need numpy; `components` loads it when it is
called, so that a map without a cover is read and written without.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ptmcad.cover.rectangles import Cover

if TYPE_CHECKING:
    from ptmcad.cover.complement import Components


def components(cover: Cover) -> Components:
    """The connected components of the open window without the closed rectangles.

    Raises
    ------
    ValueError
        When a rectangle is not one, or the lattice is too fine.
    """
    from ptmcad.cover import connectivity

    return connectivity.components(cover)
