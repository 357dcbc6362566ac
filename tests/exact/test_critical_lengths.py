"""Critical free lengths by algebra: the system against balls, msolve's answers read, and the counts
on both sides.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest
from support.programs import needs_msolve

from ptmcad.algebra import msolve
from ptmcad.studies.paper.critical import critical_free_lengths
from ptmcad.studies.paper.squaring import Design, signed_solutions

DESIGN: Design = ("7/10", "1", "3/2", "1/5", "-1/10", "-1/10")


ANSWERS = {
    "[-1]:": (),
    "[0, [1,\n[[[1 / 2^2, 3 / 2], [-1, 0]], [[5 / 2^520, 5 / 2^519], [2, 2]]]\n]]:": (
        ((Fraction(1, 4), Fraction(3, 2)), (Fraction(-1), Fraction(0))),
        ((Fraction(5, 2**520), Fraction(5, 2**519)), (Fraction(2), Fraction(2))),
    ),
    "[0, [1,\n[]\n]]:": (),
}


@pytest.mark.parametrize("answer", ANSWERS)
def test_answers_are_read(answer: str) -> None:
    assert msolve.parsed(answer, 2) == ANSWERS[answer]


@pytest.mark.parametrize("answer", [
    "", "[1, 2, -1, []]:", "[0, [1, [[[1, 2]]]]]:", "[0, [1, [[[2, 1], [1, 1]]]]]:", "[0, [1, [[[1, 2], [3, 4",
], ids=["empty", "infinitely many", "one variable missing", "ends swapped", "cut off"])  # fmt: skip
def test_what_is_no_answer_is_an_error(answer: str) -> None:
    with pytest.raises(msolve.MsolveError):
        msolve.parsed(answer, 2)


def test_a_missing_program_is_one_message(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(msolve, "program", lambda: None)
    with pytest.raises(msolve.MsolveError, match="not installed"):
        critical_free_lengths(DESIGN)


@needs_msolve
def test_real_solutions_of_a_small_system() -> None:
    boxes = msolve.real_solutions(("x", "y"), ("x^2-2", "y-x-1"))
    assert len(boxes) == 2
    assert all(low**2 <= 2 <= high**2 or high**2 <= 2 <= low**2 for (low, high), _ in boxes)
    assert msolve.real_solutions(("x", "y"), ("x^2+2", "y-x")) == ()
    with pytest.raises(msolve.MsolveError):
        msolve.real_solutions(("x", "y"), ("x*y-y",))


@needs_msolve
def test_a_time_limit_is_kept() -> None:
    with pytest.raises(msolve.MsolveError, match="did not end"):
        critical_free_lengths(DESIGN, timeout=0.2)


@needs_msolve
@pytest.mark.slow
def test_fifty_two_critical_lengths_and_the_counts_around_them() -> None:
    """52 real ones at rho = 7/10, L2 = 3/2, f = -1/10; over all signs exact counts change by 2 at
    each positive one.
    """
    found = critical_free_lengths(DESIGN)
    assert len(found) == 52
    signed = {(round(free.center, 20), signs) for free, signs in found}
    assert signed == {(-free, tuple(-s for s in signs)) for free, signs in signed}
    positive = [free for free, _ in found if free.low > 0]
    samples = [positive[0].center / 2]
    samples += [((a.center + b.center) / 2).limit_denominator(10**6) for a, b in pairwise(positive)]
    counts = [signed_solutions((*DESIGN[:3], str(free), *DESIGN[4:])) for free in samples]
    for critical, (before, after) in zip(positive, pairwise(counts), strict=False):
        assert abs(after.real - before.real) == 2, critical
