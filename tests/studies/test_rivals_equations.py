"""Equations that are written by hand: those of studies against the record, and those of the rivals against these."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from mpmath import diff, mpf
from support.mechanisms_energy import energy

from ptmcad.mechanism import ptm
from ptmcad.mechanism.ptm import RECORD
from ptmcad.studies.bench.rivals import equations, is_stable
from ptmcad.studies.equilibria import in_doubles

NAMES = [name for name in ptm().parameters if name not in ptm().free_lengths]


@given(
    st.fixed_dictionaries({name: st.integers(-9, 9).filter(bool).map(float) for name in NAMES}),
    st.tuples(st.floats(-4, 4), st.floats(-4, 4)),
)
def test_the_equations_are_the_derivatives(p: dict[str, float], angles: tuple[float, float]) -> None:
    expected = in_doubles(p, *(np.array(angle) for angle in angles))
    (h11, h12, h22), (g1, g2) = expected.hessian, expected.gradient
    (c1, c2), (s1, s2) = np.cos(angles), np.sin(angles)
    values = equations(p, c1, s1, c2, s2)
    f1, f2 = p["L1"], p["L2"]
    found = np.array(values) * np.array([f1, f2, f1, f1, f2, f2])
    assert np.allclose(found, [g1, g2, h11, h12, h12, h22], rtol=0, atol=1e-9)
    if min(f1, f2) > 0 and min(abs(h11), abs(h11 * h22 - h12 * h12)) > 1e-6:
        assert is_stable(*values[2:]) == (h11 > 0 and h11 * h22 > h12 * h12)


def test_the_derivatives_by_hand_are_those_of_the_record() -> None:
    """With free lengths, springs that differ and all loads: mpmath differentiates the energy that the record says."""
    p = {name: 0.3 + 0.2 * n for n, name in enumerate(ptm().parameters)}
    at = (0.7, -2.1)
    found = in_doubles(p, *(np.array(angle) for angle in at))

    def by(*orders: int) -> float:
        values = {name: mpf(value) for name, value in p.items()}
        return float(diff(lambda *angles: energy(RECORD, values, angles), at, orders))

    assert np.allclose(found.gradient, [by(1, 0), by(0, 1)], rtol=1e-12)
    assert np.allclose(found.hessian, [by(2, 0), by(1, 1), by(0, 2)], rtol=1e-8)
