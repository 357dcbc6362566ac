"""The solutions over one rational point: the quotient algebra over Q, and a univariate
representation of its points.

Guarantee: exact over Q; nothing here is rounded.

Reference: Rouillier, Solving zero-dimensional systems through the rational univariate
representation, AAECC 9 (1999).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from flint import (
    Ordering,
    arb,
    arb_poly,
    ctx,
    fmpq,
    fmpq_mat,
    fmpq_poly,
    fmpz,
    fmpz_mat,
    fmpz_mpoly_ctx,
    fmpz_mpoly_vec,
    fmpz_poly,
)

from ptmcad.algebra.groebner import grevlex_key, powers_of, raised
from ptmcad.algebra.membership import RationalPolynomial, Rules
from ptmcad.algebra.polynomials import Monomial, integral
from ptmcad.algebra.quotient_algebra import border_of, divided, standard_monomials
from ptmcad.algebra.real_roots import RealRoot, refine, sign_at
from ptmcad.errors import LimitReached


class FibreAlgebra(NamedTuple):
    """The quotient algebra at a rational point.

    Attributes
    ----------
    basis : the monomial basis, 1 first.
    multiplication : one matrix for each unknown; column j holds the normal form of unknown times
        basis[j].
    by_msolve : whether msolve has found it; that it is right is proved then.
    """

    basis: tuple[Monomial, ...]
    multiplication: tuple[fmpq_mat, ...]
    by_msolve: bool = False

    @property
    def dimension(self) -> int:
        """The number of complex solutions counted with multiplicity."""
        return len(self.basis)

    @property
    def one(self) -> fmpq_mat:
        """Multiplication by 1."""
        size = range(self.dimension)
        return fmpq_mat(len(size), len(size), [fmpq(int(i == j)) for i in size for j in size])

    def powers(self) -> Callable[[Monomial], fmpq_mat]:
        """Multiplication by a monomial in the unknowns; each is computed once."""
        return powers_of(self.multiplication, self.one)


class WorkLimit(NamedTuple):
    """How much work a quotient may be, whatever the machine: about a second where each is as large
    as it may be.

    Attributes
    ----------
    dimension : of the quotient.
    polynomials, terms, bits : of the basis before it is reduced: how many, and what each may have.
    by_msolve : dimension of a quotient that msolve is asked for where the basis is larger; 0 for
        none.
    """

    dimension: int
    polynomials: int
    terms: int
    bits: int
    by_msolve: int = 0


def bezout_bound(equations: Sequence[RationalPolynomial]) -> int:
    """The product of the degrees, which bounds the number of complex solutions where they are
    finitely many.
    """
    return math.prod(max(map(sum, e), default=0) or 1 for e in equations)


def own_quotient(
    equations: Sequence[RationalPolynomial], unknowns: int, most: WorkLimit | None = None
) -> FibreAlgebra | None:
    """The quotient by the given equations; None when there are infinitely many complex solutions.

    Raises
    ------
    LimitReached
        When it is more work than `most`.
    """
    context = fmpz_mpoly_ctx.get(tuple(f"u{k}" for k in range(unknowns)), Ordering.degrevlex)
    polynomials = []
    for equation in equations:
        numerators, _ = integral(equation.values())
        polynomials.append(context.from_dict(dict(zip(equation, numerators, strict=True))))
    if most is None:
        found = fmpz_mpoly_vec(polynomials, context).buchberger_naive()
    else:
        limited: Any = fmpz_mpoly_vec(polynomials, context).buchberger_naive(
            limits=most[1:4]
        )  # a pair
        found, done = limited
        if not done:
            raise LimitReached("the basis of the equations grows beyond what is counted at once")
    reduced = found.autoreduction()
    rules: dict[Monomial, dict[Monomial, fmpq]] = {}
    for p in reduced:
        lead, *others = (tuple(map(int, m)) for m in p.monoms())
        first, *coefficients = p.coeffs()
        scale = fmpq(-1, first)
        rules[lead] = {m: scale * c for m, c in zip(others, coefficients, strict=True)}
    basis = standard_monomials(tuple(rules), unknowns)
    if basis is None:
        return None
    if most is not None and len(basis) > most.dimension:
        raise LimitReached(
            f"there are {len(basis)} solutions with multiplicity, more than are counted at once"
        )
    return fibre_of_rules(rules, basis, unknowns)


def fibre_of_rules(rules: Rules, basis: tuple[Monomial, ...], unknowns: int) -> FibreAlgebra:
    """The quotient by a reduced Groebner basis.

    Parameters
    ----------
    rules : a leading monomial to what it is equal to.
    basis : the monomials that no leading monomial divides.
    """
    normal_forms = _normal_forms(basis, rules)
    size = len(basis)
    matrices = []
    for k in range(unknowns):
        columns = [normal_forms[raised(m, k)] for m in basis]
        matrices.append(fmpq_mat(size, size, [c for column in columns for c in column]).transpose())
    return FibreAlgebra(basis, tuple(matrices))


def _normal_forms(basis: Sequence[Monomial], rules: Rules) -> dict[Monomial, list[fmpq]]:
    """The coordinates of the basis monomials and of their multiples by one unknown.

    Parameters
    ----------
    rules : a leading monomial to what it is equal to.
    """
    position = {m: i for i, m in enumerate(basis)}
    size, zero, one = len(basis), fmpq(0), fmpq(1)
    table: dict[Monomial, list[fmpq]] = {
        m: [one if i == k else zero for i in range(size)] for m, k in position.items()
    }
    border = border_of(basis)
    for m in sorted(border, key=grevlex_key):
        row = [zero] * size
        if m in rules:
            for n, c in rules[m].items():
                row[position[n]] = c
        else:
            k, below = divided(m, border)
            for n, c in zip(basis, table[below], strict=True):
                if c:
                    image = raised(n, k)
                    if image in position:
                        row[position[image]] += c
                    else:
                        row = [
                            a + c * b if b else a for a, b in zip(row, table[image], strict=True)
                        ]
        table[m] = row
    return table


def evaluate(algebra: FibreAlgebra, p: RationalPolynomial) -> fmpq_mat:
    """The matrix of multiplication by a polynomial in the unknowns, or in the first of them."""
    size = algebra.dimension
    power = algebra.powers()
    return sum((power(monomial) * c for monomial, c in p.items()), fmpq_mat(size, size))


class UnivariateRepresentation(NamedTuple):
    """The points of a fibre as values of quotients of polynomials at the roots of one.

    Attributes
    ----------
    minimal : squarefree, in Z[T]; its roots are the values of a linear form that separates the
        solutions.
    coordinates : one polynomial in Q[T] for each unknown: its value at a root, over that of
        ``slope``, is the unknown.
    slope : in Q[T]; not zero at the roots.
    form : the coefficients of the linear form, one for each unknown.
    characteristic : the form's characteristic polynomial, of which the roots are as multiple as the
        points.
    """

    minimal: fmpz_poly
    coordinates: tuple[fmpq_poly, ...]
    slope: fmpq_poly
    form: tuple[int, ...]
    characteristic: fmpz_poly


def univariate_representation(
    algebra: FibreAlgebra, multiple: bool = False
) -> UnivariateRepresentation | None:
    """The representation by the first separating form of a fixed list.

    A form separates the solutions exactly when its characteristic polynomial has as many different
    roots as there are points; one of more than d^2/2 forms of this list does (Rouillier 1999, lemma
    2.1).

    The coordinates are quotients (theorem 3.1 there): for an unknown v, the sum over the points of
    multiplicity times v times the product of (T - value of the form) over the other points has the
    coefficients trace(v form^j), as it has for v = 1. Polynomials without a denominator would be
    several times as long.

    Parameters
    ----------
    multiple : whether solutions may be multiple; else None is returned where they are not all
        simple.
    """
    size, count = algebra.dimension, len(algebra.multiplication)
    different = size if not multiple else None
    for trial in range(1, size * (size - 1) // 2 * (count - 1) + 2):
        form_coefficients = tuple(trial**k for k in range(count))  # points on a moment curve
        form = fmpq_mat(size, size)
        for matrix, c in zip(algebra.multiplication, form_coefficients, strict=True):
            form = form + (matrix if c == 1 else matrix * fmpq(c))
        # in integers over common denominators: reducing every fraction on the way would take most
        # of the time
        step, denominator = form.numer_denom()
        characteristic = step.charpoly()
        radical = characteristic // characteristic.gcd(characteristic.derivative())
        degree = radical.degree()
        if degree < size and different is None:
            different = hermite_matrix(algebra, algebra.one).rank()
        if degree not in (size, different):
            continue
        return _represented(
            algebra, form_coefficients, (step, denominator), characteristic, radical
        )
    return None


def _represented(
    algebra: FibreAlgebra,
    form_coefficients: tuple[int, ...],
    form: tuple[fmpz_mat, fmpz],
    characteristic: fmpz_poly,
    radical: fmpz_poly,
) -> UnivariateRepresentation:
    """The representation by a form that separates the solutions.

    Parameters
    ----------
    form_coefficients : of the unknowns in the form.
    form : the matrix of multiplication by it, times a denominator, and this.
    characteristic : of that matrix.
    radical : its squarefree part.
    """
    size, count, degree = algebra.dimension, len(algebra.multiplication), radical.degree()
    step, denominator = form
    powers = [denominator**i for i in range(size + 1)]
    row, row_denominator = _basis_traces(algebra)
    traces_of_powers = row.entries()
    for _ in range(degree - 1):
        row = row * step
        traces_of_powers += row.entries()
    one = [fmpq(int(i == 0)) for i in range(size)]
    forms = zip(one, *([m[i, 0] for i in range(size)] for m in algebra.multiplication), strict=True)
    columns, column_denominator = fmpq_mat(
        size, count + 1, [c for row in forms for c in row]
    ).numer_denom()
    traces = fmpz_mat(degree, size, traces_of_powers) * columns
    # rows of coefficients: the quotients of the radical by T, T^2, and so on
    padded = [*radical.coeffs(), *[fmpz(0)] * degree]
    hankel = fmpz_mat(
        degree, degree, [c for i in range(1, degree + 1) for c in padded[i : i + degree]]
    )
    totals = (hankel * traces).entries()
    scale = fmpq(1, row_denominator * column_denominator)
    slope, *coordinates = (
        fmpq_poly(_stretched(totals[k :: count + 1], powers)) * scale for k in range(count + 1)
    )
    minimal, whole = (_stretched(p.coeffs(), powers) for p in (radical, characteristic))
    return UnivariateRepresentation(
        minimal // minimal.content(),
        tuple(coordinates),
        slope,
        form_coefficients,
        whole // whole.content(),
    )


def _stretched(coefficients: Sequence[fmpz], powers: Sequence[fmpz]) -> fmpz_poly:
    return fmpz_poly([c * b for c, b in zip(coefficients, powers, strict=False)])


def _basis_traces(algebra: FibreAlgebra) -> tuple[fmpz_mat, fmpz]:
    """The traces of the multiplications by the basis monomials: a row of integers, and their common
    denominator.
    """
    size = algebra.dimension
    power = algebra.powers()
    traces = [sum(power(m).entries()[:: size + 1], fmpq(0)) for m in algebra.basis]
    row, denominator = fmpq_mat(1, size, traces).numer_denom()
    return row, denominator


def unknowns_in_balls(
    representation: UnivariateRepresentation,
) -> Callable[[RealRoot], list[arb] | None]:
    """The unknowns at the real roots of ``minimal``, in balls of the precision at which this is made;
    None where they are too wide.
    """
    minimal = representation.minimal
    value, derivative = arb_poly(minimal), arb_poly(minimal.derivative())
    slope = arb_poly(representation.slope)
    numerators = [arb_poly(p) for p in representation.coordinates]

    def at(root: RealRoot) -> list[arb] | None:
        ball = newton_ball(value, derivative, root)
        below = slope(ball)
        return None if below.contains(0) else [p(ball) / below for p in numerators]

    return at


_HALVINGS = 12
"""How often an interval is halved before it is refined as fast as a cluster of roots needs."""


def newton_ball(value: arb_poly, slope: arb_poly, root: RealRoot) -> arb:
    """A ball around a root, about as narrow as the working precision allows, by the interval Newton
    operator.

    With a root in X and 0 not in p'(X), it lies in m - p(m) / p'(X) for any m in X, by the mean value
    theorem (Moore, Interval Analysis, 1966).

    Parameters
    ----------
    value, slope : the root's polynomial and its derivative in balls of that precision.
    """
    low, high = root.low, root.high
    if low == high:
        return arb(low)
    rising = sign_at(root.polynomial, high) > 0
    for _ in range(_HALVINGS):
        found = _narrowed(value, slope, arb(low).union(arb(high)))
        if found is not None:
            return found
        middle = (low + high) / 2
        there = value(arb(middle))
        if there > 0 if rising else there < 0:
            high = middle
        elif there < 0 if rising else there > 0:
            low = middle
        else:  # the root, or too near to it to tell
            break
    # by its own means as far as the ball is to be narrow, where Newton's would not be at this
    # precision
    return refine(root, fmpq(1, 2 ** (ctx.prec - 8)) * (abs(root.middle) + 1)).ball


def _narrowed(value: arb_poly, slope: arb_poly, ball: arb) -> arb | None:
    """The root of a ball in one of at most the square root of the precision's unit; None when
    that fails.
    """
    while True:
        steepness = slope(ball)
        if steepness.contains(0):
            return None
        middle = ball.mid()
        found = middle - value(middle) / steepness
        if not 2 * found.rad() < ball.rad():
            small = ball.rad() * 2 ** (ctx.prec // 2) < abs(middle) + 1
            return ball if small else None
        ball = found


def hermite_matrix(algebra: FibreAlgebra, weight: fmpq_mat) -> fmpq_mat:
    """The matrix trace(weight b_i b_j), weight being a multiplication matrix.

    Its rank is the number of different solutions where the weight is not zero, its signature the
    number of real solutions with positive weight minus those with negative weight (Hermite; Basu,
    Pollack, Roy, theorem 4.101).
    """
    size = algebra.dimension
    row, denominator = _basis_traces(algebra)
    # column j of a multiplication is the normal form of its element times b_j
    power = algebra.powers()
    products = [power(m).transpose() for m in algebra.basis]
    traces = fmpq_mat(row).transpose() / denominator
    traces_of_products = fmpq_mat(size, size, [t for m in products for t in (m * traces).entries()])
    # the first basis monomial is 1, so the first column is the weight's own normal form
    weighted = traces_of_products * fmpq_mat(size, 1, [weight[i, 0] for i in range(size)])
    return fmpq_mat(size, size, [value for m in products for value in (m * weighted).entries()])


Divisor = fmpz_poly
"""In Z[T], of the representation's minimal polynomial."""


def vanishing_divisor(
    algebra: FibreAlgebra, representation: UnivariateRepresentation, p: RationalPolynomial
) -> Divisor | None:
    """The divisor whose roots are those at which p vanishes; None when there are none.

    Parameters
    ----------
    p : in the unknowns; it may have fewer than the algebra.
    """
    if evaluate(algebra, p).det() != 0:
        return None
    degree = max((sum(m) for m in p), default=0)
    minimal = fmpq_poly(representation.minimal)
    powers = [fmpq_poly([1])]
    for _ in range(degree):
        powers.append(powers[-1] * representation.slope % minimal)
    total = fmpq_poly([0])
    for monomial, c in p.items():
        term = powers[degree - sum(monomial)] * c
        for coordinate, e in zip(representation.coordinates, monomial, strict=False):
            for _ in range(e):
                term = term * coordinate % minimal
        total += term
    return fmpz_poly(total.numer()).gcd(representation.minimal)
