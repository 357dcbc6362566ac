"""Formulas of any mechanism or potential system with a few unknowns, by automatic derivatives of
its description.

Guarantee: no formula, and no count, rests on anything of a mechanism but its description. Of the
paper's mechanism `pointcounts` checks counts by Euler's sum, and `certifiedposes` remarks on peaks
(`ptmcad.certified.peaks`).
"""
