"""Films of motions: what their pictures show, and the files."""

from __future__ import annotations

import io
import stat
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image
from support.maps import CONFIGS, shipped
from support.replacing import replace

import ptmcad
from ptmcad.answer.motion import Motion
from ptmcad.cli import run
from ptmcad.errors import ConfigError
from ptmcad.show.render.printing import settings
from ptmcad.show.render.stage import Stage
from ptmcad.show.style import DEFAULT

FIG4 = str(CONFIGS / "fig4.yaml")
PATH = "rho=3/4:6/5,L2=3/2"


@pytest.fixture(scope="module")
def motion() -> Motion:
    return shipped("fig4").animate(PATH, "stable:2", frames=6)


@pytest.fixture(scope="module")
def short() -> Motion:
    """Three pictures, for what is the same of any number."""
    return shipped("fig4").animate("rho=3/4:4/5,L2=3/2", "stable:2", frames=3)


@pytest.fixture(scope="module")
def stage(motion: Motion) -> Stage:
    with settings():
        return Stage(motion, DEFAULT, 60)


def said(stage: Stage, number: int) -> list[str]:
    with settings():
        texts = list(stage._said(stage.motion.steps[number]))
    found = [text.get_text() for text in texts]
    for text in texts:
        text.remove()
    return found


@pytest.mark.slow
def test_pictures_say_what_they_show(stage: Stage, motion: Motion) -> None:
    first = next(k for k, step in enumerate(motion.steps) if step.falling)
    assert said(stage, 0) == [
        "ρ = 0.75,  L₂ = 1.5",
        "one of exactly 6 equilibria, 2 stable",
        "θ₁ = 69.9°,  θ₂ = 36.0°",
    ]
    assert said(stage, first)[1] == "the pose has vanished: steepest descent, no equilibrium"
    assert said(stage, len(motion.steps) - 1)[1] == "one of exactly 4 equilibria, 1 stable"


def test_what_is_fixed_stands_still_and_all_is_at_one_scale(stage: Stage, motion: Motion) -> None:
    nodes = [seen.nodes for seen in stage.sketches]
    assert {tuple(round(v, 9) for v in node["A1"]) for node in nodes} == {
        tuple(round(v, 9) for v in nodes[0]["A1"])
    }
    lengths = [np.hypot(*np.subtract(node["A3"], node["A1"])) for node in nodes]
    assert lengths == pytest.approx([lengths[0]] * len(nodes))  # the bar of length 1
    wide, tall = stage.sides
    for node in nodes:
        assert all(0 < x < wide and 0 < y < tall for x, y in node.values())
    assert {len(line) for seen in stage.sketches for line in seen.coils.values()} == {
        len(stage.sketches[0].coils["spring-1"])
    }


@pytest.mark.slow
def test_a_gif_has_all_pictures_and_rests_at_its_ends(
    motion: Motion, short: Motion, tmp_path: Path
) -> None:
    motion.save(tmp_path / "one.gif", fps=10, dpi=60, size="7x4in")
    for name in ("two.gif", "three.gif"):
        short.save(tmp_path / name, fps=10, dpi=60, size="7x4in")
    assert (tmp_path / "two.gif").read_bytes() == (tmp_path / "three.gif").read_bytes()
    with Image.open(tmp_path / "one.gif") as film:
        assert (film.size, film.n_frames) == ((420, 240), len(motion.steps))
        durations = []
        for k in range(film.n_frames):
            film.seek(k)
            durations.append(film.info["duration"])
    assert durations == [800, *[100] * (len(motion.steps) - 2), 800]


def test_a_notebook_shows_the_film(motion: Motion, short: Motion) -> None:
    assert repr(motion) == "<Motion of stable:2 over fig4: 18 steps, 1 fall>"
    html = short._repr_html_()
    assert html.startswith('<img alt="&lt;Motion of stable:2 over fig4: 3 steps, 0 falls&gt;"')
    assert "data:image/gif;base64,R0lGOD" in html


FAKE = """#!{python}
import sys
data = sys.stdin.buffer.read()
if len(data) % (420 * 240 * 3) or "420x240" not in sys.argv:
    sys.exit("odd input")
open(sys.argv[-1], "wb").write(b"%d pictures" % (len(data) // (420 * 240 * 3)))
"""


