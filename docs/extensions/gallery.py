"""The gallery: every shipped record without free lengths, with its picture, its table and the command for them.

Guarantee: pictures and tables are computed from the record when the manual is built.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import ptmcad
from ptmcad.show.render import draw

_START = """# Gallery

Each map is computed from its problem record when this manual is built.

"""


def page(configs: Path, folder: Path) -> str:
    """The page as Markdown; pictures go into the folder.

    Parameters
    ----------
    configs : the folder of problem records.
    folder : where the page will be.
    """
    exact = (path for path in sorted(configs.glob("*.yaml")) if not ptmcad.load(path).has_free_lengths)
    return _START + "\n".join(entry(path, folder) for path in exact)


def entry(path: Path, folder: Path) -> str:
    """One record: picture, command, table and record."""
    result = ptmcad.classify(ptmcad.load(path))
    picture = folder / f"{path.stem}.svg"
    draw(result, picture)
    table = replace(result, timings={}).table().replace("time      not recorded; ", "          ")
    source = str(result.slice.reference.get("source", ""))
    return "\n".join(
        (
            f"## {path.stem}",
            "",
            f"{result.slice.heading}",
            "",
            f"![The map of {path.stem}]({picture.name})",
            "",
            *((f"Answers to compare with: {source}.", "") if source else ()),
            "```sh",
            f"ptmcad classify configs/{path.name} --format svg",
            "```",
            "",
            "```text",
            table,
            "```",
            "",
            "```yaml",
            _without_reference(path.read_text(encoding="utf-8")),
            "```",
            "",
        )
    )


def _without_reference(record: str) -> str:
    lines = record.split("\nreference:", maxsplit=1)[0].splitlines()
    return "\n".join(line for line in lines if not line.startswith("#"))
