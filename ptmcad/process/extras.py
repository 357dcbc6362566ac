"""Packages and programs that only some questions need: asked for before anything is computed, so that no work is lost.

Guarantee: nothing is imported to find out; a package counts as there when Python would find it.
"""

from __future__ import annotations

import shutil
from importlib.util import find_spec

from ptmcad.errors import ConfigError

NUMBA_MISSING = (
    "the certified engine, which springs with a free length need, runs on the package numba, "
    "which is not installed: pip install numba"
)

ANYWIDGET_MISSING = (
    "a living map in a notebook needs the package anywidget, which is not installed: pip install 'ptmcad[notebook]'"
)

DISTRIBUTED_MISSING = (
    "a scheduler's workers are asked through the package distributed (Dask), which is not installed: "
    "pip install 'ptmcad[distributed]', here and on every worker"
)

AIOHTTP_MISSING = (
    "the explorer's page is served by the package aiohttp, which is not installed: pip install 'ptmcad[explore]'"
)

SCIPY_MISSING = "the best design is searched by the package scipy, which is not installed: pip install 'ptmcad[design]'"


def require_numba() -> None:
    """Refuse at once what the certified engine would refuse later.

    Raises
    ------
    ConfigError
        When numba is not installed.
    """
    if find_spec("numba") is None:
        raise ConfigError(NUMBA_MISSING)


def require_anywidget() -> None:
    """Refuse what a notebook's widget needs.

    Raises
    ------
    ConfigError
        When anywidget is not installed.
    """
    if find_spec("anywidget") is None:
        raise ConfigError(ANYWIDGET_MISSING)


def require_distributed() -> None:
    """Refuse what runs on a cluster.

    Raises
    ------
    ConfigError
        When distributed is not installed.
    """
    if find_spec("distributed") is None:
        raise ConfigError(DISTRIBUTED_MISSING, key="--scheduler")


def require_aiohttp() -> None:
    """Refuse what the explorer needs.

    Raises
    ------
    ConfigError
        When aiohttp is not installed.
    """
    if find_spec("aiohttp") is None:
        raise ConfigError(AIOHTTP_MISSING)


def require_scipy() -> None:
    """Refuse what a global search needs.

    Raises
    ------
    ConfigError
        When scipy is not installed.
    """
    if find_spec("scipy") is None:
        raise ConfigError(SCIPY_MISSING)


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
            "mp4 is made by the program ffmpeg, which is not on the PATH: install it, or ask for gif", key="--format"
        )
    return found
