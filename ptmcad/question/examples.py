"""Examples in messages, in the names of the built-in mechanism's first parameters."""

from __future__ import annotations

from ptmcad.mechanism import ptm

FIRST, SECOND, *_ = ptm().parameters
POINT = f"{FIRST}=1,{SECOND}=3/2"
AXES = f"{{{FIRST}: [0, 2], {SECOND}: [0, 2]}}"
