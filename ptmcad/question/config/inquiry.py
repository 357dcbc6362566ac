"""A record read for all that it asks: a slice, a family or a sweep, and a design beside.

Guarantee: what is wrong is one `ConfigError` that knows all faults of the record, whichever of
these they are of.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from ptmcad.errors import Faults
from ptmcad.question.config.designed import Design
from ptmcad.question.config.designs import checked_design
from ptmcad.question.config.family import Family, checked_family
from ptmcad.question.config.resolution import checked_slice
from ptmcad.question.config.sweeps import Sweeping, checked_sweep
from ptmcad.question.shipped import record_tree
from ptmcad.question.slice import Slice


class Inquiry(NamedTuple):
    """What a record asks.

    Attributes
    ----------
    question : the slice or the family; of a sweep its first member.
    """

    question: Slice | Family
    sweep: Sweeping | None
    design: Design | None


def load_inquiry(path: str | Path) -> Inquiry:
    """Read a record.

    Raises
    ------
    ConfigError
        For anything wrong in it, with file, line and key; its ``faults`` are all there are.
    """
    tree = record_tree(path)
    faults = Faults()
    question: Slice | Family | None = None
    sweep = design = None
    with faults:
        if "sweep" in tree.entries:
            sweep = checked_sweep(tree)
            question = sweep.slice(0)
        else:
            question = checked_family(tree) if "free" in tree.entries else checked_slice(tree)
    with faults:
        design = checked_design(tree) if "design" in tree.entries else None
    faults.check()
    assert question is not None
    return Inquiry(question, sweep, design)
