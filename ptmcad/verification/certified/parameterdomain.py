"""The signs of a slice's parameters in the whole window, and their values over a box of it, in
balls.

Guarantee: what is said to be proved of signs is; a ball has the values at all points of the box.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress

from flint import fmpq

from ptmcad.errors import ExpressionError
from ptmcad.model import Kind
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import Expression, axis
from ptmcad.text.flint_numbers import interval_of
from ptmcad.verification.claims import Claims
from ptmcad.verification.coordinates import evaluated, monomials
from ptmcad.verification.derivation import derivation_of
from ptmcad.verification.normalform.waves import form_of
from ptmcad.verification.parameterclaims import auxiliary, written
from ptmcad.verification.report import Unchecked, Violation
from ptmcad.verification.windowsigns import Sign, has_no_pole, is_in_domain


def check_domain(claims: Claims) -> str:
    """Every parameter is in the whole open window what the geometry and the engines' proofs ask
    for.

    So are k and l0 where others are only written with them: a record is refused for their signs
    too.

    Returns
    -------
    What was proved, and of which parameters it was not.
    """
    slice = claims.result.slice
    window = (interval_of(slice.axes[0]), interval_of(slice.axes[1]))
    unchecked, asked = [], _expressions(slice)
    for what, expression, strict in (*_of_parameters(slice, asked), *_of_polynomials(claims)):
        pole = sign = Sign.UNCHECKED
        if expression is not None:
            pole = sign = has_no_pole(expression, window)
            if pole is Sign.WRONG:
                raise Violation(f"{what} has a pole in the window")
            if strict is not None:
                sign = is_in_domain(expression, window, strict)
        if sign is Sign.WRONG:
            how = "not positive" if strict else "negative"
            raise Violation(f"{what} is {how} somewhere in the window")
        if Sign.UNCHECKED in (pole, sign):
            unchecked.append(what)
    if unchecked:
        return Unchecked(
            f"{', '.join(unchecked)}: of too high degree, or zero at a point where that could not be decided"
        )
    return f"{len(asked)} parameters"


_Question = tuple[str, Expression | None, bool | None]
"""Whether something, a function if it is not too long, is positive (True), or not negative (False);
None where it only has to have no pole."""


def _of_parameters(slice: Slice, asked: Mapping[str, Expression]) -> Iterator[_Question]:
    for name, expression in asked.items():
        kind = slice.model.kind(name)
        strict = kind.is_positive or (kind is Kind.BASE and bool(expression.numerator))
        yield name, expression, strict if kind.is_positive or kind.may_vanish else None


def _of_polynomials(claims: Claims) -> Iterator[_Question]:
    """Of the stiffnesses and free lengths written in springs.

    So of stiffness times free length where it pulls: if that is negative, a spring without length
    is a minimum that is not smooth, and is not counted.
    """
    zero, slice = 0 * axis(0), claims.result.slice
    model, true = slice.model, derivation_of(slice.model)
    known, names = (
        {name: zero for name in model.free_lengths} | dict(slice.parameters),
        true.ring.names,
    )
    right = {
        strict: [*model.positive, *(() if strict else model.nonnegative)]
        for strict in (True, False)
    }
    asked = [
        (what, p, names, strict)
        for what, p, strict in true.required
        # as a parameter, or nothing is
        if list(monomials(p, names)) not in [[(fmpq(1), [(name, 1)])] for name in right[strict]]
    ]
    if claims.result.cover is not None:
        asked += [
            (f"stiffness times free length of spring {c.name}", c.pull, (), False)
            for c in form_of(slice).cones
        ]
    for what, p, variables, strict in asked:
        expression = None
        with suppress(ExpressionError):  # too long to be multiplied out
            expression = evaluated(p, known, variables) + zero
        yield what, expression, strict


def _expressions(slice: Slice) -> dict[str, Expression]:
    """The parameters, and k or l0 (or a free length that is zero) where only an axis or a text
    mentions it.
    """
    named = {
        name: axis(index)
        for index, name in enumerate(slice.axis_names)
        if name in auxiliary(slice.model)
    }
    return {**named, **written(slice), **slice.parameters}
