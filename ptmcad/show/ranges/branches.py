"""Branches of solutions along a line as text.

Guarantee: every digit that is shown is right.
"""

from __future__ import annotations

from ptmcad.answer.branches import Branch, Branches, BranchPoint
from ptmcad.answer.words import noun
from ptmcad.model import Model
from ptmcad.show.columns import aligned
from ptmcad.show.ranges.numbers import known
from ptmcad.show.units import with_unit
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import equalities, shortest_text

DIGITS = 6


def kind(branch: Branch, model: Model) -> str:
    """What the solutions of a branch are called: stable, saddle, maximum, unstable, or by the
    model's noun.
    """
    return model.criterion.kind(branch.stable, branch.index).replace("solution", noun(model, 1))


def table(found: Branches) -> str:
    """One row for each branch: where it begins and ends, and the quantities there."""
    heads = [with_unit(*pair) for pair in zip(found.quantities, found.units, strict=True)]
    rows = [["from", "to", "kind", *heads]]
    for branch in found.branches:
        first, last = branch.points[0], branch.points[-1]
        numbers = zip(first.numbers, last.numbers, strict=True)
        changes = [f"{_text(a)} to {_text(b)}" for a, b in numbers]
        rows.append([_short(first), _short(last), kind(branch, found.model), *changes])
    where = f"{found.along.name} at {equalities(found.at, shortest_text)}"
    lines = [f"branches along {where}, without the last 1/100000 before critical values", ""]
    lines += aligned(rows)
    if found.undecided:
        lines += [
            "",
            f"not all solutions could be told apart at {len(found.undecided)} of the values tried",
        ]
    return "\n".join(lines)


def _short(point: BranchPoint) -> str:
    return f"{float(point.value):.6g}"


def _text(number: Enclosure | None) -> str:
    return "-" if number is None else known(number, DIGITS)
