"""The model's equations, derived here once more, against the text of those that were solved.

Guarantee: potential, equations, Jacobian and conditions in the result equal, on the circle
cos^2 + sin^2 = 1 of each angle, those that follow from the description; as polynomials in all
parameters, so for every slice at once. Springs of an exact map have no free length.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import partial

from flint import fmpq_mpoly

from ptmcad.answer.regionmap import System
from ptmcad.text.expressions import constant
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.numerals import fraction_of
from ptmcad.verification.claims import Claims
from ptmcad.verification.coordinates import CoordinateRing
from ptmcad.verification.derivation import Derivation, coordinates_of, derivation_of, parameters_of
from ptmcad.verification.plane import PLANE, polynomial
from ptmcad.verification.report import Violation
from ptmcad.verification.work import START, fault_in_work

_FACTOR = r"(?:[0-9]{1,4000}(?:/[1-9][0-9]{0,3999})?|[A-Za-z][A-Za-z_0-9]{0,44}(?:\^[0-9]{1,2})?)"
_SUM = re.compile(rf"-?{_FACTOR}(?:\*{_FACTOR})*(?: [+-] {_FACTOR}(?:\*{_FACTOR})*)*", re.ASCII)

_Ratio = tuple[fmpq_mpoly, fmpq_mpoly]
"""Numerator and denominator."""


def _parsed(
    ring: CoordinateRing, names: Mapping[str, fmpq_mpoly], text: str, what: str
) -> fmpq_mpoly:
    """A sum of monomials such as ``-1/2*L1^2*k3 + rho*cos_th1``."""
    total = ring.context.constant(0)
    if len(text) > 100_000 or _SUM.fullmatch(text) is None:
        raise Violation(f"the {what} is not a sum of monomials: {text[:60]}")
    if text == "0":
        return total
    for sign, body in re.findall(r"(^-?|[+-]) ?([^ ]+)", text):
        term = ring.context.constant(-1 if sign == "-" else 1)
        for factor in body.split("*"):
            name, _, exponent = factor.partition("^")
            if name in names:
                term *= names[name] ** int(exponent or 1)
            elif name[0].isdigit() and not exponent:
                if (value := fraction_of(name)) == 0:
                    raise Violation(f"the {what} has a zero coefficient")
                term *= from_fraction(value)
            else:
                raise Violation(
                    f"the {what} names {name[:40]!r}, which is neither a parameter nor an unknown"
                )
        total += term
    return total


def check_system(claims: Claims) -> str:
    """The stored equations are those of the mechanism or system."""
    model, system = claims.model, claims.result.system
    unknowns = coordinates_of(model)
    if system.unknowns != unknowns:
        raise Violation(f"the unknowns are {system.unknowns}, not {unknowns}")
    if len(set(unknowns) | set(parameters_of(model))) != len(unknowns) + len(parameters_of(model)):
        raise Violation(
            "a parameter has the name of a coordinate, so that no text can be understood"
        )
    true = claims.derivation
    ring = true.ring
    names = dict(zip((*unknowns, *ring.names[len(unknowns) :]), ring.context.gens(), strict=True))
    parsed = partial(_parsed, ring, names)
    _check_sizes(system, true)
    for k, (text, relation) in enumerate(zip(system.relations, ring.relations, strict=True)):
        if parsed(text, f"relation {k}") != relation:
            raise Violation(f"relation {k} is {ring.text(relation)}, not {text[:60]}")
    number = 0
    if true.potential is not None:
        work = ring.normal(true.potential - parsed(system.potential, "potential"))
        if fault := fault_in_work(ring, work, true.moments, varying=True):
            where = f"in its slope by {fault}" if fault != START else f"by {ring.text(work)}"
            raise Violation(f"the stored potential differs from the mechanism's {where}")
        number += 1
    for what, text, expected in _pairs(system, true):
        difference = ring.normal(parsed(text, what) - expected)
        if not difference.is_zero():
            raise Violation(
                f"the stored {what} differs from the mechanism's by {ring.text(difference)}"
            )
        number += 1
    _check_free_lengths(claims, true)
    return f"{number} polynomials in {len(unknowns)} unknowns and {len(parameters_of(model))} parameters"


def _check_sizes(system: System, true: Derivation) -> None:
    n = len(true.equations)
    if (len(system.gradient), [len(row) for row in system.hessian]) != (n, [n] * n):
        raise Violation(f"{n} unknowns have {n} equations and a {n} x {n} matrix of derivatives")
    for what, stored, expected in (
        ("relations", system.relations, true.ring.relations),
        ("inequalities", system.inequalities, true.inequalities),
        ("conditions for stability", system.stability, true.stability),
    ):
        if len(stored) != len(expected):
            raise Violation(f"there are {len(expected)} {what}, not {len(stored)}")
    if true.potential is None and system.potential:
        raise Violation(
            "equations are given, or a moment depends on another unknown, so there is no potential"
        )


def _pairs(system: System, true: Derivation) -> Iterator[tuple[str, str, fmpq_mpoly]]:
    """Each stored polynomial: what it is, its text, and what is true."""
    for i, (text, row, equation) in enumerate(
        zip(system.gradient, system.hessian, true.equations, strict=True)
    ):
        yield true.meaning.equation.format(i), text, equation
        for j, entry in enumerate(row):
            yield true.meaning.entry.format(i, j), entry, true.jacobian[i][j]
    for k, (text, p) in enumerate(zip(system.inequalities, true.inequalities, strict=True)):
        yield f"inequality {k}", text, p
    for k, (text, p) in enumerate(zip(system.stability, true.stability, strict=True)):
        yield f"condition {k} for stability", text, p


def _check_free_lengths(claims: Claims, true: Derivation) -> None:
    """No spring has a free length on the slice; of one that is no parameter there it is zero."""
    for what, value, strict in true.required:
        if not (
            strict
            or all(numerator.is_zero() for numerator, _ in _on_slice(claims, true, value).values())
        ):
            raise Violation(f"{what} is not zero, so that the map is of another mechanism")


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
        for a, b in _on_slice(claims, true, true.ring.normal(equation)).values():
            if not a.is_zero():
                common = common.gcd(a / a.gcd(b))
        found.append(common)
    return found


def _on_slice(claims: Claims, true: Derivation, p: fmpq_mpoly) -> dict[tuple[int, ...], _Ratio]:
    """The coefficients, functions of the axes, of a polynomial in the coordinates; free lengths not
    named are zero.
    """
    nothing = constant(0)
    width = true.coordinates
    parameters = [
        claims.result.slice.parameters.get(name, nothing) for name in true.ring.names[width:]
    ]
    values = [(polynomial(e.numerator), polynomial(e.denominator)) for e in parameters]
    sums: dict[tuple[int, ...], _Ratio] = {}
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
