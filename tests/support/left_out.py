"""Maps as they would be without some of their critical curves."""

from __future__ import annotations

from typing import Any

import pytest


def without_curves(monkeypatch: pytest.MonkeyPatch, *parts: str) -> None:
    """Leave out the curves whose names have one of these parts."""
    from ptmcad.certified import engine

    complete = engine.curves

    def some(*given: Any, **options: Any) -> tuple[Any, ...]:
        found = complete(*given, **options)
        return tuple(c for c in found if not any(part in c.name for part in parts))

    monkeypatch.setattr(engine, "curves", some)
