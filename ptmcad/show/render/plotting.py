"""A map as objects of matplotlib's, for a caller who goes on with them."""

from __future__ import annotations

from typing import Any

from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.printing import settings
from ptmcad.show.render.regionmap import draw_on, figure_of
from ptmcad.show.render.style import Style, styled


def plot(result: RegionMap, ax: Any, style: str | Style, samples: bool, dpi: int, options: dict[str, Any]) -> Any:
    """A figure of its own, or the axes that were given, with the map in them.

    Raises
    ------
    ConfigError
        For an unknown style or option, a value that cannot be drawn, or what does not fit into the size.
    """
    made = styled(style, **options)
    if ax is not None:
        draw_on(ax, result, samples, made)
        return ax
    with settings(made):
        return figure_of(result, samples, dpi, style=made)
