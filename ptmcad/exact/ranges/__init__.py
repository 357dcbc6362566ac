"""Ranges by algebra: along a line, over a slice, and of the poses on the way."""
