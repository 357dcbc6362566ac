"""The second engine: certified enclosures of curves and counts by interval arithmetic, for what algebra cannot reach.

Guarantee: nothing here imports from `ptmcad.algebra` or `ptmcad.exact.cad`, so that the two engines check each other.

Data flows one way: `formula` (expressions and their derivatives) -> `ptm.statics` (the equations of the mechanism with
springs of any free length) -> `tape` (straight-line programs) -> `arithmetic`, `evaluation` (intervals rounded outward,
compiled) -> `contraction`, `search` (branch and prune) -> the curves and counts built on them.
"""
