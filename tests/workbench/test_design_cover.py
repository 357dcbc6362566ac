"""Covers of lines over boxes of designs: no design has a longer interval than they say."""

from __future__ import annotations

import random
from itertools import pairwise

import numpy as np
from flint import fmpq

from ptmcad.algebra.bernstein import table_of
from ptmcad.workbench.designs.designbounds import Lengths
from ptmcad.workbench.designs.designlines import (
    Space,
    certain,
    longest,
    measure,
    refined,
    root_bound,
)

WINDOW = (fmpq(0), fmpq(1))
Terms = list[tuple[tuple[int, int, int], int]]


def _random_terms(source: random.Random, even: bool) -> Terms:
    step = 2 if even else 1
    powers = [(step * i, j, k) for i in range(4) for j in range(3) for k in range(2)]
    return [(p, c) for p in powers if (c := source.randint(-9, 9))]


def _value(terms: Terms, at: tuple[float, float, float]) -> float:
    return float(sum(c * at[0] ** i * at[1] ** j * at[2] ** k for (i, j, k), c in terms))


def _space(terms: Terms, even: bool) -> Space:
    """Where the polynomial is positive the count is 1."""

    def count(value: fmpq, design: tuple[fmpq, fmpq]) -> int | None:
        total = sum(
            (c * value**i * design[0] ** j * design[1] ** k for (i, j, k), c in terms), fmpq(0)
        )
        return None if not total else int(total > 0)

    power = 2 if even else 1
    table = table_of(((i // power, j, k), c) for (i, j, k), c in terms)
    return Space((table,), power, WINDOW, count, 1)


def _true(terms: Terms, design: tuple[float, float]) -> tuple[float, float]:
    """The longest interval with a positive value, and the length of all."""
    coefficients = [0.0] * 8
    for (i, j, k), c in terms:
        coefficients[i] += c * design[0] ** j * design[1] ** k
    roots = [r.real for r in np.roots(coefficients[::-1]) if abs(r.imag) < 1e-9 and 0 < r.real < 1]
    ends = [0.0, *sorted(roots), 1.0]
    parts = [b - a for a, b in pairwise(ends) if _value(terms, ((a + b) / 2, *design)) > 0]
    return max(parts, default=0.0), sum(parts)


def test_bounds_hold_and_close_in() -> None:
    """Nested boxes, with the runs of the outer one in the inner one."""
    source = random.Random(18)
    doubt: list[float] = []
    for number in range(24):
        even = number % 2 == 1
        terms = _random_terms(source, even)
        space = _space(terms, even)
        runs, box, fine = space.whole(), (WINDOW, WINDOW), fmpq(1, 16)
        for _ in range(5):
            runs = refined(space, box, runs, fine)
            most, least, total = (_float(f(space, runs)) for f in (longest, certain, measure))
            for _ in range(20):
                inside = [_float(a) + _float(b - a) * source.random() for a, b in box]
                longest_one, all_of_them = _true(terms, (inside[0], inside[1]))
                assert longest_one <= most + 1e-9 and all_of_them <= total + 1e-9
                assert least <= longest_one + 1e-9
            if fine < fmpq(1, 128):
                doubt.append(total - all_of_them)
            halved = [
                (a, (a + b) / 2) if source.random() < 0.5 else ((a + b) / 2, b) for a, b in box
            ]
            box, fine = (halved[0], halved[1]), fine / 2
    assert len(doubt) == 24 and sorted(doubt)[12] < 0.05, (
        "bounds are near the true lengths over small boxes"
    )


def _float(value: fmpq) -> float:
    return int(value.p) / int(value.q)


def _two_intervals() -> Space:
    """The count is 1 between 1/4 and 1/2 and from 5/8 on, for all designs."""
    tables = [table_of([((1, 0, 0), a), ((0, 0, 0), b)]) for a, b in ((4, -1), (2, -1), (8, -5))]

    def count(value: fmpq, _design: tuple[fmpq, fmpq]) -> int:
        return int(fmpq(1, 4) < value < fmpq(1, 2) or value > fmpq(5, 8))

    return Space(tuple(tables), 1, WINDOW, count, 1)


def test_runs_that_are_short_enough_still_count() -> None:
    bounder = Lengths(_two_intervals(), fmpq(1, 10))
    place = (WINDOW, WINDOW)
    _, _, state = bounder.over(place, bounder.whole(), fmpq(1), fmpq(1, 10))
    for enough in (fmpq(3, 10), fmpq(1, 2)):
        assert bounder.over(place, state, fmpq(1), enough)[0] == fmpq(3, 8)


def test_roots_are_rounded_outwards() -> None:
    for value in (fmpq(2), fmpq(1, 3), fmpq(9, 4), fmpq(0)):
        low, high = root_bound(value, 2, up=False), root_bound(value, 2, up=True)
        assert low**2 <= value <= high**2 and high - low <= fmpq(1, 2**64)
        assert (low == high) == (value in (fmpq(9, 4), fmpq(0)))
        assert root_bound(value, 1, up=True) == value
