"""The galleries: every shipped record without free lengths, with its picture, its table and the
command for them.

Guarantee: pictures and tables are computed from the record when the manual is built.
"""

from __future__ import annotations

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
    exact = (
        path for path in sorted(configs.glob("*.yaml")) if not ptmcad.load(path).has_free_lengths
    )
    return _START + "\n".join(entry(path, configs, folder) for path in exact)


def models_page(configs: Path, folder: Path) -> str:
    """The page of the other mechanisms and systems, in the same way."""
    records = [
        *sorted((configs / "mechanisms").glob("*.yaml")),
        *sorted((configs / "systems").glob("*.yaml")),
    ]
    return _MODELS + "\n".join(entry(path, configs, folder) for path in records)


def entry(path: Path, configs: Path, folder: Path) -> str:
    """One record: picture, what it shows, command, table and record."""
    slice, text = ptmcad.load(path), path.read_text(encoding="utf-8")
    picture = f"{path.stem}.svg"
    record = f"configs/{path.relative_to(configs).as_posix()}"
    at = (CERTIFIED if path.stem in CERTIFIED else POSES).get(path.stem, {})
    place = ",".join(f"{name}={value}" for name, value in at.items())
    if path.stem in CERTIFIED:
        picture = f"../img/{path.stem}.png"
        commands = (f"ptmcad classify {record} --engine certified --tolerance 1/100 --format png",
                    f"ptmcad solve {record} --at {place}")  # fmt: skip
        table = ptmcad.solve(model=slice.model, **at).table()
    elif path.stem in POSES:
        found = ptmcad.solve(slice, **at)
        save(draw_poses(found), folder / picture)
        commands = (
            f"ptmcad check {record}",
            f"ptmcad solve {record} --at {place} --format table,svg",
        )
        table = found.table()
    else:
        result = ptmcad.classify(slice)
        draw(result, folder / picture)
        commands = (f"ptmcad classify {record} --format svg",)
        table = (
            replace(result, timings={}).table().replace("time      not recorded; ", "          ")
        )
    source = " ".join(str(slice.reference.get("source", "")).split())
    notes = " ".join(yaml.safe_load(text).get("notes", "").split())
    return "\n".join(
        (
            f"## {path.stem}",
            "",
            f"{slice.heading}",
            "",
            f"![{'Poses' if path.stem in POSES else 'The map'} of {path.stem}]({picture})",
            "",
            *((notes, "") if notes else ()),
            *((f"Answers to compare with: {source}.", "") if source else ()),
            "```sh",
            *commands,
            "```",
            "",
            "```text",
            table,
            "```",
            "",
            "```yaml",
            _shortened(text),
            "```",
            "",
        )
    )


def _shortened(record: str) -> str:
    """The record without comments, notes and reference answers."""
    lines = record.split("\nreference:", maxsplit=1)[0].splitlines()
    kept, within = [], False
    for line in lines:
        within = line.startswith("notes:") or (within and line.startswith(" "))
        if not within and not line.startswith("#"):
            kept.append(line)
    return "\n".join(kept)
