"""Quantities of solutions over a map, and the motion of one along a path, in floating point."""
