"""Matplotlib as it is needed here: loaded whatever the environment says of backends and settings.

Guarantee: no backend is chosen but those that write files, and nothing is printed. What the
environment names as the backend is what `matplotlib.rcParams` has afterwards, if matplotlib knows
it, for a caller who shows pictures too.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress

from ptmcad.process.memory import loading, missing_room

_BACKEND = "MPLBACKEND"
_PICTURE_BYTES = 16 << 20
"""Bytes that a small picture takes, beside the libraries."""


def load_matplotlib() -> None:
    """Load what every picture needs.

    Raises
    ------
    MemoryError
        When a memory limit leaves no room for a picture.
    """
    if "matplotlib.figure" in sys.modules:
        return
    import logging

    log = logging.getLogger("matplotlib")
    level, wanted = log.level, os.environ.get(_BACKEND)
    log.setLevel(
        logging.ERROR
    )  # of a settings file that is not used, of a folder for caches that is not there
    os.environ[_BACKEND] = (
        "agg"  # another may not exist here: a notebook's, in an environment of its own
    )
    try:
        with loading():
            import matplotlib.backends.backend_agg
            import matplotlib.figure
            import numpy as np

            np.linalg.inv(np.eye(3))  # takes the memory that linear algebra reserves, or fails, now
    finally:
        log.setLevel(level)
        del os.environ[_BACKEND]
        if wanted is not None:
            os.environ[_BACKEND] = wanted
    if wanted is not None:
        with suppress(ValueError):  # no backend's name: nobody else can use it either
            matplotlib.rcParams["backend"] = wanted
    if missing_room(_PICTURE_BYTES) is not None:
        raise MemoryError("no room for a picture")
