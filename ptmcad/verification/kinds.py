"""The kinds of count as the checker knows them: of which models, and what is asked of stable
solutions besides.

Guarantee: margins are derived here from descriptions, as polynomials; a kind without a row in this
table is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Set
from dataclasses import replace
from typing import NamedTuple

from flint import fmpq_mpoly

from ptmcad.model import Model
from ptmcad.question.counts import Count
from ptmcad.verification.derivation import Derivation, SignMeaning, SpringVector, meaning_of
from ptmcad.verification.report import Violation


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
