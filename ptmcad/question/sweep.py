"""A sweep: which values some parameters take together, as products of lists and progressions, one
after another.

Guarantee: values are exact, and the members of a sweep are numbered from 0 in the order of the
record: products in their order, of each the last parameter's value changing fastest. Nothing is
listed that a progression describes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import prod


@dataclass(frozen=True, slots=True)
class Spaced:
    """``number`` values, each a ``step`` from the one before; the step may be negative."""

    first: Fraction
    step: Fraction
    number: int

    def __len__(self) -> int:
        return self.number

    def __getitem__(self, number: int) -> Fraction:
        return self.first + number * self.step


Values = Spaced | tuple[Fraction, ...]
Product = Mapping[str, Values]
"""Every combination of the parameters' values."""


@dataclass(frozen=True, slots=True)
class Sweep:
    """Products of values, one after another; all of them are of the same parameters.

    >>> half = Spaced(Fraction(0), Fraction(1, 2), 3)
    >>> sweep = Sweep(({"F3": (Fraction(-10),), "F4": half},))
    >>> len(sweep), sweep[1]
    (3, {'F3': Fraction(-10, 1), 'F4': Fraction(1, 2)})
    """

    products: tuple[Product, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """What is swept, in the record's order."""
        return tuple(self.products[0])

    def __len__(self) -> int:
        return sum(map(_size, self.products))

    def __getitem__(self, number: int) -> dict[str, Fraction]:
        """The values of a member.

        Raises
        ------
        IndexError
            When there is no such member.
        """
        rest = number
        for product in self.products:
            if 0 <= rest < _size(product):
                chosen = _chosen(product, rest)
                return {name: chosen[name] for name in self.names}
            rest -= _size(product)
        raise IndexError(f"there is no member {number} of {len(self)}")


def _size(product: Product) -> int:
    return prod(map(len, product.values()))


def _chosen(product: Product, number: int) -> dict[str, Fraction]:
    """The values of one combination, the last parameter's changing fastest."""
    chosen = {}
    for name, values in reversed(tuple(product.items())):
        number, place = divmod(number, len(values))
        chosen[name] = values[place]
    return chosen
