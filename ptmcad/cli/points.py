"""Points on a map for its picture: with poses (``--at``), or measured by somebody (``--overlay``)."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.cli.locate import point_of, rows_of
from ptmcad.errors import ConfigError, ExpressionError, blamed, shown
from ptmcad.question.config import point_from_mapping
from ptmcad.question.counts import Shades
from ptmcad.show.table import count_text, index_text
from ptmcad.text.numerals import equalities, shortest_text
from ptmcad.text.parsing import rational

if TYPE_CHECKING:
    from ptmcad.show.render.overlay import Agreement, Measured

Place = tuple[Fraction, Fraction]
MAX_ROWS = 10_000
MAX_LABEL = 40
MAX_TOLD = 10
"""Points that are named one by one on the terminal."""
DIGITS = 10
"""Of the poses' numbers."""


def places(result: RegionMap, texts: Sequence[str]) -> tuple[Place, ...]:
    """The points of ``--at``, in the axes' order.

    Raises
    ------
    ConfigError
        When a text does not give both axes, exactly and within the window.
    """
    found = []
    for text in texts:
        point = point_of(text)
        if set(point) != set(result.slice.axis_names):
            raise ConfigError(
                f"{text}: give the axes {' and '.join(result.slice.axis_names)}", key="--at"
            )
        at = _numbers(result, point, "--at")
        if not _inside(result, at):
            raise ConfigError(f"{text} is outside of the window", key="--at")
        found.append(at)
    return tuple(found)


def poses_at(result: RegionMap, at: Place) -> Poses:
    """The equilibria of the map's mechanism at a point of its window."""
    from ptmcad.ask.solving import poses_at as solved

    slice = result.slice
    # a parameter that stands for several others is beside them in a slice
    aliased = {parameter.alias_of for parameter in slice.model.parameters.values()}
    alone = [name for name in slice.parameters if name not in aliased]
    values = {name: slice.parameters[name].evaluate(*at) for name in alone}
    return replace(
        solved(slice.model, point_from_mapping(values, slice.model), DIGITS), units=slice.units
    )


def measured(result: RegionMap, path: Path) -> tuple[tuple[Measured, ...], int]:
    """The points of a CSV file with columns named like the axes and, if there are, ``label`` and
    ``count``.

    A count is compared with the map's.

    Returns
    -------
    The points within the window, and the number of others.

    Raises
    ------
    ConfigError When the file is not such a table or has no points, a value is no exact number or no
        count, or there are more than `MAX_ROWS` points.
    """
    from ptmcad.show.render.overlay import Measured

    found: list[Measured] = []
    outside = 0
    for line, row in rows_of(path, result, ("label", "count")):
        if len(found) + outside == MAX_ROWS:
            raise ConfigError(f"has more than {MAX_ROWS} points", file=str(path), line=line)
        with blamed(file=path, line=line):
            at = _numbers(result, row, None)
            count = _count(result, row["count"])
        if _inside(result, at):
            label = "".join(c if c.isprintable() else " " for c in row["label"])[:MAX_LABEL]
            found.append(Measured(at, label, _agreement(result, at, count)))
        else:
            outside += 1
    if not found and not outside:
        raise ConfigError("has no points below its first row", file=str(path))
    return tuple(found), outside


def disagreements(result: RegionMap, found: Sequence[Measured]) -> list[str]:
    """The points that have another count than the map, in words; the first `MAX_TOLD` of them."""
    from ptmcad.show.render.overlay import Agreement

    others = [point for point in found if point.agreement is Agreement.OTHER]
    lines = []
    for point in others[:MAX_TOLD]:
        where = equalities(dict(zip(result.slice.axis_names, point.at, strict=True)), shortest_text)
        lines.append(
            f"another count than in the map: {f'{point.label}, ' if point.label else ''}at {where}"
        )
    if len(others) > MAX_TOLD:
        lines.append(f"and at {len(others) - MAX_TOLD} more points")
    return lines


def _count(result: RegionMap, text: str) -> str:
    """A count as the map writes its own, such as ``2``, or ``(1, 2, 1)`` of a map by index; empty
    for none.
    """
    if not text:
        return ""
    if result.slice.count.kind.shades is Shades.INDEX:
        numbers = text.removeprefix("(").removesuffix(")").split(",")
        if all(re.fullmatch(r"\s*\d{1,6}\s*", number, re.ASCII) for number in numbers):
            return index_text(map(int, numbers))
        raise ConfigError(f"'{shown(text, 40)}' is not a count by index such as (1, 2, 1)")
    if re.fullmatch(r"\d{1,6}(\.0*)?", text, re.ASCII):
        return str(int(text.partition(".")[0]))
    raise ConfigError(f"'{shown(text, 40)}' is not a count such as 2")


def _agreement(result: RegionMap, at: Place, count: str) -> Agreement:
    """Whether the map has this count there; untold where it, or the file, has none."""
    from ptmcad.show.render.overlay import Agreement

    location = result.locate(**dict(zip(result.slice.axis_names, at, strict=True)))
    if (
        not count
        or location.region is None
        or location.status in (Status.UNDECIDED, Status.ON_VARIETY)
    ):
        return Agreement.UNTOLD
    said = count_text(result.regions[location.region], result.slice.count)
    return Agreement.SAME if said == count else Agreement.OTHER


def _numbers(result: RegionMap, point: Mapping[str, str], key: str | None) -> Place:
    try:
        first, second = (rational(point[name]) for name in result.slice.axis_names)
    except ExpressionError as error:
        raise ConfigError(str(error), key=key) from error
    return first, second


def _inside(result: RegionMap, at: Place) -> bool:
    return all(
        axis.low <= value <= axis.high for axis, value in zip(result.slice.axes, at, strict=True)
    )
