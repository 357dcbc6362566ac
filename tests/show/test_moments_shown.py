"""Pictures, tables and messages of mechanisms under moments: what an energy leaves out, and where
there is none.
"""

from __future__ import annotations

import json
import re
from fractions import Fraction
from math import pi
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
import yaml
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from support import pages

import ptmcad
from ptmcad.answer.poses import Poses
from ptmcad.ask.solving import poses_at
from ptmcad.cli import run
from ptmcad.cli.drawing import picture
from ptmcad.errors import ConfigError, PictureError
from ptmcad.question.config import point_from_mapping
from ptmcad.show.drawable import no_landscape
from ptmcad.show.render.energy import Energy
from ptmcad.show.render.landscape import draw_landscape
from ptmcad.show.render.posepicture import draw_poses
from ptmcad.show.report import page
from ptmcad.show.report.equilibria import at_sample


def bar(moments: dict[str, object], loads: object = (0, "F"), **further: Any) -> dict[str, Any]:
    """A bar on a spring, or two that share a pivot, turned by moments."""
    mechanism = {
        "parameters": {"M": {}, "F": {"kind": "force", "default": 1}},
        "unknowns": {"th": "angle"},
        "points": {"O": [0, 0], "A": [2, 0], "P": ["cos(th)", "sin(th)"]},
        "bars": [["O", "P"]],
        "springs": [{"between": ["A", "P"], "k": 1}],
        "moments": moments,
        "loads": {"P": list(loads)},  # type: ignore[call-overload]
    }
    return {"mechanism": mechanism | further, "axes": {"M": [-3, 3], "F": [-3, 3]}}


ANGLE = bar({"th": "M"})
TWO = bar(
    {"th": "M", "ph": "-M/3"},
    unknowns={"th": "angle", "ph": "angle"},
    points={
        "O": [0, 0],
        "A": [2, 0],
        "P": ["cos(th)", "sin(th)"],
        "Q": ["cos(th)+cos(ph)/2", "sin(th)+sin(ph)/2"],
    },
    bars=[["O", "P"], ["P", "Q"]],
    springs=[{"between": ["A", "Q"], "k": 1}],
)
MIXED = bar(
    {"th": "M/10", "s": "M"},
    unknowns={"th": "angle", "s": "length"},
    points={"O": [0, 0], "A": ["s", 0], "P": ["cos(th)", "sin(th)"]},
    springs=[{"between": ["A", "P"], "k": 1}, {"between": ["O", "A"], "k": 2}],
)
FREE = bar({"th": "M"}, springs=[{"between": ["A", "P"], "k": 1, "free": "1/2"}])
WAVE = bar({"th": "M*(1 + sin(2*th))"})
UNTOLD = bar(
    {"th": "M*sin(2*th) + s/3"},
    unknowns={"th": "angle", "s": "length"},
    points={"O": [0, 0], "A": ["s", 0], "P": ["cos(th)", "sin(th)"], "Q": [2, 0]},
    springs=[{"between": ["A", "P"], "k": 1}, {"between": ["Q", "A"], "k": 2}],
)


def solved(record: dict[str, Any], **at: str) -> Poses:
    model = ptmcad.slice_from_mapping({"name": "s", **record}).model
    return poses_at(model, point_from_mapping(at, model), 10)


def words(figure: Figure) -> str:
    """All that is written, lines apart."""
    return "\n".join(text.get_text() for text in figure.findobj(Text))


@pytest.mark.parametrize("record", [ANGLE, TWO, MIXED, FREE, WAVE])
def test_what_is_drawn_is_level_at_the_equilibria(record: dict[str, Any]) -> None:
    """The derivatives by differences: without the moments' work they would be the moments."""
    found = solved(record, M="1/2", F="1/3")
    assert found.equilibria
    energy = Energy(found.model, found.parameters)
    for pose in found.equilibria:
        at = [float(x) for x in (*pose.angles, *pose.reals)]
        for k in range(len(at)):
            low, high = ([x + sign * (i == k) * 1e-5 for i, x in enumerate(at)] for sign in (-1, 1))
            rise = float(energy(*map(np.array, high))) - float(energy(*map(np.array, low)))
            assert abs(rise) / 2e-5 < 1e-5


