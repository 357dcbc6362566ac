"""What is known of the signs of a question's quantities in its window, as data that the question
carries.

Guarantee: a `Finding` says of which function and in which window it holds, so that it cannot be
taken for that of another one: a question whose parameters or axes were changed by hand carries none
of the new ones.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from ptmcad.model import Kind
from ptmcad.text.expressions import Expression

Corner = tuple[Fraction, Fraction]
Interval = tuple[Fraction, Fraction]
Box = tuple[Interval, Interval]


class Witness(NamedTuple):
    """A point of the open window at which the function is not what was asked for.

    Attributes
    ----------
    value : of the function there, or of its denominator when a pole is the matter.
    other : for a pole, a point at which the denominator has the other sign, if one was found.
    """

    point: Corner
    value: Fraction
    other: Corner | None = None


Verdict = Witness | tuple[Box, ...]
"""A witness, or the boxes that hide all dips to zero or below; their number is zero for a proof."""
PROVED: tuple[Box, ...] = ()
"""The function is what was asked for at every point of the open window."""


class Subject(NamedTuple):
    """A parameter, or a stiffness or a length that is written where a spring or a bar has it.

    Attributes
    ----------
    text : the parameter's name, or the expression as a message shows it.
    kind : what it measures, which decides what sign it needs.
    value : as a function of the axes.
    part : where it is written in the description, such as ``springs.2.k``; empty of a parameter.
    """

    text: str
    kind: Kind
    value: Expression
    part: str = ""


class Finding(NamedTuple):
    """Whether a subject is in the whole open window what its kind asks for.

    Attributes
    ----------
    problem : what is wrong or not proved, in words; empty where it is proved.
    is_final : whether more work would find nothing else.
    """

    subject: Subject
    window: Box
    verdict: Verdict
    problem: str = ""
    is_final: bool = True
