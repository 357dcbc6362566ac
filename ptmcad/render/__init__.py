"""Pictures of results; the only importer of matplotlib, which is loaded when the first picture is drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ptmcad.render.regionmap import draw

__all__ = ["draw"]


def __getattr__(name: str) -> Any:
    """`draw`, when it is first used: the report needs outlines and colours only."""
    if name == "draw":
        from ptmcad.render.backend import load_matplotlib

        load_matplotlib()
        from ptmcad.render import regionmap

        return regionmap.draw
    raise AttributeError(f"module 'ptmcad.render' has no attribute {name!r}")
