"""Involutions of a model over a window of two axes, as data that both engines read: what becomes of
unknowns and axes.

Guarantee: each `Involution` that is found takes the window to itself, and at every point of it
solutions to solutions at the point's image, those that count to such, stable ones to stable ones of
the same index unless potentials may be negated. That is proved by identities of polynomials over Q,
decided exactly. All are found that exchange and reflect unknowns and axes, turn angles by half a
turn, and keep the energy but for what no unknown is in, the springs with a free length, the
moments, the equations up to their order and signs, and the conditions up to their order; so those
that a record's `symmetries` list are found again where they are of this kind. None is found where
expressions are too large to be multiplied out, nor with free lengths in closed loops; none that
moves axes where parameters have denominators.

In cosines and sines such a change only permutes monomials and gives them signs. For each
permutation of unknowns and axes the signs with which all polynomials are kept are the solutions of
linear equations over the field of two elements.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import permutations
from typing import NamedTuple

from ptmcad.errors import ExpressionError
from ptmcad.formulas.graph import Formula
from ptmcad.model.compile import compiled
from ptmcad.model.elements import UnknownKind
from ptmcad.model.identities import Monomial, Polynomial, PolynomialRing
from ptmcad.model.parametric import Model
from ptmcad.text.expressions import Expressions, constant

MAX_WORK = 100_000
"""Products of terms, about half a second; the bars and springs of shipped mechanisms take some
hundred.
"""
MAX_UNKNOWNS = 6
"""Of six unknowns there are 76 involutions without signs, and of seven three times as many."""

Window = tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]
_AXES = ("axis:0", "axis:1")
_AXIS_SIGNS = [(1, 1), (-1, -1), (1, -1), (-1, 1)]
"""In which order they are looked for."""
_Terms = Mapping[Monomial, Fraction]
_Bits = Mapping[int, int]
"""Linear equations over the field of two elements, by the length of their numbers; bit 0 is the
constant.
"""


_KeptPolynomial = tuple[_Terms, Sequence[_Terms], bool]
"""A polynomial that an involution takes to one of some polynomials, or to the negative of one where
that may be."""


class Involution(NamedTuple):
    """What becomes of unknowns and axes, by number: q'_k = signs_k q_images(k) + halves_k pi.

    Attributes
    ----------
    images : which of the model's unknowns comes to each one's place.
    signs : 1 or -1.
    halves : half turns that are added, 0 or 1; none to unknowns on the line.
    axes, axis_signs, shifts : the same of the two axes, x'_k = axis_signs_k x_axes(k) + shifts_k.
    """

    images: tuple[int, ...]
    signs: tuple[int, ...]
    halves: tuple[int, ...]
    axes: tuple[int, int] = (0, 1)
    axis_signs: tuple[int, int] = (1, 1)
    shifts: tuple[Fraction, Fraction] = (Fraction(0), Fraction(0))

    @property
    def odd(self) -> int:
        """How many unknowns are odd, in coordinates of which the others are kept."""
        return sum(
            j > k or (j == k and s < 0)
            for k, (j, s) in enumerate(zip(self.images, self.signs, strict=True))
        )

    @property
    def has_fixed_unknowns(self) -> bool:
        """Whether it fixes some values of the unknowns: no angle turns by half a turn alone."""
        places = zip(self.images, self.signs, self.halves, strict=True)
        return not any(j == k and s > 0 and h for k, (j, s, h) in enumerate(places))

    @property
    def keeps_points(self) -> bool:
        """Whether each point of the slice is its own image."""
        return self.axes == (0, 1) and self.axis_signs == (1, 1)

    def coordinates(self, kinds: Sequence[UnknownKind]) -> list[tuple[int, int]]:
        """Which coordinate comes to each one's place, and its sign.

        Coordinates are cosine and sine of each angle, one angle after the other, and then the
        unknowns on the line.

        Parameters
        ----------
        kinds : of the model's unknowns.
        """
        angles = [k for k, kind in enumerate(kinds) if kind.turns]
        reals = [k for k in range(len(kinds)) if k not in angles]
        found = []
        for k in angles:
            place, sign = 2 * angles.index(self.images[k]), 1 - 2 * self.halves[k]
            found += [(place, sign), (place + 1, sign * self.signs[k])]
        return found + [
            (2 * len(angles) + reals.index(self.images[k]), self.signs[k]) for k in reals
        ]

    def at(self, point: tuple[Fraction, Fraction]) -> tuple[Fraction, Fraction]:
        """The image of a point of the slice."""
        x, y = (
            s * point[k] + c
            for k, s, c in zip(self.axes, self.axis_signs, self.shifts, strict=True)
        )
        return x, y

    def text(self, unknowns: Sequence[str], axes: Sequence[str]) -> str:
        """What is moved, such as ``a -> -a + 3, x -> y + pi``."""
        names, images = (*axes, *unknowns), (*self.axes, *(k + 2 for k in self.images))
        signs = (*self.axis_signs, *self.signs)
        shifts = (*map(str, self.shifts), *("pi" if half else "0" for half in self.halves))
        moves = {
            name: f"{'-' * (sign < 0)}{names[k]} + {shift}".removesuffix(" + 0").replace(
                "+ -", "- "
            )
            for name, k, sign, shift in zip(names, images, signs, shifts, strict=True)
        }
        return ", ".join(f"{name} -> {image}" for name, image in moves.items() if image != name)


def involutions(
    model: Model,
    parameters: Expressions,
    window: Window | None = None,
    *,
    may_negate: bool = False,
) -> list[Involution]:
    """The involutions of a model over a window, but for the identity.

    Parameters
    ----------
    parameters : of the model, as functions of the two axes; one that is missing is zero.
    window : of the axes; without it only those are looked for that keep each point of the slice.
    may_negate : whether those count, too, that take a potential to its negative: equilibria to
        equilibria, minima to maxima.
    """
    if len(model.unknowns) > MAX_UNKNOWNS:
        return []
    ring = SliceRing(model.unknowns, parameters, window)
    try:
        parts = list(_parts(model, ring, may_negate))
    except ExpressionError:
        return []
    size = len(model.unknowns)
    kinds = (*model.unknowns.values(), UnknownKind.REAL, UnknownKind.REAL)
    is_fixed = window is None or ring.has_denominators
    low, high = zip(*window, strict=True) if window is not None else ((0, 0), (0, 0))
    is_square = high[0] - low[0] == high[1] - low[1]
    found = []
    for axes in ((0, 1),) if is_fixed or not is_square else ((0, 1), (1, 0)):
        for own in permutations(range(size)):
            images = (*own, *(size + k for k in axes))
            if any(images[images[k]] != k or kinds[images[k]] is not kinds[k] for k in range(size)):
                continue
            change = _Change((*model.unknowns, *_AXES), images)
            for system in _kept(change, parts, change.known(kinds, is_fixed)):
                found += [
                    change.involution(bits, axes, ring.middle)
                    for bits in _solutions(system, size + 2)
                ]
    found.sort(key=lambda each: (each.axes, _AXIS_SIGNS.index(each.axis_signs), each.images))
    return list(dict.fromkeys(found))[1:]  # the identity comes first


class SliceRing(PolynomialRing):
    """The ring with the slice's parameters in it, as polynomials in the axes, measured from the
    window's middle.

    A denominator's inverse is a variable. What becomes of it where the axes change is not known.
    """

    def __init__(
        self, unknowns: Collection[str], parameters: Expressions, window: Window | None = None
    ) -> None:
        super().__init__(MAX_WORK)
        self.unknowns, self.parameters = unknowns, parameters
        self.has_denominators = False
        self.middle = (
            [Fraction(0)] * 2 if window is None else [(low + high) / 2 for low, high in window]
        )
        self.axes = [
            self.variable(name) + self.constant(m)
            for name, m in zip(_AXES, self.middle, strict=True)
        ]

    def parameter(self, name: str) -> Polynomial:
        if name in self.unknowns:
            return self.variable(name)
        given = self.parameters.get(name, constant(0))
        total = self.constant(Fraction(0))
        for i, j, c in given.numerator:
            term = self.constant(c)
            for factor in (self.axes[0],) * i + (self.axes[1],) * j:
                term = term * factor
            total += term
        if given.is_polynomial:
            return total
        self.has_denominators = True
        return total * self.variable(f"over {given.denominator}")


def _parts(model: Model, ring: SliceRing, may_negate: bool) -> Iterator[_KeptPolynomial]:
    """What an involution has to keep, but for the order."""
    system = compiled(model)
    unknowns = {name for u in model.unknowns for name in (u, f"cos {u}", f"sin {u}")}

    def marked(parts: Mapping[str, Polynomial]) -> _Terms:
        return {
            tuple(sorted(((mark, 1), *m))): c
            for mark, p in parts.items()
            for m, c in p.terms.items()
        }

    def values(formulas: Iterable[Formula]) -> list[Polynomial]:
        return system.values(tuple(formulas), ring)

    # how many are the same is said in their polynomial
    pulls = Counter((pull, x * x + y * y) for _, pull, (x, y) in system.pulling(ring))
    lengths = [
        marked({"pull": pull, "square": square, "number": ring.constant(Fraction(number))})
        for (pull, square), number in pulls.items()
    ]
    kept: list[list[_Terms]] = [
        [p.terms for p in values(some)] for some in (system.inequalities, system.stability)
    ]
    if system.are_slopes:
        assert system.smooth is not None
        (energy,) = values([system.smooth])
        moments = zip(
            (f"d {system.names[k]}" for k in system.unknowns), values(system.moments), strict=True
        )
        felt = {m: c for m, c in energy.terms.items() if any(v in unknowns for v, _ in m)}
        work = marked(dict(moments))
        kept += [[work], lengths]
        yield felt, [felt], may_negate and not (work or lengths)
    elif lengths:
        raise ExpressionError("free lengths are in none of a closed loop's equations")
    yield from ((f, images, False) for images in kept for f in images)
    if not system.are_slopes:
        equations = [p.terms for p in values(system.equations)]
        yield from ((f, equations, True) for f in equations)


class _Change(NamedTuple):
    """A permutation of the unknowns and of the axes, which are as unknowns on the line, the signs
    being open.

    Those of an unknown's cosine and sine are two bits, of two that are exchanged those of the first
    one; of one on the line the second bit is its sign.
    """

    names: tuple[str, ...]
    images: tuple[int, ...]

    def bits(self, k: int) -> tuple[int, int]:
        """Those of an unknown's cosine and sine."""
        first = min(k, self.images[k])
        return 2 << 2 * first, 4 << 2 * first

    def known(self, kinds: Sequence[UnknownKind], with_axes: bool) -> _Bits:
        """The equations for bits that nothing stands for, and with those of the axes, if they have
        to stay.
        """
        found: dict[int, int] = {}
        for k, (kind, j) in enumerate(zip(kinds, self.images, strict=True)):
            cosine, sine = 2 << 2 * k, 4 << 2 * k
            if j < k or not kind.turns:
                found[cosine.bit_length()] = cosine
            if j < k or (with_axes and self.names[k] in _AXES):
                found[sine.bit_length()] = sine
        return found

    def involution(
        self, bits: int, axes: tuple[int, int], middle: Sequence[Fraction]
    ) -> Involution:
        """That of some bits; the axes are measured from their middle."""
        halves = [bool(bits & self.bits(k)[0]) for k in range(len(self.images))]
        signs = [-1 if half != bool(bits & self.bits(k)[1]) else 1 for k, half in enumerate(halves)]
        x, y = (
            middle[k] - s * middle[j] for k, (j, s) in enumerate(zip(axes, signs[-2:], strict=True))
        )
        own = self.images[:-2], tuple(signs[:-2]), tuple(map(int, halves[:-2]))
        return Involution(*own, axes, (signs[-2], signs[-1]), (x, y))

    def variable(self, name: str) -> tuple[str, int]:
        """What becomes of a variable: another one, and the bits that may change its sign."""
        mark, _, own = name.rpartition(" ")
        if own not in self.names:
            return name, 0
        k = self.names.index(own)
        cosine, sine = self.bits(k)
        return f"{mark} {self.names[self.images[k]]}".strip(), {
            "cos": cosine,
            "d": cosine | sine,
        }.get(mark, sine)

    def monomial(self, m: Monomial) -> tuple[Monomial, int]:
        """What becomes of a monomial, and the bits that may change its sign."""
        powers, mask = [], 0
        for name, e in m:
            image, bits = self.variable(name)
            powers.append((image, e))
            mask ^= bits * (e % 2)
        return tuple(sorted(powers)), mask


