"""Fonts by their families."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.font_manager import FontProperties, fontManager

from ptmcad.errors import ConfigError

_GENERIC = ("serif", "sans-serif", "monospace", "cursive", "fantasy")
_SHOWN = 12


def check_families(families: Sequence[str]) -> None:
    """Refuse families of which none is installed.

    Raises
    ------
    ConfigError
        With those that are.
    """
    for family in families:
        if family.lower() in _GENERIC:
            continue
        try:
            fontManager.findfont(FontProperties(family=[family]), fallback_to_default=False)
        except ValueError as error:
            names = sorted(
                {
                    font.name
                    for font in fontManager.ttflist
                    if not font.name.startswith((".", "STIX", "cm"))
                }
            )
            more = "" if len(names) <= _SHOWN else f" and {len(names) - _SHOWN} more"
            raise ConfigError(
                f"no font of the family {family!r} is installed; there are {', '.join(names[:_SHOWN])}{more}, "
                "serif, sans-serif and monospace",
                key="font_family",
            ) from error
