"""The best design: exact evaluations, a global search over them, and the proof that none exceeds
a bound.
"""
