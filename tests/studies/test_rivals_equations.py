"""Derivatives that are written by hand, against the record."""

from __future__ import annotations

import numpy as np
from mpmath import diff, mpf
from support.mechanisms_energy import energy

from ptmcad.model import ptm
from ptmcad.model.builtin import RECORD
from ptmcad.studies import byhand


def test_the_derivatives_by_hand_are_those_of_the_record() -> None:
    """With free lengths, springs that differ and all loads: mpmath differentiates the energy that
    the record says.
    """
    p = {name: 0.3 + 0.2 * n for n, name in enumerate(ptm().parameters)}
    at = (0.7, -2.1)
    found = byhand.at(p, *(np.array(angle) for angle in at))

    def by(*orders: int) -> float:
        values = {name: mpf(value) for name, value in p.items()}
        return float(diff(lambda *angles: energy(RECORD, values, angles), at, orders))

    assert np.allclose(found[0], [by(1, 0), by(0, 1)], rtol=1e-12)
    assert np.allclose(found[1], [by(2, 0), by(1, 1), by(0, 2)], rtol=1e-8)