def test_a_force_that_depends_on_another_unknown_is_called_so() -> None:
    record = {**UNTOLD, "mechanism": {**UNTOLD["mechanism"], "moments": {"s": "cos(th) + M"}}}
    found = solved(record, M="1/2", F="1/5")
    why = "nothing says which are stable, as the force on s depends on another unknown"
    assert why in found.table() and why in words(draw_poses(found)).replace("\n", " ")
    assert data_of(record)["untold"] == why
    assert no_landscape(found.model).startswith(
        "the force on s of the mechanism depends on another unknown"
    )
    with pytest.raises(
        ConfigError, match="the force on s that depends on another unknown has no potential"
    ):
        ptmcad.slice_from_mapping({"name": "s", **record, "count": "stable"})


def marks(figure: Figure) -> list[tuple[float, float]]:
    """Where equilibria are marked."""
    shown = [
        a
        for a in figure.axes[0].get_children()
        if isinstance(a, Line2D) and a.get_marker() in ("o", "X", "^")
    ]
    return [(float(a.get_xdata()[0]), float(a.get_ydata()[0])) for a in shown]  # type: ignore[index,arg-type]


def test_equilibria_are_marked_on_the_curve_at_both_edges_of_the_cut() -> None:
    """At M = F one equilibrium is exactly at 180 degrees, where V is lower by a turn's work than at
    -180.
    """
    found = solved(ANGLE, M="1/2", F="1/2")
    energy = Energy(found.model, found.parameters)
    figure = draw_landscape(found)
    places = marks(figure)
    for x, y in places:
        assert float(energy(np.radians(x))) == pytest.approx(y, abs=1e-9)
    ends = dict(place for place in places if abs(place[0]) == 180)
    assert ends[-180.0] - ends[180.0] == pytest.approx(2 * pi * 0.5)
    assert "two levels" in words(figure) and "which are the same" not in words(figure)


def test_the_table_says_what_the_energy_leaves_out() -> None:
    note = "of springs and loads, without the moment's work"
    assert f"energy  {note}" in solved(ANGLE, M="1/2", F="1").table()
    assert "without the moments' work" in solved(TWO, M="1/2", F="1").table()
    assert note not in solved(ANGLE, M="0", F="1").table()
    assert note in solved(FREE, M="1/2", F="1").table()
    assert (
        "without the work of the constant part of the moment"
        in solved(WAVE, M="1/2", F="1").table()
    )
    assert (
        "without the work of the moment and the force on s" in solved(MIXED, M="1/2", F="1").table()
    )
    untold = solved(UNTOLD, M="1/2", F="1").table()
    assert "energy  none, and nothing says which are stable" in untold and "solution" not in untold


def test_poses_without_an_energy_are_drawn() -> None:
    found = solved(UNTOLD, M="1/2", F="1/5")
    figure = draw_poses(found)
    gids = {artist.get_gid() for artist in figure.findobj() if artist.get_gid()}
    assert {"pose-1-bar-OP", "pose-1-spring-AP"} <= gids or {
        "pose-1-bar-OP",
        "pose-2-node-P",
    } <= gids
    said = words(figure)
    assert figure.get_label().startswith(f"{len(found.equilibria)} equilibria at")
    assert (
        "1  equilibrium" in said
        and "degenerate" not in said
        and "U" not in said
        and " stable at" not in said
    )
    assert "nothing says which are stable" in said


def test_a_landscape_that_there_is_not_is_refused_beside_the_other_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "untold.yaml").write_text(yaml.safe_dump(UNTOLD), encoding="utf-8")
    asked = [
        str(tmp_path / "untold.yaml"),
        "--at",
        "M=1/2,F=1/5",
        "--landscape",
        "--out",
        str(tmp_path),
    ]
    assert run(["solve", *asked, "--format", "svg,json"]) == 2
    said = capsys.readouterr()
    assert re.match(r"error: --landscape: .* depends on another unknown: ", said.err)
    assert said.out == f"written   {tmp_path / 'poses.svg'}, {tmp_path / 'poses.json'}\n"
    assert {path.name for path in tmp_path.iterdir()} == {"untold.yaml", "poses.svg", "poses.json"}


@pytest.mark.parametrize(
    "error", [ValueError("a < b"), KeyError("font"), ConfigError("no energy"), RuntimeError()]
)
def test_no_exception_is_named_in_a_message(error: Exception) -> None:
    def fail(_: Path) -> None:
        raise error

    with pytest.raises(PictureError) as found:
        picture("a.svg", fail)(Path("a.svg"))
    assert not re.search(r"[A-Z][a-z]+(Error|Exception)", str(found.value))
    assert str(found.value).startswith("a.svg cannot be drawn: ")
    assert all(str(said) in str(found.value) for said in error.args)


