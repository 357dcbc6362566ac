"""A path over a map's window: straight pieces between corners, that are given as values of the two
axes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ptmcad.answer.motion import Place
from ptmcad.errors import ConfigError, shown
from ptmcad.question.shipped import FIRST, SECOND
from ptmcad.question.slice import Slice
from ptmcad.text.parsing import number_for

OPTION = "--path"
MAX_CORNERS = 100
MIN_LENGTH = 1e-6
"""Of a piece, against the longest: shorter ones are left out."""


def corners_of(slice: Slice, path: str | Mapping[str, Any]) -> tuple[Place, ...]:
    """The corners of a path such as ``rho=1/2:6/5,L2=3/2``, where each axis has one value or one
    for each corner.

    Parameters
    ----------
    path : a text, or a mapping of the two axes to a value or a sequence of values.

    Raises
    ------
    ConfigError
        When the names are not the two axes, a value is not an exact number inside the window, the
        numbers of values do not fit together, or the path leads nowhere.
    """
    given = _of_text(path) if isinstance(path, str) else {n: _listed(v) for n, v in path.items()}
    names = slice.axis_names
    if set(given) != set(names):
        raise ConfigError(
            f"give values of both axes, as in {names[0]}=FROM:TO,{names[1]}=VALUE", key=OPTION
        )
    values = [[number_for(OPTION, value) for value in given[name]] for name in names]
    for axis, own in zip(slice.axes, values, strict=True):
        outside = [value for value in own if not axis.holds(value)]
        if outside:
            raise ConfigError(
                f"{axis.name} = {shown(str(outside[0]), 40)} is not inside the window, {axis.low} to {axis.high}",
                key=OPTION,
            )
    most = max(map(len, values))
    if most > MAX_CORNERS:
        raise ConfigError(f"a path has at most {MAX_CORNERS} corners", key=OPTION)
    if any(len(own) not in (1, most) for own in values):
        raise ConfigError(
            f"{names[0]} has {len(values[0])} values and {names[1]} {len(values[1])}: give one, or as many for both",
            key=OPTION,
        )
    x, y = (own * most if len(own) == 1 else own for own in values)
    corners = tuple(zip(x, y, strict=True))
    if len(set(corners)) < 2:
        raise ConfigError(f"the path leads nowhere: write {names[0]}=FROM:TO", key=OPTION)
    return corners


def _of_text(text: str) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for part in text.split(","):
        name, equals, values = (piece.strip() for piece in part.partition("="))
        listed = [value.strip() for value in values.split(":")]
        if not (name and equals and all(listed)) or name in found:
            raise ConfigError(
                f"'{shown(part, 60)}' is neither NAME=VALUE nor NAME=FROM:TO, as in {SECOND}=1/2:6/5,{FIRST}=3/2",
                key=OPTION,
            )
        found[name] = listed
    return found


def _listed(value: Any) -> list[Any]:
    return list(value) if isinstance(value, Sequence) and not isinstance(value, str) else [value]
