"""Pictures of results; the only importer of matplotlib."""

from ptmcad.render.regionmap import draw

__all__ = ["draw"]
