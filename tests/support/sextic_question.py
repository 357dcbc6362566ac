"""What QEPCAD is asked about the paper's mechanism: its equilibria counted by the sextic, as an
expert would let it.

The sextic's real roots t2 = tan(theta2/2) are, over all parameters outside a set of measure zero,
in one-to-one correspondence with the equilibria of the slice. On that set QEPCAD is allowed to be
wrong (it is two to five times faster so); and an equilibrium at theta2 = pi has no t2. The
elimination is that of `ptmcad.studies.byhand`, with roots t of p = N. Up to positive factors H11 is
V W and, where that is positive, the second derivative of the energy along the curve E1 = 0 is -V
p'(t). So a root is a stable equilibrium exactly if V W > 0 and V p' < 0.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from enum import Enum
from fractions import Fraction
from typing import NamedTuple

from ptmcad.question.slice import Axis, Slice
from ptmcad.studies.byhand import sextic
from ptmcad.text.expressions import Expression
from ptmcad.text.plane import signed_terms

LOSES_PI = "an equilibrium at theta2 = pi over the whole window: t2 = tan(theta2/2) loses it"
_FORMULA = re.compile(r"An equivalent quantifier-free formula:\s*(.*?)\n\s*\n", re.DOTALL)


def formulas(output: str) -> list[str]:
    """The quantifier-free formulas that QEPCAD wrote; after most errors it writes none and exits
    with 0.
    """
    return [" ".join(found.split()) for found in _FORMULA.findall(output)]


class Task(Enum):
    """What QEPCAD is asked: in which part of the window are there exactly so many equilibria?"""

    SIX = "6 equilibria"
    FOUR = "4 equilibria"
    TWO_STABLE = "2 stable equilibria"


Terms = list[tuple[int, int, int, Fraction]]
"""A polynomial in x, y and t: ``(i, j, n, c)`` means c x^i y^j t^n."""


class Question(NamedTuple):
    """The sextic over a window, its derivative in t, and the numerators of V and W, up to positive
    factors.
    """

    sextic: Terms
    slope: Terms
    v: Terms
    w: Terms
    axes: tuple[Axis, Axis]

    def problem(
        self, task: Task, *, swapped: bool = False, then: Sequence[str] = ("solution T",)
    ) -> str:
        """One problem of a session.

        Parameters
        ----------
        swapped : eliminate the first axis before the second, instead of the second before the
            first.
        then : the commands that are given once the decomposition is made.
        """
        p, slope, v, w = (
            " ".join(
                signed_terms((((i, j, n), c) for i, j, n, c in terms), "xyt", times=" ", number=str)
            )
            for terms in self[:4]
        )
        condition = f"{p} = 0"
        if task is Task.TWO_STABLE:
            condition += (
                rf" /\ [[{v} > 0 /\ {w} > 0 /\ {slope} < 0] \/ [{v} < 0 /\ {w} < 0 /\ {slope} > 0]]"
            )
        (x0, x1), (y0, y1) = ((axis.low, axis.high) for axis in self.axes)
        return "\n".join((
            f"[ x is {self.axes[0].name}, y is {self.axes[1].name} ]",
            "(y,x,t)" if swapped else "(x,y,t)",
            "2",
            f"(X{task.value.split()[0]} t)[ {condition} ].",
            rf"assume [ x > {x0} /\ x < {x1} /\ y > {y0} /\ y < {y1} ]",
            "measure-zero-error",
            *("go",) * 3,
            *then,
        ))  # fmt: skip


def question(slice: Slice) -> Question | str:
    """The sextic of a slice, or the reason why there is none to put to QEPCAD."""
    coefficients, v, w, _ = sextic(slice.parameters)
    if not coefficients[6].numerator:
        return LOSES_PI
    slope = [n * coefficient for n, coefficient in enumerate(coefficients)][1:]
    return Question(_terms(coefficients), _terms(slope), _terms(v), _terms(w), slice.axes)


def _terms(polynomial: Sequence[Expression]) -> Terms:
    return [
        (i, j, n, c)
        for n, coefficient in enumerate(polynomial)
        for i, j, c in coefficient.numerator
    ]
