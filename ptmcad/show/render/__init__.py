"""Pictures of results; but for those of the studies the only importer of matplotlib, loaded when
the first is drawn.
"""

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
    from ptmcad.show.render.backend import load_matplotlib

    load_matplotlib()
    return getattr(import_module(f"ptmcad.show.render.{_MODULES[name]}"), name)
