"""Formulas of any mechanism or potential system with a few unknowns, by automatic derivatives of its description.

Guarantee: nothing is known of a mechanism but its description. A mechanism with formulas of its own, such as the
paper's in `ptmcad.certified.ptm`, is faster with them; `ptmcad.certified.formulation` chooses.
"""
