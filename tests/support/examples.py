"""How many examples hypothesis draws: few in the fast suite, and all where ``make test-slow`` asks
for them.
"""

from __future__ import annotations

from hypothesis import settings

FAST, THOROUGH = "fast", "thorough"
"""The names of the profiles."""
ALL = 100
"""What a test draws in the thorough profile that asks for no number of its own."""
FEW = 12
"""The same in the fast one."""


def examples(number: int) -> int:
    """A test's own number, less in the fast profile by as much as that of a test without one."""
    return max(1, number * settings().max_examples // ALL)
