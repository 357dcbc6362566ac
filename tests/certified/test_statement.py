"""The potential that a certified map states, evaluated as text, against the poses that were solved
another way.
"""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import Any

import pytest

import ptmcad
from ptmcad.ask.solving import poses_at
from ptmcad.certified.statement import system_text
from ptmcad.question.config import point_from_mapping

ARM: dict[str, Any] = {
    "name": "arm",
    "mechanism": {
        "parameters": {"M": {}, "F": {"kind": "force"}, "c": {"kind": "stiffness", "default": 2}},
        "unknowns": {"th": "angle", "s": "length"},
        "points": {"O": [0, 0], "A": [2, 1], "B": ["s", 0], "P": ["cos(th)", "sin(th)"]},
        "springs": [
            {"between": ["A", "P"], "k": 1, "free": "1/2"},
            {"between": ["B", "P"], "k": "c"},
        ],
        "torsion": [{"angle": "2*th", "k": "c", "rest": {"cos": "3/5", "sin": "-4/5"}}],
        "loads": {"P": ["F", "1/3"]},
    },
    "axes": {"F": [-2, 2], "c": [1, 2]},
}
MOMENTS = {"th": "M - F", "s": "M/2"}


@pytest.mark.parametrize("moments", [MOMENTS, {}])
def test_the_stated_potential_is_level_at_every_equilibrium(moments: dict[str, str]) -> None:
    mechanism = dict(ARM["mechanism"])
    if moments:
        mechanism["moments"] = moments
    else:
        mechanism["parameters"] = {k: v for k, v in mechanism["parameters"].items() if k != "M"}
    axes = ARM["axes"] | ({} if not moments else {"M": [-1, 1]})
    record = ARM | {"mechanism": mechanism, "axes": dict(list(axes.items())[-2:])}
    model = ptmcad.slice_from_mapping(record).model
    at = {"F": "1/4", "c": "2"} | ({"M": "1/3"} if moments else {})
    text = compile(system_text(model).potential.replace("^", "**"), "potential", "eval")
    known: dict[str, Any] = {
        "cos": cos,
        "sin": sin,
        "sqrt": sqrt,
        **{n: eval(v) for n, v in at.items()},
    }
    poses = poses_at(model, point_from_mapping(at, model), 12).equilibria
    assert poses

    def potential(th: float, s: float) -> float:
        return float(eval(text, known | {"th": th, "s": s}))

    for pose in poses:
        th, s = float(pose.angles[0]), float(pose.reals[0])
        assert abs(potential(th + 1e-5, s) - potential(th - 1e-5, s)) / 2e-5 < 1e-6
        assert abs(potential(th, s + 1e-5) - potential(th, s - 1e-5)) / 2e-5 < 1e-6
        if not moments:
            assert potential(th, s) == pytest.approx(float(pose.known_energy))
