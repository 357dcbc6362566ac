"""The stored potential at one point: a polynomial in the cosines and sines of the angles with
rational coefficients.

Guarantee: the coefficients are exact. A text that is no polynomial in the known names is refused.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction

from ptmcad.answer.regionmap import System
from ptmcad.errors import ConfigError
from ptmcad.show.report.bounds import Bounds, exactly
from ptmcad.text.numerals import Numbers, fraction_of

Potential = Mapping[tuple[int, ...], Fraction]
"""Exponents of the system's unknowns to coefficients."""

_TERM = re.compile(r"(^-?|[+-]) ?([^ ]+) ?")
_MAX_CHARACTERS = 100_000
"""Characters of a potential, which has some hundred."""
_EXPONENT = re.compile(r"[1-9][0-9]?", re.ASCII)


def potential_at(system: System, values: Numbers) -> Potential:
    """The potential with numbers for the parameters.

    Raises
    ------
    ConfigError
        When the text is not a sum of products of numbers, parameters and unknowns.
    """
    text = system.potential
    if len(text) > _MAX_CHARACTERS or "".join(m[0] for m in _TERM.finditer(text)) != text:
        raise ConfigError("the stored potential is not a polynomial", key="system.potential")
    found: dict[tuple[int, ...], Fraction] = {}
    for sign, body in _TERM.findall(text):
        exponents = [0] * len(system.unknowns)
        coefficient = Fraction(-1 if sign == "-" else 1)
        for factor in body.split("*"):
            name, hat, exponent = factor.partition("^")
            if hat and not _EXPONENT.fullmatch(exponent):
                raise ConfigError(f"{factor[:40]!r} is not a power", key="system.potential")
            times_taken = int(exponent) if hat else 1
            if name in system.unknowns:
                exponents[system.unknowns.index(name)] += times_taken
            elif name in values:
                coefficient *= values[name] ** times_taken
            else:
                coefficient *= _number(factor)
        key = tuple(exponents)
        found[key] = found.get(key, Fraction(0)) + coefficient
    return {key: c for key, c in found.items() if c}


def _number(text: str) -> Fraction:
    try:
        return fraction_of(text)
    except ValueError as error:
        raise ConfigError(
            f"{text[:40]!r} is neither a number nor a known name", key="system.potential"
        ) from error


def energy(potential: Potential, unknowns: tuple[Bounds, ...]) -> Bounds:
    """Bounds of the potential's value."""
    total = exactly(0)
    for exponents, coefficient in potential.items():
        term = exactly(coefficient)
        for value, exponent in zip(unknowns, exponents, strict=True):
            term = term * value**exponent if exponent else term
        total = total + term
    return total
