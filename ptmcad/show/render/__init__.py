"""Pictures of results; but for those of the studies the only importer of matplotlib, loaded when the first is drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ptmcad.show.render.plotting import plot
    from ptmcad.show.render.regionmap import draw

__all__ = ["draw", "plot"]


def __getattr__(name: str) -> Any:
    """`draw` and `plot`, when they are first used: the report needs outlines and colours only."""
    if name in __all__:
        from ptmcad.show.render.backend import load_matplotlib

        load_matplotlib()
        from ptmcad.show.render import plotting, regionmap

        return {"draw": regionmap.draw, "plot": plotting.plot}[name]
    raise AttributeError(f"module 'ptmcad.show.render' has no attribute {name!r}")
