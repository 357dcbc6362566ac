"""The source distribution has all that its tests read, and a wheel what it needs where there is no
source.
"""

from __future__ import annotations

import email
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from zipfile import ZipFile

import pytest

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("configs", "docs", "ptmcad", "scripts", "tests")
FILES = (".gitignore", "CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md", "LICENSE", "MANIFEST.in", "Makefile",
         "README.md", "pyproject.toml", "setup.py")  # fmt: skip
MADE = {
    "__pycache__",
    "generated",
    "findings",
    ".hypothesis",
    ".mypy_cache",
    ".ruff_cache",
    ".pytest_cache",
}
"""Folders that running the program, its tests or its manual's build makes."""


def wanted() -> Iterator[str]:
    yield from FILES
    for folder in FOLDERS:
        for place, folders, names in os.walk(ROOT / folder):
            folders[:] = [name for name in folders if name not in MADE]
            yield from (Path(place, name).relative_to(ROOT).as_posix() for name in names)


@pytest.mark.slow
def test_the_source_distribution_has_every_file(tmp_path: Path) -> None:
    """By the file list that setuptools makes before it packs."""
    command = [sys.executable, "setup.py", "-q", "egg_info", "--egg-base", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (listing,) = tmp_path.glob("*.egg-info/SOURCES.txt")
    listed = {name.removeprefix("./") for name in listing.read_text(encoding="utf-8").splitlines()}
    assert set(wanted()) - listed == set()
    foreign = {
        name for name in listed - set(wanted()) if ".egg-info/" not in name and name != "setup.cfg"
    }
    assert foreign == set()


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a wheel of the present tree holds, unpacked."""
    folder = tmp_path_factory.mktemp("wheel")
    script = f"""
from setuptools import build_meta
settings = {{"--build-option": ["--bdist-dir", {str(folder / "bdist")!r}]}}
build_meta.build_wheel({str(folder)!r}, settings)
"""
    copy = folder / "source"
    shutil.copytree(
        ROOT,
        copy,
        ignore=shutil.ignore_patterns(*MADE, ".*", "build", "out", "dist", "*.egg-info", "tests"),
    )
    subprocess.run([sys.executable, "-c", script], cwd=copy, check=True, capture_output=True)
    (made,) = folder.glob("*.whl")
    with ZipFile(made) as archive:
        archive.extractall(folder / "unpacked")
    return folder / "unpacked"


@pytest.mark.slow
def test_a_wheel_has_the_records(wheel: Path) -> None:
    shipped = {path.relative_to(ROOT).as_posix() for path in (ROOT / "configs").rglob("*.yaml")}
    packed = {
        path.relative_to(wheel / "ptmcad").as_posix()
        for path in (wheel / "ptmcad" / "configs").rglob("*.yaml")
    }
    assert packed == shipped
    (record,) = wheel.glob("*.dist-info/RECORD")
    assert "ptmcad/configs/fig4.yaml," in record.read_text(encoding="utf-8")
    assert not (wheel / "configs").exists()


def test_bench_needs_no_record_where_a_wheel_is_installed(wheel: Path, tmp_path: Path) -> None:
    code = "from ptmcad.question.shipped import record_file; print(record_file('fig4'))"
    environment = os.environ | {"PYTHONPATH": str(wheel)}
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env=environment,
        check=True,
        capture_output=True,
        text=True,
    )
    assert done.stdout == f"{wheel / 'ptmcad' / 'configs' / 'fig4.yaml'}\n"


@pytest.mark.slow
def test_a_new_user_finds_the_records_in_a_wheel(wheel: Path, tmp_path: Path) -> None:
    """In an empty folder: the commands of the README and of the page of questions that ask a
    shipped record.
    """
    pages = (ROOT / "README.md", ROOT / "docs" / "how-to.md")
    shown = "\n".join(page.read_text(encoding="utf-8") for page in pages)
    lines = re.findall(r"^(?:\$ |\.venv/bin/)ptmcad ((?:\w+) fig\d .*)$", shown, re.MULTILINE)
    quick = [
        shlex.split(line)
        for line in lines
        if line.split()[0] in ("classify", "range", "solve", "variety")
    ]
    assert len(quick) > 6
    environment = os.environ | {"PYTHONPATH": str(wheel)}
    for words in quick:
        done = subprocess.run(
            [sys.executable, "-m", "ptmcad", *words],
            cwd=tmp_path, env=environment, check=False, capture_output=True, text=True,
        )  # fmt: skip
        assert (done.returncode, done.stderr) == (0, ""), words
    assert (tmp_path / "out" / "fig4.json").is_file()


def test_what_a_wheel_says_of_itself(wheel: Path) -> None:
    (metadata,) = wheel.glob("*.dist-info/METADATA")
    said = email.message_from_string(metadata.read_text(encoding="utf-8"))
    assert said["Author"] == "The ptmcad authors" and "tensegrity mechanism" in said["Keywords"]
    assert "Typing :: Typed" in said.get_all("Classifier", [])
    text = str(said.get_payload())
    assert text.startswith("# ptmcad") and "](" not in re.sub(r"\]\(https?:", "", text)
