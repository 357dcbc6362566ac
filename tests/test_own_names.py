"""Where the built-in mechanism's own names are still typed in: a list that only gets shorter."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from ptmcad.mechanism import ptm

PACKAGE = Path(__file__).resolve().parents[1] / "ptmcad"
FILES = sorted(p for p in PACKAGE.rglob("*") if p.suffix in {".py", ".js"} and p.parent.name != "mechanism")
OWN = {*ptm().parameters, *ptm().unknowns, *ptm().points}
VAGUE = {"k", "l0"}
"""Also short names of other things: as identifiers they tell nothing, nor does k in a text."""
TEXT = re.compile(r"(?<![\w.])(?:" + "|".join(sorted(OWN - {"k"})) + r")(?!\w)")


def own_names(path: Path) -> Iterator[tuple[int, str]]:
    """Lines and names in code and in texts; docstrings are prose, and so are comments."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".js":
        for number, line in enumerate(text.splitlines(), 1):
            yield from ((number, name) for name in TEXT.findall(line.partition("//")[0]))
        return
    tree = ast.parse(text)
    prose = set()
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            prose |= {id(s.value) for s in body if isinstance(s, ast.Expr) and isinstance(s.value, ast.Constant)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in prose:
            yield from ((node.lineno, name) for name in TEXT.findall(node.value))
        for name in (getattr(node, "id", None), getattr(node, "arg", None), getattr(node, "attr", None)):
            if isinstance(name, str) and name in OWN - VAGUE:
                yield getattr(node, "lineno", 0), name


if __name__ == "__main__":
    for path in FILES:
        if found := list(own_names(path)):
            print(len(found), path.relative_to(PACKAGE), [f"{n}:{w}" for n, w in found][:12])
