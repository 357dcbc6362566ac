"""All claims of the paper, in the order of its sections.

Guarantee: names are unique; each check is independent of the others, so they may run in any order.
"""

from __future__ import annotations

from ptmcad.studies.paper.claim import Claim
from ptmcad.studies.paper.claims import (
    basics,
    extensions,
    free_springs,
    general,
    overall,
    symmetric,
    symmetric_map,
    unloaded,
    unloaded_map,
)

SECTIONS = (
    "abstract", "1", "2", "3", "3.1", "3.2", "3.3", "4", "4.1", "4.2", "4.3", "5.1", "5.2", "conclusions",
)  # fmt: skip
"""Sections with claims, as they follow each other."""
_MODULES = (
    overall, basics, unloaded, unloaded_map, symmetric, symmetric_map, general, extensions, free_springs,
)  # fmt: skip


def all_claims() -> tuple[Claim, ...]:
    """Every claim, sorted by section and, within one, as listed."""
    listed = [c for module in _MODULES for c in module.CLAIMS]
    return tuple(sorted(listed, key=lambda c: SECTIONS.index(c.section)))


__all__ = ["SECTIONS", "all_claims"]
