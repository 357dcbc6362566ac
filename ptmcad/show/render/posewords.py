"""Equilibria in words: kinds, numbers as they are printed, and where they are.

Guarantee: every digit of an enclosed number is certified; a parameter is given exactly, or after the
sign for what is rounded.
"""

from __future__ import annotations

import textwrap
from fractions import Fraction

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.words import counted, noun
from ptmcad.model import Model
from ptmcad.model.criterion import critical_point
from ptmcad.show.posetable import point_texts
from ptmcad.show.render.axes import symbol
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import power_of_ten, shortest_text

_DIGITS = 6
_MAX_VALUE = 14
"""Longer values of parameters are rounded in the title."""


def kind(pose: Pose) -> str:
    """What an equilibrium is, in words; just that where nothing says what is stable."""
    if pose.multiplicity > 1:
        return f"degenerate, multiplicity {pose.multiplicity}"
    if pose.index is None:
        return {True: "stable", False: "unstable", None: "equilibrium"}[pose.stable]
    return (
        "stable (minimum)" if pose.index == 0 else critical_point(pose.index, len(pose.eigenvalues))
    )


def number_text(number: Enclosure) -> str:
    """A certified number rounded to nearest, as it is printed."""
    return printed_number(number.text(1 if number.told_digits(_DIGITS) is None else _DIGITS))


def printed_number(text: str) -> str:
    """A number as print has it: a true minus, and powers of ten as such."""
    if " ± " in text:
        return " ± ".join(map(printed_number, text.split(" ± ")))
    mantissa, _, exponent = text.replace("-", "−").partition("e")
    if not exponent:
        return mantissa
    power = power_of_ten(int(exponent.replace("−", "-")))
    return {"1": power, "−1": f"−{power}"}.get(mantissa, f"{mantissa}·{power}")


def value_text(value: Fraction) -> str:
    """A parameter's value, exactly where that is short, else rounded and after the sign for it."""
    text = shortest_text(value)
    if len(text) <= _MAX_VALUE and abs(value) < 10**7:
        return f"=\N{NO-BREAK SPACE}{printed_number(text)}"
    known = Enclosure(value, value)
    rounded = known.text(7)
    exact = Fraction(rounded) == value
    return f"{'=' if exact else '≈'}\N{NO-BREAK SPACE}{printed_number(rounded)}"


def assigned(name: str, value: Fraction) -> str:
    """A parameter and its value, which no line break parts."""
    return f"{symbol(name)}\N{NO-BREAK SPACE}{value_text(value)}"


def heading(poses: Poses, columns: int) -> list[str]:
    """The title's lines: where the equilibria are."""
    at = ",  ".join(point_texts(poses, assigned))
    return textwrap.wrap(
        f"{_count(poses)} at {at}" if at else _count(poses).rstrip(","), max(columns, 30)
    )


def _count(poses: Poses) -> str:
    if not poses.equilibria:
        return noun(poses.model).capitalize()
    stable = "" if poses.known_stable is None else f", {poses.known_stable} stable,"
    return f"{counted(poses.model, len(poses.equilibria))}{stable}"


def describe(poses: Poses) -> str:
    """What the picture shows, in words."""
    parts = [
        f"{n}: {kind(p)}{', flat' if p.flat else ''}, "
        + ("" if p.energy is None else f"U {number_text(p.energy)}, ")
        + _unknowns_in_words(poses.model, p)
        for n, p in enumerate(poses.in_order, 1)
    ]
    return (
        f"{noun(poses.model).capitalize()} of the {poses.model.record_key}, {', '.join(point_texts(poses, assigned))}. "
        + "; ".join(parts)
        + poses.remark
    )


def _unknowns_in_words(model: Model, pose: Pose) -> str:
    """Without signs that a screen reader does not know."""
    angles = [
        f"{'theta' + name[2:] if name[:2] == 'th' and name[2:].isdigit() else name} {number_text(a)}"
        for name, a in zip(model.angles, pose.degrees, strict=True)
    ]
    reals = [f"{name} {number_text(x)}" for name, x in zip(model.reals, pose.reals, strict=True)]
    return ", ".join(([", ".join(angles) + " degrees"] if angles else []) + reals)
