"""The stability and the index of a solution, as far as they are known.

Guarantee: a model has one criterion, which decides, counts and names what is known in its case.
Whoever needs a number, a word or a matrix asks for that; where nothing is known there is none.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple, TypeVar

from ptmcad.text.tree import Tree, to_text

T = TypeVar("T")


def critical_point(negative: int, unknowns: int) -> str:
    """A critical point by the number of negative eigenvalues of its Hessian."""
    return "minimum" if negative == 0 else "maximum" if negative == unknowns else "saddle"


class Criterion(NamedTuple):
    """By what it is known whether a solution is stable; without arguments by nothing.

    Signs are ``+``, ``-`` and ``0``, one for each eigenvalue of the Hessian, or for each condition
    for stability.

    Attributes
    ----------
    counts : what can be counted, by names of `ptmcad.question.counts`; the finest last.
    order : the number of rows of the Hessian; 0 where there is none.
    is_definite : whether conditions for stability hold together where a symmetric matrix is
        positive definite, and the last one is its determinant, times what is positive.
    stable_at_zero : whether a solution at which a condition vanishes may be stable all the same.
    numbers, differences : what has values where there is an energy: of one solution, and between
        two.
    adjective, poses : before the noun of the solutions that are followed and make ranges, and as
        messages call them.
    solutions, singular, matrix, determinant : what they are called in messages.
    loose : why there may be infinitely many solutions.
    undecided, degenerate : a solution of which it is not decided whether it is stable, and one
        without signs.
    may_vary : why the number of stable solutions is not said of a region in which all are counted.
    no_descent : why nothing falls from where a stable solution vanishes.
    no_target : what is not said of a followed solution that vanishes.
    no_energy : why no energy is drawn.
    """

    counts: tuple[str, ...] = ("total",)
    order: int = 0
    is_definite: bool = False
    stable_at_zero: bool = False
    numbers: tuple[str, ...] = ()
    differences: tuple[str, ...] = ()
    adjective: str = ""
    poses: str = "solutions"
    solutions: str = "solutions"
    singular: str = "solution has a singular Jacobian"
    matrix: str = "Jacobian"
    determinant: str = "the Jacobian's determinant"
    loose: str = ""
    undecided: str = "solution"
    degenerate: str = "solution"
    may_vary: str = ""
    no_descent: str = "the pose vanishes, and without a potential nothing says where it goes"
    no_target: str = ""
    no_energy: str = "has equations and no potential: there is no energy to be drawn"

    @property
    def is_told(self) -> bool:
        """Whether it is known what a stable solution is."""
        return "stable" in self.counts

    @property
    def on_lines(self) -> Criterion:
        """The same where leading minors of a Hessian are conditions for stability."""
        return DEFINITENESS if self.order else self

    def morse_index(self, signs: str) -> int | None:
        """The number of negative eigenvalues of the Hessian; None where it is not known."""
        return signs.count("-") if 0 < self.order == len(signs) and not signs.strip("+-") else None

    def is_stable(self, signs: str) -> bool | None:
        """Whether a solution is stable; None where it is not known."""
        known = self.morse_index(signs) is not None if self.order else signs and self.is_told
        return not signs.strip("+") if known else None

    def rank(self, signs: str) -> int:
        """0 of what is stable; else the number of negative eigenvalues, or 1."""
        return signs.count("-") if self.order else int(not self.is_stable(signs))

    def number(self, stable: Iterable[bool | None]) -> int | None:
        """How many of some solutions are stable; None where nothing says which are."""
        return [*stable].count(True) if self.is_told else None

    def indices(self, signs: Sequence[str]) -> tuple[int, ...] | None:
        """Numbers of solutions by the number of negative eigenvalues; None where there is no
        Hessian.
        """
        negative = [each.count("-") for each in signs]
        return tuple(negative.count(k) for k in range(self.order + 1)) if self.order else None

    def works(self, stable: bool | None) -> bool:
        """Whether a solution is among those that make ranges: stable ones, or all where nothing
        says which are.
        """
        return stable is True or not self.is_told

    def kind(self, stable: bool | None, index: int | None) -> str:
        """The name of a solution among others."""
        if stable is None:
            return self.undecided
        return critical_point(index, self.order) if index else "stable" if stable else "unstable"

    def kind_of_signs(self, signs: str) -> str:
        """The same by signs."""
        stable = self.is_stable(signs)
        return self.degenerate if stable is None else self.kind(stable, self.morse_index(signs))

    def ranked(self, rank: int, noun: str) -> str:
        """What a solution of a rank is called where it meets others."""
        if self.order:
            return critical_point(rank, self.order)
        return f"un{self.adjective}{noun}" if rank and self.is_told else f"{self.adjective}{noun}"

    def entry(self, row: int, column: int) -> tuple[int, int]:
        """Which of the equal entries of the matrix stands for one."""
        return (max(row, column), min(row, column)) if self.order else (row, column)

    def decisive(self, conditions: tuple[T, ...]) -> tuple[T, ...]:
        """Those of the conditions for stability off whose zeros no solution loses it."""
        return conditions[-1:] if self.is_definite else conditions

    def at_zero(self, what: str, number: int, condition: Tree | None) -> str:
        """What it means that a condition for stability, None of what is multiplied out, vanishes at
        some solutions.
        """
        if self.is_definite:
            return f"{what} {'are' if number > 1 else 'is'} degenerate: poses meet there, or the loop is flat"
        assert condition is not None
        return f"{to_text(condition)} is zero at {what}, which {'count' if number > 1 else 'counts'} as unstable"


NOTHING = Criterion()
"""Nothing is known of a solution but that it is one."""
CONDITIONS = Criterion(
    counts=("total", "stable"),
    adjective="stable ",
    poses="stable poses",
    undecided="undecided",
    may_vary="it may change within a region, see --count stable",
    no_target="where it goes from there is not decided",
)
"""A solution is stable where all conditions are positive."""
DEFINITENESS = CONDITIONS._replace(is_definite=True, stable_at_zero=True)
"""The same where they say together that a symmetric matrix is definite."""


def by_hessian(unknowns: int) -> Criterion:
    """Solutions are critical points, near each of a function: stable where its Hessian is positive
    definite.
    """
    return CONDITIONS._replace(
        counts=("total", "stable", "index"),
        order=unknowns,
        stable_at_zero=True,
        numbers=("energy", "stiffness"),
        differences=("barrier",),
        solutions="equilibria",
        singular="equilibrium has a singular Hessian",
        matrix="Hessian",
        determinant="det H",
        loose="nothing holds some motion; ",
        degenerate="degenerate",
        may_vary="",
        no_descent="",
        no_energy="",
    )
