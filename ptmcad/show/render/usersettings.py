"""Settings of a user's own for matplotlib: a matplotlibrc, a file of a style, or a style's name.

Guarantee: only what they set counts, and nothing of it stays when the picture is drawn; what would change the meaning
of text or what files hold is left out, and colours that could not be read on white, such as those of a dark style.
"""

from __future__ import annotations

import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ptmcad.errors import ConfigError
from ptmcad.show.render.backend import load_matplotlib
from ptmcad.show.style import USER, Style, styled

_OWN = ("text.usetex", "text.parse_math", "svg.", "pdf.", "ps.", "pgf.", "savefig.", "path.", "backend", "interactive",
        "toolbar", "timezone", "webagg", "keymap", "animation", "docstring", "date.epoch")  # fmt: skip

_INKS = ("text.color", "axes.labelcolor", "axes.titlecolor", "axes.edgecolor", "xtick.color", "xtick.labelcolor",
         "ytick.color", "ytick.labelcolor", "hatch.color", "patch.edgecolor")  # fmt: skip
_GROUNDS = ("axes.facecolor",)
MIDDLE = 0.6
"""The lightest ink on white, and the darkest ground for black, from 0 to 1."""


def user_settings(name: str) -> dict[str, Any]:
    """What a style of matplotlib's sets.

    Parameters
    ----------
    name : `USER` for the matplotlibrc that matplotlib itself would read, a path, or the name of a style.

    Raises
    ------
    ConfigError
        When there is no such style, or its file cannot be read.
    """
    load_matplotlib()
    import matplotlib

    with _refusing_faults(name):
        if name == USER:
            found = matplotlib.rc_params_from_file(matplotlib.matplotlib_fname(), True, use_default_template=False)
        elif Path(name).is_file():
            found = matplotlib.rc_params_from_file(name, True, use_default_template=False)
        else:
            from matplotlib import style

            if name not in style.library:
                names = ", ".join(n for n in style.available if not n.startswith("_"))
                raise ConfigError(f"{name!r} is neither a file nor a style of matplotlib: {names}", key="mpl_style")
            found = style.library[name]
    return {key: found[key] for key in found if not key.startswith(_OWN) and not _is_lost(key, found[key])}


def _is_lost(key: str, value: Any) -> bool:
    """Whether a colour is of no use in pictures, which are on white: a light ink, or a dark ground."""
    from matplotlib.colors import is_color_like, to_rgb

    if key not in (*_INKS, *_GROUNDS) or not is_color_like(value):
        return False
    red, green, blue = to_rgb(value)
    return (0.2126 * red + 0.7152 * green + 0.0722 * blue > MIDDLE) == (key in _INKS)


@contextmanager
def _refusing_faults(name: str) -> Iterator[None]:
    """What matplotlib logs and goes on with is one message here."""
    said: list[str] = []
    handler = logging.Handler()
    handler.emit = lambda record: said.append(record.getMessage())  # type: ignore[method-assign]
    log = logging.getLogger("matplotlib")
    before = log.propagate
    log.propagate = False
    log.addHandler(handler)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            yield
    except (OSError, ValueError, KeyError, Warning) as error:
        raise ConfigError(f"{name} cannot be read as a style of matplotlib: {error}", key="mpl_style") from error
    finally:
        log.removeHandler(handler)
        log.propagate = before
    if said:
        raise ConfigError(f"{name} cannot be read as a style of matplotlib: {said[0].strip()}", key="mpl_style")


def user_styled(name: str | Style = "default", mpl_style: str | None = None, **options: Any) -> Style:
    """A style as `styled` makes it, with a user's own settings where they are asked for.

    Raises
    ------
    ConfigError
        As `styled` does, and for settings that cannot be read.
    """
    own = mpl_style or (USER if name == USER else None)
    if own is None:
        return styled(name, None, **options)
    return styled("default" if name == USER else name, user_settings(str(own)), **options)
