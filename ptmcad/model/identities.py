"""Polynomials in which identities of descriptions are decided, and the coordinates of a mechanism's
points as such.

Guarantee: exact; in Q[parameters, lengths][cos, sin], reduced by cos^2 + sin^2 = 1, so that equal
functions are equal.

The ring is a small one of its own: readers and checkers load no algebra.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from itertools import product

from ptmcad.errors import ExpressionError
from ptmcad.model.description import Mechanism
from ptmcad.model.elements import squared_distance
from ptmcad.model.evaluate import Named, evaluated
from ptmcad.text.tree import Name, Tree, names_of, replaced

MAX_WORK = 12_000
"""Products of terms for one question, a fraction of a second; two bars and a spring take some
hundred.
"""

Monomial = tuple[tuple[str, int], ...]
"""Variables with their exponents, in order; the cosine of an angle is ``cos NAME``, its exponent at
most 1.
"""


class Polynomial:
    """An element of the ring; it changes only while it is made."""

    __slots__ = ("ring", "terms")

    def __init__(self, ring: PolynomialRing, terms: dict[Monomial, Fraction]):
        self.ring = ring
        self.terms = terms

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Polynomial) and self.terms == other.terms

    def __hash__(self) -> int:
        return hash(frozenset(self.terms.items()))

    def __add__(self, other: Polynomial) -> Polynomial:
        return self._collected((*self.terms.items(), *other.terms.items()))

    def __sub__(self, other: Polynomial) -> Polynomial:
        return self + -other

    def __neg__(self) -> Polynomial:
        return Polynomial(self.ring, {m: -c for m, c in self.terms.items()})

    def _collected(self, terms: Iterable[tuple[Monomial, Fraction]]) -> Polynomial:
        """The sum of terms that need not be different."""
        found, zero = dict[Monomial, Fraction](), Fraction(0)
        for monomial, c in terms:
            found[monomial] = found.get(monomial, zero) + c
        return Polynomial(self.ring, {m: c for m, c in found.items() if c})

    def __mul__(self, other: Polynomial) -> Polynomial:
        self.ring.spend(len(self.terms) * len(other.terms))
        pairs = product(self.terms.items(), other.terms.items())
        return self._collected((term for (m, a), (n, b) in pairs for term in _product(m, n, a * b)))

    def derivative(self, unknown: str) -> Polynomial:
        """By an unknown, on the line or on the circle."""
        others = {
            unknown: "",
            f"cos {unknown}": f"sin {unknown}",
            f"sin {unknown}": f"cos {unknown}",
        }
        slopes = list[tuple[Monomial, Fraction]]()
        for monomial, c in self.terms.items():
            for variable, e in monomial:
                if variable in others:
                    lower = tuple(
                        (v, n - (v == variable)) for v, n in monomial if v != variable or n > 1
                    )
                    own = ((others[variable], 1),) if others[variable] else ()
                    slopes += _product(lower, own, c * (-e if variable.startswith("cos ") else e))
        return self._collected(slopes)


class PolynomialRing:
    """Q[parameters, lengths][cos, sin], as a ring in which trees have values; it stops after so
    much work.
    """

    def __init__(self, most: int = MAX_WORK) -> None:
        self.work = 0
        self.most = most

    def spend(self, work: int) -> None:
        """Note work.

        Raises
        ------
        ExpressionError
            When it is too much.
        """
        self.work += work
        if self.work > self.most:
            raise ExpressionError("the expressions are too large to be multiplied out")

    def constant(self, value: Fraction) -> Polynomial:
        return Polynomial(self, {(): value} if value else {})

    def variable(self, name: str) -> Polynomial:
        return Polynomial(self, {((name, 1),): Fraction(1)})

    parameter = variable

    def cos(self, angle: str) -> Polynomial:
        return self.variable(f"cos {angle}")

    def sin(self, angle: str) -> Polynomial:
        return self.variable(f"sin {angle}")


def _product(one: Monomial, two: Monomial, c: Fraction) -> Iterator[tuple[Monomial, Fraction]]:
    """The product of two monomials and a number, as terms with cosines to the power of at most 1."""
    exponents = dict(one)
    for variable, e in two:
        exponents[variable] = exponents.get(variable, 0) + e
    found: list[tuple[dict[str, int], Fraction]] = [(exponents, c)]
    for cosine in [v for v, e in exponents.items() if e > 1 and v.startswith("cos ")]:
        sine = f"sin {cosine[4:]}"
        split = []
        for powers, factor in found:  # cos^2 = 1 - sin^2
            rest = {v: e for v, e in powers.items() if v != cosine}
            split += [(rest, factor), ({**rest, sine: rest.get(sine, 0) + 2}, -factor)]
        found = split
    for powers, factor in found:
        yield tuple(sorted(powers.items())), factor


class Points:
    """The coordinates of a mechanism's points, each computed once, and what is made of them.

    Parameters
    ----------
    images : trees in place of names.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        ring: PolynomialRing | None = None,
        images: Mapping[str, Tree] | None = None,
    ):
        self.mechanism = mechanism
        self.ring = ring or PolynomialRing()
        self.images = images or {}
        self.placed = Named(
            self.ring,
            {name: replaced(tree, self.images) for name, tree in mechanism.coordinates.items()},
        )

    def value(self, tree: Tree) -> Polynomial:
        """Of an expression, in which coordinates are names ``P.x``."""
        return self.values((tree,))[0]

    def values(self, trees: Iterable[Tree]) -> tuple[Polynomial, ...]:
        """The same of several ones, of which parts that they share are evaluated once."""
        return evaluated([replaced(tree, self.images) for tree in trees], self.placed)

    def at(self, name: str) -> tuple[Polynomial, Polynomial]:
        return self.placed.parameter(f"{name}.x"), self.placed.parameter(f"{name}.y")

    def squared(self, start: str, end: str) -> Polynomial:
        """The square of a distance."""
        return self.value(squared_distance(start, end))

    def varies(self, tree: Tree) -> bool:
        """Whether an expression changes with an unknown; also where that is too much to be
        multiplied out.
        """
        unknowns = {*self.mechanism.unknowns, *self.mechanism.followers}
        names = {
            name
            for part in names_of(tree)
            for name in names_of(self.placed.trees.get(part, Name(part)))
        }
        if not names & unknowns:
            return False
        try:
            value = self.value(tree)
            return any(value.derivative(u).terms for u in unknowns)
        except ExpressionError:
            return True

    def turning(self, start: str, end: str) -> dict[str, Fraction] | None:
        """By how much the way from one point to another, (x, y), turns with each unknown u, in
        turns of u: n, where dx/du = -n y and dy/du = n x; None where it is no rigid one, or no way
        at all."""
        (x0, y0), (x1, y1) = self.at(start), self.at(end)
        x, y = x1 - x0, y1 - y0
        if not (x.terms or y.terms):
            return None
        term, c = next(iter((x.terms or y.terms).items()))
        found = {}
        for unknown in (*self.mechanism.unknowns, *self.mechanism.followers):
            dx, dy = x.derivative(unknown), y.derivative(unknown)
            n = (
                dy.terms.get(term, Fraction(0)) / c
                if x.terms
                else -dx.terms.get(term, Fraction(0)) / c
            )
            times = self.ring.constant(n)
            if (dy - times * x).terms or (dx + times * y).terms:
                return None
            found[unknown] = n
        return found
