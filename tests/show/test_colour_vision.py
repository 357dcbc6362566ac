"""The default palette as it is seen without the green cones (deuteranopia), by the matrix of
Machado et al., 2009.
"""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from ptmcad.answer.counts import Counts
from ptmcad.show.render.colours import (
    ODD_TOTALS,
    ONE_MAXIMUM,
    TWO_MAXIMA,
    UNDETERMINED,
    fill_of_counts,
)

Floats = NDArray[np.float64]

DEUTERANOPIA = np.array([
    [0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881],
])  # fmt: skip
NORMAL = np.eye(3)
TO_XYZ = np.array([
    [0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041],
])  # fmt: skip
WHITE = np.array([0.95047, 1.0, 1.08883])


def seen(colour: str, eye: Floats) -> Floats:
    """CIE Lab of an sRGB colour as an eye sees it."""
    encoded = np.array([int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)])
    light = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    x, y, z = np.clip(eye @ light, 0, 1) @ TO_XYZ.T / WHITE
    f = [np.cbrt(v) if v > 216 / 24389 else (24389 / 27 * v + 16) / 116 for v in (x, y, z)]
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def apart(one: str, other: str, eye: Floats) -> float:
    return float(np.linalg.norm(seen(one, eye) - seen(other, eye)))


@pytest.mark.parametrize("eye", [NORMAL, DEUTERANOPIA], ids=["normal", "deuteranopia"])
@pytest.mark.parametrize(
    "row", [ONE_MAXIMUM, TWO_MAXIMA, ODD_TOTALS], ids=["one maximum", "two maxima", "odd"]
)
def test_neighbours_and_what_is_undetermined_are_told_apart(
    row: tuple[str, ...], eye: Floats
) -> None:
    assert min(apart(a, b, eye) for a, b in pairwise(row)) >= 16
    assert min(apart(a, UNDETERMINED.face, eye) for a in row) >= 15


@pytest.mark.parametrize(
    ("eye", "least"), [(NORMAL, 13.5), (DEUTERANOPIA, 11)], ids=["normal", "deuteranopia"]
)
def test_any_two_totals_up_to_twelve_are_told_apart(eye: Floats, least: float) -> None:
    """Those for none and one to four are as they ever were, and what they leave is the bound."""
    fills = [fill_of_counts(Counts(total, None, None)) for total in range(13)]
    assert fills[0].hatch and not any(fill.hatch for fill in fills[1:])
    faces = [fill.face for fill in fills[1:]]
    assert faces[:4] == ["#e8eacd", "#f7f6f2", "#bf78a3", "#c7e4f6"]
    assert min(apart(a, b, eye) for a, b in combinations(faces, 2)) >= least
    assert min(apart(a, UNDETERMINED.face, eye) for a in faces) >= 15
    new = faces[4::2]
    assert min(apart(a, b, eye) for a in new for b in faces if a != b) >= 20
