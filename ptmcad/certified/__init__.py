"""The second engine: certified enclosures of curves and counts by interval arithmetic, for what
algebra cannot reach.

Guarantee: nothing here imports from `ptmcad.algebra` or `ptmcad.exact.cad`, so that the two engines
check each other.

Data flows one way: a spring's force, from its description compiled once (`ptmcad.model.compile`),
becomes a cone of a `plain.problem`, whose equations are sums of harmonics, and then formulas of a
`plain.springchart`, which an `equationsystem` writes on a tape of `ptmcad.formulas`.

    plain.criticalcurves          the curves at which counts change, as systems
    branchandprune, refinement    their enclosures, in boxes that `contraction` shrinks
    covering                      the cover of all that the boxes hold
    ptmcad.cover                  the components of its complement
    plain.zeros, plain.pointcounts, uniqueness    a count at a sample of each, proved
    mapassembly, engine           cells and regions
"""
