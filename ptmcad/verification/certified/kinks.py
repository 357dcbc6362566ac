"""Springs whose vectors stay on one line: which they are, and on which side of length zero a configuration has them.

Guarantee: exact. Where d = s e with a fixed e, a spring's direction is e/|e| or -e/|e| wherever it has a length, so
that solutions are those of the equations with either one, at which s is positive or negative. Springs without length
are no solutions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from itertools import product

from ptmcad.verification.certified.vectors import Terms
from ptmcad.verification.certified.waves import Cone, Form

Line = tuple[Terms, Terms]
Sides = Mapping[str, int]
"""1 or -1 by the name of each spring on a line: the sign of s."""


def sides(form: Form) -> Iterator[Sides]:
    """All choices; a single empty one where no spring is on a line."""
    names = [cone.name for cone in form.cones if line_of(cone) is not None]
    for chosen in product((1, -1), repeat=len(names)):
        yield dict(zip(names, chosen, strict=True))


def line_of(cone: Cone) -> Line | None:
    """The vector e along which d stays for all values of the parameters, if there is one."""
    across, up = cone.vector
    first = next(iter(across or up))
    x, y = _simplest(across.get(first, ()), up.get(first, ()))
    for key in across.keys() | up.keys():
        if _product(across.get(key, ()), y) != _product(up.get(key, ()), x):
            return None
    return x, y


def _simplest(x: Terms, y: Terms) -> Line:
    """A vector in the same direction, or against it, without what both coordinates have in common, if that is all."""
    if not x or not y:
        one: Terms = ((1, 1, ()),)
        return (one, ()) if x else ((), one)
    p, q = _polynomial(x), _polynomial(y)
    name = next(iter(p))
    if p.keys() == q.keys() and all(p[n] * q[name] == q[n] * p[name] for n in p):
        ratio = q[name] / p[name]
        return ((ratio.denominator, 1, ()),), ((ratio.numerator, 1, ()),)
    return x, y


def _polynomial(terms: Terms) -> dict[tuple[str, ...], Fraction]:
    found: dict[tuple[str, ...], Fraction] = {}
    for p, q, names in terms:
        key = tuple(sorted(names))
        found[key] = found.get(key, Fraction(0)) + Fraction(p, q)
    return found


def _product(f: Terms, g: Terms) -> dict[tuple[str, ...], Fraction]:
    """Of two polynomials, without terms that are zero."""
    found: dict[tuple[str, ...], Fraction] = {}
    for a, factor in _polynomial(f).items():
        for b, other in _polynomial(g).items():
            key = tuple(sorted(a + b))
            found[key] = found.get(key, Fraction(0)) + factor * other
    return {key: c for key, c in found.items() if c}
