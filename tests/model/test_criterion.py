"""What is known of solutions in each of the four cases: counts, signs and words belong together."""

from __future__ import annotations

import pytest

from ptmcad.answer.counts import counts_of_signs
from ptmcad.errors import ConfigError
from ptmcad.model.criterion import CONDITIONS, DEFINITENESS, NOTHING, Criterion, by_hessian
from ptmcad.question.config import load
from ptmcad.question.counts import usual_count
from ptmcad.question.slice import count_fault
from ptmcad.workbench.fields.quantityfield import choice_of

RECORDS = {
    "fig2": by_hessian(2),
    "four-bar": DEFINITENESS,
    "schloegl": CONDITIONS,
    "duffing": NOTHING,
    "inverted-pendulum": by_hessian(1),
}
CHOICES = {
    "pose": "total",
    "stable": "stable",
    "unstable": "stable",
    "saddle": "index",
    "maximum": "index",
}


@pytest.mark.parametrize(("name", "expected"), RECORDS.items())
def test_a_record_has_the_criterion_of_its_kind(name: str, expected: Criterion) -> None:
    slice = load(name)
    model = slice.model
    assert model.criterion == expected
    assert usual_count(model).value == ("stable" if expected.is_told else "total")
    for kind, needed in CHOICES.items():
        if needed in expected.counts:
            assert choice_of(kind, model).kind == kind
        else:
            with pytest.raises(ConfigError):
                choice_of(kind, model)
    assert not count_fault(slice.count, model, slice.parameters)


@pytest.mark.parametrize(
    ("criterion", "signs", "stable", "index", "kind"),
    [
        (NOTHING, "", None, None, "solution"),
        (NOTHING, "+", None, None, "solution"),
        (CONDITIONS, "", None, None, "solution"),
        (CONDITIONS, "++", True, None, "stable"),
        (CONDITIONS, "+0", False, None, "unstable"),
        (DEFINITENESS, "-", False, None, "unstable"),
        (by_hessian(2), "", None, None, "degenerate"),
        (by_hessian(2), "+0", None, None, "degenerate"),
        (by_hessian(2), "+", None, None, "degenerate"),
        (by_hessian(2), "++", True, 0, "stable"),
        (by_hessian(2), "+-", False, 1, "saddle"),
        (by_hessian(2), "--", False, 2, "maximum"),
        (by_hessian(1), "-", False, 1, "maximum"),
        (by_hessian(3), "+--", False, 2, "saddle"),
    ],
)
def test_signs_say_what_a_solution_is(
    criterion: Criterion, signs: str, stable: bool | None, index: int | None, kind: str
) -> None:
    assert (criterion.is_stable(signs), criterion.morse_index(signs)) == (stable, index)
    assert criterion.kind_of_signs(signs) == kind


@pytest.mark.parametrize(
    ("criterion", "stable", "index"),
    [
        (NOTHING, None, None),
        (CONDITIONS, 2, None),
        (DEFINITENESS, 2, None),
        (by_hessian(2), 2, (2, 1, 1)),
    ],
)
def test_counts_are_those_of_the_signs(
    criterion: Criterion, stable: int | None, index: tuple[int, ...] | None
) -> None:
    counts = counts_of_signs(["++", "+-", "++", "--"], criterion)
    assert (counts.total, counts.stable, counts.index) == (4, stable, index)
    assert counts.working == (4 if stable is None else 2)


def test_a_definite_matrix_loses_that_at_its_determinant_alone() -> None:
    assert [each.decisive(("minor", "determinant")) for each in (CONDITIONS, DEFINITENESS)] == [
        ("minor", "determinant"),
        ("determinant",),
    ]
    assert by_hessian(3).on_lines == DEFINITENESS and CONDITIONS.on_lines == CONDITIONS
