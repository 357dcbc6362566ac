"""Checks of the discriminant variety: nothing is missing, nothing is foreign.

The norm N of det H, the determinant of the Hessian or of another Jacobian, is compared with the
product of the stored components at random integer points, of 48 bits in each coordinate. If N = c
A_1^e1 ... / B_1^f1 ..., its exponents follow from its values at a few of these points (`_exponent`)
and the identity is checked at the others. A false identity of degree d agrees at one random point
with probability under d/2^47. So are the norms of inequalities and of conditions for stability,
over those solutions at which they are not zero all over the slice.

The points are drawn from a fresh seed, so that no one can choose claims to fit them. They lie on no
stored component: a point on one, where the fibre degenerates, is drawn again.

Guarantee: up to that probability, every CRITICAL component is a factor of N, and no other curve is
a factor of it but BOUNDARY components; every curve on which a condition's norm vanishes is stored;
the poles of the unknowns' characteristic polynomials lie on stored components, and every INFINITY
component consists of such poles. Where one is left out as harmless, all unknowns are angles, and
the values of det H and of all conditions at the solutions stay away from 0 near almost all of its
points.

Conversely, whatever the points are, no true claim about N is rejected: each rejection is a
contradiction between exact values. Claims about poles, which are recognised by the primes that
values have in common, are decided by half of the bits of a value of at least 200 bits; a true one
is rejected, or a false one accepted, when primes that make up 100 of these bits divide further
values too, which has a probability near 2^-100.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from itertools import islice, permutations
from math import gcd, lcm, prod

from flint import fmpq, fmpq_mat

from ptmcad.answer.regionmap import HARMLESS, Kind
from ptmcad.text.flint_numbers import to_fraction
from ptmcad.text.plane import PlanePolynomial
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import coordinates_of
from ptmcad.verification.fibrealgebra import SolutionAlgebra
from ptmcad.verification.planecurves import factors, polynomial
from ptmcad.verification.report import Violation

POINTS, BITS = 12, 48
FRESH_POINTS = 10
"""Of these, points at least that no exponent was read off at."""
FAR_POINTS, FAR_BITS = 3, 400
"""For poles: a value of so many bits is not made of small primes by accident, nor by trying."""
CLEAR_BITS = FAR_BITS // 2
"""A value's part with primes of its own says something from this size on."""


def check_irreducible(claims: Claims) -> str:
    """Every component is irreducible over Q, and none is stored twice."""
    names = claims.result.slice.axis_names
    seen = set()
    for n, c in enumerate(claims.result.components):
        text = c.polynomial.text(names)[:60]
        if c.polynomial.total_degree < 1:
            raise Violation(f"component {n} is a constant: {text}")
        if PlanePolynomial.of(c.polynomial.terms) != c.polynomial:
            raise Violation(
                f"component {n} is not primitive with a positive first coefficient: {text}"
            )
        if factors(polynomial(c.polynomial.terms)) != [c.polynomial]:
            raise Violation(f"component {n} is not irreducible: {text}")
        if c.polynomial in seen:
            raise Violation(f"component {n} is stored twice: {text}")
        seen.add(c.polynomial)
    return f"{len(seen)} components"


@dataclass(frozen=True)
class FibrePoint:
    """The fibre over a random integer point that lies on no stored component.

    Attributes
    ----------
    values : of the components' polynomials there, none zero.
    form : coefficients of a random linear form in the coordinates of the unknowns.
    """

    x: Fraction
    y: Fraction
    values: tuple[int, ...]
    form: tuple[int, ...]
    fibre: SolutionAlgebra

    def norm(self) -> Fraction:
        """The product of det H over the solutions."""
        return to_fraction(self.fibre.norm())

    def condition_norm(self, k: int) -> Fraction:
        """The product of a condition over the solutions at which it is not 0."""
        return to_fraction(self.fibre.norm_where_nonzero(self.fibre.conditions[k]))

    @cached_property
    def denominator(self) -> int:
        """The common denominator of the power traces of the linear form."""
        return lcm(*(int(t.q) for t in self.fibre.form_traces(self.form)))

    def own(self, k: int, *others: int) -> int:
        """The value of component k without the primes of the other components' values here, and of
        other numbers.
        """
        return _without(
            abs(self.values[k]), prod(v for j, v in enumerate(self.values) if j != k) * prod(others)
        )


