"""The best design: exact evaluations, a global search over them, and the proof of what none
exceeds.
"""