def _kept(change: _Change, parts: Sequence[_KeptPolynomial], known: _Bits) -> list[_Bits]:
    """The equations for the bits with which all polynomials are kept, for each choice of what they
    become.
    """
    systems = [known]
    for n, (polynomial, images, may_be_negated) in enumerate(parts):
        terms = ((change.monomial(m), c) for m, c in polynomial.items())
        moved = {m: (c, mask) for (m, mask), c in terms}
        own = 2 << 2 * len(change.names) + n if may_be_negated else 0
        found = (_same(moved, image, own, system) for system in systems for image in images)
        systems = [system for system in found if system is not None]
        if not systems:
            break
    return systems


def _same(
    moved: Mapping[Monomial, tuple[Fraction, int]], image: _Terms, own: int, known: _Bits
) -> _Bits | None:
    """The equations for the bits with which a polynomial becomes another one, or its negative if
    its own bit is 1.
    """
    if moved.keys() != image.keys():
        return None
    system: _Bits | None = known
    for m, (c, mask) in moved.items():
        if abs(c) != abs(image[m]) or system is None:
            return None
        system = _with(system, mask ^ own ^ int(c != image[m]))
    return system


def _with(system: _Bits, row: int) -> _Bits | None:
    """The equations with one more; None where they contradict each other."""
    while row > 1:
        top = row.bit_length()
        if top not in system:
            return {**system, top: row}
        row ^= system[top]
    return None if row else system


def _solutions(system: _Bits, unknowns: int) -> list[int]:
    """The values of the unknowns' bits; bit 0 is the constant."""
    found = [1]
    for bit in range(1, 2 * unknowns + 1):
        row = system.get(bit + 1)
        choices = ((v, (0, 1) if row is None else ((v & row).bit_count() % 2,)) for v in found)
        found = [v | b << bit for v, values in choices for b in values]
    return found
