"""Plane curves whose points over the square root of two are known: A(v) + (u^2 - 2) B(u, v) has
those at A's roots.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx
from hypothesis import strategies as st

RING: fmpz_mpoly_ctx = fmpz_mpoly_ctx.get(("u", "v"), Ordering.lex)


@dataclass(frozen=True)
class KnownCurves:
    """Curves, and the heights of their real points over the square root of two."""

    terms: tuple[tuple[tuple[int, int, int], ...], ...]
    heights: tuple[Fraction, ...]


def _factor(root: Fraction) -> fmpz_mpoly:
    return RING.gen(1) * root.denominator - root.numerator


@st.composite
def known_curves(draw: st.DrawFn) -> KnownCurves:
    """One or two curves with at most one double root over the value, and at most one root in
    common.
    """
    u, v = RING.gens()
    heights = draw(
        st.lists(st.fractions(-3, 3, max_denominator=9), min_size=2, max_size=5, unique=True)
    )
    cut = draw(st.integers(1, len(heights)))
    own = [heights[:cut], heights[cut:]]
    how = draw(st.sampled_from(["simple", "double", "common"]))
    if how == "double":
        own[0] = [heights[0], *own[0]]
    if how == "common" and own[1]:
        own[1] = [heights[0], *own[1]]
    found = []
    for roots in own:
        if not roots:
            continue
        over = RING.constant(1)
        for root in roots:
            over = over * _factor(root)
        if draw(st.booleans()):
            over = over * (v * v + draw(st.integers(1, 5)))
        small = st.integers(-4, 4)
        other = (
            sum(
                (u**i * v**j * draw(small) for i in range(3) for j in range(len(roots))),
                RING.constant(0),
            )
            + 5 * u
        )
        p = over + (u * u - 2) * other
        found.append(tuple((int(i), int(j), int(c)) for (i, j), c in p.to_dict().items()))
    return KnownCurves(tuple(found), tuple(sorted(heights)))
