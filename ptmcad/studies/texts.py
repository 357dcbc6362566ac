"""What the studies say and ask, which is data beside their code."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml


def texts_beside(module: str, name: str) -> dict[str, Any]:
    """The data in a file of this name beside a module, which is given by its own file."""
    found: dict[str, Any] = yaml.safe_load(Path(module).with_name(name).read_text(encoding="utf-8"))
    return found
