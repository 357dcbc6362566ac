"""What a page gives to its script, as the script reads it."""

from __future__ import annotations

import json
import re
from typing import Any


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
