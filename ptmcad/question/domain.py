"""The domain of the geometry: what each parameter of the mechanism needs to be in the whole open window.

So does each stiffness and free length that is an expression of parameters, written where a spring has it.

Guarantee: `prove` returns only when all of them are, by proof, what they need to be: hypotheses (H1) and (H2) of
docs/soundness.md. Nothing is concluded from not having found a counterexample.
"""

from __future__ import annotations

from collections.abc import Mapping

from ptmcad.errors import ExpressionError, GeometryError
from ptmcad.model import Kind, Model
from ptmcad.model.elements import Part
from ptmcad.question.positivity import Axes, Need, Undecided, Witness, decide, named, number, place
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import Expression, constant
from ptmcad.text.parsing import value_in_axes

MAX_DEGREE = 32
"""Of a parameter in the two axes; F3 = F^24 takes a minute and a half, and a dense polynomial far more."""


def need(kind: Kind, expression: Expression) -> Need:
    """What a parameter needs to be, besides having no pole."""
    # a base is positive, or zero everywhere
    if kind.is_positive or (kind is Kind.BASE and expression.numerator):
        return Need.POSITIVE
    return Need.NOT_NEGATIVE if kind.may_vanish else Need.NO_POLE


def fault(name: str, kind: Kind, expression: Expression, axes: Axes, max_work: int | None = None) -> str:
    """What a point of the window contradicts, in words; empty when there is no such point, or none was found.

    Parameters
    ----------
    max_work : see `ptmcad.question.positivity.decide`.
    """
    pole = decide(expression, axes, Need.NO_POLE, max_work)
    if isinstance(pole, Witness):
        return f"division by zero inside the window: the denominator of {name} vanishes {_pole_place(pole, axes)}"
    verdict = decide(expression, axes, need(kind, expression), max_work)
    if isinstance(verdict, Witness):
        value = number(verdict.value)
        least = "not be negative" if need(kind, expression) is Need.NOT_NEGATIVE else "be positive"
        return (
            f"a {kind.noun} must {least} in the whole window, but {name} is {value} {place(verdict, axes)}: "
            "narrow the window"
        )
    return ""


def unproved(name: str, kind: Kind, expression: Expression, axes: Axes, max_work: int | None = None) -> str:
    """What is not proved of a parameter, in words; empty when all is.

    Parameters
    ----------
    max_work : see `ptmcad.question.positivity.decide`.
    """
    for asked in dict.fromkeys((Need.NO_POLE, need(kind, expression))):
        verdict = decide(expression, axes, asked, max_work)
        if isinstance(verdict, Undecided):
            return (
                f"it is not proved that {name} is {asked.value} in the whole window: its sign is not decided "
                f"{place(verdict, axes)}; narrow the window or simplify the expression"
            )
    return ""


def prove(model: Model, parameters: Mapping[str, Expression], axes: Axes) -> None:
    """Prove of every parameter that it is in the whole open window what it needs to be, and of what springs are given.

    Raises
    ------
    GeometryError
        With the parameter, or the part of the description, and the place where it is not, or where that could not be
        decided.
    """
    for name, expression in parameters.items():
        kind = model.kind(name)
        problem = fault(name, kind, expression, axes) or unproved(name, kind, expression, axes)
        if problem:
            raise GeometryError(problem, parameter=name)
    for part in model.parts:
        problem = fault_of_part(model, part, parameters, axes) or unproved_of_part(model, part, parameters, axes)
        if problem:
            raise GeometryError(problem, part=part.key)


def fault_of_part(
    model: Model, part: Part, parameters: Mapping[str, Expression], axes: Axes, max_work: int | None = None
) -> str:
    """The same as `fault` of what a spring is given: a stiffness or a free length that is written there."""
    try:
        value = value_of_part(model, part, parameters)
    except ExpressionError as error:
        return f"cannot be judged: {error.message}"
    if value.is_constant:
        return part.fault(value.constant())
    if value.degree > MAX_DEGREE:
        return f"{part.text} has degree {value.degree} in the axes: at most {MAX_DEGREE} can be computed"
    return fault(part.text, part.kind, value, axes, max_work)


def unproved_of_part(
    model: Model, part: Part, parameters: Mapping[str, Expression], axes: Axes, max_work: int | None = None
) -> str:
    """The same as `unproved` of what a spring is given, of which `fault_of_part` has found nothing."""
    return unproved(part.text, part.kind, value_of_part(model, part, parameters), axes, max_work)


def value_of_part(model: Model, part: Part, parameters: Mapping[str, Expression]) -> Expression:
    """What a spring is given, as a function of the axes; free lengths that a slice does not name are zero.

    Raises
    ------
    ExpressionError
        When it is too large.
    """
    return value_in_axes(part.tree, {**dict.fromkeys(model.free_lengths, constant(0)), **parameters})


def prove_slice(slice: Slice) -> None:
    """The same for a slice."""
    prove(slice.model, slice.parameters, slice.axes)


def _pole_place(pole: Witness, axes: Axes) -> str:
    if pole.other is None:
        return place(pole, axes)
    return f"between {named(pole.other, axes)} and {named(pole.point, axes)}"
