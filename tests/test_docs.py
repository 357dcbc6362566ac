"""The manual: its commands run, its tables name every key, its links lead somewhere, and it is
built quietly.
"""

from __future__ import annotations

import ast
import json
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest
import yaml
from support.shipped_records import EXACT

from ptmcad.cli import run

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = sorted(path for path in DOCS.rglob("*.md") if "generated" not in path.parts)
TUTORIAL = (DOCS / "tutorial.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", TUTORIAL, re.DOTALL | re.MULTILINE)
RESULT = re.compile(r"^(?P<expression>[^#\n]+?)\s*#\s*(?P<value>\S.*)$")
SAYS = {
    "classify": "computed: ",
    "verify": "ok ",
    "locate": "total   4\n",
    "variety": "written ",
    "plot": "mine.pdf",
}
needs_sphinx = pytest.mark.skipif(
    not all(map(find_spec, ("sphinx", "myst_parser", "furo", "sphinx_click"))),
    reason="Sphinx and its extensions are not installed (pip install '.[docs]')",
)


def blocks(language: str) -> list[str]:
    return [text for found, text in BLOCKS if found == language]


def test_tutorial(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Its record, every command in its order, the files it names, and its Python with the values it
    shows.
    """
    monkeypatch.chdir(tmp_path)
    (record,) = blocks("yaml")
    Path("mine.yaml").write_text(record, encoding="utf-8")
    make, *lines = [line for block in blocks("sh") for line in block.splitlines()]
    assert make == "make demo"
    assert len(lines) == 6
    for line in lines:
        program, command, *arguments = shlex.split(line)
        assert program == ".venv/bin/ptmcad"
        status = run([command, *arguments])
        out, err = capfd.readouterr()
        assert status == 0 and all(
            said.startswith("note: mine.pdf has no room") for said in err.splitlines()
        ), line
        assert bool(err) == ("ieee" in line), line
        assert SAYS[command] in out, line
    assert {path.name for path in Path("mine").iterdir()} == {
        "mine.json", "mine.pdf", "mine.svg", "variety.py", "variety.tex",
    }  # fmt: skip
    assert r"\includegraphics{mine/mine.pdf}" in "".join(blocks("latex"))
    names: dict[str, object] = {}
    (python,) = blocks("python")
    values = 0
    for line in python.splitlines():
        shown = RESULT.match(line)
        if shown is None:
            exec(line, names)
        else:
            assert eval(shown["expression"], names) == ast.literal_eval(shown["value"]), line
            values += 1
    assert values == 3


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(DOCS)))
def test_links_lead_somewhere(page: Path) -> None:
    """As files, so that they work where the pages are read as they are; generated pages are there
    after a build.
    """
    text = re.sub(
        r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE
    )
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        file, _, anchor = target.partition("#")
        found = page if not file else page.parent / file
        if "generated" in Path(file).parts:
            continue
        assert found.exists(), target
        if anchor:
            headings = re.findall(r"^#+ (.*)$", found.read_text(encoding="utf-8"), re.MULTILINE)
            assert anchor in {
                re.sub(r"[^\w -]", "", h).lower().replace(" ", "-") for h in headings
            }, target


def test_every_page_has_its_place() -> None:
    """Each page is in a table of contents, by name or because its folder is."""
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    for page in PAGES:
        name = page.relative_to(DOCS).with_suffix("").as_posix()
        assert (
            name == "index"
            or f"{name}\n" in index
            or f"<{name}>" in index
            or page.parent.name == "use"
        ), name


def test_the_citation_is_of_this_version() -> None:
    """With the keys that the Citation File Format requires."""
    import ptmcad

    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert {"cff-version", "message", "title", "authors"} <= citation.keys()
    assert citation["version"] == ptmcad.__version__
    for entry in (citation, *citation["references"]):
        assert all(
            set(author) in ({"name"}, {"family-names", "given-names"})
            for author in entry["authors"]
        )
    assert all({"type", "title"} <= entry.keys() for entry in citation["references"])


def test_the_manual_shows_public_names() -> None:
    import ptmcad

    api = (DOCS / "api.md").read_text(encoding="utf-8")
    shown = set(re.findall(r"^\.\. auto\w+:: (?:ptmcad\.(?:\w+\.)*)?(\w+)$", api, re.MULTILINE))
    assert set(ptmcad.__all__) - {"__version__"} <= shown


# ---------------------------------------------------------------------------------------------- schemas as tables


def keys(schema: object) -> Iterator[str]:
    """Every key of every object that a schema describes, at any depth."""
    if isinstance(schema, dict):
        for name, value in schema.items():
            if name == "properties":
                yield from value
            yield from keys(value)
    elif isinstance(schema, list):
        for value in schema:
            yield from keys(value)


@pytest.fixture
def schema_tables(monkeypatch: pytest.MonkeyPatch) -> object:
    monkeypatch.syspath_prepend(str(DOCS / "extensions"))
    import schema_tables

    return schema_tables


@pytest.mark.parametrize(
    "path",
    [ROOT / "ptmcad" / "record.schema.json", *sorted(DOCS.glob("*.schema.json"))],
    ids=lambda path: path.name,
)
def test_every_key_is_in_a_table(path: Path, schema_tables: object) -> None:
    schema = json.loads(path.read_text(encoding="utf-8"))
    page = schema_tables.page("Title", path.name, schema)  # type: ignore[attr-defined]
    expected = list(keys(schema))
    assert expected
    for key in expected:
        assert f"| `{key}`" in page, key
    rows = [line for line in page.splitlines() if line.startswith("|")]
    assert all(len(re.findall(r"(?<!\\)\|", row)) == 4 for row in rows)
    assert len([row for row in rows if row.startswith("| `")]) == len(expected)


def test_a_keyword_that_no_table_shows_is_an_error(schema_tables: object) -> None:
    with pytest.raises(ValueError, match="dependentSchemas"):
        schema_tables.page("Title", "x", {"properties": {"a": {"dependentSchemas": {}}}})  # type: ignore[attr-defined]


# -------------------------------------------------------------------------------------------------------- the build


@needs_sphinx
@pytest.mark.slow
def test_the_manual_is_built_without_a_warning(tmp_path: Path) -> None:
    """And it works without a network: no picture, script or style comes from elsewhere."""
    for name in ("docs", "configs", "ptmcad"):
        shutil.copytree(
            ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__", "generated")
        )
    shutil.copy(ROOT / "CHANGELOG.md", tmp_path)
    command = [
        sys.executable,
        "-m",
        "sphinx",
        "--fail-on-warning",
        "--keep-going",
        "--quiet",
        "-b",
        "html",
        "docs",
        "html",
    ]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    html = tmp_path / "html"
    pages = {
        path.relative_to(html).as_posix(): path.read_text(encoding="utf-8")
        for path in html.rglob("*.html")
    }
    assert {
        "index.html",
        "tutorial.html",
        "generated/gallery.html",
        "command-line.html",
        "api.html",
    } <= pages.keys()
    for name, text in pages.items():
        assert not re.findall(
            r"<(?:script|img|iframe|source)[^>]*(?:src|srcset)=\"(?:https?:)?//", text
        ), name
        assert not re.findall(r"<link[^>]*href=\"(?:https?:)?//", text), name
    for style in html.rglob("*.css"):
        assert not re.findall(
            r"url\([\"']?(?:https?:)?//|@import", style.read_text(encoding="utf-8")
        ), style
    for record in EXACT:
        assert f"{record.stem}.svg" in pages["generated/gallery.html"]
    for folder in ("mechanisms", "systems"):
        for record in (ROOT / "configs" / folder).glob("*.yaml"):
            assert re.search(rf"{record.stem}\.(svg|png)", pages["generated/gallery-models.html"])
            notes = " ".join(yaml.safe_load(record.read_text(encoding="utf-8"))["notes"].split())
            assert notes.count(".") >= 3
            assert notes.split(".")[0].split(",")[0] in pages["generated/gallery-models.html"]
    assert "--slice" in pages["command-line.html"] and "–slice" not in pages["command-line.html"]
