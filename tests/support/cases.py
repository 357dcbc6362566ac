"""Tables of cases that are plain data, in tests/data/cases: a file for a module of tests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

FOLDER = Path(__file__).resolve().parents[1] / "data" / "cases"


def cases(file: str, table: str) -> list[Any]:
    """The rows of a table as parameters of a test; where each has a name, this is its id."""
    rows = yaml.safe_load((FOLDER / f"{file}.yaml").read_text(encoding="utf-8"))[table]
    if isinstance(rows, dict):
        return [pytest.param(*row, id=name) for name, row in rows.items()]
    return list(rows)
