"""The shapes of a map, whichever engine made it."""

from __future__ import annotations

from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.view import Shapes


def shapes(result: RegionMap) -> Shapes:
    """The shapes of a map over its whole window.

    Raises
    ------
    ValueError, IndexError, ArithmeticError
        When the map contradicts itself.
    """
    if result.cover is not None:
        from ptmcad.show.render.coveroutline import cover_outline

        return cover_outline(result)
    from ptmcad.show.render.outline import outline

    return outline(result)
