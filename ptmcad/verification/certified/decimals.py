"""Decimal numbers in stored formulas as quotients of integers: a parser of Python would round them.

Guarantee: exact.
"""

from __future__ import annotations

import re

_DECIMAL = re.compile(
    r"(?<![A-Za-z0-9_.])([0-9]{1,60})(?:\.([0-9]{1,60}))?(?:e([+-]?[0-9]{1,3}))?(?![A-Za-z0-9_.])",
    re.ASCII,
)


def in_quotients(text: str) -> str:
    """A formula without decimal numbers.

    >>> in_quotients("0.5*x1 + 2e-3 - 12*x")
    '(5/10)*x1 + (2/1000) - 12*x'
    """
    return _DECIMAL.sub(_quotient, text)


def _quotient(number: re.Match[str]) -> str:
    whole, behind, exponent = number.groups()
    if behind is None and exponent is None:
        return str(whole)
    shift = int(exponent or 0) - len(behind or "")
    digits = int(whole + (behind or ""))
    return f"({digits * 10**shift})" if shift >= 0 else f"({digits}/{10**-shift})"
