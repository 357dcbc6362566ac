"""Critical points of an energy along a four-bar's loop, by a dense search along its own angle.

Nothing of ptmcad is used: the coupler's end is where two circles meet, each closed curve of
configurations is run through once, and the energy's changes of direction are counted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]
Energy = Callable[[Numbers, Numbers, Numbers, Numbers], Numbers]
"""Of the coordinates of P, at the first crank's end, and of Q, at the second one's."""


def loop_of(
    lengths: Mapping[str, float], places: int = 6001
) -> Iterator[tuple[Numbers, Numbers, Numbers, Numbers]]:
    """The closed curves of configurations, each as the coordinates of P and Q at some places.

    The cranks have the lengths L1 and L2, the coupler L3, and their pivots are b apart. The first
    crank's angle is mid + half*sin(s) where it does not turn around, so that places are dense where
    the assemblies meet.
    """
    a, c, coupler, b = (lengths[name] for name in ("L1", "L2", "L3", "b"))
    most, least = ((a * a + b * b - reach**2) / (2 * a * b) for reach in (c - coupler, c + coupler))
    if least > 1 or most < -1:
        return
    if least <= -1 and most >= 1:
        turns = np.linspace(-np.pi, np.pi, 2 * places, endpoint=False)
        for side in (1.0, -1.0):
            yield _points((a, c, coupler, b), turns, np.full_like(turns, side))
        return
    first, last = np.arccos(min(most, 1)), np.arccos(max(least, -1))
    spans = [(first, last), (-last, -first)]
    if least <= -1:
        spans = [(first, 2 * np.pi - first)]
    elif most >= 1:
        spans = [(-last, last)]
    half = np.sin(np.linspace(-np.pi / 2, np.pi / 2, places))
    sides = np.concatenate([np.ones(places), -np.ones(places - 2)])
    for low, high in spans:
        there = (low + high) / 2 + (high - low) / 2 * half
        yield _points((a, c, coupler, b), np.concatenate([there, there[-2:0:-1]]), sides)


def _points(
    lengths: tuple[float, float, float, float], angle: Numbers, side: Numbers
) -> tuple[Numbers, Numbers, Numbers, Numbers]:
    a, c, coupler, b = lengths
    px, py = a * np.cos(angle), a * np.sin(angle)
    dx, dy = b - px, -py
    apart = np.hypot(dx, dy)
    along = (coupler**2 - c**2 + apart**2) / (2 * apart)
    off = side * np.sqrt(np.maximum(coupler**2 - along**2, 0))
    return px, py, px + (along * dx - off * dy) / apart, py + (along * dy + off * dx) / apart


Taut = Callable[[Numbers, Numbers, Numbers, Numbers], NDArray[np.bool_]]
"""Of the same, whether all springs are longer than their free lengths."""


def taut_along(lengths: Mapping[str, float], energy: Energy, taut: Taut, places: int = 6001) -> int:
    """The number of minima at which all springs are longer than their free lengths."""
    number = 0
    for curve in loop_of(lengths, places):
        values = energy(*curve)
        lower = (values < np.roll(values, 1)) & (values <= np.roll(values, -1))
        number += int((lower & taut(*curve)).sum())
    return number


def counts_along(
    lengths: Mapping[str, float], energy: Energy, places: int = 6001
) -> tuple[int, int]:
    """The numbers of all critical points and of minima."""
    total = minima = 0
    for curve in loop_of(lengths, places):
        values = energy(*curve)
        rising = np.diff(np.append(values, values[0])) > 0
        before = np.roll(rising, 1)
        total += int((rising != before).sum())
        minima += int((rising & ~before).sum())
    return total, minima
