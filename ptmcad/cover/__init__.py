"""A cover: closed rectangles on a lattice of the window that contain everything a certified map
leaves open.

Guarantee: all its numbers are integers, so what lies in a rectangle, and what is connected outside
all of them, is decided exactly.

The geometry is in the modules of this package, which need numpy; the functions here load it when
they are called, so that a map without a cover is read and written without.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ptmcad.cover.rectangles import Cover, Window

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


def union_area(cover: Cover) -> int:
    """The area of the rectangles' union, in squares of a lattice step."""
    from ptmcad.cover import connectivity

    return connectivity.union_area(cover)


def from_boxes(window: Window, low: Any, high: Any, steps: int) -> Cover:
    """The cover of boxes that floats bound: each is rounded outward to the lattice and clipped to
    the window.

    Parameters
    ----------
    low, high : arrays of shape (k, 2), the ends along the two axes, in the axes' own units;
        infinite ends are allowed.

    Raises
    ------
    ValueError
        When an end is not a number, or low > high.

    Guarantee
    ---------
    Every point of the open window that lies in a closed box lies in a rectangle.
    """
    from ptmcad.cover import lattice

    return lattice.from_boxes(window, low, high, steps)
