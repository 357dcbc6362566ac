"""Springs side by side in a slice: where vectors are parallel at every point of it, and how long
they are together.

Guarantee: exact; factors are polynomials over Q in the parameters that are proved to be positive in
the open window.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from flint import fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.question.slice import Axis
from ptmcad.text.expressions import Expression, constant
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.verification.coordinates import evaluated
from ptmcad.verification.windowsigns import Sign, Window, has_no_pole, is_in_domain

Coordinate = Mapping[Any, fmpq_mpoly]
"""One of a vector, by waves."""


class Parameters:
    """A slice's parameters as variables of polynomials: which are numbers, or the same as others,
    and their signs.

    Parameters
    ----------
    values : by name; a variable without one is zero.
    context : the ring, whose variables are the parameters.
    """

    def __init__(
        self,
        values: Iterable[tuple[str, Expression]],
        axes: tuple[Axis, Axis],
        context: fmpq_mpoly_ctx,
    ):
        self.context, known = context, dict(values)
        self.values = [known.get(name, constant(0)) for name in context.names()]
        across, up = ((from_fraction(axis.low), from_fraction(axis.high)) for axis in axes)
        self.window: Window = (across, up)

    def valued(self, f: Coordinate) -> dict[Any, fmpq_mpoly]:
        """The same at every point of the slice, with numbers in place of parameters, and one name
        for equal ones.
        """
        found = {key: self._valued(p) for key, p in f.items()}
        return {key: p for key, p in found.items() if not p.is_zero()}

    def _valued(self, p: fmpq_mpoly) -> fmpq_mpoly:
        found: dict[tuple[int, ...], fmpq] = {}
        for powers, c in p.terms():
            kept, number = [0] * len(powers), c
            for k, power in enumerate(map(int, powers)):
                if power and self.values[k].is_constant:
                    number *= from_fraction(self.values[k].constant()) ** power
                elif power:
                    kept[self.values.index(self.values[k])] += power
            found[tuple(kept)] = found.get(tuple(kept), fmpq(0)) + number
        return self.context.from_dict(found)

    def size(self, p: fmpq_mpoly) -> fmpq_mpoly | None:
        """The absolute value of a polynomial that is proved to be zero nowhere in the window."""
        value = self._expression(p)
        if has_no_pole(value, self.window) is not Sign.PROVED:
            return None
        signs = (
            sign for sign in (1, -1) if is_in_domain(sign * value, self.window, True) is Sign.PROVED
        )
        sign = next(signs, None)
        return None if sign is None else p * sign

    def is_positive_number(self, p: fmpq_mpoly) -> bool:
        """Whether a polynomial in the parameters is the same positive number all over the slice."""
        value = self._expression(p)
        return value.is_constant and value.constant() > 0

    def vanishes(self, p: fmpq_mpoly) -> bool:
        """Whether a polynomial in the parameters is zero all over the slice."""
        return not self._expression(p).numerator

    def _expression(self, p: fmpq_mpoly) -> Expression:
        known = dict(zip(self.context.names(), self.values, strict=True))
        total: Expression = constant(0) + evaluated(p, known)
        return total

    def shares(
        self, d: Sequence[Coordinate], other: Sequence[Coordinate]
    ) -> tuple[fmpq_mpoly, fmpq_mpoly] | None:
        """Positive f and g for which d/f and other/g, or its negative, are the same polynomials;
        None without a proof.

        Parameters
        ----------
        d, other : neither is zero.
        """
        lead = next((k, key) for k in (0, 1) for key in d[k])
        one, two = d[lead[0]][lead[1]], other[lead[0]].get(lead[1])
        if two is None:
            return None
        divisor = one.gcd(two)
        f, g = one / divisor, two / divisor
        if any(p * g != other[k].get(key, 0) * f for k in (0, 1) for key, p in d[k].items()):
            return None
        if any(key not in d[k] for k in (0, 1) for key in other[k]):
            return None
        unit = f.leading_coefficient()  # so that f is 1 where the ratio is a number
        sizes = self.size(f / unit), self.size(g / unit)
        return None if sizes[0] is None or sizes[1] is None else (sizes[0], sizes[1])
