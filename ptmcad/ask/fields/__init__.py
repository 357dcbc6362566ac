"""Continuous quantities of equilibria over a map's window, in floating point, from the certified
samples onwards.
"""
