"""Words around nothing, and around points that are not the paper's."""

from __future__ import annotations

import pytest
import yaml

import ptmcad
from ptmcad.errors import ConfigError
from ptmcad.model import Mechanism, ptm
from ptmcad.show.ranges.pathtable import _heights


def test_heights_have_the_names_of_points() -> None:
    arms = yaml.safe_load("""
        unknowns: {th: angle, phi: angle}
        points: {O: [0, 0], A2: [sin(th), cos(th)], B2: [sin(phi), cos(phi)]}
        springs: [{between: [A2, B2], k: 1}]
        loads: {A2: [H, -W]}
        parameters: {H: {kind: force}, W: {kind: force}}
    """)
    assert _heights(ptmcad.Mechanism(arms)) == ["y of A2", "y of B2"]
    own = ptm()
    assert isinstance(own, Mechanism)
    assert _heights(own) == ["y3", "y4"]


def test_no_names_are_no_list() -> None:
    with pytest.raises(ConfigError, match="; no name is known here"):
        ptmcad.Mechanism(
            unknowns={"th": "angle"}, points={"O": ["c", 0], "P": ["sin(th)", "cos(th)"]}
        )
