"""Records to start from, commented and ready to run, and the mechanisms in them by name.

Guarantee: each is a record that `ptmcad classify` maps as it is; a record that says ``mechanism:
NAME`` means the same mechanism as the starter of that name.
"""

from __future__ import annotations

from ptmcad.text.entry import Written
from ptmcad.text.yamltree import read_text

NAMES = ("ptm", "pendulum", "chain", "platform", "cusp")


def starter_text(name: str) -> str:
    """The starter of a name, as text.

    Raises
    ------
    KeyError
        When there is none.
    """
    from importlib.resources import files  # which a record without a starter's name can do without

    if name not in NAMES:
        raise KeyError(name)
    return files(__package__).joinpath(f"{name}.yaml").read_text(encoding="utf-8")


def mechanism_names() -> tuple[str, ...]:
    """The names of the mechanisms."""
    return tuple(name for name in NAMES if starter_mechanism(name) is not None)


def starter_mechanism(name: str) -> Written | None:
    """The description of a mechanism by its name; None when there is none."""
    return read_text(starter_text(name)).entries.get("mechanism") if name in NAMES else None
