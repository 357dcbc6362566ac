"""The kinds of count as the checker knows them: the meaning of the signs at a solution, the models
that have a kind, and the further conditions on stable solutions.

Guarantee: margins are derived here from descriptions, as polynomials; a kind without a row in this
table is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence, Set
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from flint import fmpq_mpoly

from ptmcad.model import Mechanism, Model, System
from ptmcad.question.counts import Count
from ptmcad.text.tree import names_of
from ptmcad.verification.report import Violation

if TYPE_CHECKING:
    from ptmcad.verification.derivation import Derivation, SpringVector

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


class CheckedMargin(NamedTuple):
    """What is positive at a stable solution that is counted.

    Attributes
    ----------
    value : a polynomial in coordinates and parameters.
    spring : the value is its squared length less the square of its free length; None of another
        one.
    """

    value: fmpq_mpoly
    spring: SpringVector | None = None


class CheckedKind(NamedTuple):
    """A row of the table.

    Attributes
    ----------
    is_of : whether a model has solutions that may be counted so.
    margins : of a model with or without numbers in the place of parameters; no free length is
        negative.
    boundary : the name of the curves on which they vanish.
    undecided : said where one of them may be zero.
    has_exact_maps : whether margins say something where no spring has a free length.
    is_of_stable : whether stable solutions alone matter.
    """

    is_of: Callable[[Model], bool]
    margins: Callable[[Derivation], Iterator[CheckedMargin]] = lambda _point: iter(())
    boundary: str = ""
    undecided: str = ""
    has_exact_maps: bool = True
    is_of_stable: bool = True

    @property
    def is_predicate(self) -> bool:
        """Whether some stable solutions are not counted."""
        return bool(self.boundary)

    def with_margins(self, point: Derivation) -> Derivation:
        """With the margins as conditions for stability, of a model without free lengths.

        Raises
        ------
        Violation
            When there are such conditions already: with these the last alone would be decisive.
        """
        if not (self.is_predicate and self.has_exact_maps):
            return point
        if point.stability:
            raise Violation(
                "where conditions say what is stable there are no exact maps by a predicate"
            )
        return replace(point, stability=tuple(margin.value for margin in self.margins(point)))


def _is_told(count: Count) -> Callable[[Model], bool]:
    return lambda model: count in meaning_of(model).kinds


def _is_of_springs(model: Model) -> bool:
    """Whether margins may be asked of its points: those of X-joints are not in its unknowns alone."""
    mechanism = model.whole
    return (
        mechanism is not None and not mechanism.xjoints and Count.STABLE in meaning_of(model).kinds
    )


def _longer_than_free(point: Derivation) -> Iterator[CheckedMargin]:
    for spring in point.springs:
        yield CheckedMargin(spring.squared - spring.free**2, spring)


_KINDS = {
    Count.STABLE: CheckedKind(_is_told(Count.STABLE)),
    Count.TOTAL: CheckedKind(_is_told(Count.TOTAL), is_of_stable=False),
    Count.INDEX: CheckedKind(_is_told(Count.INDEX), is_of_stable=False),
    Count.ADMISSIBLE: CheckedKind(
        _is_of_springs,
        _longer_than_free,
        boundary="free length",
        undecided="a spring may be as long as its free length",
        has_exact_maps=False,
    ),
}
"""The table."""


def kind_of(count: Count) -> CheckedKind:
    """Its row of the table.

    Raises
    ------
    Violation
        When there is none.
    """
    if count not in _KINDS:
        raise Violation(f"the checker does not know what {count.value} counts are")
    return _KINDS[count]


def numbers_for(count: Count, meaning: SignMeaning) -> Set[str]:
    """The names of the counts that a certified map has; without an index all solutions, or stable
    ones alone.
    """
    return {"stable", count.value} if kind_of(count).is_of_stable else meaning.with_all
