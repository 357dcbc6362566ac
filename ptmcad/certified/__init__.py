"""The second engine: certified enclosures of curves and counts by interval arithmetic, for what
algebra cannot reach.

Guarantee: nothing here imports from `ptmcad.algebra` or `ptmcad.exact`, so that the two engines
check each other.

There are three entrances: `engine` makes the map of a slice, `enclosedline` finds where counts
change along a line, and `plain.certifiedposes` the equilibria at a point. Data flows one way.

The formulas of a problem, exact:

    plain.problem           a slice's equations as sums of harmonics, and a cone for each spring
    plain.harmonics         these sums, over Q(x, y)
    plain.divisors          common factors of their coefficients
    plain.straight          springs along one line: a problem for each choice of their sides
    plain.geometry          springs, factors, slopes and directions that formulas are made of
    plain.springchart       equations, Hessian and determinant as formulas of `ptmcad.formulas`
    plain.unknownranges     where all solutions are, proved
    plain.mirrors           involutions that keep a problem, coordinates about fixed points, savings
    plain.opening           the energy in coordinates that are regular there
    plain.symmetricfolds    the folds about fixed points
    plain.curvesearch       what all curves of a problem have in common
    plain.criticalcurves    the curves at which counts change, as systems
    equationsystem          a system on a tape of `ptmcad.formulas`

The search, compiled:

    loading                 compiled code, made ready before the clock starts
    contraction, linear     a box, shrunk around the solutions in it
    branchandprune          boxes, shrunk and bisected until they are small
    uniqueness              proofs that a box holds one solution
    arb_isolation           the same with any number of digits
    refinement              the curves' boxes, level by level
    boxstrips               thin rectangles around the curve in a small box
    covering                a cover of the window's part that boxes or strips leave open, without specks
    pace                    when to hand a map over, and when to end

The answer:

    plain.zeros             the solutions at a rational point, each proved
    plain.spectrum          eigenvalues, and how many of them are negative
    plain.rational          what is exact at an equilibrium
    plain.pointcounts       the counts at a point
    peaks                   a check of these, of the paper's mechanism
    coverassembly           cells and regions, from the components that `ptmcad.cover` finds
    statement               what a result says of its problem, and its plan
"""
