"""Which curves of a system on the line are critical, which at infinity (Lazard and Rouillier's W_c
and W_inf).
"""

from __future__ import annotations

import pytest

import ptmcad
from ptmcad.verification import verify

KINDS = {
    "a*x^2 + a + 1": {"a": "infinity", "a + 1": "critical"},
    # one root escapes where two others meet: the norm does not show the meeting
    "(a*x - 1)*((x - 1)^2 - a)": {"a": "infinity", "a^3 - a^2 + 2*a - 1": "critical"},
    # two roots escape together, as a square root's values do
    "(a^2 - b)*x^2 - 1": {"a^2 - b": "infinity"},
    "(a^2 - b)*x^2 - a*x - 1": {"a^2 - b": "infinity", "5*a^2 - 4*b": "critical"},
}


@pytest.mark.parametrize("equation", KINDS, ids=str)
def test_kinds_of_one_equation(equation: str) -> None:
    record = {
        "system": {"unknowns": {"x": "real"}, "equations": [equation]},
        "axes": {"a": ["-3/2", "3/2"], "b": [-1, 1]},
    }
    result = ptmcad.classify(record)
    found = {c.polynomial.text(("a", "b")): c.kind.value for c in result.components}
    assert verify(result).ok
    assert found == KINDS[equation]
