"""The convenience methods of answers, entered for their classes (see `ptmcad.answer`)."""

from ptmcad.answer import METHODS
from ptmcad.methods import families, maps, points  # each enters its methods

__all__ = ["METHODS", "families", "maps", "points"]
