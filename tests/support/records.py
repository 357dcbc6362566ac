"""Records of mechanisms that several tests ask for."""

from __future__ import annotations

from typing import Any

import yaml

TRUSS: dict[str, Any] = yaml.safe_load("""
mechanism:
  name: truss
  parameters:
    a: {kind: base, default: 1}
    k: {kind: stiffness, default: 1}
    l0: {kind: free length, default: 1}
    f: {kind: force}
  unknowns: {h: length}
  points: {A: [-a, 0], B: [a, 0], P: [0, h]}
  springs: [{between: [A, P], k: k, free: l0}, {between: [B, P], k: k, free: l0}]
  loads: {P: [0, f]}
parameters: {l0: 1}
axes: {a: [0, 2], f: [-1, 1]}
count: index
""")
"""Von Mises's: two springs that snap through, loaded at their joint."""
