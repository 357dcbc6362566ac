"""The built-in mechanism refined: formulas made by hand that enclose what its description says more narrowly.

Guarantee: each formula equals the one that `ptmcad.certified.potential` derives from the description, everywhere or, as
it says, at equilibria; tests/certified/test_refined_formulas.py proves it in exact arithmetic. Outside of this package
the certified engine knows no parameter, no angle and no point by name.
"""