def program(folder: Path, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program ffmpeg on the PATH, and nothing else."""
    file = folder / "bin" / "ffmpeg"
    file.parent.mkdir()
    file.write_text(text.format(python=sys.executable))
    file.chmod(file.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(file.parent))


def test_ffmpeg_gets_every_picture(
    short: Motion, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program(tmp_path, FAKE, monkeypatch)
    short.save(tmp_path / "film.mp4", fps=10, dpi=60, size="7x4in")
    assert (tmp_path / "film.mp4").read_bytes() == b"%d pictures" % (len(short.steps) + 2 * 8)


@pytest.mark.parametrize("reads", [True, False], ids=["at the end", "at once"])
@pytest.mark.slow_cases("at the end")
def test_what_ffmpeg_refuses_is_said(
    reads: bool,
    short: Motion,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    read = "sys.stdin.buffer.read()\n" if reads else ""
    program(tmp_path, f"#!{{python}}\nimport sys\n{read}sys.exit('no encoder')\n", monkeypatch)
    with pytest.raises(OSError, match="ffmpeg failed with status 1: no encoder"):
        short.save(tmp_path / "film.mp4", dpi=60)
    if not reads:  # the command is told in the same way
        return
    (tmp_path / "fig4.json").write_text(shipped("fig4").to_json())
    asked = [
        "animate",
        str(tmp_path / "fig4.json"),
        "--path",
        "rho=3/4:4/5,L2=3/2",
        "--pose",
        "stable:2",
    ]
    asked += ["--frames", "2", "--dpi", "50", "--format", "gif,mp4"]
    assert run([*asked, "--out", str(tmp_path / "out")]) == 2
    assert (
        "fig4-motion.mp4 cannot be drawn: ffmpeg failed with status 1: no encoder"
        in capsys.readouterr().err
    )
    assert not list((tmp_path / "out").iterdir())


def test_the_command_writes_one_film_of_a_record_and_of_its_map(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["classify", FIG4, "--format", "json", "--no-areas", "--out", str(tmp_path)]) == 0
    capsys.readouterr()
    stored = str(tmp_path / "fig4.json")
    asked = ["--pose", "stable:2", "--frames", "2", "--dpi", "50", "--out", str(tmp_path)]
    for source, name in ((FIG4, "a"), (stored, "b")):
        assert run(["animate", source, "--path", "rho=3/4:4/5,L2=3/2", *asked, "--name", name]) == 0
        assert f"{name}.gif" in capsys.readouterr().out
    assert (tmp_path / "a.gif").read_bytes() == (tmp_path / "b.gif").read_bytes()
    assert run(["animate", stored, "--path", PATH, "--set", "F3=0", "--out", str(tmp_path)]) == 2
    assert "--set: a result has its slice already" in capsys.readouterr().err
    with Image.open(io.BytesIO((tmp_path / "a.gif").read_bytes())) as film:
        assert film.size in ((450, 255), (450, 254))  # older matplotlib cuts half a pixel off


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--path", "rho=1"], "--path: give values of both axes"),
        (["--path", PATH, "--pose", "best"], "--pose: 'best' is not a pose such as stable:1"),
        (
            ["--path", PATH, "--pose", "stable:3"],
            "--pose: there is no stable:3 at the path's start",
        ),
        (["--path", PATH, "--size", "9"], "--size: '9' is not a size such as"),
        (["--path", PATH, "--size", "2x2in"], "a film needs at least 6.5x3.4in"),
        (
            ["--path", PATH, "--format", "mp4"],
            "mp4 is made by the program ffmpeg, which is not on the PATH",
        ),
        (["--path", PATH, "--format", "avi"], "avi is not among gif, mp4"),
    ],
)
def test_bad_options_leave_nothing(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.setenv("PATH", str(tmp_path))
    assert run(["animate", FIG4, "--frames", "3", "--out", str(tmp_path), *arguments]) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_stored_map_that_contradicts_itself_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = shipped("fig4")
    stacks = (replace(s, walls=tuple(replace(w, root=9) for w in s.walls)) for s in whole.stacks)
    (tmp_path / "damaged.json").write_text(replace(whole, stacks=tuple(stacks)).to_json())
    command = [
        "animate",
        str(tmp_path / "damaged.json"),
        "--path",
        PATH,
        "--pose",
        "stable:2",
        "--frames",
        "3",
    ]
    assert run([*command, "--out", str(tmp_path / "films")]) == 2
    said = capsys.readouterr().err
    assert (
        "damaged.json: the map contradicts itself (" in said
        and "); check it with ptmcad verify" in said
    )
    assert not list((tmp_path / "films").iterdir())


def test_a_system_cannot_be_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cubic = str(CONFIGS / "systems" / "cubic.yaml")
    assert run(["animate", cubic, "--path", "a=0:1,b=1/2", "--out", str(tmp_path)]) == 2
    assert "solutions of a system cubic cannot be drawn" in capsys.readouterr().err
    found = shipped("systems/cubic").animate("a=0:1,b=1/2", "pose:1", frames=3)
    assert found._repr_html_() == "<pre>&lt;Motion of pose:1 over cubic: 3 steps, 0 falls&gt;</pre>"
    with pytest.raises(ConfigError, match="cannot be drawn"):
        found.save(tmp_path / "film.gif")


@pytest.mark.slow
def test_a_certified_map_has_films_too(tmp_path: Path) -> None:
    pytest.importorskip("numba")
    record = yaml.safe_load("""
        name: short
        mechanism: ptm
        parameters: {l0: 1/5, F3: -10, F4: -10}
        axes: {rho: ['1', 6/5], L2: ['1', 6/5]}
    """)
    result = ptmcad.classify(record, tolerance="1/10", jobs=1)
    motion = result.animate("rho=21/20:23/20,L2=11/10", frames=3)
    with settings():
        stage = Stage(motion, DEFAULT, 50)
    assert said(stage, 0)[1] == f"equilibrium; exactly {motion.steps[0].stable} stable here"
    assert "undetermined" in {text.get_text() for text in stage.figure.texts}
