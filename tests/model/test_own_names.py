"""Where the built-in mechanism's own names are still typed in: a list that only gets shorter."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from ptmcad.model import ptm

PACKAGE = Path(__file__).resolve().parents[2] / "ptmcad"
DATA = {".js", ".json", ".yaml", ".html", ".css"}
FILES = sorted(
    p for p in PACKAGE.rglob("*") if p.suffix in {".py", *DATA} and p.parent.name != "model"
)
OWN = {*ptm().parameters, *ptm().unknowns, *ptm().points}
VAGUE = {"k", "l0"}
"""Also short names of other things: as identifiers they say nothing, nor does k in a text."""
IDENTIFIERS = (OWN - VAGUE) | {name.upper() for name in OWN if name.islower()} - {
    name.upper() for name in VAGUE
}
"""Constants may be named after them, too."""
TEXT = re.compile(r"(?<![\w.])(?:" + "|".join(sorted(OWN - {"k"})) + r")(?!\w)")


def own_names(path: Path) -> Iterator[tuple[int, str]]:
    """Lines and names in code and in texts; docstrings are prose, and so are comments."""
    text = path.read_text(encoding="utf-8")
    if not any(
        name in text for name in OWN - {"k"}
    ):  # most files: then there is nothing to take apart
        return
    if path.suffix in DATA:
        for number, line in enumerate(text.splitlines(), 1):
            yield from (
                (number, name)
                for name in TEXT.findall(line.partition("//" if path.suffix == ".js" else "\0")[0])
            )
        return
    nodes = list(ast.walk(ast.parse(text)))
    prose = set()
    for node in nodes:
        body = getattr(node, "body", None)
        if isinstance(body, list):
            prose |= {
                id(s.value)
                for s in body
                if isinstance(s, ast.Expr) and isinstance(s.value, ast.Constant)
            }
    for node in nodes:
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in prose:
            yield from ((node.lineno, name) for name in TEXT.findall(node.value))
        for name in (getattr(node, kind, None) for kind in ("id", "arg", "attr", "name")):
            if isinstance(name, str) and name in IDENTIFIERS:
                yield getattr(node, "lineno", 0), name


ELSEWHERE = ("studies/", "question/config/starters/")
"""Studies of this mechanism: constructions, published equations and rival methods are its own. And
records to begin other mechanisms with, whose parts have such names too."""
KERNELS = {"certified/peaks.py"}
"""Where this mechanism's energy has peaks, which no formula for all mechanisms tells."""
GREEK = ("show/polynomial_text.py", "show/render/axes.py", "text/syntax.py")
"""A Greek letter's name, and no other name."""
WRITTEN = {"record.schema.json"}
"""What a script writes from the description."""
STILL_HOLDING = {name: OWN | IDENTIFIERS for name in KERNELS | WRITTEN} | {
    name: {"rho"} for name in GREEK
}


def test_own_names_are_typed_in_the_description_and_where_the_list_says() -> None:
    """A file that is new here has to read the description; one that is free of the names leaves the
    list.
    """
    held = {
        p.relative_to(PACKAGE).as_posix(): {n for _, n in found}
        for p in FILES
        if (found := list(own_names(p)))
    }
    new = {
        name: found - STILL_HOLDING.get(name, set())
        for name, found in held.items()
        if not name.startswith(ELSEWHERE) and not found <= STILL_HOLDING.get(name, set())
    }
    assert not new
    assert held.keys() >= STILL_HOLDING.keys(), (
        f"take off the list: {sorted(STILL_HOLDING.keys() - held.keys())}"
    )


def test_the_reader_sees_names_in_code_and_texts_but_not_in_prose(tmp_path: Path) -> None:
    module = tmp_path / "module.py"
    module.write_text(
        '"""About rho."""\nrho = p["L1"]  # and th1\nx.th2 = f"-{k}*A3 F3x"\n'
        'k = flow = "rhombus"\nTH1 = 1\ndef L2(): ...\n'
    )
    assert sorted(name for _, name in own_names(module)) == [
        "A3",
        "F3x",
        "L1",
        "L2",
        "TH1",
        "rho",
        "th2",
    ]
    script = tmp_path / "script.js"
    script.write_text("// about rho\nconst a = cell.L1 + at['A3'];\n")
    assert [name for _, name in own_names(script)] == ["A3"]
