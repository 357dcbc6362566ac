"""The paper of Wenger & Chablat, reproduced: its equations, its figures, and a verdict on every
claim it makes.

Guarantee: verdicts are computed. It is the only part of the package, besides the tests, that uses
SymPy for mathematics.
"""
