"""The equations of the rivals, written by hand, against the jets of the description in doubles."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from ptmcad.mechanism import ptm
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
