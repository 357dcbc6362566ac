"""What a page gives to its script, as the script reads it."""

from __future__ import annotations

import json
import re
from typing import Any

from ptmcad.show.render.polylines import GRID


def data_of(text: str) -> dict[str, Any]:
    """The page's data."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)
    assert found
    data: dict[str, Any] = json.loads(found[1])
    return data


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
