"""Cases that the fast tests keep, of many that run one path on other data."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def few(cases: Iterable[Any], *kept: Any) -> list[Any]:
    """All cases as parameters of a test; those that are not kept are slow."""
    found = list(cases)
    assert all(case in found for case in kept), f"{kept} are not all among {found}"
    return [case if case in kept else pytest.param(case, marks=pytest.mark.slow) for case in found]
