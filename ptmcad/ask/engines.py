"""Which engine makes a slice's map; of a point `solving.needs_intervals` says it, of a line
`question.line`.
"""

from __future__ import annotations

from ptmcad.question.slice import Slice


def is_certified(slice: Slice, engine: str) -> bool:
    """Whether the choice ``"exact"``, ``"certified"`` or ``"auto"`` means the certified engine for
    a slice.
    """
    only = slice.has_free_lengths or slice.count.kind.predicate is not None
    return engine == "certified" or (engine == "auto" and only)
