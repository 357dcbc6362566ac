"""Pictures of results; but for those of the studies the only importer of matplotlib, loaded when
the first is drawn, whatever the environment says of backends and settings.

Guarantee: no backend is chosen but those that write files, and nothing is printed. What the
environment names as the backend is what `matplotlib.rcParams` has afterwards, if matplotlib knows
it, for a caller who shows pictures too.
"""

import os
import sys
from contextlib import suppress
from importlib import import_module
from typing import Any

_FUNCTIONS = {
    "comparing": ("comparison_figure", "difference_words", "traced"),
    "designpicture": ("figure_of_design",),
    "fieldpicture": ("description", "field_figure"),
    "film": ("gif_bytes", "save_film", "save_pictures", "sweep_pictures"),
    "landscape": ("draw_landscape",),
    "mechanism": ("draw_mechanism",),
    "chartgrid": ("multiples_figure",),
    "pathpicture": ("draw_branches", "draw_paths", "draw_paths_and_branches"),
    "pixelmap": ("field_png", "grid_png"),
    "plotting": ("draw_with_poses", "plot"),
    "posepicture": ("draw_poses",),
    "printing": ("check_families", "content", "save"),
    "rangepicture": ("draw_range", "draw_widths"),
    "mappicture": ("draw",),
    "solid": ("solid_figure",),
}
"""What other rooms draw with, by the modules that have it: the report needs outlines and colours
only.
"""
_MODULES = {function: module for module, functions in _FUNCTIONS.items() for function in functions}


def __getattr__(name: str) -> Any:
    """One of these functions, matplotlib being loaded when the first is asked for."""
    if name not in _MODULES:
        raise AttributeError(f"module 'ptmcad.show.render' has no attribute {name!r}")
    _load_matplotlib()
    return getattr(import_module(f"ptmcad.show.render.{_MODULES[name]}"), name)


_BACKEND = "MPLBACKEND"
_PICTURE_BYTES = 16 << 20
"""Bytes that a small picture takes, beside the libraries."""


def _load_matplotlib() -> None:
    """Load what every picture needs.

    Raises
    ------
    MemoryError
        When a memory limit leaves no room for a picture.
    """
    if "matplotlib.figure" in sys.modules:
        return
    import logging

    from ptmcad.process.memory import loading, missing_room

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
