"""Pages that are made when the manual is built: the galleries, the schemas' tables and the
changelog.

Guarantee: what they show is what the sources say at that moment; a page is written only when its
text has changed.
"""

from __future__ import annotations

import json
from pathlib import Path

import gallery
import schema_tables
from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[2]
TITLES = {"record": "Problem records (YAML)", "region-map": "Region maps (JSON)"}
"""Of schemas whose names do not say it all."""


def make_pages(app: Sphinx) -> None:
    """Write all generated pages into the folder ``generated`` of the sources."""
    folder = Path(app.srcdir) / "generated"
    folder.mkdir(exist_ok=True)
    for name, (title, path) in schemas().items():
        text = path.read_text(encoding="utf-8")
        write(folder / path.name, text)  # so that the page can link to it
        write(folder / f"{name}.md", schema_tables.page(title, path.name, json.loads(text)))
    write(folder / "changelog.md", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))
    write(folder / "gallery.md", gallery.page(ROOT / "configs", folder))
    write(folder / "gallery-models.md", gallery.models_page(ROOT / "configs", folder))


def schemas() -> dict[str, tuple[str, Path]]:
    """Page name to title and schema: that of records, and every schema beside the manual."""
    found = {}
    for path in (
        ROOT / "ptmcad/record.schema.json",
        *sorted((ROOT / "docs").glob("*.schema.json")),
    ):
        name = path.name.removesuffix(".schema.json")
        title = TITLES.get(name, f"{name.replace('-', ' ').capitalize()} (JSON)")
        found[f"schema-{name}"] = title, path
    return found


def write(path: Path, text: str) -> None:
    """Write the page unless it is there already, so that Sphinx reads only what is new."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """What Sphinx calls."""
    app.connect("builder-inited", make_pages)
    return {"parallel_read_safe": True}
