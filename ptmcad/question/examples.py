"""Examples in messages, in the names of the built-in mechanism's first parameters."""

from __future__ import annotations

from ptmcad.model import ptm

FIRST, SECOND, THIRD, *_ = ptm().parameters
FORCE, *_ = ptm().forces
POINT = f"{FIRST}=1,{SECOND}=3/2"
A_SWEEP = "{F: [-10, -20]} or {F: {from: -40, to: 0, step: 5}}"
A_DESIGN = f"{{maximise: range, along: {THIRD}, over: {{{FIRST}: [1/2, 2], {SECOND}: [1/2, 2]}}}}"
AXES = f"{{{FIRST}: [0, 2], {SECOND}: [0, 2]}}"
