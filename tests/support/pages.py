"""What a page gives to its script, as the script reads it."""

from __future__ import annotations

import json
import re
from typing import Any

from ptmcad.show.render.polylines import GRID


def data_of(text: str) -> dict[str, Any]:
    """The page's data, with the cells as rows."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)
    assert found
    data: dict[str, Any] = json.loads(found[1])
    return data | {"cells": unpacked(data["cells"])}


def unpacked(table: dict[str, Any]) -> list[dict[str, Any]]:
    """A table as rows."""
    rows: list[dict[str, Any]] = [{} for _ in range(table["length"])]
    for name, column in table["columns"].items():
        if "many" in column:
            inner = iter(unpacked(column["rows"]))
            entries = [[next(inner) for _ in range(many)] for many in column["many"]]
            assert next(inner, None) is None
        elif "at" in column:
            entries = [column["of"][number] for number in column["at"] or [0] * len(rows)]
        else:
            entries = column["of"]
        for row, entry in zip(rows, entries, strict=True):
            row[name] = entry
    return rows


def corners(data: str) -> list[tuple[float, float]]:
    """The corners of one line, read as SVG's grammar says, in the picture's units."""
    assert re.fullmatch(r"M-?\d+[ -]\d+(?:[lhv]-?\d+(?:(?: |(?=-))-?\d+)*)*z?", data), data
    first, *pieces = re.findall(r"[Mlhv][^Mlhvz]*", data)
    x, y = (int(number) for number in re.findall(r"-?\d+", first))
    found = [(x, y)]
    for piece in pieces:
        numbers = [int(number) for number in re.findall(r"-?\d+", piece)]
        steps = {"h": [(n, 0) for n in numbers], "v": [(0, n) for n in numbers]}.get(piece[0])
        for dx, dy in zip(numbers[::2], numbers[1::2], strict=True) if steps is None else steps:
            x, y = x + dx, y + dy
            found.append((x, y))
    return [(x / GRID, y / GRID) for x, y in found]
