"""The equations that rivals get as source, against the jets of the description in doubles."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from ptmcad.mechanism import ptm
from ptmcad.studies.bench.companion import moments_of
from ptmcad.studies.equilibria import in_doubles
from ptmcad.studies.moments import source

NAMES = [name for name in ptm().parameters if name not in ptm().free_lengths]
MOMENTS = moments_of({"moments": source()})


@given(
    st.fixed_dictionaries({name: st.integers(-9, 9).filter(bool).map(float) for name in NAMES}),
    st.tuples(st.floats(-4, 4), st.floats(-4, 4)),
)
def test_the_source_computes_the_derivatives(p: dict[str, float], angles: tuple[float, float]) -> None:
    expected = in_doubles(p, *(np.array(angle) for angle in angles))
    (h11, h12, h22), (g1, g2) = expected.hessian, expected.gradient
    (c1, c2), (s1, s2) = np.cos(angles), np.sin(angles)
    a, (f1, f2) = MOMENTS["coefficients"](p), MOMENTS["factors"](p)

    told = np.array(MOMENTS["equations"](a, c1, s1, c2, s2)) * np.array([f1, f2, f1, f1, f2, f2])
    assert np.allclose(told, [g1, g2, h11, h12, h12, h22], rtol=0, atol=1e-9)
    assert np.allclose(told[2:], np.array(MOMENTS["slopes"](a, c1, s1, c2, s2)) * np.array([f1, f1, f2, f2]))
    across, along = MOMENTS["first"](a, c2, s2)
    assert np.isclose(f1 * (across * c1 + along * s1), g1, rtol=0, atol=1e-9)
    free, rest = MOMENTS["second"](a, c1, s1, c2, s2)
    assert np.isclose(f2 * (free + rest), g2, rtol=0, atol=1e-9)
    assert np.isclose(free, MOMENTS["second"](a, 0, 0, c2, s2)[0])
    assert MOMENTS["second"](a, 0, 0, c2, s2)[1] == 0
