"""The mechanism's equations, derived here once more, against the text of those that were solved.

Guarantee: potential, gradient and Hessian in the result equal, on the torus cos^2 + sin^2 = 1 of each angle, those that
follow from the coordinates of the nodes; as polynomials in all parameters, so for every slice at once.
"""

from __future__ import annotations

import re
from functools import cache

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx, fmpz_mpoly

from ptmcad.answer.regionmap import System
from ptmcad.text.numerals import fraction_of
from ptmcad.verification.claims import PLANE, Claims
from ptmcad.verification.derivation import ANGLES, PARAMETERS, UNKNOWNS, Configuration, potential
from ptmcad.verification.report import Violation

_RING: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get((*UNKNOWNS, *PARAMETERS), Ordering.lex)
_NAMES = (*UNKNOWNS, *PARAMETERS)
_FACTOR = r"(?:[0-9]{1,40}(?:/[1-9][0-9]{0,39})?|[A-Za-z][A-Za-z_0-9]{0,40}(?:\^[0-9]{1,2})?)"
_SUM = re.compile(rf"-?{_FACTOR}(?:\*{_FACTOR})*(?: [+-] {_FACTOR}(?:\*{_FACTOR})*)*", re.ASCII)


def _variable(name: str) -> fmpq_mpoly:
    return _RING.gen(_NAMES.index(name))


def _on_torus(p: fmpq_mpoly) -> fmpq_mpoly:
    """The normal form modulo the circles: at most the first power of each cosine."""
    for relation in _relations():
        p = divmod(p, relation)[1]
    return p


@cache
def _relations() -> tuple[fmpq_mpoly, ...]:
    return tuple(c * c + s * s - 1 for c, s in _circles().values())


def _circles() -> dict[str, tuple[fmpq_mpoly, fmpq_mpoly]]:
    return {angle: (_variable(f"cos_{angle}"), _variable(f"sin_{angle}")) for angle in ANGLES}


@cache
def _potential() -> fmpq_mpoly:
    energy: fmpq_mpoly = potential(Configuration({name: _variable(name) for name in PARAMETERS}, _circles()))
    return energy


def _by_angle(p: fmpq_mpoly, angle: int) -> fmpq_mpoly:
    c, s = UNKNOWNS[2 * angle], UNKNOWNS[2 * angle + 1]
    return _variable(c) * p.derivative(s) - _variable(s) * p.derivative(c)


def _parsed(text: str, what: str) -> fmpq_mpoly:
    """A sum of monomials such as ``-1/2*L1^2*k3 + rho*cos_th1``."""
    total = _RING.constant(0)
    if len(text) > 100_000 or _SUM.fullmatch(text) is None:
        raise Violation(f"the {what} is not a sum of monomials: {text[:60]}")
    for sign, body in re.findall(r"(^-?|[+-]) ?([^ ]+)", text):
        term = _RING.constant(-1 if sign == "-" else 1)
        for factor in body.split("*"):
            name, _, exponent = factor.partition("^")
            if name in _NAMES:
                term *= _variable(name) ** int(exponent or 1)
            elif name[0].isdigit() and not exponent:
                if (value := fraction_of(name)) == 0:
                    raise Violation(f"the {what} has a zero coefficient")
                term *= fmpq(value.numerator, value.denominator)
            else:
                raise Violation(f"the {what} names {name[:40]!r}, which is neither a parameter nor an unknown")
        total += term
    return total


def check_system(claims: Claims) -> str:
    """The stored equations are those of the mechanism."""
    system: System = claims.result.system
    if system.unknowns != UNKNOWNS:
        raise Violation(f"the unknowns are {system.unknowns}, not {UNKNOWNS}")
    if (len(system.relations), len(system.gradient), [len(row) for row in system.hessian]) != (2, 2, [2, 2]):
        raise Violation("two angles have two relations, two equations and a 2 x 2 Hessian")
    for k, (text, relation) in enumerate(zip(system.relations, _relations(), strict=True)):
        if _parsed(text, f"relation {k}") != relation:
            raise Violation(f"relation {k} is {relation}, not {text[:60]}")
    energy = _potential()
    expected = [("potential", system.potential, energy)]
    for i in (0, 1):
        first = _by_angle(energy, i)
        expected.append((f"gradient's entry {i}", system.gradient[i], first))
        expected += [(f"Hessian's entry {i},{j}", system.hessian[i][j], _by_angle(first, j)) for j in (0, 1)]
    for what, text, true in expected:
        difference = _on_torus(_parsed(text, what) - true)
        if not difference.is_zero():
            raise Violation(f"the stored {what} differs from the mechanism's by {str(difference)[:80]}")
    return f"{len(expected)} polynomials in {len(UNKNOWNS)} unknowns and {len(PARAMETERS)} parameters"


def equation_factors(claims: Claims) -> list[fmpz_mpoly]:
    """For each entry of the gradient on the slice, the common factor of its coefficients in Z[x, y]."""
    parameters = claims.result.slice.parameters
    plane: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(("u", "v"), Ordering.lex)

    def polynomial(terms: object) -> fmpq_mpoly:
        return plane.from_dict({(i, j): fmpq(c.numerator, c.denominator) for i, j, c in terms})  # type: ignore[attr-defined]

    values = {n: (polynomial(parameters[n].numerator), polynomial(parameters[n].denominator)) for n in PARAMETERS}
    found = []
    for angle in (0, 1):
        sums: dict[tuple[int, ...], tuple[fmpq_mpoly, fmpq_mpoly]] = {}
        for exponents, c in _on_torus(_by_angle(_potential(), angle)).to_dict().items():
            powers = [int(e) for e in exponents]
            numerator, denominator = plane.constant(c), plane.constant(1)
            for name, e in zip(PARAMETERS, powers[len(UNKNOWNS) :], strict=True):
                numerator, denominator = numerator * values[name][0] ** e, denominator * values[name][1] ** e
            unknown = tuple(powers[: len(UNKNOWNS)])
            a, b = sums.get(unknown, (plane.constant(0), plane.constant(1)))
            sums[unknown] = (a * denominator + numerator * b, b * denominator)
        common = plane.constant(0)
        for a, b in sums.values():
            if not a.is_zero():
                common = common.gcd(a / a.gcd(b))
        found.append(PLANE.from_dict({m: int(c) for m, c in _integral(common).items()}))
    return found


def _integral(p: fmpq_mpoly) -> dict[tuple[int, int], int]:
    scale = 1
    for c in p.coeffs():
        scale = scale * int(c.q)
    return {(int(m[0]), int(m[1])): int((c * scale).p) for m, c in p.to_dict().items()}
