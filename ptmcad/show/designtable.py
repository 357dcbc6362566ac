"""The best design as text for the terminal.

Guarantee: every digit of a value is right; bounds are rounded upwards.
"""

from __future__ import annotations

from fractions import Fraction

from ptmcad.answer.design import BestDesign
from ptmcad.answer.words import sought
from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.numerals import between, decimal, equalities, percent, shortest_text

DIGITS = 10
_BOUND_DIGITS = 7
_NOTHING = Fraction(1, 10**12)
"""What a bound exceeds a value by, as a share of it, that is not worth a word."""


def design_table(found: BestDesign) -> str:
    """What was asked, the best design with its value, and what is proved, a line each."""
    rows = [("maximise", _asked(found)), ("over", ", ".join(map(_window, found.over)))]
    if found.conditions:
        rows.append(("where", " and ".join(found.conditions)))
    if found.best is None or found.value is None:
        rows.append(("best", "none: no design that was looked at has such a value"))
    else:
        rows.append(("best", equalities(found.best, shortest_text)))
        rows.append(("value", value_text(found.value) + _span(found)))
    rows.append(("proof", _proof(found)))
    rows.append(("searched", f"{found.evaluations} designs, seed {found.seed}"))
    return "\n".join(f"{head:<10}{text}" for head, text in rows)


def _asked(found: BestDesign) -> str:
    number = f"{found.working} {sought(found.model, found.working)}"
    if found.along is not None:
        return f"the range of {_window(found.along)} with {number}"
    if found.fixed:
        return f"the area with {number} in {' x '.join(map(_window, found.fixed))}"
    return f"{found.maximise}, where there are {number}"


def _window(axis: Axis) -> str:
    return f"{axis.name} in [{shortest_text(axis.low)}, {shortest_text(axis.high)}]"


def _span(found: BestDesign) -> str:
    if found.span is None or found.along is None:
        return ""
    low, high = map(value_text, found.span)
    return f", {found.along.name} from {low} to {high}"


def value_text(value: Enclosure) -> str:
    """All digits that are known, at most ten."""
    return value.settled_text(DIGITS, least=2) or between(value.low, value.high, _BOUND_DIGITS)


def _proof(found: BestDesign) -> str:
    if found.bound is None:
        return f"of the value at this design alone; {found.reason}"
    bound = decimal(found.bound, up=True, digits=_BOUND_DIGITS)
    low = found.value.low if found.value is not None else 0
    excess = found.bound / low - 1 if low > 0 else Fraction(0)
    if excess < _NOTHING:
        return f"no design has more than {bound}, {found.reason}"
    share = percent(excess)
    words = f"no design has more than {bound}, {share} more, {found.reason}"
    return (
        words if found.proved else f"{words}; not within {shortest_text(found.tolerance * 100)} %"
    )
