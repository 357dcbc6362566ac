"""The extensions that docs/architecture.md describes, as patches: each applies to this tree, touches
few files, and its own test passes in the tree that it makes.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PATCHES = sorted((ROOT / "docs" / "extensions").glob("*.patch"))
MOST_FILES = 6
"""That an extension changes, tests apart: the schemas that `scripts/schemas` writes are among them."""


def files_of(patch: Path) -> list[str]:
    return re.findall(r"^\+\+\+ b/(.+)$", patch.read_text(encoding="utf-8"), re.MULTILINE)


def applied(patch: Path, tree: Path, *options: str) -> None:
    done = subprocess.run(
        ["git", "apply", *options, str(patch)],
        cwd=tree, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
@pytest.mark.parametrize("patch", PATCHES, ids=lambda patch: patch.stem)
def test_an_extension_applies_and_touches_few_files(patch: Path) -> None:
    assert len(PATCHES) == 3
    code = [name for name in files_of(patch) if not name.startswith("tests/")]
    row = next(
        line
        for line in (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8").splitlines()
        if line.startswith(f"| `docs/extensions/{patch.name}`")
    )
    named = set(re.findall(r"`([a-z_]+(?:/[a-z_]+)+)`", row))
    schemas = re.findall(r"`([\w./-]+\.schema\.json)`", row)
    assert named == {name.removeprefix("ptmcad/").removesuffix(".py") for name in code}
    assert len(code) + len(schemas) <= MOST_FILES
    applied(patch, ROOT, "--check")


@pytest.mark.slow
@pytest.mark.parametrize("patch", PATCHES, ids=lambda patch: patch.stem)
def test_an_extension_s_own_test_passes(patch: Path, tmp_path: Path) -> None:
    tree = tmp_path / "tree"
    hidden = shutil.ignore_patterns(".*", "__pycache__", "out", "build", "dist")
    shutil.copytree(ROOT, tree, ignore=hidden)
    applied(patch, tree)
    around = {**os.environ, "PYTHONPATH": str(tree)}
    subprocess.run([sys.executable, "scripts/schemas"], cwd=tree, env=around, check=True)
    tests = [name for name in files_of(patch) if name.startswith("tests/")]
    assert tests
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", *tests],
        cwd=tree, env=around, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-3000:]
