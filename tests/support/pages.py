"""What a page gives to its script, as the script reads it."""

from __future__ import annotations

import json
import re
from itertools import accumulate
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
    assert re.fullmatch(r"M-?\d+[ -]\d+l-?\d+(?:(?: |(?=-))-?\d+)*z?", data), data
    numbers = [int(number) for number in re.findall(r"-?\d+", data)]
    places = zip(accumulate(numbers[::2]), accumulate(numbers[1::2]), strict=True)
    return [(x / GRID, y / GRID) for x, y in places]
