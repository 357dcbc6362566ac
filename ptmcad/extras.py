"""Packages and programs that only some questions need: asked for before anything is computed, so
that no work is lost.

Guarantee: nothing is imported to find out; a package counts as there when Python would find it.
Every message names the extra of ptmcad that installs what is missing.
"""

from __future__ import annotations

import shutil
from importlib.util import find_spec

from ptmcad.errors import ConfigError

EXTRAS = {
    "certified": (
        "numba",
        "the certified engine, which springs with a free length need, runs on the package {}",
    ),
    "design": ("scipy", "the best design is searched by the package {}"),
    # numba, too, is asked for by what needs it
    "bench": ("scipy", "distances are measured with the package {}"),
    "data": ("pandas", "a data frame needs the package {}"),
    "notebook": ("anywidget", "a living map in a notebook needs the package {}"),
    "explore": ("aiohttp", "the explorer's page is served by the package {}"),
    "distributed": ("distributed", "a scheduler's workers are asked through the package {} (Dask)"),
}
"""Optional groups of packages, by their names in pyproject.toml: the package that is asked for, by
the name under which it is imported, and what needs it.
"""


def remedy(extra: str) -> str:
    """The message that its package is missing, with the command that installs it."""
    package, use = EXTRAS[extra]
    where = ", here and on every worker" if extra == "distributed" else ""
    return f"{use.format(package)}, which is not installed: pip install 'ptmcad[{extra}]'{where}"


def missing(extra: str) -> str:
    """The same; empty where the package is installed."""
    return remedy(extra) if find_spec(EXTRAS[extra][0]) is None else ""


def require(extra: str, key: str | None = None) -> None:
    """Refuse at once what would fail later.

    Parameters
    ----------
    key : of the option or record that asks for it.

    Raises
    ------
    ConfigError
        When the package is not installed.
    """
    if why := missing(extra):
        raise ConfigError(why, key=key)


def require_ffmpeg() -> str:
    """Where the program is that makes MP4.

    Raises
    ------
    ConfigError
        When it is not on the PATH.
    """
    found = shutil.which("ffmpeg")
    if found is None:
        raise ConfigError(
            "mp4 is made by the program ffmpeg, which is not on the PATH: install it, or ask for gif",
            key="--format",
        )
    return found
