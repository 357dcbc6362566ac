"""The second engine: certified enclosures of curves and counts by interval arithmetic, for what
algebra cannot reach.

Guarantee: nothing here imports from `ptmcad.algebra` or `ptmcad.exact.cad`, so that the two engines
check each other.

Data flows one way: the compiled system (`ptmcad.model.compile`) -> `plain.problem` (equations as
sums of harmonics) -> `ptmcad.formulas` (straight-line programs, run on boxes) -> `contraction`,
`search` (branch and prune) -> the curves and counts built on them.
"""
