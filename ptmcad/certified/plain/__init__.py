"""Formulas of any mechanism or potential system with a few unknowns, by automatic derivatives of
its description.

Guarantee: nothing is known of a mechanism but its description.
"""
