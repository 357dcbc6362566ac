"""The classification as a user of QEPCAD would do it: the sextic made by hand, one quantifier elimination per count.

Guarantee: where `question` returns a `Question`, its sextic's real roots t2 = tan(theta2/2) are, over all parameters
outside a set of measure zero, in one-to-one correspondence with the equilibria of the slice.

Not guaranteed: the answer on that set of measure zero. QEPCAD is allowed to be wrong there, as an expert would allow it
(it is two to five times faster so); and an equilibrium at theta2 = pi has no t2.

The elimination is that of `ptmcad.studies.sextic`, with roots t of p = N. Up to positive factors H11 is V W and, where
that is positive, the second derivative of the energy along the curve E1 = 0 is -V p'(t). So a root is a stable
equilibrium exactly if V W > 0 and V p' < 0.
"""

from __future__ import annotations

import math
import re
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from ptmcad.question.slice import Axis, Slice
from ptmcad.studies.sextic import sextic
from ptmcad.text.expressions import Expression
from ptmcad.text.terms import signed_terms

_GARBAGE_COLLECTED_CELLS = 20_000_000
_ANSWER = re.compile(r"An equivalent quantifier-free formula:\s*(.*?)\n\s*\n", re.DOTALL)


class Task(Enum):
    """What QEPCAD is asked: in which part of the window are there exactly so many equilibria?"""

    SIX = "6 equilibria"
    FOUR = "4 equilibria"
    TWO_STABLE = "2 stable equilibria"


TOTAL = (Task.SIX, Task.FOUR)
"""The tasks that make up the classification by the total count."""

Terms = tuple[tuple[int, int, int, int], ...]
"""A polynomial in x, y and t: ``(i, j, n, c)`` means c x^i y^j t^n, c an integer, the content being 1."""


@dataclass(frozen=True, slots=True)
class Question:
    """The sextic over a window, ready to be put to QEPCAD.

    Attributes
    ----------
    sextic, slope : the sextic and its derivative in t, up to a positive factor.
    v, w : numerators of V and W, up to a positive factor.
    axes : the window.
    """

    sextic: Terms
    slope: Terms
    v: Terms
    w: Terms
    axes: tuple[Axis, Axis]

    def text(self, task: Task, *, swapped: bool = False, then: Sequence[str] = ("solution T",)) -> str:
        """QEPCAD's standard input.

        Parameters
        ----------
        swapped : eliminate the first axis before the second, instead of the second before the first.
        then : the commands that are given once the decomposition is made.
        """
        return f"{self.problem(task, swapped=swapped, then=then)}\nquit\n"

    def problem(self, task: Task, *, swapped: bool = False, then: Sequence[str] = ("solution T",)) -> str:
        """The same without the end of the session, so that other problems may follow."""
        condition = f"{_text(self.sextic)} = 0"
        if task is Task.TWO_STABLE:
            v, w, slope = _text(self.v), _text(self.w), _text(self.slope)
            condition += rf" /\ [[{v} > 0 /\ {w} > 0 /\ {slope} < 0] \/ [{v} < 0 /\ {w} < 0 /\ {slope} > 0]]"
        number = {Task.SIX: 6, Task.FOUR: 4, Task.TWO_STABLE: 2}[task]
        window = r" /\ ".join(
            bound
            for name, axis in zip("xy", self.axes, strict=True)
            for bound in (f"{_line(name, axis.low)} > 0", f"{_line(name, axis.high)} < 0")
        )
        return "\n".join(
            (
                f"[ x is {self.axes[0].name}, y is {self.axes[1].name} ]",
                "(y,x,t)" if swapped else "(x,y,t)",
                "2",
                f"(X{number} t)[ {condition} ].",
                f"assume [ {window} ]",
                "measure-zero-error",
                "go",
                "go",
                "go",
                *then,
            )
        )


LOSES_PI = "an equilibrium at theta2 = pi over the whole window: t2 = tan(theta2/2) loses it"


def question(slice: Slice) -> Question | str:
    """The sextic of a slice, or the reason why there is none to put to QEPCAD."""
    if slice.mechanism != "ptm":
        return f"the sextic is the paper's mechanism's, not that of {slice.mechanism}"
    if slice.has_free_lengths:
        return "with free lengths there is no sextic"
    if not all(value.is_polynomial for value in slice.parameters.values()):
        return "a parameter is not a polynomial in the axes"
    coefficients, v, w, _ = sextic(slice.parameters)
    if not coefficients[6].numerator:
        return LOSES_PI
    slope = tuple(n * coefficient for n, coefficient in enumerate(coefficients))[1:]
    return Question(_terms(coefficients), _terms(slope), _terms(v), _terms(w), slice.axes)


def program() -> str | None:
    """Where QEPCAD is, None when it is not installed."""
    return shutil.which("qepcad")


def command() -> tuple[str, ...] | None:
    """The command that reads a question from standard input, None when QEPCAD is not installed."""
    where = program()
    return (where, "-noecho", f"+N{_GARBAGE_COLLECTED_CELLS}") if where is not None else None


def formula(output: str) -> str:
    """The quantifier-free formula that QEPCAD wrote, empty when there is none: it exits with 0 after most errors."""
    found = _ANSWER.search(output)
    return " ".join(found.group(1).split()) if found else ""


def _terms(polynomial: Sequence[Expression]) -> Terms:
    terms = [(i, j, n, c) for n, coefficient in enumerate(polynomial) for i, j, c in coefficient.numerator]
    scale = math.lcm(*(c.denominator for *_, c in terms))
    content = math.gcd(*(int(c * scale) for *_, c in terms))
    return tuple((i, j, n, int(c * scale) // content) for i, j, n, c in terms)


def _text(terms: Terms) -> str:
    return " ".join(signed_terms((((i, j, n), c) for i, j, n, c in terms), "xyt", times=" "))


def _line(name: str, end: Fraction) -> str:
    """The line q name - p, positive where ``name > p/q``."""
    terms = ((1,), end.denominator), ((0,), -end.numerator)
    return " ".join(signed_terms((term for term in terms if term[1]), name, times=" "))
