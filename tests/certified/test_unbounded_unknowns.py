"""Systems of which no bound of an unknown is proved over the window: the certified engine refuses
them by its name.
"""

from __future__ import annotations

from typing import Any

import pytest

import ptmcad
from ptmcad.errors import ConfigError

ONE = {"x": "real"}
PAIR = {"x": "real", "y": "real"}
LEAVING = {"unknowns": ONE, "equations": ["a*x^2 + a + 1"]}
"""Two roots where -1 < a < 0, which leave to infinity at a = 0."""
ANY = {"unknowns": PAIR, "equations": ["x*(y - a)", "x^2 - b*x"]}
"""y is nothing's value where x is zero, whatever a and b are."""


@pytest.mark.parametrize(("system", "name"), [(LEAVING, "x"), (ANY, "y")])
def test_an_unknown_without_a_bound_is_named(system: dict[str, Any], name: str) -> None:
    record = {"name": "unbounded", "system": system, "axes": {"a": [-2, 2], "b": [1, 2]}}
    with pytest.raises(
        ConfigError, match=f"no bound of the unknown {name} could be proved .* choose exact"
    ):
        ptmcad.classify(record, engine="certified", tolerance="1/20", jobs=1)


def test_on_one_side_of_where_they_leave_roots_are_bounded() -> None:
    record = {"name": "bounded", "system": LEAVING, "axes": {"a": [-2, "-1/8"], "b": [1, 2]}}
    found = ptmcad.classify(record, engine="certified", tolerance="1/20", jobs=1)
    assert {cell.total for cell in found.cells} == {0, 2}
