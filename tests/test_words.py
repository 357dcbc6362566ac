"""CONTRIBUTING's rule on names, where a machine can look: one word for each thing, through the
whole package.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "ptmcad"
CODE = sorted(PACKAGE.rglob("*.py"))

BOUNDS = re.compile(r"_?(MOST|LONGEST|LARGEST|GREATEST|LEAST|SMALLEST|SHORTEST|FEWEST)(_[A-Z_]+)?")
"""MAX_ and MIN_ say the same in one way."""
VERBS = re.compile(r"_?(tell|told)")
"""What a function does is to report, send or write; `told_apart` and the like are other words."""
VAGUE = re.compile(r"(?i)_?(utils?|helpers?|manager)|.*_(impl|safe)")
RENAMED = re.compile(r"(?i)\bdear\b|\bcan not\b|--keep\b")
"""Expensive, cannot, --without."""
DIALECT = re.compile(
    r"(?i)\b(?:fore)?told\b|\bforetell|\bdearer\b|\bwhat is halved\b|\bof which none\b"
)
"""Reported, predicted, more expensive: the manual is written as an editor would leave it."""


def old_names(tree: ast.Module) -> Iterator[str]:
    """Of what a module defines."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            name, patterns = node.name, (VERBS, VAGUE)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            name, patterns = node.id, (BOUNDS, VAGUE)
        else:
            continue
        if any(pattern.fullmatch(name) for pattern in patterns):
            yield name


@pytest.mark.parametrize(
    ("code", "old"),
    [("_MOST = 3", True), ("LEAST_SHARE: float = 0.5", True), ("def _tell(): ...", True), ("step_impl = 1", True),
     ("class Manager: ...", True), ("MAX_STEPS = MOSTLY = 3", False), ("def told_apart(): told = 1", False)],
)  # fmt: skip
def test_old_words_are_known(code: str, old: bool) -> None:
    assert bool([*old_names(ast.parse(code))]) == old


def test_names_are_the_houses() -> None:
    """Of modules, classes, functions, constants and variables."""
    found = [
        f"{path.relative_to(ROOT)}: {n}"
        for path in CODE
        for n in old_names(ast.parse(path.read_text("utf-8")))
    ]
    assert not found + [str(path) for path in CODE if VAGUE.fullmatch(path.stem)]


def test_prose_and_messages_use_no_renamed_word() -> None:
    """The old option is a hidden alias, where its own name has to stand."""
    docs = ROOT / "docs"
    prose = [*CODE, ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(docs.rglob("*.md"))]
    own = PACKAGE / "cli" / "classify.py"
    read = [p for p in prose if p != own and docs / "generated" not in p.parents]
    found = [f"{p}: {m[0]}" for p in read for m in RENAMED.finditer(p.read_text("utf-8"))]
    assert not found


def test_the_manual_is_in_the_fields_english() -> None:
    docs = ROOT / "docs"
    manual = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted(docs.rglob("*.md"))]
    read = [p for p in manual if docs / "generated" not in p.parents]
    assert not [f"{p}: {m[0]}" for p in read for m in DIALECT.finditer(p.read_text("utf-8"))]
