"""The manual's notebooks: every cell runs, in its order, and says what is stored; pictures are
pictures.
"""

from __future__ import annotations

import ast
import json
import re
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parent.parent
NOTEBOOKS = sorted((ROOT / "docs" / "examples").glob("*.ipynb"))
CHANGING = re.compile(r"^time .*|<Figure size .*|at 0x\w+", re.MULTILINE)


def shown(source: str, names: dict[str, Any]) -> tuple[str, str]:
    """What a cell prints, and the representation of its last expression."""
    tree = ast.parse(source)
    last = ast.Expression(tree.body.pop().value) if isinstance(tree.body[-1], ast.Expr) else None
    printed = StringIO()
    with redirect_stdout(printed):
        exec(compile(tree, "cell", "exec"), names)
        value = None if last is None else eval(compile(last, "cell", "eval"), names)
    return printed.getvalue(), "" if value is None else repr(value)


HEAVY = ("replotting", "design-study")
"""Of what is asked in them, the tests of docs/data.md and docs/how-to.md ask the same."""


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(p, marks=pytest.mark.slow if p.stem in HEAVY else (), id=p.stem)
        for p in NOTEBOOKS
    ],
)
def test_cells_say_what_is_stored(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    names: dict[str, Any] = {}
    outputs = 0
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] != "code":
            continue
        printed, value = shown("".join(cell["source"]), names)
        stored = {"stream": "", "execute_result": ""}
        for output in cell["outputs"]:
            assert output["output_type"] in stored, output
            data = output.get("data", {})
            text = output["text"] if "text" in output else data["text/plain"]
            stored[output["output_type"]] += "".join(text)
            outputs += 1
        flat = [re.sub(r"\s+", " ", CHANGING.sub("…", text)).replace("( ", "(").strip()
                for text in (printed, stored["stream"], value, stored["execute_result"])]  # fmt: skip
        assert (flat[0], flat[2]) == (flat[1], flat[3]), cell["source"]
    assert outputs >= 4


def test_there_are_three() -> None:
    assert len(NOTEBOOKS) == 3
    for path in NOTEBOOKS:
        assert path.stat().st_size < 400_000
