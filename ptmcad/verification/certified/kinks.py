"""Springs whose vectors stay on one line, which may turn with angles: which they are, and on which
side of length zero a configuration has them.

Guarantee: exact. Where d = s e with a fixed e, or one that is turned by a sum of angles, a spring's
direction is e/|e| or -e/|e| wherever it has a length, so that solutions are those of the equations
with either one, at which s is positive or negative. Springs without length are no solutions. Where
half an angle is in that sum, a full turn of the angle changes sides: each side has its own part of
any box of the angles, and one configuration is on both sides at the box's two ends.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product

from ptmcad.verification.certified.waves import Form

Sides = Mapping[str, int]
"""1 or -1 by the name of each spring on a line: the sign of s."""


def sides(form: Form) -> Iterator[Sides]:
    """All choices; a single empty one where no spring is on a line."""
    names = [cone.name for cone in form.cones if cone.line is not None]
    for chosen in product((1, -1), repeat=len(names)):
        yield dict(zip(names, chosen, strict=True))
