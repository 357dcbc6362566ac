"""Springs as sums of vectors that angles turn, and the energy's derivatives as sums of waves, from the description.

Guarantee: exact; polynomials over Q in the parameters. With points as complex numbers, a point or a spring is
z0 + z1 exp(+-i th1) + z2 exp(+-i th2) with real z; half its square and the work of the loads are sums of cosines and
sines of the angles and of their sum, and so are the derivatives. A description of another form is refused.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import cache, reduce
from itertools import product
from math import prod
from typing import Any, NamedTuple

from flint import Ordering, arb, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.mechanism import description
from ptmcad.text.balls import ball_of
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.verification.certified.powers import power
from ptmcad.verification.derivation import ANGLES, MECHANISM, POSITIVE, Configuration

NAMES = MECHANISM.variables
Frequency = tuple[int, int]
"""Multiples of the two angles."""
Waves = Mapping[tuple[Frequency, int], fmpq_mpoly]
"""Factors of the cosine (0) or the sine (1) of each frequency, whose first entry that is not zero is positive."""
_TURNS = tuple(f"{way}_{angle}" for angle in ANGLES for way in ("exp", "inverse"))
_RING: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get((*NAMES, "i", *_TURNS), Ordering.lex)
_NUMBERS: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(NAMES, Ordering.lex)
_ZERO: fmpq_mpoly = _NUMBERS.constant(0)
_I, *_EXP = (_RING.gen(k) for k in range(len(NAMES), len(NAMES) + 5))
_CONFIGURATION = Configuration(
    {name: _RING.gen(k) for k, name in enumerate(NAMES)},
    {angle: ((e + f) * fmpq(1, 2), -_I * (e - f) * fmpq(1, 2))
     for angle, e, f in zip(ANGLES, _EXP[::2], _EXP[1::2], strict=True)},
)  # fmt: skip
SUM: Frequency = (1, 1)
ORDER = tuple((w, kind) for w in ((1, 0), (0, 1), SUM) for kind in (0, 1))
"""The waves that there are beside the constant: cosine and sine of each angle and of their sum."""


def _vectors(across: fmpq_mpoly, up: fmpq_mpoly) -> dict[Frequency, fmpq_mpoly]:
    """The vectors that make up a point or a spring, by the multiple of the angles that turns each of them."""
    whole = across + _I * up
    for square in (_I * _I + 1, _EXP[0] * _EXP[1] - 1, _EXP[2] * _EXP[3] - 1):
        whole = divmod(whole, square)[1]
    found: dict[Frequency, fmpq_mpoly] = {}
    for powers, c in whole.terms():
        numbers, (i, a, b, d, e) = powers[: len(NAMES)], (int(p) for p in powers[len(NAMES) :])
        if i or abs(a - b) + abs(d - e) > 1:
            raise NotImplementedError("the checker knows bars that turn about points of one line only")
        found[a - b, d - e] = found.get((a - b, d - e), _ZERO) + _NUMBERS.from_dict({numbers: c})
    return found


def _collected(terms: Iterable[tuple[Frequency, int, fmpq_mpoly]]) -> Waves:
    found: dict[tuple[Frequency, int], fmpq_mpoly] = {}
    for w, kind, c in terms:
        turned = w < (0, 0)
        key = ((-w[0], -w[1]) if turned else w), kind
        found[key] = found.get(key, _ZERO) + (-c if turned and kind else c)
    return {key: c for key, c in found.items() if not c.is_zero() and key != ((0, 0), 1)}


def _part(vectors: Mapping[Frequency, fmpq_mpoly], kind: int) -> Waves:
    """The real (0) or imaginary (1) part of a sum of vectors."""
    return _collected((w, kind, z) for w, z in vectors.items())


def _half_square(vectors: Mapping[Frequency, fmpq_mpoly]) -> Waves:
    return _collected(
        ((w[0] - v[0], w[1] - v[1]), 0, y * z * fmpq(1, 2)) for (w, y), (v, z) in product(vectors.items(), repeat=2)
    )


def _by(f: Waves, angle: int) -> Waves:
    """The derivative by an angle."""
    return {(w, 1 - kind): c * (w[angle] if kind else -w[angle]) for (w, kind), c in f.items() if w[angle]}


def _number(tree: Any) -> fmpq_mpoly:
    """A tree without angles."""
    return _vectors(_CONFIGURATION.value(tree) + _RING.constant(0), _RING.constant(0)).get((0, 0), _ZERO)


Terms = tuple[tuple[int, int, tuple[str, ...]], ...]
"""A polynomial: numerator and denominator of each coefficient, and the parameters, with repetitions, next to it."""
Row = Mapping[tuple[Frequency, int], Terms]
"""A sum of waves."""


class Spring(NamedTuple):
    """A spring from its start to its end.

    Attributes
    ----------
    vectors : of no angle and of each; one of the angles' is zero unless the spring joins both bars.
    angle : the only one that turns it; None for both.
    zero, product : the squared length of a spring that one angle turns is zero^2 + product sin^2(angle/2), and with
        a first vector that is zero, that of another is zero^2 + product cos^2(half the sum of the angles).
    rows : the derivatives of half the squared length.
    """

    vectors: tuple[Terms, Terms, Terms]
    angle: int | None
    zero: Terms
    product: Terms
    stiffness: Terms
    free: Terms
    rows: tuple[Row, ...]

    def has_crease(self, values: Mapping[str, Any]) -> bool:
        """Whether the length is zero on a circle, for parameters that are exact numbers or functions."""
        zero = [self.zero] if self.angle is not None else [self.zero, self.vectors[0]]
        # a function is zero when its numerator has no terms, a number when it is 0
        return not any(evaluated(z, values).numerator for z in zero)


def _spring(spring: description.Spring) -> Spring:
    vectors = _vectors_of(spring)
    fixed, *arms = (
        sum((z for w, z in vectors.items() if tuple(map(abs, w)) == place), _ZERO) for place in ((0, 0), (1, 0), (0, 1))
    )
    turning = [k for k, arm in enumerate(arms) if not arm.is_zero()]
    alone = len(turning) == 1
    one, two = (fixed, arms[turning[0]]) if alone else arms
    lengthwise = 4 * one * two * (-1 if alone else 1)
    if any(c < 0 for c in lengthwise.coeffs()):
        raise NotImplementedError("the checker knows springs of the paper's form only")
    return Spring(
        (_terms(fixed), _terms(arms[0]), _terms(arms[1])),
        turning[0] if alone else None,
        _terms(one + two if alone else one - two),
        _terms(lengthwise),
        _terms(_number(spring.stiffness)),
        _terms(_number(spring.free)),
        _derivatives(_half_square(vectors)),
    )


def _vectors_of(spring: description.Spring) -> dict[Frequency, fmpq_mpoly]:
    (a, b), (x, y) = _POINTS[spring.start], _POINTS[spring.end]
    return _vectors(x - a, y - b)


def _quadratic() -> Waves:
    """The energy of springs without free lengths and of the loads."""
    terms = []
    for spring in MECHANISM.springs:
        square, stiffness = _half_square(_vectors_of(spring)), _number(spring.stiffness)
        terms += [(w, kind, stiffness * c) for (w, kind), c in square.items()]
    for load in MECHANISM.loads:
        vectors = _vectors(*_POINTS[load.point])
        for kind, force in enumerate((load.x, load.y)):
            terms += [(w, k, -_number(force) * c) for (w, k), c in _part(vectors, kind).items()]
    return _collected(terms)


def _derivatives(f: Waves) -> tuple[Row, ...]:
    """By the first and the second angle; the first again by the first, the second by the second; the first by both.

    Each is divided by the length of the angle's bar, or by both, and has no denominator.
    """
    (one, two), (bar1, bar2) = (_by(f, 0), _by(f, 1)), _BARS
    return (
        _row(one, bar1), _row(two, bar2), _row(_by(one, 0), bar1), _row(_by(two, 1), bar2),
        _row(_by(one, 1), bar1 * bar2),
    )  # fmt: skip


def _row(f: Waves, divisor: fmpq_mpoly) -> Row:
    return {key: _terms(c / divisor) for key, c in f.items()}


def _terms(p: fmpq_mpoly) -> Terms:
    return tuple(
        (int(c.p), int(c.q), tuple(name for name, n in zip(NAMES, powers, strict=True) for _ in range(int(n))))
        for powers, c in p.terms()
    )


def evaluated(terms: Terms, values: Mapping[str, Any]) -> Any:
    """The value of a polynomial for exact numbers, functions or balls; of one without names a fraction, or 0."""
    total: Any = 0
    number = Fraction(0)  # exact: a quotient of integers would be a double
    for numerator, denominator, names in terms:
        if names:
            term = prod([_raised(values[name], exponent) for name, exponent in _powers(names)], start=numerator)
            total = total + (term / denominator if denominator != 1 else term)
        else:
            number += Fraction(numerator, denominator)
    if not number:
        return total
    return total + (from_fraction(number) if isinstance(total, arb) else number)


@cache
def _powers(names: tuple[str, ...]) -> tuple[tuple[str, int], ...]:
    return tuple(Counter(names).items())


def _raised(value: Any, exponent: int) -> Any:
    """A power: of a ball with both signs an even one is not negative."""
    if exponent == 1:
        return value
    return power(value, exponent) if isinstance(value, arb) else value**exponent


def ball(terms: Terms, values: Mapping[str, Any]) -> arb:
    """The value of a polynomial for balls, also of one without names."""
    found = evaluated(terms, values)
    return found if isinstance(found, arb) else ball_of(Fraction(found))


_POINTS = _CONFIGURATION.points()
_ENERGY = _quadratic()
_BARS = tuple(reduce(lambda p, q: p.gcd(q), _by(_ENERGY, k).values()) for k in (0, 1))
BARS = tuple(map(_terms, _BARS))
"""The lengths of the bars that the angles turn."""
SPRINGS = tuple(map(_spring, MECHANISM.springs))
TURNED = tuple(s for s in SPRINGS if s.angle is not None)
"""Those from a bar's end to the pivot of the other bar."""
(CROSSING,) = (s for s in SPRINGS if s.angle is None)
"""The one between the bars' ends."""
_BETWEEN = _vectors_of(MECHANISM.springs[SPRINGS.index(CROSSING)])
ROWS = (*_derivatives(_ENERGY), *(_row(_part(_BETWEEN, kind), _NUMBERS.constant(1)) for kind in (0, 1)))
"""The derivatives without free lengths, and the components of the spring between the bars."""
if sorted(s.angle or 0 for s in TURNED) != [0, 1] or not {str(b) for b in _BARS} <= {*POSITIVE}:
    raise NotImplementedError("the checker knows a spring for each bar and one between them only")
