"""Tables as columns, in which equal entries are written once: what the page gives its script, in
fewer characters.

Guarantee: theme.js's ``unpacked`` gives the same rows again.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

Row = Mapping[str, Any]


def packed(rows: Sequence[Row], inner: Sequence[str] = ()) -> dict[str, Any]:
    """Rows with the same names as a mapping of columns.

    A column is ``{"of": entries}``, or ``{"of": distinct, "at": numbers}`` with the number of each
    row's entry, none at all where the distinct entry is one. One of tables is ``{"many": lengths,
    "rows": packed}``.

    Parameters
    ----------
    inner : names of entries that are such rows themselves.

    >>> packed([{"a": "equilibria", "b": 1}, {"a": "equilibria", "b": 2}])
    {'length': 2, 'columns': {'a': {'of': ['equilibria'], 'at': []}, 'b': {'of': [1, 2]}}}
    """
    columns: dict[str, Any] = {}
    for name in rows[0] if rows else ():
        entries = [row[name] for row in rows]
        if name in inner:
            flat = packed([row for entry in entries for row in entry])
            columns[name] = {"many": [len(entry) for entry in entries], "rows": flat}
        else:
            columns[name] = _column(entries)
    return {"length": len(rows), "columns": columns}


def _column(entries: list[Any]) -> dict[str, Any]:
    """Of the two ways to write a column the shorter one."""
    numbers: dict[str, int] = {}
    at = [numbers.setdefault(json.dumps(entry), len(numbers)) for entry in entries]
    distinct = {"of": [json.loads(text) for text in numbers], "at": at if len(numbers) > 1 else []}
    plain = {"of": entries}
    return min(plain, distinct, key=lambda column: len(json.dumps(column, separators=(",", ":"))))
