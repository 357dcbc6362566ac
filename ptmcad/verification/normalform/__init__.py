"""The description's equations in Fourier's normal form, and as formulas that are evaluated in balls
or by compiled code.
"""
