"""Branches of solutions along a line, stable and unstable: a bifurcation diagram of some
quantities, as data.

Guarantee: at each point the solutions are all there are, and each number is right in every digit.
Which points are on one branch is taken from their nearness, and no claim.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from ptmcad.model import Model
from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import Enclosure


@dataclass(frozen=True, slots=True)
class BranchPoint:
    """A solution at a value of the axis: the quantities, in their order; None for one that it does
    not have.
    """

    value: Fraction
    numbers: tuple[Enclosure | None, ...]


@dataclass(frozen=True, slots=True)
class Branch:
    """One solution between two critical values.

    Attributes
    ----------
    stable : None where nothing says what is stable.
    index : the number of negative eigenvalues; None without a potential.
    points : in increasing order of the axis.
    """

    stable: bool | None
    index: int | None
    points: tuple[BranchPoint, ...]


@dataclass(frozen=True, slots=True)
class Branches:
    """The answer of ``--quantity``.

    Attributes
    ----------
    quantities : their names as they were asked for.
    units : of each, as the record declares it or in words; empty for one that has none of its own.
    undecided : values of the axis at which not all solutions could be separated; there the
        branches have gaps.
    """

    name: str
    model: Model
    along: Axis
    at: Mapping[str, Fraction]
    quantities: tuple[str, ...]
    units: tuple[str, ...]
    branches: tuple[Branch, ...]
    undecided: tuple[Fraction, ...] = ()
