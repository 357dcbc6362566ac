"""Records of sliders that springs alone hold."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import yaml
from hypothesis import strategies as st

PAIR: dict[str, Any] = yaml.safe_load("""
name: pair
mechanism:
  name: pair
  parameters:
    a: {kind: number}
    b: {kind: number}
    c: {kind: number}
    d: {kind: number}
    F: {kind: number}
    G: {kind: number}
    k: {kind: stiffness}
    m: {kind: stiffness}
    "n": {kind: stiffness}
    l: {kind: free length}
    r: {kind: free length}
    q: {kind: free length}
  unknowns: {x: length, y: length}
  points: {S: [a*x, b*x], T: [1+c*y, 1/3+d*y], A: [1/5, -3/7], B: ["-1", 2/3]}
  springs:
    - {between: [A, S], k: k, free: l}
    - {between: [B, T], k: m, free: r}
    - {between: [S, T], k: "n", free: q}
  loads: {S: [F, 1/9], T: [0, G]}
axes: {F: [-2, 2], l: [1/10, 2]}
parameters: {a: 1, b: 2, c: 3, d: 1, G: 1/7, k: 1, m: 1, "n": 1/2, r: 1, q: 1/4}
count: index
""")
"""Two sliders, each with a spring to a point beside its guide, and one between them; unknowns are
shares of vectors.
"""
SLANTED: dict[str, Any] = yaml.safe_load("""
name: slanted
mechanism:
  name: slanted
  parameters: {a: {kind: number}, F: {kind: force}}
  unknowns: {x: length, y: length}
  points: {S: [x, 0], T: [y, 1 + a*y]}
  springs: [{between: [S, T], k: 1, free: 1/2}]
  loads: {S: [F, 0]}
axes: {a: [-1/4, 3/4], F: [1, 2]}
count: total
""")
"""Sliders on two guides with nothing but a spring between them, and a force on one: far away where
a is small.
"""


coordinates = st.fractions(min_value=-3, max_value=3, max_denominator=4)
stiffnesses = st.fractions(min_value=Fraction(1, 20), max_value=20, max_denominator=20)
lengths = st.fractions(min_value=Fraction(1, 10), max_value=2, max_denominator=10)
guides = st.tuples(coordinates, coordinates).filter(any)


@st.composite
def pairs(draw: st.DrawFn) -> dict[str, Fraction]:
    """Values of all parameters of the pair of sliders."""
    directions = dict(zip("abcd", (*draw(guides), *draw(guides)), strict=True))
    return (
        directions
        | {name: draw(coordinates) for name in "FG"}
        | {name: draw(stiffnesses) for name in "kmn"}
        | {name: draw(lengths) for name in "lrq"}
    )
