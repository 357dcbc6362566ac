"""The kinds of count as the checker knows them: the meaning of the signs at a solution, and the models
that have a kind.

Guarantee: a kind that is not in the table is refused.
"""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import dataclass
from typing import TypeVar

from ptmcad.model import Mechanism, Model, System
from ptmcad.question.counts import Count
from ptmcad.text.tree import names_of
from ptmcad.verification.report import Violation

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class SignMeaning:
    """What the signs at a solution mean: those of conditions for stability, if there are any.

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
    in_box: str = (
        "the list of conditions for stability at the solution in it has the signs {!r}, not {!r}"
    )
    at_solution: str = (
        "the conditions for stability at the solution {} have the signs {!r}, not {!r}"
    )

    def place(self, row: int, column: int) -> tuple[int, int]:
        """Which of the equal entries of the Jacobian stands for one."""
        return (min(row, column), max(row, column)) if self.order else (row, column)

    def index(self, signs: str) -> int | None:
        """The number of negative eigenvalues of the Hessian."""
        return signs.count("-") if self.order else None

    def is_stable(self, signs: str) -> bool | None:
        """Whether a solution is stable; None where nothing says so."""
        return self.about_stability(not {*signs} & {"-", "0"})

    def about_stability(self, what: T) -> T | None:
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


def meaning_of(model: Model) -> SignMeaning:
    """What is known of a model's solutions: by an index where they are critical points, near each
    of a function.
    """
    mechanism = model.whole
    if mechanism is not None and (mechanism.closing or mechanism.xjoints):
        return SignMeaning(
            (Count.TOTAL, Count.STABLE)
        )  # conditions for stability stand in the place of a Hessian
    if mechanism is not None:
        has_index = not has_moments_apart(mechanism)
    else:
        assert isinstance(model, System)
        has_index = model.potential is not None
    if has_index:
        return of_eigenvalues(len(model.unknowns))
    return SignMeaning((Count.TOTAL, Count.STABLE) if model.stability else (Count.TOTAL,))


def has_moments_apart(mechanism: Mechanism) -> bool:
    """Whether some moment depends on another unknown than its own.

    Others are slopes of a function; with such a one nothing may be stored of indices and of what is
    stable.
    """
    unknowns = {*mechanism.angles, *mechanism.reals}
    return any(
        unknowns.intersection(names_of(tree)) - {unknown}
        for unknown, tree in mechanism.work.items()
    )


_OF_STABLE = {
    Count.STABLE: True,
    Count.TOTAL: False,
    Count.INDEX: False,
    Count.ADMISSIBLE: True,
}
"""The kinds that the checker knows, and whether stable solutions alone matter for them."""


def is_of_stable(count: Count) -> bool:
    """Whether stable solutions alone matter.

    Raises
    ------
    Violation
        When the checker does not know the kind.
    """
    if count not in _OF_STABLE:
        raise Violation(f"the checker does not know what {count.value} counts are")
    return _OF_STABLE[count]


def has_margins(count: Count) -> bool:
    """Whether of stable solutions those alone count at which no spring is shorter than it is free."""
    return count is Count.ADMISSIBLE


def has_counts(model: Model, count: Count) -> bool:
    """Whether a model has solutions that may be counted so.

    Margins may be asked of points in the unknowns alone, as those of X-joints are not.
    """
    kinds = meaning_of(model).kinds
    if not has_margins(count):
        return count in kinds
    mechanism = model.whole
    return mechanism is not None and not mechanism.xjoints and Count.STABLE in kinds


def numbers_for(count: Count, meaning: SignMeaning) -> Set[str]:
    """The names of the counts that a certified map has; without an index all solutions, or stable
    ones alone.
    """
    return {"stable", count.value} if is_of_stable(count) else meaning.with_all
