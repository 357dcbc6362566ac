"""Pictures, pages and words of mechanisms that are not built in, and of systems."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
import yaml
from click.testing import CliRunner
from support import pages

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.solving import poses_at
from ptmcad.cli.solve import command as solve_command
from ptmcad.errors import ConfigError
from ptmcad.question.config import point_from_mapping
from ptmcad.show.render.landscape import draw_landscape
from ptmcad.show.render.posepicture import draw_poses
from ptmcad.show.report import page
from ptmcad.show.table import table

PENDULUM: dict[str, Any] = yaml.safe_load("""
name: pendulum
mechanism:
  name: pendulum
  parameters:
    L: {kind: length, default: 1}
    a: {kind: base, default: 1}
    k: {kind: stiffness, default: 1}
    W: {kind: force, default: 0}
  unknowns: {th: angle, s: length}
  points: {O: [0, 0], A: [0, a], B: [s, 0], P: [L*sin(th), L*cos(th)]}
  bars: [[O, P]]
  supports: {O: pin, B: slider x, A: slider y}
  springs: [{between: [A, P], k: k}, {between: [B, P], k: k}, {between: [B, O], k: 2}]
  loads: {P: [1/10, W]}
axes: {a: [0, 3], W: [-4, 4]}
""")

TURNED: dict[str, Any] = yaml.safe_load("""
name: turned
mechanism:
  parameters: {c: {kind: stiffness}, W: {kind: force}}
  unknowns: {th: angle}
  points: {O: [0, 0], P: [cos(th), sin(th)]}
  bars: [[O, P]]
  supports: {O: pin}
  torsion: [{angle: th, k: c, rest: pi/2}, {angle: 2*th, k: 1/9}]
  loads: {P: {weight: W}}
axes: {c: [1/10, 1], W: [0, 2]}
""")


def system(count: str = "total", **asked: Any) -> dict[str, Any]:
    return {"name": "s", "system": asked, "axes": {"a": [-2, 2], "b": [-2, 2]}, "count": count}


CUSP = system(unknowns={"x": "real"}, equations=["x^3 - a*x + b"])
VALLEYS = system("index", unknowns={"x": "real"}, potential="x^4/4 - a*x^2/2 + b*x")


def solved(record: dict[str, Any], **at: str) -> Any:
    model = ptmcad.slice_from_mapping(record).model
    return poses_at(model, point_from_mapping(at, model), 10)


def test_a_mechanism_is_drawn_with_its_own_parts() -> None:
    figure = draw_poses(solved(PENDULUM, a="1", W="1/2"))
    gids = {artist.get_gid() for artist in figure.findobj() if artist.get_gid()}
    assert {
        "pose-1-bar-OP",
        "pose-1-node-B",
        "pose-1-base-2",
        "pose-1-spring-3",
        "pose-1-load-1/10",
    } <= gids
    texts = [
        text.get_text() for text in figure.findobj(match=lambda artist: hasattr(artist, "get_text"))
    ]
    assert any(re.fullmatch(r"θ = .*°, s = .*", text) for text in texts)
    assert "vertical slider, at A" in texts and "springs AP, BP, BO; drawn aside" in texts


def test_an_energy_over_one_unknown_is_a_curve() -> None:
    figure = draw_landscape(solved(VALLEYS, a="1", b="1/9"))
    gids = {artist.get_gid() for artist in figure.findobj() if artist.get_gid()}
    assert {"landscape", "equilibrium-1", "equilibrium-2", "equilibrium-3"} <= gids
    assert figure.axes[0].get_xlabel() == "x"


def test_what_cannot_be_drawn_is_refused(tmp_path: Path) -> None:
    found = solved(CUSP, a="1", b="0")
    with pytest.raises(ConfigError, match="no points, bars or springs"):
        draw_poses(found)
    with pytest.raises(ConfigError, match="no energy"):
        draw_landscape(found)
    (tmp_path / "cusp.json").write_text(json.dumps(CUSP), encoding="utf-8")
    asked = [str(tmp_path / "cusp.json"), "--at", "a=1,b=0", "--out", str(tmp_path), "--format"]
    with pytest.raises(ConfigError, match=r"--format: .* ask for table or json"):
        CliRunner().invoke(solve_command, [*asked, "png"], catch_exceptions=False)
    assert not list(tmp_path.glob("*.png"))
    assert (
        CliRunner().invoke(solve_command, [*asked, "table,json"], catch_exceptions=False).exit_code
        == 0
    )


def data_of(result: RegionMap) -> dict[str, Any]:
    return pages.data_of(page(result, timings=False))


def test_maps_and_pages_of_systems_speak_of_solutions() -> None:
    result = ptmcad.classify(ptmcad.slice_from_mapping(CUSP))
    assert "1 solution: 1 region; 3 solutions: 1 region" in table(result)
    data = data_of(result)
    assert not data["drawable"] and not data["landscape"] and data["mechanism"]["unknowns"] == ["x"]
    for cell in data["cells"]:
        a, b = (float(Fraction(text.split()[0])) for text in cell["sample"])
        for solution in cell["equilibria"]:
            (x,) = solution["at"]
            assert (
                solution["kind"] == "solution"
                and solution["energy"] == ""
                and abs(x**3 - a * x + b) < 1e-6
            )
    assert "(minima, maxima)" in table(ptmcad.classify(ptmcad.slice_from_mapping(VALLEYS)))


def test_the_page_draws_any_mechanism() -> None:
    data = data_of(ptmcad.classify(ptmcad.slice_from_mapping(PENDULUM)))
    assert data["drawable"] and not data["landscape"]
    drawn = data["mechanism"]
    assert (drawn["pinned"], drawn["sliding"], drawn["rising"]) == ([0], [2], [1])
    for cell in data["cells"]:
        for pose in cell["equilibria"]:
            cosine, sine, s = pose["at"]
            assert pose["nodes"][2] == pytest.approx([s, 0]) and pose["nodes"][3] == pytest.approx(
                [sine, cosine]
            )


def test_a_page_tells_and_draws_torsion_springs() -> None:
    """What its poses say is what exact poses say; a mechanism without such springs has no word of
    them.
    """
    result = ptmcad.classify(TURNED)
    data = data_of(result)
    assert data["mechanism"]["torsion"] == [{"name": "θ", "at": [0, 1]}, {"name": "2*θ", "at": []}]
    cell, shown = result.cells[0], data["cells"][0]
    at = {name: cell.sample[name] for name in cell.sample.names}
    exact = poses_at(result.slice.model, point_from_mapping(at, result.slice.model), 10)

    def told(text: str) -> float:
        return float(text.rstrip("°").replace("−", "-"))

    entries = {
        round(told(entry["unknowns"][0]), 2): entry["deflections"] for entry in shown["equilibria"]
    }
    assert len(entries) == len(exact.equilibria) > 2
    for pose in exact.equilibria:
        for spring, (deflection, moment) in zip(
            pose.torsion, entries[round(float(pose.degrees[0]), 2)], strict=True
        ):
            assert told(deflection) == pytest.approx(float(spring.degrees), abs=1e-4)
            assert told(moment) == pytest.approx(float(spring.moment), abs=1e-6)
    plain = data_of(ptmcad.classify(PENDULUM))
    assert "torsion" not in plain["mechanism"]
    assert not any("deflections" in pose for c in plain["cells"] for pose in c["equilibria"])
