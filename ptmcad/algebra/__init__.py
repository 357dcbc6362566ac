"""Exact algebra: polynomials, Groebner bases over Q(x, y), quotient algebras, real roots, rational
fibres.

This package is the only importer of FLINT's polynomials. Its functions are exact, or return
enclosures that are proved.
"""
