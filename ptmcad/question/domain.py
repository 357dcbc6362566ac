"""The domain of the geometry: what each parameter of the mechanism needs to be in the whole open
window.

So does each stiffness and free length that is an expression of parameters, written where a spring
has it.

Guarantee: `proved` returns only when all of them are, by proof, what they need to be: hypotheses
(H1) and (H2) of docs/soundness.md. Nothing is concluded from not having found a counterexample.
What is proved is proved once: the slice that is returned carries it, as one does that was read from
a record, and it is looked up there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from ptmcad.errors import ExpressionError, GeometryError
from ptmcad.model import Kind, Model
from ptmcad.model.elements import Part
from ptmcad.question.positivity import Need, decide, middle_of, named, number, place, window_of
from ptmcad.question.slice import PROVED, Axes, Finding, Slice, Subject, Witness
from ptmcad.text.expressions import Expression, Expressions, constant
from ptmcad.text.parsing import value_in_axes

_NOTHING: Mapping[Subject, Finding] = {}
MAX_DEGREE = 32
"""Of a parameter in the two axes; F3 = F^24 takes a minute and a half, and a dense polynomial far
more.
"""


def need(kind: Kind, expression: Expression) -> Need:
    """What a parameter needs to be, besides having no pole."""
    # a base is positive, or zero everywhere
    if kind.is_positive or (kind is Kind.BASE and expression.numerator):
        return Need.POSITIVE
    return Need.NOT_NEGATIVE if kind.may_vanish else Need.NO_POLE


def sign_of(subject: Subject, axes: Axes) -> Finding:
    """The sign of a subject: a pole or a point that contradicts it, or else what is proved."""
    found = Finding(subject, window_of(axes), PROVED)
    for asked in dict.fromkeys((Need.NO_POLE, need(subject.kind, subject.value))):
        verdict = decide(subject.value, axes, asked)
        if isinstance(verdict, Witness):
            return found._replace(
                verdict=verdict, problem=_refutation(subject, asked, verdict, axes), is_final=True
            )
        if verdict != PROVED and not found.problem:
            problem = (
                f"it is not proved that {subject.text} is {asked.value} in the whole window: its sign is not decided "
                f"{place(verdict, axes)}; narrow the window or simplify the expression"
            )
            found = found._replace(verdict=verdict, problem=problem, is_final=False)
    return found


def _refutation(subject: Subject, asked: Need, witness: Witness, axes: Axes) -> str:
    name = subject.text
    if asked is Need.NO_POLE:
        where = place(witness, axes)
        if witness.other is not None:
            where = f"between {named(witness.other, axes)} and {named(witness.point, axes)}"
        return f"division by zero inside the window: the denominator of {name} vanishes {where}"
    least = "not be negative" if asked is Need.NOT_NEGATIVE else "be positive"
    return (
        f"a {subject.kind.noun} must {least} in the whole window, but {name} is {number(witness.value)} "
        f"{place(witness, axes)}: narrow the window"
    )


def sign_of_part(
    model: Model,
    part: Part,
    parameters: Expressions,
    axes: Axes,
    known: Mapping[Subject, Finding] = _NOTHING,
) -> Finding:
    """The same of what a spring is given; free lengths that a slice does not name are zero.

    Parameters
    ----------
    known : signs in this window that need not be proved again.
    """
    window = window_of(axes)
    subject = Subject(part.text, part.kind, constant(0), part.key)
    try:
        value = value_in_axes(
            part.tree, {**dict.fromkeys(model.free_lengths, constant(0)), **parameters}
        )
    except ExpressionError as error:
        return Finding(subject, window, (window,), f"cannot be judged: {error.message}")
    subject = subject._replace(value=value)
    if value.is_constant:
        problem = part.fault(value.constant())
        verdict = Witness(middle_of(window), value.constant()) if problem else PROVED
        return Finding(subject, window, verdict, problem)
    if value.degree > MAX_DEGREE:
        problem = f"{part.text} has degree {value.degree} in the axes: at most {MAX_DEGREE} can be computed"
        return Finding(subject, window, (window,), problem)
    return known.get(subject) or sign_of(subject, axes)


def signs_of(slice: Slice) -> Iterator[Finding]:
    """The signs of all parameters of a slice, and of what its springs are given: as it carries
    them, or proved here.
    """
    window, final = window_of(slice.axes), dict[Subject, Finding]()
    final.update(
        (sign.subject, sign) for sign in slice.signs if sign.is_final and sign.window == window
    )
    for name, value in slice.parameters.items():
        subject = Subject(name, slice.model.kind(name), value)
        yield final.get(subject) or sign_of(subject, slice.axes)
    for part in slice.model.parts:
        yield sign_of_part(slice.model, part, slice.parameters, slice.axes, known=final)


def proved(slice: Slice) -> Slice:
    """The slice, which carries the proof that every subject is in the whole open window what it
    needs to be.

    Raises
    ------
    GeometryError
        With the parameter, or the part of the description, and the place where it is not, or where
        that could not be decided.
    """
    found = []
    for sign in signs_of(slice):
        if sign.problem:
            name, part = sign.subject.text, sign.subject.part
            raise GeometryError(sign.problem, parameter="" if part else name, part=part)
        found.append(sign)
    return replace(slice, signs=tuple(found))
