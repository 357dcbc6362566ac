"""The titles of pictures of a quantity over a map: names as they are, solutions of systems as such."""

from __future__ import annotations

import pytest
import yaml

import ptmcad

SWITCH = yaml.safe_load("""
name: switch
system: {unknowns: {u: real}, equations: [u^3 - a*u - b], stable: [3*u^2 - a]}
axes: {a: [-1, 2], b: [-1, 1]}
""")


@pytest.mark.parametrize(
    ("value", "pose", "title"),
    [
        ("u", "pose:1", "u of solution 1: switch"),
        ("u^2", "stable:1", "u^2 of stable solution 1: switch"),
    ],
)
def test_the_title_of_a_systems_quantity(value: str, pose: str, title: str) -> None:
    pytest.importorskip("matplotlib")
    from ptmcad.show.render.fieldpicture import title_of

    result = ptmcad.classify(SWITCH)
    assert title_of(result, result.field(value, pose, 2, 2)) == title


def test_the_title_of_a_mechanisms_quantity() -> None:
    from ptmcad.show.render.fieldpicture import title_of

    result = ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho"))
    assert (
        title_of(result, result.field("length:k3", "stable:1", 2, 2))
        == "Length k₃ of stable pose 1: slice-L2-rho"
    )
