"""Verification of a certified map: its cover, its counts, and random points of what it says is
free.

Guarantee: nothing here imports the second engine; derivatives, exclusion and components are found
in other ways: Arb instead of floats with outward rounding, square roots instead of unit vectors,
Krawczyk's test instead of Hansen and Sengupta's, a sweep instead of a subdivision.
"""