def random_points(claims: Claims, seed: str, bits: int) -> Iterator[FibrePoint]:
    """Random points, without end, of components that `check_irreducible` has accepted: of others
    there may be none.

    Components vanish on a share of at most (sum of degrees)/2^bits of the points, and on a point
    where one does, nothing can be concluded: it is drawn again from one bit more, so that a point
    is found whatever the degrees are.
    """
    source, forms = random.Random(f"{bits} {seed}"), random.Random(f"form {bits} {seed}")
    components = [polynomial(c.polynomial.terms) for c in claims.result.components]
    width = len(coordinates_of(claims.result.slice.model))
    while True:
        x, y = (source.getrandbits(bits) - 2 ** (bits - 1) for _ in range(2))
        values = tuple(int(p(x, y).p) for p in components)
        if 0 in values:
            bits += 1
        else:
            form = tuple(1 + forms.getrandbits(16) for _ in range(width))
            yield FibrePoint(
                Fraction(x), Fraction(y), values, form, claims.fibre_at(Fraction(x), Fraction(y))
            )


def check_norm(claims: Claims, seed: str) -> str:
    """Norm of det H and poles against the stored components."""
    number, exponents = check_identity(claims, random_points(claims, seed, BITS))
    _check_poles(claims, random_points(claims, seed, FAR_BITS))
    return f"{number} points of {BITS} bits, seed {seed}; multiplicities {exponents}"


def check_identity(claims: Claims, points: Iterator[FibrePoint]) -> tuple[int, list[int]]:
    """The number of points, and the exponents with which the norm is a product of the components."""
    result = claims.result

    def norm_at(point: FibrePoint) -> Fraction:
        if point.fibre.dimension != result.complex_solutions:
            raise Violation(
                f"there are {point.fibre.dimension} complex solutions at {_at(claims, point)}, "
                f"not {result.complex_solutions}"
            )
        norm = point.norm()
        if norm == 0:
            raise Violation(
                f"det H vanishes at {_at(claims, point)}, which is on no stored component"
            )
        return norm

    norms, exponents = _product_of_powers(claims, points, norm_at, "det H")
    for k, (c, e) in enumerate(zip(result.components, exponents, strict=True)):
        if c.kind is Kind.CRITICAL and e < 1:
            raise Violation(
                f"component {k} is said to be critical, but is no factor of the norm of det H "
                f"at {_at(claims, norms[0][0])}"
            )
        # with real unknowns det H may vanish at the solutions that escape
        if c.kind is Kind.INFINITY and e > 0 and not result.slice.model.reals:
            raise Violation(f"component {k} is said to be at infinity, but det H vanishes on it")
    return len(norms), exponents


def check_conditions(claims: Claims, seed: str) -> str:
    """Norms of the inequalities and of the conditions for stability against the stored components."""
    names = _conditions(claims)
    if not names:
        return "none"
    found = condition_exponents(claims, seed)
    return f"{len(found)} norms; multiplicities {', '.join(map(str, found))}"


def condition_exponents(claims: Claims, seed: str) -> list[list[int]]:
    """For each inequality and each condition for stability, how often each component divides its
    norm.

    Raises
    ------
    Violation
        When one is no product of components.
    """
    return [
        _product_of_powers(
            claims, random_points(claims, seed, BITS), partial(FibrePoint.condition_norm, k=k), name
        )[1]
        for k, name in _conditions(claims).items()
    ]


def _conditions(claims: Claims) -> dict[int, str]:
    """The numbers of inequalities and of conditions for stability, with their names.

    With closed loops or X-joints the conditions for stability are those for a matrix to be
    definite, the last of them its determinant: where that is not zero the matrix does not stop or
    begin to be definite.
    """
    true = claims.derivation
    inequalities = len(true.inequalities)
    return {k: f"inequality {k}" for k in range(inequalities)} | {
        inequalities + k: f"condition {k} for stability" for k in true.decisive
    }


_Norm = tuple[FibrePoint, Fraction]
"""A point with the value of a norm there."""


def _product_of_powers(
    claims: Claims,
    points: Iterator[FibrePoint],
    norm_at: Callable[[FibrePoint], Fraction],
    what: str,
) -> tuple[list[_Norm], list[int]]:
    """A norm at points, and the exponents with which it is a constant times a product of the
    components.

    Raises
    ------
    Violation
        When it is not.
    """
    norms: list[_Norm] = []

    def draw() -> None:
        point = next(points)
        norms.append((point, norm_at(point)))

    draw()
    exponents: list[int] = []
    for k in range(len(claims.result.components)):
        while (pair := _separating_points(k, norms)) is None:
            draw()
        exponents.append(_exponent(*pair))
    for _ in range(max(POINTS - len(norms), FRESH_POINTS)):
        draw()
    constants = [
        n / prod(Fraction(v) ** e for v, e in zip(p.values, exponents, strict=True))
        for p, n in norms
    ]
    for (point, _), constant in zip(norms, constants, strict=True):
        if constant != constants[0]:
            raise Violation(
                f"the norm of {what} at {_at(claims, point)} is no constant times powers of the stored "
                "components: a curve of the variety is missing or wrong"
            )
    return norms, exponents


