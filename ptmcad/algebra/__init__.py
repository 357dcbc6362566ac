"""Exact algebra: polynomials, Groebner bases over Q(x, y), quotient algebras, real roots, rational
fibres.

FLINT's polynomials stay in this package, but for `verification`, which must not use it, studies that
eliminate by hand, and `certified/plain/divisors`. Its functions are exact, or return enclosures that
are proved.
"""
