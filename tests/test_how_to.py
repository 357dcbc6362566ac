"""The pages of questions and of numbers: commands and Python say what the pages show; figures are
drawn again.
"""

from __future__ import annotations

import contextlib
import doctest
import io
import re
import shlex
from pathlib import Path

import pytest

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
