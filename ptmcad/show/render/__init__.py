"""Pictures of results; but for those of the studies the only importer of matplotlib, loaded when the first is drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ptmcad.show.render.regionmap import draw

__all__ = ["draw"]


def __getattr__(name: str) -> Any:
    """`draw`, when it is first used: the report needs outlines and colours only."""
    if name == "draw":
        from ptmcad.show.render.backend import load_matplotlib

        load_matplotlib()
        from ptmcad.show.render import regionmap

        return regionmap.draw
    raise AttributeError(f"module 'ptmcad.show.render' has no attribute {name!r}")
