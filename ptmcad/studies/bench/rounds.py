"""Repeated measurements: jobs take turns in shuffled rounds, and what their times come to.

Guarantee: in each round every job that is due runs once, in an order drawn from the seed, so that a slow minute of the
machine hits all alike, and that the i-th figures of two jobs belong together.
"""

from __future__ import annotations

import random
import statistics
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Times:
    """Seconds of repeated runs."""

    runs: int
    median: float
    minimum: float
    maximum: float


def times(seconds: Sequence[float]) -> Times:
    """Median and spread, rounded to 0.1 ms."""
    return Times(len(seconds), *(round(x, 4) for x in (statistics.median(seconds), min(seconds), max(seconds))))


def ratio(numerators: Sequence[float], denominators: Sequence[float]) -> float:
    """The median of the ratios of the same rounds; the longer sequence's last ones have no partner."""
    return statistics.median(a / b for a, b in zip(numerators, denominators, strict=False))


def rounds(number: int, due: Callable[[int], Sequence[T]], order: random.Random) -> Iterator[list[T]]:
    """For each round the jobs that are due then, shuffled; `due` is asked when the round begins."""
    for index in range(number):
        yield order.sample(list(due(index)), len(due(index)))
