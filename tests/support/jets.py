"""An independent derivation: values in balls with their first and second derivatives by the unknowns.

Guarantee: each ball of a result contains what follows from any numbers in the operands' balls; what does not depend on
an unknown has no entry for it, so that nothing is spent on zeros.
"""

from __future__ import annotations

from typing import TypeVar

from flint import arb, fmpq

Ball = arb | fmpq | int


class Jet:
    """A function of the unknowns at a place.

    Attributes
    ----------
    slopes : first derivatives, by the number of the unknown.
    bends : second derivatives, by two numbers, the smaller first.
    """

    __slots__ = ("bends", "slopes", "value")

    def __init__(self, value: arb, slopes: dict[int, arb], bends: dict[tuple[int, int], arb]):
        self.value, self.slopes, self.bends = value, slopes, bends

    def __add__(self, other: Jet | Ball) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.value + other, self.slopes, self.bends)
        return Jet(self.value + other.value, _sum(self.slopes, other.slopes), _sum(self.bends, other.bends))

    __radd__ = __add__

    def __neg__(self) -> Jet:
        return Jet(-self.value, {i: -x for i, x in self.slopes.items()}, {ij: -x for ij, x in self.bends.items()})

    def __sub__(self, other: Jet | Ball) -> Jet:
        return self + -other

    def __rsub__(self, other: Ball) -> Jet:
        return -self + other

    def __mul__(self, other: Jet | Ball) -> Jet:
        if not isinstance(other, Jet):
            return Jet(
                self.value * other,
                {i: x * other for i, x in self.slopes.items()},
                {ij: x * other for ij, x in self.bends.items()},
            )
        a, b = self.value, other.value
        bends = _sum({ij: x * b for ij, x in self.bends.items()}, {ij: a * x for ij, x in other.bends.items()})
        for i, x in self.slopes.items():
            for j, y in other.slopes.items():
                # the mixed derivative of a product has both orders; on the diagonal they are the same term, twice
                bends = _sum(bends, {(i, j) if i <= j else (j, i): 2 * (x * y) if i == j else x * y})
        slopes = _sum({i: x * b for i, x in self.slopes.items()}, {i: a * x for i, x in other.slopes.items()})
        return Jet(a * b, slopes, bends)

    __rmul__ = __mul__


def circle(number: int, cosine: arb, sine: arb) -> tuple[Jet, Jet]:
    """Cosine and sine of the angle of this number."""
    twice = (number, number)
    return Jet(cosine, {number: -sine}, {twice: -cosine}), Jet(sine, {number: cosine}, {twice: -sine})


def line(number: int, value: arb) -> Jet:
    """The real unknown of this number."""
    return Jet(value, {number: arb(1)}, {})


def jet_of(value: Jet | Ball) -> Jet:
    """What no unknown is in, as a function of the unknowns."""
    return value if isinstance(value, Jet) else Jet(arb(value), {}, {})


_Key = TypeVar("_Key", int, tuple[int, int])


def _sum(left: dict[_Key, arb], right: dict[_Key, arb]) -> dict[_Key, arb]:
    total = dict(left)
    for key, value in right.items():
        total[key] = total[key] + value if key in total else value
    return total
