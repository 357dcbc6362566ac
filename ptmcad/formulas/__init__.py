"""Formulas: one graph of expressions with exact derivatives, and an evaluator for each arithmetic.

Guarantee: the graph (`graph`) is exact; each evaluator says what its values enclose. Both engines,
pictures and pages use it; the checker has formulas of its own.

`evaluation` is in any numbers that can be added and multiplied: rationals, bounds, polynomials over
Q(x, y). `instructions` are for formulas that are evaluated often, at many points at once, and for
pages. A `tape` is formulas written out as data, which the evaluators that are compiled once for all
(`compilation`) run on boxes: in `intervalarithmetic` and in `affine` forms, with `rounding` outward;
and in `ballarithmetic` at any precision. `continuation` follows solutions along a parameter in balls.
"""