_Pair = tuple[_Norm, _Norm, int]


def _separating_points(k: int, norms: Sequence[_Norm]) -> _Pair | None:
    """Two points that tell component k's exponent: its value at the first has primes that divide no
    other value at either, which are returned as their product with multiplicities. None when there
    are no such points yet.

    Irreducible polynomials that differ have large primes in common only by accident, so few points
    are needed; which ones is decided by the components alone.
    """
    for first, second in permutations(norms, 2):
        own = first[0].own(k, *second[0].values)
        if own > 1:
            return first, second, own
    return None


def _exponent(first: _Norm, second: _Norm, own: int) -> int:
    """The exponent e of a component, if the norm is a constant times powers of the components.

    The norms' quotient at the two points is free of the constant, and its part with primes of
    ``own`` is own^e: these primes divide no other value.
    """
    quotient = first[1] / second[1]
    for part, sign in ((quotient.numerator, 1), (quotient.denominator, -1)):
        e = 0
        while part % own ** (e + 1) == 0:
            e += 1
        if e:
            return sign * e
    return 0


def _check_poles(claims: Claims, points: Iterator[FibrePoint]) -> None:
    result = claims.result
    far = list(islice(points, FAR_POINTS))
    for k, c in enumerate(result.components):
        harmless = c.left_out == HARMLESS
        if harmless and result.slice.model.reals:
            raise Violation(
                f"component {k} is left out, but real solutions may leave every bounded set on it"
            )
        for is_said, holds, message in (
            (c.kind is Kind.INFINITY, _has_poles, "at infinity, but solutions have no pole on it"),
            (harmless, _is_harmless, "harmless, but det H may vanish at solutions near it"),
        ):
            clear = [p for p in far if _far_part(k, p).bit_length() > CLEAR_BITS]
            while is_said and len(clear) < FAR_POINTS:
                far.append(next(points))
                clear += far[-1:] * (_far_part(k, far[-1]).bit_length() > CLEAR_BITS)
            if is_said and not any(holds(k, point) for point in clear):
                text = c.polynomial.text(result.slice.axis_names)[:60]
                raise Violation(f"component {k} is said to be {message}: {text}")
    foreign = [_foreign_poles(point) for point in far]
    # constant factors of denominators have their primes at every point, but for accidents
    own = [
        _without(f, prod(g for j, g in enumerate(foreign) if j != i)) for i, f in enumerate(foreign)
    ]
    if all(
        f.bit_length() > CLEAR_BITS for f in own
    ):  # a curve that is missing has values of some hundred bits
        raise Violation("solutions have a pole on no stored component")


_SMALL_PRIMES = prod(p for p in range(2, 2000) if all(p % q for q in range(2, p)))


def _without(n: int, other: int) -> int:
    """n without the primes of ``other``."""
    while (common := gcd(n, other)) > 1:
        n //= common
    return n


def _far_part(k: int, point: FibrePoint) -> int:
    return point.own(k, _SMALL_PRIMES)


def _has_poles(k: int, point: FibrePoint) -> bool:
    """Whether most of component k's own part of its value consists of primes in denominators of
    traces.

    For a curve without poles it would have to consist of primes of constants.
    """
    own = _far_part(k, point)
    return _without(own, point.denominator) ** 2 < own


def _is_harmless(k: int, point: FibrePoint) -> bool:
    """Whether det H and all conditions stay away from 0 at the solutions near component k.

    A function does where most of the component's own part is no divisor of the constant coefficient
    of its characteristic polynomial, which is made integral and primitive first. On a curve that
    divides that coefficient as a polynomial in the axes, all primes of the curve's values divide
    it.
    """
    own = _far_part(k, point)
    functions = [point.fibre.jacobian, *(point.fibre.matrix(p) for p in point.fibre.conditions)]
    return all((own // gcd(own, _constant_coefficient(f))) ** 2 > own for f in functions)


def _constant_coefficient(matrix: fmpq_mat) -> int:
    """Of the characteristic polynomial without its factors x, made integral and primitive."""
    coefficients = [fmpq(c) for c in matrix.charpoly().coeffs()]
    lowest = next(c for c in coefficients if c != 0)
    return int((lowest * lcm(*(int(c.q) for c in coefficients))).p)


def _foreign_poles(point: FibrePoint) -> int:
    """Denominator of the power traces without the primes of the stored components."""
    return _without(point.denominator, prod(point.values) * _SMALL_PRIMES)


def _at(claims: Claims, point: FibrePoint) -> str:
    return claims.place(point.x, point.y)
