"""Examples in messages, in the names of the built-in mechanism's first parameters, and records that are shipped."""

from __future__ import annotations

from pathlib import Path

from ptmcad.errors import ConfigError
from ptmcad.mechanism import ptm

FIRST, SECOND, THIRD, *_ = ptm().parameters
POINT = f"{FIRST}=1,{SECOND}=3/2"
A_SWEEP = "{F: [-10, -20]} or {F: {from: -40, to: 0, step: 5}}"
A_DESIGN = f"{{maximise: range, along: {THIRD}, over: {{{FIRST}: [1/2, 2], {SECOND}: [1/2, 2]}}}}"
AXES = f"{{{FIRST}: [0, 2], {SECOND}: [0, 2]}}"


def shipped_record(name: str) -> Path:
    """A record of ``configs/``: of the folder one is in, or of the one that a wheel has, or of the source tree.

    Raises
    ------
    ConfigError
        When there is none of this name.
    """
    package = Path(__file__).resolve().parents[1]
    places = [folder / "configs" / f"{name}.yaml" for folder in (Path(), package, package.parent)]
    for place in places:
        if place.is_file():
            return place
    raise ConfigError(f"there is no record {name} in configs/: name a problem record", key="CONFIG")
