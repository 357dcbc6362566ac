"""The pages of questions and of numbers: commands and Python say what the pages show; figures are
drawn again.
"""

from __future__ import annotations

import contextlib
import csv
import doctest
import io
import re
import shlex
from pathlib import Path
from typing import Any

import pytest
from numpy.lib.npyio import NpzFile
from support.maps import CONFIGS

from ptmcad.cli import run

DOCS = Path(__file__).parent.parent / "docs"
HOW_TO, DATA = ((DOCS / f"{name}.md").read_text(encoding="utf-8") for name in ("how-to", "data"))
CHANGING = re.compile(
    r"^time .*|^searched .*|\d+ random pixels agree .*|\d+ points of \d+ bits, seed\s+\w+",
    re.MULTILINE,
)
"""What is another time in each run, or rounding of another machine."""


def without_what_changes(text: str) -> str:
    lines = (line.rstrip() for line in CHANGING.sub("…", text).rstrip().splitlines())
    return "\n".join(lines)


HEAVY = (
    "… find the best of two design parameters?",
    "… see a quantity over the whole map?",
    "… show how the mechanism moves, and how it snaps?",
    "… compare several loads?",
    "… map the same slice for many loads and designs?",
)
"""Questions of many pixels, pictures and maps; the README's test asks the first two, of the same
map.
"""


@pytest.mark.parametrize(
    ("left_out", "least"),
    [pytest.param((), (9, 7), marks=pytest.mark.slow, id="all"), (HEAVY, (6, 3))],
)
@pytest.mark.usefixtures("coarse")
def test_commands_and_python_say_what_the_page_shows(
    left_out: tuple[str, ...], least: tuple[int, int],
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    """In their order, in a folder that is empty at first."""
    questions = re.split("^## ", HOW_TO, flags=re.MULTILINE)
    kept = [text for text in questions if text.partition("\n")[0] not in left_out]
    assert len(kept) == len(questions) - len(left_out)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    commands = examples = 0
    for language, block in re.findall(
        r"^```(console|pycon|yaml)\n(.*?)^```$", "## ".join(kept), re.DOTALL | re.MULTILINE
    ):
        if language == "yaml":
            Path(block.splitlines()[0].removeprefix("# ")).write_text(block, encoding="utf-8")
            continue
        if language == "console":
            for command, shown in re.findall(
                r"^\$ ptmcad (.*)\n((?:(?!\$ ).*\n)*)", block, re.MULTILINE
            ):
                assert run(shlex.split(command)) == 0, command
                assert without_what_changes(capsys.readouterr().out) == without_what_changes(
                    shown
                ), command
                commands += 1
            continue
        for example in doctest.DocTestParser().get_examples(block):
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                exec(compile(example.source, "how-to.md", "single"), names)
            assert said.getvalue() == example.want, example.source
            examples += 1
    assert commands >= least[0]
    assert examples >= least[1]


@pytest.mark.slow
def test_numbers_are_drawn_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """matplotlib's lines run; the columns that the others name are there."""
    monkeypatch.chdir(tmp_path)
    assert run(["classify", str(CONFIGS / "fig4.yaml"), "--format", "csv,npz", "--pixels", "40",
                "--boundary-tolerance", "1/50"]) == 0  # fmt: skip
    (python,) = re.findall(r"^```python\n(.*?)^```$", DATA, re.DOTALL | re.MULTILINE)
    monkeypatch.setenv("MPLBACKEND", "agg")
    names: dict[str, Any] = {}
    exec(python, names)
    for value in names.values():
        if isinstance(value, NpzFile):
            value.close()
    assert Path("again.png").read_bytes().startswith(b"\x89PNG")
    with (
        Path("fig4-boundaries.csv").open() as boundaries,
        Path("fig4-regions.csv").open() as regions,
    ):
        columns = set(next(csv.reader(boundaries))), set(next(csv.reader(regions)))
    (latex,), (matlab,) = (
        re.findall(rf"^```{name}\n(.*?)^```$", DATA, re.DOTALL | re.MULTILINE)
        for name in ("latex", "matlab")
    )
    assert {
        *re.findall(r"\b[xy]=([A-Za-z]\w*)[,\]]", latex),
        *re.findall(r"thisrow\{(\w+)\}", latex),
    } <= columns[0]
    assert set(re.findall(r"\bt\.(\w+)", matlab)) <= columns[0]
    assert set(re.findall(r"\br\.(\w+)", matlab)) <= columns[1]
    for table, shown in re.findall(r"^\| `NAME-(\w+)\.csv` \|[^|]*\| (.*) \|$", DATA, re.MULTILINE):
        header = Path(f"fig4-{table}.csv").read_text().splitlines()[0].split(",")
        assert {name for name in re.findall(r"`(\w+)`", shown)} <= set(header)