def test_a_load_is_told_by_its_name_or_as_a_force() -> None:
    named = words(draw_poses(solved(ANGLE, M="1/2", F="3"))).splitlines()
    assert named[named.index("load") + 1] == "F\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}3"
    plain = words(draw_poses(solved(bar({"th": "M + F"}, (0, -1)), M="1/2", F="1"))).splitlines()
    assert plain[plain.index("load") + 1] == "Fy at P = −1".replace(" ", "\N{NO-BREAK SPACE}")
    several = words(draw_poses(solved(bar({"th": "M"}, (1, "F")), M="1/2", F="1/90")))
    assert "loads; arrows in proportion to them\nexcept that short ones are lengthened" in several


def data_of(record: dict[str, Any]) -> dict[str, Any]:
    result = ptmcad.classify(
        ptmcad.slice_from_mapping({"name": "s", **record}), area_tolerance="1/10"
    )
    return pages.data_of(page(result, timings=False))


def test_the_page_has_the_moments_and_calls_nothing_degenerate_without_a_potential() -> None:
    data = data_of(ANGLE)
    assert data["told"]
    for cell in data["cells"]:
        exact, *_ = cell["sample"]
        assert cell["moments"] == ([float(Fraction(exact.split()[0]))] if exact != "0" else [])
    data = data_of(UNTOLD)
    assert not data["told"] and not data["landscape"]
    poses = [pose for cell in data["cells"] for pose in cell["equilibria"]]
    assert (
        poses
        and {pose["kind"] for pose in poses} == {"solution"}
        and {pose["energy"] for pose in poses} == {""}
    )
    assert all(cell["moments"] == [] for cell in data["cells"])


def test_the_page_of_a_certified_map_has_the_energies_of_moments_on_their_own_unknown() -> None:
    record = bar({"th": "M*sin(th)"}, springs=[{"between": ["A", "P"], "k": 1, "free": "1/2"}])
    slice = ptmcad.slice_from_mapping({"name": "s", **record, "axes": {"M": [1, 3], "F": [1, 3]}})
    result = ptmcad.classify(slice, tolerance="1/10", count="index")
    seen = 0
    for cell in result.cells:
        values = {name: e.evaluate(*cell.sample) for name, e in slice.parameters.items()}
        poses = ptmcad.solve(model=slice.model, **values)
        known = sorted(float(pose.known_energy.center) for pose in poses.equilibria)
        shown = sorted(pose["level"] for pose in at_sample(result, cell)["equilibria"])
        assert shown == pytest.approx(known, rel=1e-6)
        seen += len(shown)
    assert seen


CUSP = yaml.safe_load("""
system: {unknowns: {x: real}, equations: [x^3 - a*x + b]}
axes: {a: [-2, 2], b: [-2, 2]}
""")


@pytest.mark.parametrize(
    ("record", "at"),
    [
        *((record, {"M": "1/2", "F": "1/3"}) for record in (ANGLE, TWO, MIXED, FREE, UNTOLD)),
        (CUSP, {"a": "1", "b": "0"}),
    ],
)
def test_poses_of_any_model_are_what_the_schema_says(
    record: dict[str, Any], at: dict[str, str]
) -> None:
    """Of one unknown and two, with an energy and without; and they are read back."""
    found = solved(record, **at)
    data = json.loads(found.to_json())
    schema = json.loads(
        (Path(__file__).parents[2] / "docs" / "poses.schema.json").read_text(encoding="utf-8")
    )
    jsonschema.validate(data, schema, cls=jsonschema.Draft202012Validator)
    assert data["equilibria"] and Poses.from_json(found.to_json()) == found


def test_the_page_of_a_certified_map_of_lengths_alone() -> None:
    """Its unknowns are those of a polynomial system, but its energy has roots."""
    record = {
        "name": "truss",
        "mechanism": {
            "parameters": {"a": {"kind": "base", "default": 1}, "f": {"kind": "force"}},
            "unknowns": {"h": "length"},
            "points": {"A": ["-a", 0], "B": ["a", 0], "P": [0, "h"]},
            "springs": [{"between": [end, "P"], "k": 1, "free": 1} for end in ("A", "B")],
            "loads": {"P": [0, "f"]},
        },
        "axes": {"a": [0, 2], "f": [-1, 1]},
        "count": "total",
    }
    result = ptmcad.classify(ptmcad.slice_from_mapping(record), tolerance="1/5")
    cells = pages.data_of(page(result, timings=False))["cells"]
    assert all(pose["energy"] for cell in cells for pose in cell["equilibria"])
