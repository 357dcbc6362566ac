"""How cost grows: families of slices, each growing in one respect, measured in forked children, with fitted exponents.

Guarantee: seconds are processor time; what runs find is checked against what is known of the slices, and all of it but
time and memory is the same in the next run with the same seed.

Run it with ``python -m ptmcad.studies.bench.scaling --out docs/benchmarks``; `scaling` is the plain function.
"""

from ptmcad.studies.bench.scaling.families import FAMILIES, Family, families_named
from ptmcad.studies.bench.scaling.run import scaling

__all__ = ["FAMILIES", "Family", "families_named", "scaling"]
