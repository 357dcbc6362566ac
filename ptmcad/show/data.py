"""A map as tables of numbers: for data frames, as CSV and as NumPy's NPZ.

Guarantee: the same map gives the same text. Numbers are the floats nearest to the exact ones,
areas' bounds rounded outwards. Between two polylines there is a line without numbers (``nan``),
where MATLAB, pgfplots and matplotlib break a line.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from io import BytesIO, StringIO
from math import inf, isnan, nan, nextafter
from typing import TYPE_CHECKING, Any

from ptmcad.answer.boundaries import Boundary, Grid
from ptmcad.answer.counts import Counted
from ptmcad.answer.field import Field
from ptmcad.answer.regionmap import RegionMap
from ptmcad.errors import ConfigError
from ptmcad.extras import require
from ptmcad.question.counts import PREDICATES, further_names
from ptmcad.question.slice import within_doubles
from ptmcad.show.polynomial_text import Style, polynomial_text

if TYPE_CHECKING:
    from pandas import DataFrame

Row = dict[str, Any]
TABLES = ("regions", "cells", "components", "boundaries", "grid")
"""What a map is as a data frame."""
_OF_ITS_OWN = {
    "region", "stable", "total", "index", *PREDICATES, "area_low", "area_high", "cells", "cell", "stack", "level",
    "piece", "component", "kind", "separates", "left", "right", "distance", "polynomial",
}  # fmt: skip


def axis_columns(result: RegionMap) -> tuple[str, str]:
    """The names of the coordinates' columns: the axes', with an underscore where a table has such a
    column already.
    """
    first, second = (f"{n}_" if n in _OF_ITS_OWN else n for n in result.slice.axis_names)
    return first, second


def region_rows(result: RegionMap) -> list[Row]:
    """A row for each region, with a point of it and the bounds of its area."""
    with within_doubles(result.slice):
        return [
            {
                "region": k, **_counts(result, r),
                "area_low": _rounded(r.area[0], -inf), "area_high": _rounded(r.area[1], inf), "cells": len(r.cells),
                **_at(result, r.sample),
            }
            for k, r in enumerate(result.regions)
        ]  # fmt: skip


def cell_rows(result: RegionMap) -> list[Row]:
    """A row for each cell, with its sample point."""
    with within_doubles(result.slice):
        return [
            {
                "cell": k, "region": c.region, **_counts(result, c), "stack": c.stack, "level": c.level,
                **_at(result, c.sample),
            }
            for k, c in enumerate(result.cells)
        ]  # fmt: skip


def _counts(result: RegionMap, part: Counted) -> Row:
    """All numbers of solutions that are known; of how many predicates hold by their names."""
    index = None if part.index is None else " ".join(map(str, part.index))
    further = {name: part.further.get(name) for name in further_names(result.slice.count)}
    return {"stable": part.stable, "total": part.total, "index": index, **further}


def component_rows(result: RegionMap) -> list[Row]:
    """A row for each component of the variety, with its polynomial as text."""
    names = result.slice.axis_names
    return [
        {
            "component": k, "kind": c.kind.value, "separates": c.separates, "left_out": c.left_out,
            "polynomial": polynomial_text(c.polynomial, names, Style.TEXT),
        }
        for k, c in enumerate(result.components)
    ]  # fmt: skip


def boundary_rows(result: RegionMap, boundaries: Sequence[Boundary]) -> Iterator[Row]:
    """A row for each point of each polyline, and one without numbers between two polylines."""
    x, y = axis_columns(result)
    for k, piece in enumerate(boundaries):
        own = {
            "piece": k, "component": piece.component, "kind": piece.kind.value if piece.kind else None,
            "separates": piece.separates, "left": piece.left, "right": piece.right, "distance": piece.distance,
        }  # fmt: skip
        if k:
            yield {**own, x: nan, y: nan}
        for first, second in piece.points.tolist():
            yield {**own, x: first, y: second}


def grid_columns(result: RegionMap, grid: Grid) -> dict[str, Any]:
    """Columns for each pixel, row after row from the bottom."""
    import numpy as np

    x, y = axis_columns(result)
    rows, columns = grid.region.shape
    labels = {name: getattr(grid, name).ravel() for name in ("cell", "region", "stable", "total")}
    return {x: np.tile(grid.x, rows), y: np.repeat(grid.y, columns), **labels}


_OPTIONS: dict[str, tuple[str, ...]] = {"boundaries": ("tolerance",), "grid": ("columns", "rows")}


def data_frame(result: RegionMap, what: str, options: Mapping[str, Any]) -> DataFrame:
    """One of the tables as a data frame; whole numbers that may be missing are pandas' own
    ``Int64``.

    Raises
    ------
    ConfigError
        For another table or option, or when pandas is not installed.
    """
    if what not in TABLES:
        raise ConfigError(f"{what!r} is not among {', '.join(TABLES)}")
    unknown = [name for name in options if name not in _OPTIONS.get(what, ())]
    if unknown:
        known = ", ".join(_OPTIONS.get(what, ())) or "none"
        raise ConfigError(f"the table {what} has no option {unknown[0]!r}; its options: {known}")
    if what == "grid":
        grid: DataFrame = _pandas().DataFrame(grid_columns(result, result.grid(**options)))
        return grid
    return pandas_frame(
        rows_of(result, what, lambda: result.boundaries(**options)), None, _MAY_BE_MISSING
    )


def pandas_frame(
    rows: Iterable[Row], columns: Sequence[str] | None, whole: Iterable[str]
) -> DataFrame:
    """Rows as a data frame.

    Parameters
    ----------
    columns : their names in order; those of the rows when None.
    whole : columns of whole numbers that may be missing: pandas' own ``Int64``.

    Raises
    ------
    ConfigError
        When pandas is not installed.
    """
    table: DataFrame = _pandas().DataFrame(list(rows), columns=columns)
    for name in whole:
        if name in table:
            table[name] = table[name].astype("Int64")
    return table


def _pandas() -> Any:
    require("data")
    import pandas as pd

    return pd


_MAY_BE_MISSING = ("stable", "total", *PREDICATES, "component", "left", "right", "stack")


def rows_of(
    result: RegionMap, what: str, boundaries: Callable[[], Sequence[Boundary]]
) -> Iterable[Row]:
    """The rows of one of the tables but that of a grid."""
    if what == "boundaries":
        return boundary_rows(result, boundaries())
    return {"regions": region_rows, "cells": cell_rows, "components": component_rows}[what](result)


def csv_text(rows: Iterable[Row], names: Sequence[str] | None = None) -> str:
    """Comma-separated values with a line of names, those of the first row unless they are given.

    Truth is 1 and 0, and numbers that do not exist are empty or ``nan``.
    """
    text = StringIO()
    writer = csv.DictWriter(text, names or (), lineterminator="\n")
    if names is not None:
        writer.writeheader()
    for row in rows:
        if not writer.fieldnames:
            writer.fieldnames = list(row)
            writer.writeheader()
        writer.writerow({name: int(v) if isinstance(v, bool) else v for name, v in row.items()})
    return text.getvalue()


def npz_bytes(result: RegionMap, boundaries: Sequence[Boundary], grid: Grid) -> bytes:
    """The map as arrays in NumPy's format, the same bytes for the same map.

    ``boundary`` has shape (n, 2) with rows of nan between polylines, ``piece`` their numbers,
    ``left`` and ``right`` the regions on their two sides (-1: none); ``x``, ``y``, ``cell``,
    ``region``, ``stable``, ``total`` are the grid's; ``area`` has shape (regions, 2),
    ``region_stable`` and ``region_total`` shape (regions,); ``axes`` are the names.
    """
    import numpy as np

    points, numbers = [], []
    for k, piece in enumerate(boundaries):
        points += [np.full((1, 2), nan)] if k else []
        points.append(piece.points)
        numbers += [k] * (len(piece.points) + bool(k))
    regions = region_rows(result)
    data = {
        "axes": np.array(result.slice.axis_names),
        "boundary": np.concatenate(points) if points else np.empty((0, 2)),
        "piece": np.array(numbers, dtype=np.int64),
        "left": _labels(b.left for b in boundaries),
        "right": _labels(b.right for b in boundaries),
        "separates": np.array([b.separates for b in boundaries], dtype=np.bool_),
        "distance": np.array([b.distance for b in boundaries], dtype=np.float64),
        "area": np.array([(r["area_low"], r["area_high"]) for r in regions]).reshape(-1, 2),
        "region_stable": _labels(r["stable"] for r in regions),
        "region_total": _labels(r["total"] for r in regions),
        **grid.arrays(),
    }
    return _zipped(data)


def _zipped(arrays: Mapping[str, Any]) -> bytes:
    import numpy as np

    content = BytesIO()
    np.savez_compressed(content, **arrays)
    return content.getvalue()


def field_csv(field: Field) -> str:
    """A field with a line for each pixel, row after row from the bottom; empty where there is no
    value.
    """
    x, y = (f"{n}_" if n in ("value", "region") else n for n in field.names)
    rows = (
        {x: u, y: v, "value": "" if isnan(value) else value, "region": region}
        for v, values, regions in zip(
            field.y.tolist(), field.values.tolist(), field.region.tolist(), strict=True
        )
        for u, value, region in zip(field.x.tolist(), values, regions, strict=True)
    )
    return csv_text(rows)


def field_npz(field: Field) -> bytes:
    """A field as arrays: ``x``, ``y``, ``values`` and ``region`` of shape (rows, columns), ``axes``
    the names.

    ``jump_right``, shape (rows, columns - 1), and ``jump_above``, shape (rows - 1, columns), say
    where the branch changes between a pixel and its neighbour, as `Field.jumps` does; they are
    missing where it was not looked for.
    """
    import numpy as np

    arrays: dict[str, Any] = {"axes": np.array(field.names), "x": field.x, "y": field.y}
    arrays |= {"values": field.values, "region": field.region}
    if field.jumps is not None:
        arrays["jump_right"], arrays["jump_above"] = field.jumps
    return _zipped(arrays)


def _labels(values: Iterator[int | None]) -> Any:
    import numpy as np

    return np.array([-1 if v is None else v for v in values], dtype=np.int64)


def _at(result: RegionMap, sample: Sequence[Fraction]) -> Row:
    return dict(zip(axis_columns(result), map(float, sample), strict=True))


def _rounded(value: Fraction, towards: float) -> float:
    """The nearest float on one side."""
    near = float(value)
    wrong = near > value if towards < 0 else near < value
    return nextafter(near, towards) if wrong else near
