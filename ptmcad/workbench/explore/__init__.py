"""The page on which one explores a family of slices: a local server, and processes that compute for
it.
"""
