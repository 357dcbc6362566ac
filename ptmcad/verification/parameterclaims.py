"""Checks of the parameters: as they were written, and the curves that bound the domain of the
slice.

Guarantee: BOUNDARY components are exactly the irreducible factors of the parameters' denominators,
of lengths and stiffnesses that vary, of what is common to all coefficients of an equation, and, as
far as they are not critical, of the norms of conditions (these up to the probability of
`ptmcad.verification.norms`). On a component that is said to have infinitely many solutions there
are; where perhaps, an equation vanishes on it, or complex solutions are infinitely many at random
points of a line.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import partial
from itertools import product
from typing import TypeVar

from flint import fmpq_mpoly

from ptmcad.answer.regionmap import Continuum, Kind
from ptmcad.errors import ExpressionError
from ptmcad.model import Model
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import Expression, axis, constant
from ptmcad.text.parsing import parse
from ptmcad.text.plane import PlanePolynomial
from ptmcad.text.syntax import names_in
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import Derivation, derivation_at, derivation_of
from ptmcad.verification.fibrealgebra import NotFinite, algebra
from ptmcad.verification.norms import BITS, check_identity, condition_exponents, random_points
from ptmcad.verification.planecurves import PLANE, factors, polynomial
from ptmcad.verification.report import Violation

T = TypeVar("T")

_LINE_POINTS = 2
"""Random points of a line at which solutions are counted."""


def auxiliary(model: Model) -> tuple[str, ...]:
    """Names that may be kept as texts alone, because other texts name them.

    They are shorthands, which are no parameters of the mechanism, free lengths that are zero, and
    parameters that only a record's own expressions use.
    """
    return (*model.shorthands, *model.free_lengths, *model.idle)


def check_text(claims: Claims) -> str:
    """Each parameter as the user wrote it is the one that was computed with, and an axis stands for
    itself.
    """
    slice, model = claims.result.slice, claims.result.slice.model
    alone = slice.text.keys() - slice.parameters.keys()
    if slice.parameters.keys() - slice.text.keys() or not alone <= {*auxiliary(model)} - {
        *slice.axis_names
    }:
        raise Violation(
            "a parameter lacks the text that it was written as, or a text its parameter"
        )
    for index, name in enumerate(slice.axis_names):
        if name in slice.parameters and (slice.parameters[name] - axis(index)).numerator:
            raise Violation(f"{name} is an axis, but the parameter {name} is {_shown(slice, name)}")
    for name in sorted(alone | (model.shorthands.keys() & slice.text.keys())):
        if not any(name in named_in(n, text) for n, text in slice.text.items() if n != name):
            raise Violation(f"the parameter {name} is stored, but nothing depends on it")
    for name, expression in written(slice).items():
        if name in slice.parameters and (expression - slice.parameters[name]).numerator:
            raise Violation(
                f"{name} was written as {slice.text[name][:60]!r}, but is {_shown(slice, name)}"
            )
        if name in alone and name in model.free_lengths and expression.numerator:
            raise Violation(
                f"{name} was written as {slice.text[name][:60]!r}, but is left out as if it were zero"
            )
    return f"{len(slice.text)} parameters"


def written(slice: Slice) -> dict[str, Expression]:
    """What each text of a slice says, as functions of its axes.

    Raises
    ------
    Violation
    """
    return explained(slice.text, {name: axis(k) for k, name in enumerate(slice.axis_names)})


def explained(texts: Mapping[str, str], known: Mapping[str, Expression]) -> dict[str, Expression]:
    """What each text says, by what is known and by texts explained before it.

    Raises
    ------
    Violation
        When one is no expression, or names what is not explained.
    """
    known, found, waiting = dict(known), {}, dict(texts)
    while waiting:
        # one whose names are all known by now, so that nothing is explained by itself
        ready = next((n for n, text in waiting.items() if named_in(n, text) <= known.keys()), None)
        if ready is None:
            raise Violation(
                f"the texts kept for {', '.join(sorted(waiting))[:80]} name what is not explained"
            )
        found[ready] = _read(ready, waiting.pop(ready), partial(parse, names=known))
        known.setdefault(ready, found[ready])
    return found


def _shown(slice: Slice, name: str) -> str:
    return slice.parameters[name].to_text(slice.axis_names)[:60]


def named_in(name: str, text: str) -> set[str]:
    """The names in the text kept for one.

    Raises
    ------
    Violation
    """
    return set(_read(name, text, names_in))


def _read(name: str, text: str, reader: Callable[[str], T]) -> T:
    try:
        return reader(text)
    except ExpressionError as error:
        raise Violation(
            f"the text kept for {name[:40]!r}, {text[:40]!r}, is no expression: {error}"
        ) from error


def check_boundary(claims: Claims, seed: str) -> str:
    """The BOUNDARY components are those that the slice's expressions and the conditions ask for."""
    names = claims.result.slice.axis_names
    needed = _needed(claims)
    for factor, why in _of_conditions(claims, seed).items():
        needed.setdefault(factor, why)
    stored = {c.polynomial: c for c in claims.result.components}
    for factor, why in needed.items():
        if factor not in stored:
            raise Violation(f"{factor.text(names)} = 0 is not stored, but {why}")
        if stored[factor].kind is not Kind.BOUNDARY:
            raise Violation(
                f"{factor.text(names)} = 0 is stored as {stored[factor].kind.value}, but {why}"
            )
    for n, c in enumerate(claims.result.components):
        if c.kind is Kind.BOUNDARY and c.polynomial not in needed:
            raise Violation(
                f"component {n} is stored as boundary, but bounds nothing: {c.polynomial.text(names)[:60]}"
            )
        if c.continuum is Continuum.PROVED:
            _check_continuum(claims, n, c.polynomial)
        if c.continuum is Continuum.POSSIBLE:
            _check_possible_continuum(claims, n, c.polynomial, seed)
    return f"{len(needed)} factors of parameters and equations"


