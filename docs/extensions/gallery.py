"""The galleries: every shipped record without free lengths, with its picture, its table and the
command for them.

Guarantee: pictures and tables are computed from the record when the manual is built.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import yaml

import ptmcad
from ptmcad.show.render import draw
from ptmcad.show.render.posepicture import draw_poses
from ptmcad.show.render.printing import save

_START = """# Gallery

Each map is computed from its problem record when this manual is built.

"""
_MODELS = """# Gallery of other mechanisms and systems

Each record is shipped with figures of the literature or of a second computation. The pictures are made from the
records when this manual is built.

"""
CERTIFIED = {"three-bar-chain": {"a": "1", "F": "1/2"}}
"""Records whose map takes the certified engine minutes, each with a point of which the table is;
`scripts/free-maps` draws their maps."""

POSES = {
    "five-bar": {"F": "2", "G": "2"},
    "two-dof-tensegrity-loaded": {"r1": "37/20", "r2": "163/100"},
    "two-x-joints": {"F": "-1/8", "G": "5/4"},
}
"""Records without a map, each with a point whose poses are shown."""


def page(configs: Path, folder: Path) -> str:
    """The page of the built-in mechanism as Markdown; pictures go into the folder.

    Parameters
    ----------
    configs : the folder of problem records.
    folder : where the page will be.
    """
    records = sorted(configs.glob("*.yaml"))
    exact = (path for path in records if not ptmcad.load(path).has_free_lengths)
    return _START + "\n".join(entry(path, configs, folder) for path in exact)


def models_page(configs: Path, folder: Path) -> str:
    """The page of the other mechanisms and systems, in the same way."""
    records = (
        path for kind in ("mechanisms", "systems") for path in sorted((configs / kind).iterdir())
    )
    return _MODELS + "\n".join(entry(path, configs, folder) for path in records)


def entry(path: Path, configs: Path, folder: Path) -> str:
    """One record: picture, what it shows, command, table and record."""
    slice, text, shown = ptmcad.load(path), path.read_text(encoding="utf-8"), "The map"
    picture = f"{path.stem}.svg"
    record = f"configs/{path.relative_to(configs).as_posix()}"
    at = {**CERTIFIED, **POSES}.get(path.stem)
    if at is None:
        result = ptmcad.classify(slice)
        draw(result, folder / picture)
        commands = f"ptmcad classify {record} --format svg"
        table = (
            replace(result, timings={}).table().replace("time      not recorded; ", "          ")
        )
    else:
        found = ptmcad.solve(slice, **at)
        table = found.table()
        solve = f"ptmcad solve {record} --at {','.join(map('='.join, at.items()))}"
        if path.stem in CERTIFIED:
            picture = f"../img/{path.stem}.png"
            options = "--engine certified --tolerance 1/100 --format png"
            commands = f"ptmcad classify {record} {options}\n{solve}"
        else:
            shown = "Poses"
            save(draw_poses(found), folder / picture)
            commands = f"ptmcad check {record}\n{solve} --format table,svg"
    source = " ".join(str(slice.reference.get("source", "")).split())
    blocks = (
        f"## {path.stem}",
        slice.heading,
        f"![{shown} of {path.stem}]({picture})",
        " ".join(yaml.safe_load(text).get("notes", "").split()),
        f"Answers to compare with: {source}." if source else "",
        *(
            f"```{kind}\n{said}\n```"
            for kind, said in (("sh", commands), ("text", table), ("yaml", _shortened(text)))
        ),
    )
    return "\n\n".join(filter(None, blocks)) + "\n"


def _shortened(record: str) -> str:
    """The record without comments, notes and reference answers."""
    before = record.partition("\nreference:")[0]
    return re.sub(r"^(?:#.*|notes:.*(?:\n .*)*)\n?", "", before, flags=re.MULTILINE).rstrip("\n")
