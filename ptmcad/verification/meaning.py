"""What the signs at a solution mean to the checks: those of a Hessian's eigenvalues, of conditions, or none.

Guarantee: derived here once more; nothing of the engines' `ptmcad.model.criterion` is used.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

from ptmcad.question.counts import Count

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class SignMeaning:
    """That of conditions for stability, if there are any.

    Attributes
    ----------
    kinds : what may be counted.
    order : the number of rows of the Hessian; 0 where there is none.
    with_all : the names of the counts of a certified map that counts all solutions.
    solution, equation, entry, determinant : what they are called in messages.
    in_box, at_solution : that stored signs are not the true ones.
    """

    kinds: tuple[Count, ...]
    order: int = 0
    with_all: frozenset[str] = frozenset({"total"})
    solution: str = "a solution"
    equation: str = "equation {}"
    entry: str = "Jacobian's entry {},{}"
    determinant: str = "the Jacobian's determinant"
    in_box: str = "the list of conditions for stability at the solution in it has the signs {!r}, not {!r}"
    at_solution: str = "the conditions for stability at the solution {} have the signs {!r}, not {!r}"

    def place(self, row: int, column: int) -> tuple[int, int]:
        """Which of the equal entries of the Jacobian stands for one."""
        return (min(row, column), max(row, column)) if self.order else (row, column)

    def index(self, signs: str) -> int | None:
        """The number of negative eigenvalues of the Hessian."""
        return signs.count("-") if self.order else None

    def is_stable(self, signs: str) -> bool | None:
        """Whether a solution is stable; None where nothing says so."""
        return self.told(not {*signs} & {"-", "0"})

    def told(self, what: T) -> T | None:
        """Something about stability; None where nothing says what is stable."""
        return what if Count.STABLE in self.kinds else None

    def indices(self, negative: Sequence[int | None]) -> tuple[int, ...] | None:
        """Numbers of solutions by the number of negative eigenvalues."""
        return tuple(negative.count(k) for k in range(self.order + 1)) if self.order else None


def of_eigenvalues(unknowns: int) -> SignMeaning:
    """Solutions are critical points, near each of a function, and the Jacobian is its Hessian."""
    return SignMeaning(
        kinds=(Count.TOTAL, Count.STABLE, Count.INDEX),
        order=unknowns,
        with_all=frozenset({"total", "stable", "index"}),
        solution="an equilibrium",
        equation="gradient's entry {}",
        entry="Hessian's entry {},{}",
        determinant="det H",
        in_box="the Hessian at the solution in it has eigenvalues of signs {!r}, not {!r}",
        at_solution="the Hessian at the solution {} has eigenvalues of signs {}, not {!r}",
    )
