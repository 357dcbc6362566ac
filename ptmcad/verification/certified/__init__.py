"""Verification of a certified map: its cover, its counts, and what it says is free.

Order of reading, from the description to the verdict. A spring's force, K (|d| - l)/|d| d, is
followed through all of it.

1. `verification.derivation`: equations as polynomials in cosines and sines; K, l and the vector d of
   each spring.
2. `normalform.waves`: the same in Fourier's normal form; the part -K l |d| of the energy as a cone.
   `normalform.springlines`: the line that d may stay on. `normalform.unknownbounds`: how large real
   unknowns may be.
3. `normalform.modelequations`: formulas of the equations and of the Jacobian, with d/|d| for the
   cone's direction, as lists of `normalform.operations`.
4. `exclusion.places`: which boxes of the unknowns may have solutions, by affine forms of doubles.
5. `krawczyk`: which of these have one, by the same formulas in balls (`ballequations`); `narrow`:
   whether a stored box has one; `models` counts them, at a point or over a rectangle of the window.
6. `coversweep` and `coverclaims`: which cells the cover leaves. `cellsamples`, `sampling` and
   `freearea` hold the counts against them: at samples, over random boxes, and over all of the free
   area, where `exclusion.criticalsystems` has no solution.
7. `certificate`: the list of all checks.

Guarantee: nothing here imports the second engine; derivatives, exclusion and components are found
in other ways: Arb instead of floats with outward rounding, square roots instead of unit vectors,
Krawczyk's test instead of Hansen and Sengupta's, a sweep instead of a subdivision.
"""
