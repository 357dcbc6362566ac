"""The source distribution has all that its tests read."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("configs", "docs", "ptmcad", "scripts", "tests")
FILES = (".gitignore", "CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md", "LICENSE", "MANIFEST.in", "Makefile",
         "README.md", "pyproject.toml")  # fmt: skip
MADE = {"__pycache__", "generated", "findings", ".hypothesis", ".mypy_cache", ".ruff_cache", ".pytest_cache"}
"""Folders that running the program, its tests or its manual's build makes."""


def wanted() -> Iterator[str]:
    yield from FILES
    for folder in FOLDERS:
        for place, folders, names in os.walk(ROOT / folder):
            folders[:] = [name for name in folders if name not in MADE]
            yield from (Path(place, name).relative_to(ROOT).as_posix() for name in names)


def test_the_source_distribution_has_every_file(tmp_path: Path) -> None:
    """By the file list that setuptools makes before it packs."""
    code = f"from setuptools import setup; setup(script_args=['-q', 'egg_info', '--egg-base', {str(tmp_path)!r}])"
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True)
    (listing,) = tmp_path.glob("*.egg-info/SOURCES.txt")
    listed = {name.removeprefix("./") for name in listing.read_text(encoding="utf-8").splitlines()}
    assert set(wanted()) - listed == set()
    foreign = {name for name in listed - set(wanted()) if ".egg-info/" not in name and name != "setup.cfg"}
    assert foreign == set()
