"""Problem records by path or, of those that are shipped, by name; and examples in messages, in the
names of the built-in mechanism's first parameters.

Guarantee: a name is found from anywhere, in a wheel and in a source tree; a file of that name wins
over a shipped one.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ptmcad.errors import ConfigError
from ptmcad.model import ptm
from ptmcad.text.entry import Tree
from ptmcad.text.syntax import did_you_mean
from ptmcad.text.yamltree import read_file

FIRST, SECOND, THIRD, *_ = ptm().parameters
FORCE, *_ = ptm().forces
POINT = f"{FIRST}=1,{SECOND}=3/2"
A_SWEEP = "{F: [-10, -20]} or {F: {from: -40, to: 0, step: 5}}"
A_DESIGN = f"{{maximise: range, along: {THIRD}, over: {{{FIRST}: [1/2, 2], {SECOND}: [1/2, 2]}}}}"
AXES = f"{{{FIRST}: [0, 2], {SECOND}: [0, 2]}}"


RecordSource = str | Path | Mapping[str, Any]
"""What a record is read from: its file, or a mapping like one."""


def shipped_records() -> dict[str, Path]:
    """The records of ``configs/`` by name: of the folder that a wheel has, or else of the source
    tree.
    """
    package = Path(__file__).resolve().parents[1]
    folder = next(
        folder for folder in (package / "configs", package.parent / "configs") if folder.is_dir()
    )
    return {path.stem: path for path in sorted(folder.rglob("*.yaml"))}


def record_file(record: str | Path) -> Path:
    """The file of a record that is named by its path or, of a shipped one, by its name."""
    return (
        Path(record) if os.path.isfile(record) else shipped_records().get(str(record), Path(record))
    )


def record_tree(record: str | Path) -> Tree:
    """Read a record that is named by its path or, of a shipped one, by its name.

    Raises
    ------
    ConfigError
        As `ptmcad.text.yamltree.read_file` does.
    """
    try:
        return read_file(record_file(record))
    except ConfigError as error:
        if not isinstance(error.__cause__, FileNotFoundError):
            raise
        hint = (
            did_you_mean(Path(record).stem, shipped_records())
            or ": `ptmcad mechanisms` lists those"
        )
        raise ConfigError(
            f"{error.message}, and no record of this name is shipped{hint}", file=error.file
        ) from error
