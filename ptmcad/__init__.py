"""Exact region maps of planar tensegrity mechanisms."""
