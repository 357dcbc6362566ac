"""Stiff and extreme cases: what ptmcad and what double precision make of them, against answers
known beforehand.

Guarantee: the expected answer of a case comes from a theorem, a construction or a second method,
never from the method that is tested; a case is right only when the counts agree and every enclosed
number contains the one to 100 digits.
"""