def _check_continuum(claims: Claims, number: int, curve: PlanePolynomial) -> None:
    """On a component on which an equation vanishes, or a sum of some, that is where some angles
    turn together.

    There are some where the equations are the slopes of a function on a torus, or there is no
    other.
    """
    model = claims.result.slice.model
    true = derivation_of(model)
    weights = [row for row in product((-1, 0, 1), repeat=len(model.unknowns)) if any(row)]
    vanishes = any(curve in factors(common) for common in equation_factors(claims, weights))
    if not (vanishes and true.has_minima):
        raise Violation(
            f"component {number} is said to have infinitely many solutions, which is not proved"
        )


def _check_possible_continuum(
    claims: Claims, number: int, curve: PlanePolynomial, seed: str
) -> None:
    """An equation vanishes on the component, or it is a line, and complex solutions are infinitely
    many at random points of it.
    """
    if any(curve in factors(common) for common in equation_factors(claims)):
        return
    if curve.total_degree > 1 or any(
        _has_finitely_many(claims, *at) for at in _points_of_line(curve, seed)
    ):
        raise Violation(
            f"component {number} is said to have perhaps infinitely many solutions, but has not even "
            "complex ones"
        )


def _points_of_line(line: PlanePolynomial, seed: str) -> Iterator[tuple[Fraction, Fraction]]:
    by_power = {(i, j): c for i, j, c in line.terms}
    x, y, c = (by_power.get(power, 0) for power in ((1, 0), (0, 1), (0, 0)))
    source = random.Random(f"continuum {seed}")
    for _ in range(_LINE_POINTS):
        t = Fraction(source.getrandbits(BITS), 2**BITS)
        yield (-(c + y * t) / Fraction(x), t) if x else (t, Fraction(-c, y))


def _has_finitely_many(claims: Claims, x: Fraction, y: Fraction) -> bool:
    """Whether there are finitely many complex solutions at a point, whatever inequalities say."""
    point = derivation_at(claims.model, claims.parameters_at(x, y))
    try:
        algebra(point.generators(), point.coordinates)
    except NotFinite:
        return False
    return True


def _needed(claims: Claims) -> dict[PlanePolynomial, str]:
    """The factors of parameters and equations, each with the reason why it bounds the slice."""
    bounding = {*claims.model.positive, *claims.model.nonnegative}
    needed: dict[PlanePolynomial, str] = {}
    for name, e in claims.result.slice.parameters.items():
        parts = [e.denominator]
        if name in bounding:
            parts.append(e.numerator)
        for terms in parts:
            for factor in factors(polynomial(terms)):
                needed[factor] = f"it bounds the domain of {name}"
    for k, common in enumerate(equation_factors(claims)):
        for factor in factors(common):
            needed.setdefault(factor, f"equation {k} vanishes on it")
    return needed


def _of_conditions(claims: Claims, seed: str) -> dict[PlanePolynomial, str]:
    """The components on which a condition's norm vanishes, but not that of det H, each with the
    reason.
    """
    found: dict[PlanePolynomial, str] = {}
    conditions = condition_exponents(claims, seed)
    if not conditions:
        return found
    _, critical = check_identity(claims, random_points(claims, seed, BITS))
    for k, exponents in enumerate(conditions):
        for c, e, of_jacobian in zip(claims.result.components, exponents, critical, strict=True):
            if e > 0 and of_jacobian < 1:
                found.setdefault(c.polynomial, f"the norm of condition {k} vanishes on it")
    return found


Quotient = tuple[fmpq_mpoly, fmpq_mpoly]
"""Numerator and denominator."""


def equation_factors(claims: Claims, weights: Sequence[Sequence[int]] = ()) -> list[fmpq_mpoly]:
    """For each equation on the slice, or sum of some by weights, the common factor of its
    coefficients in Q[x, y].
    """
    true = derivation_of(claims.model)
    found = []
    sums = [
        sum((w * e for w, e in zip(row, true.equations, strict=True)), 0 * true.equations[0])
        for row in weights
    ]
    for equation in sums or true.equations:
        common = PLANE.constant(0)
        for a, b in on_slice(claims, true, true.ring.normal(equation)).values():
            if not a.is_zero():
                common = common.gcd(a / a.gcd(b))
        found.append(common)
    return found


def on_slice(claims: Claims, true: Derivation, p: fmpq_mpoly) -> dict[tuple[int, ...], Quotient]:
    """The coefficients, functions of the axes, of a polynomial in the coordinates; free lengths not
    named are zero.
    """
    nothing = constant(0)
    width = true.coordinates
    parameters = [
        claims.result.slice.parameters.get(name, nothing) for name in true.ring.names[width:]
    ]
    values = [(polynomial(e.numerator), polynomial(e.denominator)) for e in parameters]
    sums: dict[tuple[int, ...], Quotient] = {}
    for powers, c in p.terms():
        numerator, denominator = PLANE.constant(c), PLANE.constant(1)
        for value, e in zip(
            values, powers[width:], strict=False
        ):  # X-joints' second bars come last
            if e:
                numerator, denominator = numerator * value[0] ** e, denominator * value[1] ** e
        a, b = sums.get(powers[:width], (PLANE.constant(0), PLANE.constant(1)))
        sums[powers[:width]] = (a * denominator + numerator * b, b * denominator)
    return sums
