"""Functions in a process of their own, which is ended when they take too long."""

from __future__ import annotations

import os
import time

import pytest

from ptmcad.ask.timed import returns_within
from ptmcad.errors import ConfigError, expect

ENOUGH = 60.0


def test_what_is_raised_arrives_whole() -> None:
    with pytest.raises(ConfigError, match="expected a text, not 3") as caught:
        returns_within(ENOUGH, expect, 3, str, "name", "a text")
    assert caught.value.key == "name"


def test_what_takes_too_long_is_ended_and_what_dies_has_not_returned() -> None:
    before = time.monotonic()
    assert not returns_within(0.3, time.sleep, ENOUGH)
    assert time.monotonic() - before < ENOUGH / 2
    assert not returns_within(ENOUGH, os._exit, 3)
    assert returns_within(ENOUGH, time.sleep, 0)
