"""What is known of a solution beside that it is one: whether it is stable, and its index.

Guarantee: a model has one criterion, which decides, counts and names what is known in its case. Whoever needs a
number, a word or a matrix asks for that; where nothing is known there is none.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import ClassVar, TypeVar

from ptmcad.text.tree import Tree, to_text

T = TypeVar("T")


def critical_point(negative: int, unknowns: int) -> str:
    """A critical point by the number of negative eigenvalues of its Hessian."""
    return "minimum" if negative == 0 else "maximum" if negative == unknowns else "saddle"


@dataclass(frozen=True)
class Criterion:
    """That of equations alone: nothing is known of a solution but that it is one.

    Signs are ``+``, ``-`` and ``0``, one for each eigenvalue of the Hessian, or for each condition for stability.

    Attributes
    ----------
    unknowns : their number.
    counts : what can be counted, by names of `ptmcad.question.counts`; the finest last.
    choices : kinds of which a solution may be chosen.
    numbers, differences : what else has values where there is an energy: of one solution, and between two.
    adjective : before the noun of the solutions that are followed and make ranges.
    solutions, singular, matrix, determinant : what they are called in messages.
    loose : why there may be infinitely many solutions.
    undecided, degenerate : a solution of which it is not decided whether it is stable, and one without signs.
    may_vary : why the number of stable solutions is not said of a region in which all are counted.
    no_descent : why nothing falls from where a stable solution vanishes.
    no_target : of a followed solution that vanishes, what is not said.
    no_energy : why no energy is drawn.
    stable_at_zero : whether a solution at which a condition vanishes may be stable all the same.
    """

    unknowns: int
    counts: ClassVar[tuple[str, ...]] = ("total",)
    choices: ClassVar[tuple[str, ...]] = ("pose",)
    numbers: ClassVar[tuple[str, ...]] = ()
    differences: ClassVar[tuple[str, ...]] = ()
    adjective: ClassVar[str] = ""
    solutions: ClassVar[str] = "solutions"
    singular: ClassVar[str] = "solution has a singular Jacobian"
    matrix: ClassVar[str] = "Jacobian"
    determinant: ClassVar[str] = "the Jacobian's determinant"
    loose: ClassVar[str] = ""
    undecided: ClassVar[str] = "solution"
    degenerate: ClassVar[str] = "solution"
    may_vary: ClassVar[str] = ""
    no_descent: ClassVar[str] = "the pose vanishes, and without a potential nothing says where it goes"
    no_target: ClassVar[str] = ""
    no_energy: ClassVar[str] = "has equations and no potential: there is no energy to be drawn"
    stable_at_zero: ClassVar[bool] = False

    @property
    def order(self) -> int:
        """The number of rows of the Hessian; 0 where there is none."""
        return 0

    @property
    def on_lines(self) -> Criterion:
        """The same where leading minors of a Hessian are conditions for stability."""
        return self

    def index(self, signs: str) -> int | None:
        """The number of negative eigenvalues of the Hessian; None where it is not known."""
        return None

    def is_stable(self, signs: str) -> bool | None:
        """Whether a solution is stable; None where it is not known."""
        return None

    def rank(self, signs: str) -> int:
        """0 of what is stable; else the number of negative eigenvalues, or 1."""
        return 0 if self.is_stable(signs) else 1

    def number(self, stable: Iterable[bool | None]) -> int | None:
        """How many of some solutions are stable; None where nothing says which are."""
        return None

    def indices(self, signs: Sequence[str]) -> tuple[int, ...] | None:
        """Numbers of solutions by the number of negative eigenvalues; None where there is no Hessian."""
        return None

    def works(self, stable: bool | None) -> bool:
        """Whether a solution is among those that make ranges: stable ones, or all where nothing says which are."""
        return True

    def kind(self, stable: bool | None, index: int | None) -> str:
        """What a solution is called where it stands beside others."""
        return self.undecided

    def kind_of_signs(self, signs: str) -> str:
        """The same by signs."""
        stable = self.is_stable(signs)
        return self.degenerate if stable is None else self.kind(stable, self.index(signs))

    def ranked(self, rank: int, noun: str) -> str:
        """What a solution of a rank is called where it meets others."""
        return noun

    def entry(self, row: int, column: int) -> tuple[int, int]:
        """Which of the equal entries of the matrix stands for one."""
        return row, column

    def decisive(self, conditions: tuple[T, ...]) -> tuple[T, ...]:
        """Those of the conditions for stability off whose zeros no solution loses it."""
        return conditions

    def at_zero(self, what: str, number: int, condition: Tree) -> str:
        """What it means that a condition for stability vanishes at some solutions."""
        return f"{to_text(condition)} is zero at {what}, which {'count' if number > 1 else 'counts'} as unstable"


class ByConditions(Criterion):
    """A solution is stable where all conditions are positive."""

    counts: ClassVar[tuple[str, ...]] = ("total", "stable")
    choices: ClassVar[tuple[str, ...]] = ("pose", "stable", "unstable")
    adjective = "stable "
    undecided = "undecided"
    no_target = "where it goes from there is not decided"
    may_vary = "it may change within a region, see --count stable"

    def is_stable(self, signs: str) -> bool | None:
        return not signs.strip("+") if signs else None

    def number(self, stable: Iterable[bool | None]) -> int | None:
        return [*stable].count(True)

    def works(self, stable: bool | None) -> bool:
        return stable is True

    def kind(self, stable: bool | None, index: int | None) -> str:
        return self.undecided if stable is None else "stable" if stable else "unstable"

    def ranked(self, rank: int, noun: str) -> str:
        return f"unstable {noun}" if rank else f"stable {noun}"


class ByDefiniteness(ByConditions):
    """All conditions are positive where a symmetric matrix is definite; the last one is its determinant, times what is
    positive."""

    stable_at_zero = True

    def decisive(self, conditions: tuple[T, ...]) -> tuple[T, ...]:
        return conditions[-1:]

    def at_zero(self, what: str, number: int, condition: Tree) -> str:
        # the condition is a determinant, pages long
        return f"{what} {'are' if number > 1 else 'is'} degenerate: poses meet there, or the loop is flat"


class ByHessian(ByConditions):
    """Solutions are critical points, near each of a function: stable where its Hessian is positive definite."""

    counts = ("total", "stable", "index")
    choices = ("pose", "stable", "unstable", "saddle", "maximum")
    numbers = ("energy", "stiffness")
    differences = ("barrier",)
    solutions = "equilibria"
    singular = "equilibrium has a singular Hessian"
    matrix = "Hessian"
    determinant = "det H"
    loose = "nothing holds some motion; "
    degenerate = "degenerate"
    may_vary = no_descent = no_energy = ""
    stable_at_zero = True

    @property
    def order(self) -> int:
        return self.unknowns

    @property
    def on_lines(self) -> Criterion:
        return ByDefiniteness(self.unknowns)

    def index(self, signs: str) -> int | None:
        return signs.count("-") if len(signs) == self.unknowns and not signs.strip("+-") else None

    def is_stable(self, signs: str) -> bool | None:
        index = self.index(signs)
        return None if index is None else index == 0

    def rank(self, signs: str) -> int:
        return signs.count("-")

    def indices(self, signs: Sequence[str]) -> tuple[int, ...] | None:
        numbers = Counter(each.count("-") for each in signs)
        return tuple(numbers[k] for k in range(self.unknowns + 1))

    def kind(self, stable: bool | None, index: int | None) -> str:
        return critical_point(index, self.unknowns) if index else super().kind(stable, index)

    def ranked(self, rank: int, noun: str) -> str:
        return critical_point(rank, self.unknowns)

    def entry(self, row: int, column: int) -> tuple[int, int]:
        return max(row, column), min(row, column)
