"""Critical free lengths by algebra: the system against balls, msolve's answers read, and the counts
on both sides.
"""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise
from math import cos, sin
from pathlib import Path
from random import Random
from typing import Any

import pytest
import sympy
from support.paper_energy import alike, bent
from support.programs import needs_msolve

from ptmcad.algebra import msolve
from ptmcad.ask.lines.along import certified_intervals
from ptmcad.question.config import slice_from_options
from ptmcad.studies.paper.critical import (
    UNKNOWNS,
    Design,
    critical_free_lengths,
    critical_system,
    signed_solutions,
)

DESIGN: Design = ("7/10", "1", "3/2", "1/5", "-1/10", "-1/10")


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(k, marks=pytest.mark.slow) for k in (2, 3))])
@pytest.mark.slow_cases("1")
def test_equations_are_derivatives_of_the_potential(seed: int) -> None:
    """Difference quotients of U/k from the nodes' coordinates; each polynomial up to one positive
    factor.
    """
    random = Random(seed)
    exact = [Fraction(random.randint(1, 30), 10) for _ in range(5)]
    rho, l1, l2, f3, f4 = map(float, exact)
    texts = critical_system((*map(str, exact[:3]), "1", *map(str, exact[3:])))  # type: ignore[arg-type]
    equations = [sympy.sympify(text.replace("^", "**")) for text in texts]
    ratios = []
    for _ in range(3):
        free, a, b = random.uniform(0.5, 3), random.uniform(-3, 3), random.uniform(-3, 3)
        p = alike(rho, l1, l2, free, f3, f4)
        inverses = (1 / length for length in bent(p, a, b, math).lengths)
        at = dict(
            zip(map(str, UNKNOWNS), (*inverses, cos(a), sin(a), cos(b), sin(b), free), strict=True)
        )
        values = [float(e.subs(at)) for e in equations]
        assert max(map(abs, values[:5])) < 1e-7
        h = 1e-3

        def u(i: int, j: int, p: Any = p, a: float = a, b: float = b, h: float = h) -> float:
            return float(bent(p, a + i * h, b + j * h, math).energy)

        h11, h22 = ((u(i, j) - 2 * u(0, 0) + u(-i, -j)) / h**2 for i, j in ((1, 0), (0, 1)))
        h12 = (u(1, 1) - u(1, -1) - u(-1, 1) + u(-1, -1)) / (4 * h * h)
        wanted = (u(1, 0) - u(-1, 0)) / (2 * h), (u(0, 1) - u(0, -1)) / (2 * h), h11 * h22 - h12**2
        ratios.append([w / v for w, v in zip(wanted, values[5:], strict=True)])
    for same in zip(*ratios, strict=True):
        assert min(same) > 0
        assert max(same) == pytest.approx(min(same), rel=1e-2)


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


@needs_msolve
@pytest.mark.slow
def test_elimination_and_intervals_find_the_same_folds() -> None:
    """Along l0 in (0, 2) at rho = 7/10, L2 = 3/2, F = -10: seven, to ten digits."""
    pytest.importorskip("numba")
    axes = {"slice": "rho,l0", "ranges": ["l0=0:2"], "sets": ["L2=3/2", "F3=-10", "F4=-10"]}
    slice = slice_from_options(**axes)  # type: ignore[arg-type]
    algebra = [
        free
        for free, signs in critical_free_lengths(DESIGN)
        if signs == (1, 1, 1) and 0 < free.center < 2
    ]
    line = certified_intervals(slice, "l0", {"rho": "7/10"}, 10)
    folds = [c.at for c in line.changes if c.names == ("fold",)]
    assert len(algebra) == 7
    assert [c.text(10) for c in algebra] == [c.text(10) for c in folds]
