"""Files and modules that prose speaks of are there: in the manual, in the README, in docstrings."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
ROOMS = "|".join(
    sorted(p.name for p in (ROOT / "ptmcad").iterdir() if p.is_dir() and p.name != "__pycache__")
)
FILE = re.compile(rf"`((?:ptmcad|tests|docs|configs|scripts|{ROOMS})/[\w./-]+)`")
NAME = re.compile(r"`(ptmcad(?:\.[a-z_]\w*)+)")
PROSE = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md")),
    *sorted((ROOT / "docs").rglob("*.md")),
    *sorted((ROOT / "ptmcad").rglob("*.py")),
    *sorted((ROOT / "tests").rglob("*.py")),
]


def is_file(named: str) -> bool:
    """From the project's root, or from a folder that prose counts from; modules also without their
    ending.
    """
    starts = (ROOT / folder / named for folder in (".", "ptmcad", "tests"))
    return any(start.exists() or start.with_suffix(".py").exists() for start in starts)


def is_name(named: str) -> bool:
    """A module, or a module and a word in it."""
    *parts, word = named.split(".")
    module = ROOT.joinpath(*parts)
    if module.joinpath(word).is_dir() or module.joinpath(f"{word}.py").exists():
        return True
    if not module.is_dir() and not module.with_suffix(".py").exists():
        return bool(parts) and is_name(".".join(parts))  # a class's attribute
    text = module.joinpath("__init__.py") if module.is_dir() else module.with_suffix(".py")
    return re.search(rf"\b{word}\b", text.read_text(encoding="utf-8")) is not None


def lost(text: str) -> list[str]:
    return [m[1] for m in FILE.finditer(text) if not is_file(m[1])] + [
        m[1] for m in NAME.finditer(text) if not is_name(m[1])
    ]


@pytest.mark.parametrize(
    ("text", "there"),
    [("`exact/areas/area.py`", True), ("`certified/covering`", True), ("`exact/cad/surface.py`", False),
     ("`ptmcad.model.closedloops`", True), ("`ptmcad.model.closures`", False),
     ("`ptmcad.answer.regionmap.RegionMap.cells`", True)],
)  # fmt: skip
def test_what_is_lost_is_seen(text: str, there: bool) -> None:
    assert (not lost(text)) == there


def test_prose_speaks_of_what_is_there() -> None:
    own = Path(__file__)
    found = {
        str(p.relative_to(ROOT)): names
        for p in PROSE
        if p != own and (names := lost(p.read_text("utf-8")))
    }
    assert not found


def test_a_rooms_map_names_its_modules() -> None:
    """Of the certified engine and of formulas: each module, and no other one."""
    for room in ("certified", "formulas"):
        folder = ROOT / "ptmcad" / room
        text = ast.get_docstring(ast.parse((folder / "__init__.py").read_text("utf-8"))) or ""
        words = {word for word in re.findall(r"`([a-z_.]+)`", text) if "ptmcad." not in word}
        for line in re.findall(r"^    (\S.*?)  ", text, re.MULTILINE):
            words.update(line.split(", "))
        modules = {
            ".".join(path.relative_to(folder).with_suffix("").parts)
            for path in folder.rglob("*.py")
            if path.name != "__init__.py"
        }
        assert words == modules
