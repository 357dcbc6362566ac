"""A stored region map as the checks see it: its polynomials in FLINT, seen from the base axis.

Guarantee: only the result's own data are used, and what `ptmcad.verification.derivation` derives
from the description in it. ``u`` is the coordinate on the base axis, ``v`` the
other one.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import gcd

from flint import arb, ctx, fmpq, fmpq_poly, fmpz_poly

from ptmcad.answer.regionmap import CriticalValue, RegionMap
from ptmcad.errors import PoleError
from ptmcad.model import Model
from ptmcad.text.flint_numbers import interval_of, to_fraction
from ptmcad.text.numerals import approximate_text, text_of
from ptmcad.text.plane import PlanePolynomial
from ptmcad.verification.derivation import (
    Derivation,
    derivation_at,
    derivation_of,
)
from ptmcad.verification.fibrealgebra import NotFinite, SolutionAlgebra, fibre_over
from ptmcad.verification.kinds import SignMeaning, kind_of, meaning_of
from ptmcad.verification.planecurves import Terms, coefficients
from ptmcad.verification.report import Violation
from ptmcad.verification.rootcounts import (
    Interval,
    ends_of,
    numbered_root,
    roots_between,
    roots_within,
)


@dataclass(frozen=True)
class PlaneCurve:
    """A component as a polynomial in u and v."""

    number: int
    terms: Terms

    @classmethod
    def of(cls, number: int, p: PlanePolynomial, base: int) -> PlaneCurve:
        """The curve seen from a base axis."""
        return cls(number, tuple((t[base], t[1 - base], t[2]) for t in p.terms))

    @cached_property
    def degrees(self) -> tuple[int, int]:
        return (max(i for i, _, _ in self.terms), max(j for _, j, _ in self.terms))

    @cached_property
    def in_v(self) -> list[fmpz_poly]:
        """Coefficients in Z[u] of the powers of v."""
        return coefficients(self.terms)

    @cached_property
    def in_u(self) -> list[fmpz_poly]:
        """Coefficients in Z[v] of the powers of u."""
        return coefficients(self.terms, 0)

    def over(self, u: fmpq) -> fmpz_poly:
        """A positive multiple of p(u, v), in Z[v]."""
        return fmpq_poly([c(u) for c in self.in_v]).numer()

    def along(self, v: fmpq) -> fmpz_poly:
        """A positive multiple of p(u, v), in Z[u]."""
        return fmpq_poly([c(v) for c in self.in_u]).numer()

    def exponent_gcd(self, variable: int) -> int:
        """The largest k such that only powers of the variable's k-th power occur."""
        return max(1, gcd(*(t[variable] for t in self.terms)))

    def deflated(self, k: int, m: int) -> Terms:
        """The terms with u for u^k and v for v^m."""
        return tuple((i // k, j // m, c) for i, j, c in self.terms)


@dataclass(frozen=True)
class Claims:
    """The result with its window and curves as FLINT sees them."""

    result: RegionMap

    @cached_property
    def _fibres(self) -> dict[tuple[Fraction, Fraction], SolutionAlgebra]:
        return {}

    @property
    def model(self) -> Model:
        """The mechanism or system that the slice is of."""
        return self.result.slice.model

    @cached_property
    def meaning(self) -> SignMeaning:
        """Of the signs at solutions."""
        return meaning_of(self.model)

    @property
    def derivation(self) -> Derivation:
        """What solutions satisfy, in all parameters, with what the count asks of stable ones
        besides.
        """
        return kind_of(self.result.slice.count).with_margins(derivation_of(self.model))

    @cached_property
    def base(self) -> Interval:
        return interval_of(self.result.slice.axes[self.result.base])

    @cached_property
    def height(self) -> Interval:
        return interval_of(self.result.slice.axes[1 - self.result.base])

    def _used(self) -> list[PlaneCurve]:
        return [
            PlaneCurve.of(n, c.polynomial, self.result.base)
            for n, c in enumerate(self.result.components)
            if not c.left_out
        ]

    @cached_property
    def curves(self) -> list[PlaneCurve]:
        """Components that are used and have walls."""
        return [c for c in self._used() if c.degrees[1] > 0]

    @cached_property
    def lines(self) -> list[PlaneCurve]:
        """Components that are used and consist of lines u = constant."""
        return [c for c in self._used() if c.degrees[1] == 0]

    def parameters_at(self, x: Fraction, y: Fraction) -> dict[str, Fraction]:
        """The values of the parameters at a point.

        Raises
        ------
        Violation
            When one has a pole there.
        """
        try:
            return {name: e.evaluate(x, y) for name, e in self.result.slice.parameters.items()}
        except PoleError as error:
            raise Violation(str(error)) from error

    def place(self, x: Fraction, y: Fraction) -> str:
        """A point of the plane in words."""
        one, two = self.result.slice.axis_names
        return f"{one}={text_of(x)}, {two}={text_of(y)}"

    def fibre_at(self, x: Fraction, y: Fraction) -> SolutionAlgebra:
        """The solutions over a point.

        Raises
        ------
        Violation
            When there are infinitely many, or a parameter has a pole there.
        """
        if (x, y) in self._fibres:
            return self._fibres[x, y]
        try:
            point = derivation_at(self.model, self.parameters_at(x, y))
            self._fibres[x, y] = fibre_over(kind_of(self.result.slice.count).with_margins(point))
            return self._fibres[x, y]
        except NotFinite:
            raise Violation(f"there are infinitely many solutions at {self.place(x, y)}") from None

    def level(self, u: fmpq, v: fmpq) -> int:
        """How many roots of the curves over u lie below v."""
        return sum(roots_between(c.over(u), self.height[0], v) for c in self.curves)

    def met_by(self, low: fmpq, high: fmpq, v: fmpq) -> PlaneCurve | None:
        """A curve that meets the closed segment [low, high] x {v}; None where it is free of them."""
        return next((c for c in self.curves if roots_within(c.along(v), low, high) > 0), None)


def polynomial(value: CriticalValue) -> fmpz_poly:
    """The polynomial of a critical value."""
    return fmpz_poly(list(value.polynomial))


def side(u: fmpq, value: CriticalValue) -> int:
    """The sign of u minus the critical value."""
    low, high = interval_of(value)
    if u < low or u > high:
        return -1 if u < low else 1
    p = polynomial(value)
    if p(u) == 0:
        return 0
    return 1 if roots_within(p, low, u) > 0 else -1


def short(value: fmpq) -> str:
    """A number as a short decimal for messages."""
    return approximate_text(to_fraction(value))


def is_root(f: fmpz_poly, value: CriticalValue) -> bool:
    """Whether a critical value is a root of f."""
    return roots_within(f.gcd(polynomial(value)), *interval_of(value)) > 0


def bracket(value: CriticalValue, width: fmpq) -> Interval:
    """A narrow bracket of a critical value, within the stored one."""
    low, high = interval_of(value)
    p, bits = polynomial(value), 64
    for end in (low, high):
        if p(end) == 0:
            return end, end
    while high - low > width:
        with ctx.workprec(bits):
            root = numbered_root(p, low, high, 0)
        if root is None:
            raise Violation(
                f"the polynomial of a critical value has no root between {short(low)} and {short(high)}"
            )
        first, last = ends_of(root)
        low, high, bits = max(low, first), min(high, last), 2 * bits
    return low, high


def ball(value: CriticalValue, width: fmpq) -> arb:
    """A ball around a critical value."""
    low, high = bracket(value, width)
    return arb(low).union(arb(high))
