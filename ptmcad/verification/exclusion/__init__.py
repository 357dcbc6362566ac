"""The share of the free area of a certified map that is proved free of critical curves, by
exclusion and bisection.
"""
